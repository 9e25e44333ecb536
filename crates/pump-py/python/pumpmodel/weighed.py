"""Weighed runs and short doses, and the fit to short doses."""

import json
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

from pumpmodel._pumpmodel import Calibration, _number, _reading
from pumpmodel._results.numbers import Number, floats_of
from pumpmodel._results.record import Record
from pumpmodel.errors import DriveError


@dataclass(frozen=True, kw_only=True)
class WeighedRun(Record):
    """A run at constant speed, with the reading of a scale or a vessel.

    Parameters
    ----------
    speed_rpm : float
        Cruise speed, r/min.
    turned_deg : float
        Angle that the rotor turned, deg; negative in reverse.
    mass_g : float, optional
        Reading of the scale, g.
    volume_ml : float, optional
        Reading of a measuring vessel, mL. Give at most one of `mass_g` and `volume_ml`; a fit needs one.
    start_angle_deg : float, optional
        Angle of the rollers at the start, deg; whole pitches do not need it.
    temperature_degc : float, optional
        Temperature of the fluid, degC; by default the pump file's.
    time : str, optional
        Time of the run, as it was written down.
    warnings : tuple of str, optional
        Warnings of the run that `Bench.calibration_run` made.

    Raises
    ------
    ValueError
        If a number is not allowed, or both readings are given.
    """

    speed_rpm: float
    turned_deg: float
    mass_g: float | None = None
    volume_ml: float | None = None
    start_angle_deg: float | None = None
    temperature_degc: float | None = None
    time: str | None = None
    warnings: tuple[str, ...] = ()

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            speed_rpm: Number,
            turned_deg: Number,
            mass_g: Number | None = None,
            volume_ml: Number | None = None,
            start_angle_deg: Number | None = None,
            temperature_degc: Number | None = None,
            time: str | None = None,
            warnings: tuple[str, ...] = (),
        ) -> None: ...

    def __post_init__(self) -> None:
        """Refuse an impossible run."""
        floats_of(
            self,
            "speed_rpm",
            "turned_deg",
            "mass_g",
            "volume_ml",
            "start_angle_deg",
            "temperature_degc",
        )
        if not 0 < self.speed_rpm < math.inf:
            raise ValueError(f"speed_rpm is {self.speed_rpm}; allowed: more than 0")
        if self.turned_deg == 0 or not abs(self.turned_deg) < math.inf:
            raise ValueError(f"turned_deg is {self.turned_deg}; allowed: a finite angle, not 0")
        if self.mass_g is not None and self.volume_ml is not None:
            raise ValueError("mass_g and volume_ml are both given; give one")
        for name in ("mass_g", "volume_ml"):
            reading = getattr(self, name)
            if reading is not None and not 0 < reading < math.inf:
                raise ValueError(f"{name} is {reading}; allowed: more than 0")

    def weighed(self, reading: str, *, temperature_degc: Number | None = None) -> Self:
        """Return the run with a reading.

        Parameters
        ----------
        reading : str
            Reading of scale or vessel, as "42.51g" or "42.6mL".
        temperature_degc : float, optional
            Temperature of the fluid, degC; by default the temperature of the run.

        Raises
        ------
        TypeError
            If the reading is a bare number.
        ValueError
            If the text is neither a mass nor a volume.
        """
        mass_g, volume_ml = _reading(reading)
        degc = self.temperature_degc
        if temperature_degc is not None:
            degc = _number("temperature_degc", temperature_degc)
        return replace(self, mass_g=mass_g, volume_ml=volume_ml, temperature_degc=degc)

    @classmethod
    def _made(cls, made: tuple[float, float | None, float, str, bool, list[str]]) -> Self:
        speed_rpm, start_angle_deg, turned_deg, time, whole, warnings = made
        if not whole:
            raise DriveError("the run was stopped and is on record; do not weigh a part of a run")
        return cls(
            speed_rpm=speed_rpm,
            turned_deg=turned_deg,
            start_angle_deg=start_angle_deg,
            time=time,
            warnings=tuple(warnings),
        )

    def _json(self) -> str:
        if self.mass_g is None and self.volume_ml is None:
            raise ValueError('a run has no reading; add it, as run.weighed("42.51g")')
        reading: dict[str, Any] = (
            {"volume_ml": self.volume_ml} if self.mass_g is None else {"mass_g": self.mass_g}
        )
        data = self.to_dict()
        del data["mass_g"], data["volume_ml"], data["warnings"]
        return json.dumps({**data, "reading": reading})


@dataclass(frozen=True, kw_only=True)
class ShortDose(Record):
    """A short dose from a known angle, with the volume that arrived.

    Parameters
    ----------
    start_angle_deg : float
        Angle of the rollers at the start, by the record, deg.
    turned_deg : float
        Angle that the rotor turned, deg; negative in reverse.
    volume_ml : float
        Volume that arrived, mL, without sign.
    speed_rpm : float, optional
        Cruise speed of the dose, r/min; by default the mean speed of the calibration's runs.

    Raises
    ------
    ValueError
        If a number is not allowed.
    """

    start_angle_deg: float
    turned_deg: float
    volume_ml: float
    speed_rpm: float | None = None

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            start_angle_deg: Number,
            turned_deg: Number,
            volume_ml: Number,
            speed_rpm: Number | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Refuse an impossible dose."""
        floats_of(self, "start_angle_deg", "turned_deg", "volume_ml", "speed_rpm")
        if not abs(self.start_angle_deg) < math.inf:
            raise ValueError(f"start_angle_deg is {self.start_angle_deg}; allowed: a finite angle")
        if self.turned_deg == 0 or not abs(self.turned_deg) < math.inf:
            raise ValueError(f"turned_deg is {self.turned_deg}; allowed: a finite angle, not 0")
        if not 0 < self.volume_ml < math.inf:
            raise ValueError(f"volume_ml is {self.volume_ml}; allowed: more than 0")
        if self.speed_rpm is not None and not 0 < self.speed_rpm < math.inf:
            raise ValueError(f"speed_rpm is {self.speed_rpm}; allowed: more than 0")


@dataclass(frozen=True)
class PhaseFit:
    """Fit to short doses with its standard uncertainties, and the calibration that keeps all three.

    `zero_rad` is the model angle of the rollers at the record's angle 0.
    """

    calibration: Calibration
    roller_volume_ml: float
    roller_volume_standard_ml: float
    engagement_rad: float
    engagement_standard_rad: float
    zero_rad: float
    zero_standard_rad: float

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.shown import phase_html

        return phase_html(self)
