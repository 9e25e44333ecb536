"""Volume against speed; experimental."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from pumpmodel import _pumpmodel as core
from pumpmodel._pumpmodel import Pump
from pumpmodel._record import Record


@dataclass(frozen=True, kw_only=True)
class SpeedLaw(Record):
    """How the volume of a revolution depends on the speed, by the inlet pressure that traps a segment.

    Experimental: doses use it where the pump's `[speed_law]` or a calibration says so. The published
    parameters are fitted to summary numbers of McIntyre et al.

    Parameters
    ----------
    scale : float
        Volume between two rollers over that of the round tube.
    distensibility_per_kpa : float
        How much more a segment holds for more pressure, 1/kPa, 0 to 1.
    closure_rad : float
        Where an engaging roller closes the lumen, rad.
    ambient_kpa : float
        Ambient pressure, kPa absolute.

    Raises
    ------
    ValueError
        If a value is outside its range.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> law, pump = pm.SpeedLaw.published(), pm.Pump.three_roller()
    >>> law.revolution_ml(pump, speed_rpm=150) > law.revolution_ml(pump, speed_rpm=10)
    True
    """

    scale: float
    distensibility_per_kpa: float
    closure_rad: float
    ambient_kpa: float

    def __post_init__(self) -> None:
        """Refuse parameters that are no law's."""
        core._law_check(self._numbers())

    @classmethod
    def published(cls) -> Self:
        """Return the law fitted to what McIntyre et al. publish of their pump."""
        scale, distensibility, closure, ambient = core._law_published()
        return cls(
            scale=scale, distensibility_per_kpa=distensibility, closure_rad=closure, ambient_kpa=ambient
        )

    def revolution_ml(
        self,
        pump: Pump,
        *,
        speed_rpm: float | NDArray[Any] | Sequence[Any] | None = None,
        speed_rad_s: float | NDArray[Any] | Sequence[Any] | None = None,
    ) -> float | NDArray[np.float64]:
        """Return the volume of a revolution.

        Parameters
        ----------
        pump : Pump
            The pump.
        speed_rpm : float or array_like
            Speed of the pump head, r/min, not zero; negative in reverse.
        speed_rad_s : float or array_like
            The same in rad/s; exactly one of both is given.

        Returns
        -------
        float or numpy.ndarray
            mL; of arrays an array of float64 of the same shape.

        Raises
        ------
        ValueError
            If a speed is not allowed.
        """
        return core._law_revolution(self._numbers(), pump, speed_rpm, speed_rad_s)

    def trapped_kpa(
        self,
        pump: Pump,
        *,
        speed_rpm: float | NDArray[Any] | Sequence[Any] | None = None,
        speed_rad_s: float | NDArray[Any] | Sequence[Any] | None = None,
    ) -> float | NDArray[np.float64]:
        """Return the inlet pressure of the steady state when a roller closes the lumen.

        Parameters and errors are those of `revolution_ml`.

        Returns
        -------
        float or numpy.ndarray
            kPa absolute; of arrays an array of float64 of the same shape.
        """
        return core._law_trapped(self._numbers(), pump, speed_rpm, speed_rad_s)

    def _numbers(self) -> tuple[float, float, float, float]:
        return (self.scale, self.distensibility_per_kpa, self.closure_rad, self.ambient_kpa)
