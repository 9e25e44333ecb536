"""The experimental law of volume against speed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from pumpmodel import _pumpmodel as core
from pumpmodel._pumpmodel import Pump
from pumpmodel._results.numbers import Number, floats_of
from pumpmodel._results.record import Record


@dataclass(frozen=True, kw_only=True)
class SpeedLaw(Record):
    """Law of the volume of a revolution against speed: the inlet pressure fixes the volume that is trapped.

    The law is experimental. Doses use it if the pump's `[speed_law]` or a calibration has it. The published
    parameters are fitted to summary numbers of McIntyre et al.

    Parameters
    ----------
    scale : float
        Volume between two rollers over the volume of the round tube.
    distensibility_per_kpa : float
        Relative growth of a segment's volume with pressure, 1/kPa, 0 to 1.
    closure_rad : float
        Angle after first contact at which an engaging roller closes the lumen, rad.
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

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            scale: Number,
            distensibility_per_kpa: Number,
            closure_rad: Number,
            ambient_kpa: Number,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Refuse parameters that no speed law has."""
        floats_of(self, "scale", "distensibility_per_kpa", "closure_rad", "ambient_kpa")
        core._law_check(self._numbers())

    @classmethod
    def published(cls) -> Self:
        """Return the law fitted to the numbers that McIntyre et al. publish of their pump."""
        scale, distensibility, closure, ambient = core._law_published()
        return cls(
            scale=scale, distensibility_per_kpa=distensibility, closure_rad=closure, ambient_kpa=ambient
        )

    def revolution_ml(
        self,
        pump: Pump,
        *,
        speed_rpm: Number | NDArray[Any] | Sequence[Any] | None = None,
        speed_rad_s: Number | NDArray[Any] | Sequence[Any] | None = None,
    ) -> float | NDArray[np.float64]:
        """Return the volume of a revolution.

        Parameters
        ----------
        pump : Pump
            Pump whose volume and inlet line count.
        speed_rpm : float or array_like
            Speed of the pump head, r/min, not zero; negative in reverse.
        speed_rad_s : float or array_like
            Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.

        Returns
        -------
        float or numpy.ndarray
            Volume, mL, negative in reverse. Array input gives an array of float64 of its shape.

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
        speed_rpm: Number | NDArray[Any] | Sequence[Any] | None = None,
        speed_rad_s: Number | NDArray[Any] | Sequence[Any] | None = None,
    ) -> float | NDArray[np.float64]:
        """Return the inlet pressure of the steady state when a roller closes the lumen.

        Parameters
        ----------
        pump : Pump
            Pump whose volume and inlet line count.
        speed_rpm : float or array_like
            Speed of the pump head, r/min, not zero; negative in reverse.
        speed_rad_s : float or array_like
            Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.

        Returns
        -------
        float or numpy.ndarray
            Pressure, kPa absolute. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If a speed is not allowed.
        """
        return core._law_trapped(self._numbers(), pump, speed_rpm, speed_rad_s)

    def _numbers(self) -> tuple[float, float, float, float]:
        return (self.scale, self.distensibility_per_kpa, self.closure_rad, self.ambient_kpa)
