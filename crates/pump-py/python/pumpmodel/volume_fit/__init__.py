"""The volume of a roller: from measured points, from a function of the angle, or from coefficients."""

from pumpmodel.volume_fit.fit import Fall, RunFall, VolumeFit
from pumpmodel.volume_fit.polynomial import VolumePolynomial

__all__ = ["Fall", "RunFall", "VolumeFit", "VolumePolynomial"]
