"""The angle over which a roller engages, as an argument."""

from numpy.typing import ArrayLike

from pumpmodel import _pumpmodel as core


def engagement_of(engagement_deg: ArrayLike) -> float:
    """Return the angle over which a roller engages, deg, or refuse it."""
    angle = core._numbers("engagement_deg", engagement_deg)
    if not isinstance(angle, float):
        raise ValueError(f"engagement_deg has the shape {angle.shape}; allowed: one number")
    if not 0 < angle < 360:
        raise ValueError(f"engagement_deg is {angle:.6g}; allowed: more than 0 and less than 360")
    return angle
