import os
from collections.abc import Sequence
from typing import Any, TypeAlias, final, overload

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray
from pandas import Series

from pumpmodel.choices import CalibrationFit, Finish, Ramps
from pumpmodel.weighed import WeighedRun

from .pump import Pump
from .results import Plan

# A number of Python or NumPy.
_Number: TypeAlias = float | np.floating[Any] | np.integer[Any]
_Array: TypeAlias = NDArray[np.float64]
# Arguments that become an array; a single number stays a number.
_Numbers: TypeAlias = NDArray[np.floating[Any] | np.integer[Any]] | Sequence[Any] | Series[Any]

@final
class Limits:
    """Pressure limits that a dose must keep. A limit that is left out is the pump file's, if it has one.

    In reverse the outlet limit applies to the inlet, which then pushes, and the inlet limit to the outlet.

    Parameters
    ----------
    max_outlet_kpa : float, optional
        Largest pressure at the port that pushes, kPa absolute, 1e-9 to 1e6.
    min_inlet_kpa : float, optional
        Smallest pressure at the port that sucks, kPa absolute, up to 1e6 either way.

    Raises
    ------
    ValueError
        If a limit is outside its range.
    """

    def __new__(
        cls, *, max_outlet_kpa: _Number | None = None, min_inlet_kpa: _Number | None = None
    ) -> Limits: ...
    @property
    def max_outlet_kpa(self) -> float | None:
        """Largest pressure at the port that pushes, kPa absolute, or None."""
    @property
    def min_inlet_kpa(self) -> float | None:
        """Smallest pressure at the port that sucks, kPa absolute, or None."""
    def to_dict(self) -> dict[str, float | None]:
        """Return the limits as plain data.

        Returns
        -------
        dict
            `max_outlet_kpa` and `min_inlet_kpa`, floats or None. `Limits(**...)` reads them back.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Calibration:
    """Volume that a pump really displaces, from weighed runs, with its uncertainty.

    `Calibration.from_runs`, `Calibration.from_csv`, `Bench.calibrate` and `Bench.calibrations` make calibrations. A
    dose's volume is the model's volume times `displacement_factor`: measured over model volume, which may change with
    the speed. `version` is the calibration's number on a bench, or 0 without a bench.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pump = pm.Pump.three_roller()
    >>> runs = [pm.WeighedRun(speed_rpm=60, turned_deg=720, volume_ml=v) for v in (43.0, 43.1, 43.05)]
    >>> calibration = pm.Calibration.from_runs(pump, runs)
    >>> round(calibration.displacement_factor(speed_rpm=60), 4)
    1.0097
    >>> pm.Doser(pump, calibration=calibration).plan("25mL", speed="60rpm").steps < pm.Doser(pump).plan("25mL").steps
    True
    """

    @staticmethod
    def from_runs(
        pump: Pump, runs: Sequence[WeighedRun], *, scale: str | None = None, fit: CalibrationFit = "best"
    ) -> Calibration:
        """Calibrate a pump by weighed runs.

        Parameters
        ----------
        pump : Pump
            Pump whose fluid was weighed.
        runs : sequence of WeighedRun
            Runs with their readings.
        scale : str, optional
            Standard uncertainty of a reading, as "0.01g" or "0.1mL".
        fit : {"best", "line", "factor", "speed-law"}
            "best" fits a straight line over the speed, or a parabola where an F test at four speeds or more asks for
            it. "line" fits a straight line alone, "factor" one factor for every speed. "speed-law" fits s and D of
            the speed law to three speeds or more.

        Raises
        ------
        ValueError
            If there are no runs, or a run is impossible.
        """
    @staticmethod
    def from_csv(
        pump: Pump, path: str | os.PathLike[str], *, scale: str | None = None, fit: CalibrationFit = "best"
    ) -> Calibration:
        """Calibrate a pump by a table of weighed runs, as `dose calibrate run --from` reads it.

        Parameters
        ----------
        pump : Pump
            Pump whose fluid was weighed.
        path : str or os.PathLike
            CSV with a header. Columns are `speed_rpm`, one of `turned_deg`, `revolutions` and `steps`, and one of
            `mass_g` and `volume_ml`; optional are `start_angle_deg`, `direction`, `temperature_degc` and `time`.
        scale : str, optional
            Standard uncertainty of a reading, as "0.01g" or "0.1mL".
        fit : {"best", "line", "factor", "speed-law"}
            "best" fits a straight line over the speed, or a parabola where an F test at four speeds or more asks for
            it. "line" fits a straight line alone, "factor" one factor for every speed. "speed-law" fits s and D of
            the speed law to three speeds or more.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If the file is no such table, or a run is impossible.
        """
    @staticmethod
    def from_dict(data: dict[str, Any]) -> Calibration:
        """Return the calibration of the data that `to_dict` gave.

        Parameters
        ----------
        data : dict
            Data that `to_dict` returned. Numbers and arrays of NumPy are taken too.

        Raises
        ------
        TypeError
            If `data` is no dict, or holds something that is no plain data.
        ValueError
            If the data are no calibration, or a number is none that weighed runs give. The message has the key.
        """
    def to_dict(self) -> dict[str, Any]:
        """Return the calibration as plain data, as `dose calibrate list --format json` prints it.

        Returns
        -------
        dict
            Numbers, texts, lists and dicts only, raw data included.
        """
    @overload
    def displacement_factor(
        self,
        *,
        speed_rpm: _Number | None = None,
        speed_rad_s: _Number | None = None,
        pump: Pump | None = None,
    ) -> float:
        """Return measured over model volume at a cruise speed.

        Parameters
        ----------
        speed_rpm : float or array_like
            Cruise speed of the pump head, r/min.
        speed_rad_s : float or array_like
            Cruise speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
        pump : Pump, optional
            Pump, which a fitted speed law needs to compute the trapped volume.

        Returns
        -------
        float or numpy.ndarray
            Factor; 1 while only the zero was sought. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If not exactly one speed is given, or if a speed law was fitted and no pump is given.
        """
    @overload
    def displacement_factor(
        self, *, speed_rpm: _Numbers, speed_rad_s: None = None, pump: Pump | None = None
    ) -> _Array: ...
    @overload
    def displacement_factor(
        self, *, speed_rpm: None = None, speed_rad_s: _Numbers, pump: Pump | None = None
    ) -> _Array: ...
    @overload
    def standard_uncertainty(
        self,
        *,
        speed_rpm: _Number | None = None,
        speed_rad_s: _Number | None = None,
        pump: Pump | None = None,
    ) -> float:
        """Return the standard uncertainty of `displacement_factor`.

        It is widened so that twice its value covers 95 % for any number of runs, and includes the lack of fit.

        Parameters
        ----------
        speed_rpm : float or array_like
            Cruise speed of the pump head, r/min.
        speed_rad_s : float or array_like
            Cruise speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
        pump : Pump, optional
            Pump, which a fitted speed law needs to compute the trapped volume.

        Returns
        -------
        float or numpy.ndarray
            Standard uncertainty; 0 while only the zero was sought. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If not exactly one speed is given, or if a speed law was fitted and no pump is given.
        """
    @overload
    def standard_uncertainty(
        self, *, speed_rpm: _Numbers, speed_rad_s: None = None, pump: Pump | None = None
    ) -> _Array: ...
    @overload
    def standard_uncertainty(
        self, *, speed_rpm: None = None, speed_rad_s: _Numbers, pump: Pump | None = None
    ) -> _Array: ...
    @property
    def version(self) -> int:
        """Number of the calibration on its bench; 0 without a bench."""
    @property
    def date(self) -> str:
        """Time at which the calibration was made, UTC."""
    @property
    def fluid(self) -> str:
        """Name of the fluid that was weighed."""
    @property
    def temperature_degc(self) -> float:
        """Mean temperature of that fluid, °C."""
    @property
    def tube(self) -> str | None:
        """Name that the user gave the tube, or None."""
    @property
    def note(self) -> str | None:
        """Note of the user, or None."""
    @property
    def revolution_ml(self) -> float:
        """Model volume of a revolution that the factors multiply, mL."""
    @property
    def speeds_rpm(self) -> list[float]:
        """Speeds of the runs, r/min, rising."""
    @property
    def scatter(self) -> float | None:
        """\
        Standard deviation of the runs about the fit, as a fraction of the volume; None if there were too few runs.
        """
    @property
    def outliers(self) -> list[int]:
        """Numbers, from 1, of runs that lie far from the others. The fit includes them."""
    @property
    def zero_rad(self) -> float:
        """Model angle of the rollers at the record's angle 0, rad."""
    @property
    def roller_volume_ml(self) -> tuple[float, float] | None:
        """Roller volume V_r that short doses found and its standard uncertainty, mL; None if the pump's own holds."""
    @property
    def engagement_rad(self) -> tuple[float, float] | None:
        """\
        Engagement angle phi that short doses found and its standard uncertainty, rad; None if the pump's own holds.
        """
    def plot(self, *, pump: Pump | None = None, ax: Axes | None = None) -> Axes:
        """Draw the displacement factor over the speed, with the band that covers 95 %.

        Parameters
        ----------
        pump : Pump, optional
            Pump of the calibration. With it the weighed runs are drawn as points; a fitted speed law needs it.
        ax : Axes, optional
            Axes to draw in. By default a new figure.

        Returns
        -------
        Axes
            Axes over the speed.

        Raises
        ------
        ValueError
            If a speed law was fitted and no pump is given, or the calibration has no runs.
        ImportError
            If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
        """
    def _repr_html_(self) -> str:
        """Return what a notebook shows: a table of the main numbers and a small picture, as HTML."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Doser:
    """Plans doses of a pump within its limits.

    Parameters
    ----------
    pump : Pump
        Pump that doses.
    limits : Limits, optional
        Pressure limits that replace the pump file's.
    calibration : Calibration, optional
        Calibration of the volume. Without one, volume and uncertainty are the model's.

    Raises
    ------
    ValueError
        If a limit is outside its range.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> plan = pm.Doser(pm.Pump.three_roller()).plan("25mL", rate="10 mL/s")
    >>> plan.steps
    15480
    """

    def __new__(
        cls, pump: Pump, limits: Limits | None = None, calibration: Calibration | None = None
    ) -> Doser: ...
    @property
    def pump(self) -> Pump:
        """Pump that doses."""
    @property
    def limits(self) -> Limits:
        """Pressure limits that replace the pump file's."""
    @property
    def calibration(self) -> Calibration | None:
        """Calibration of the volume, or None."""
    def plan(
        self,
        volume: str,
        *,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        finish: Finish = "any",
        ramps: Ramps = "line",
        retract: str | None = None,
        start_angle_rad: _Number | None = None,
        start_half_width_rad: _Number = 0.0,
        carry_in_ml: _Number = 0.0,
    ) -> Plan:
        """Plan a dose and predict its pressures. Nothing moves. Other Python threads run meanwhile.

        Parameters
        ----------
        volume : str
            Volume or mass with its unit, as "25mL", "0.025 L", "250uL", "25 g"; negative in reverse.
        rate : str, optional
            Average flow while cruising, as "10 mL/s"; "max" is the fastest flow that holds every limit.
        speed : str, optional
            Speed of the pump head while cruising, as "100rpm".
        within : str, optional
            Total time with ramps and settling, as "10s"; the plan takes the slowest cruise that meets it. Give at most
            one of `rate`, `speed` and `within`. The default is the pump's `default_rate_ml_s`.
        smooth : bool
            Let the speed follow the rollers' angle, so that the flow at the outlet is as smooth as the motor's speed
            and acceleration allow. Rate and speed are then means over whole pitches.
        finish : {"any", "low-flow"}
            Places in a pitch where the dose may end. At "low-flow" the outlet's flow is at most half of the flow
            between pulses. The plan takes the nearest such end and carries the difference.
        ramps : {"line", "fastest"}
            Ramps in which the dose starts and stops. Line-aware ramps leave the outlet's line nearly at rest, so that
            it settles soonest and takes little back. "fastest" is the motor's largest acceleration.
        retract : str, optional
            Volume that is sucked back after the dose, as "0.1mL", so that nothing drips. `carry_ml` includes it, so the
            next dose repays it.
        start_angle_rad : float, optional
            Angle of the rollers at the start, rad; by default 0. Only the angle within a pitch matters.
        start_half_width_rad : float
            Half width of the start angle, rad: the true angle lies within it on either side. Half a pitch and more, as
            `math.pi`, means an unknown angle. The plan then has the smallest worst case over all angles, and whole
            pitches are exact.
        carry_in_ml : float
            Carry from earlier doses, mL, positive toward the outlet: `carry_ml` of the previous plan.

        Returns
        -------
        Plan
            Steps, times and predicted pressures.

        Raises
        ------
        TypeError
            If a quantity is a bare number.
        ValueError
            If a text is not the expected quantity, or a number is outside its range.
        PlanError
            If the pump cannot make the dose, for example because its rate or pressure is beyond a limit.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
