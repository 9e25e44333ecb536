import os
from collections.abc import Callable, Sequence
from typing import Any, Literal, TypeAlias, final, overload

import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray
from pandas import Series
from typing_extensions import deprecated

from pumpmodel._results.harmonics import Harmonics
from pumpmodel._results.states import LineStates
from pumpmodel.choices import Begin, Initial, Method, Model, Port, Variant
from pumpmodel.volume_fit import VolumeFit, VolumePolynomial

from .results import Run, SteadyState

# A number of Python or NumPy.
_Number: TypeAlias = float | np.floating[Any] | np.integer[Any]
_Array: TypeAlias = NDArray[np.float64]
# Arguments that become an array; a single number stays a number.
_Numbers: TypeAlias = NDArray[np.floating[Any] | np.integer[Any]] | Sequence[Any] | Series[Any]

@final
class Line:
    """\
    Hydraulic line between the rollers and a reservoir: compliance at the pump, resistance and inertance in series.

    Parameters
    ----------
    resistance_kpa_s_ml : float
        R, kPa s/mL, zero or more.
    compliance_ml_kpa : float
        C, mL/kPa, more than zero.
    inertance_kpa_s2_ml : float
        L, kPa s²/mL, more than zero.
    reservoir_kpa : float
        Pressure of the reservoir, kPa absolute, more than zero.

    Raises
    ------
    ValueError
        If a value is outside its range.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> line = pm.Line(
    ...     resistance_kpa_s_ml=0.1108, compliance_ml_kpa=0.0361, inertance_kpa_s2_ml=0.0042, reservoir_kpa=88.637
    ... )
    >>> line == pm.Pump.three_roller().outlet
    True
    """

    def __new__(
        cls,
        *,
        resistance_kpa_s_ml: _Number,
        compliance_ml_kpa: _Number,
        inertance_kpa_s2_ml: _Number,
        reservoir_kpa: _Number,
    ) -> Line: ...
    @property
    def resistance_kpa_s_ml(self) -> float:
        """Resistance R, kPa s/mL."""
    @property
    def compliance_ml_kpa(self) -> float:
        """Compliance C, mL/kPa."""
    @property
    def inertance_kpa_s2_ml(self) -> float:
        """Inertance L, kPa s²/mL."""
    @property
    def reservoir_kpa(self) -> float:
        """Pressure of the reservoir, kPa absolute."""
    def replace(
        self,
        *,
        resistance_kpa_s_ml: _Number | None = None,
        compliance_ml_kpa: _Number | None = None,
        inertance_kpa_s2_ml: _Number | None = None,
        reservoir_kpa: _Number | None = None,
    ) -> Line:
        """Return this line with some values replaced. A value that is left out stays.

        Parameters
        ----------
        resistance_kpa_s_ml : float, optional
            R, kPa s/mL, zero or more.
        compliance_ml_kpa : float, optional
            C, mL/kPa, more than zero.
        inertance_kpa_s2_ml : float, optional
            L, kPa s²/mL, more than zero.
        reservoir_kpa : float, optional
            Pressure of the reservoir, kPa absolute, more than zero.

        Raises
        ------
        ValueError
            If a value is outside its range.
        """
    def to_dict(self) -> dict[str, float]:
        """Return the line as plain data.

        Returns
        -------
        dict
            The four floats of the line by their names. `Line(**...)` reads them back.
        """
    def state_space(self, port: Port = "outlet") -> tuple[_Array, _Array, _Array, _Array]:
        """Return the matrices A, B, C and D of the line: dx/dt = A x + B u, y = C x + D u.

        The input u is the flow at the rollers, mL/s, and the output y the pressure at the port above the reservoir's,
        kPa. The states x are that pressure, kPa, and the flow in the line, mL/s. `scipy.signal.StateSpace(*matrices)`
        and `control.ss(*matrices)` take them.

        Parameters
        ----------
        port : {"outlet", "inlet"}
            Port of the line. The rollers push into the outlet's line and suck from the inlet's.

        Returns
        -------
        tuple of numpy.ndarray
            Arrays of float64 of the shapes (2, 2), (2, 1), (1, 2) and (1, 1).

        Raises
        ------
        ValueError
            If no port has this name.

        Examples
        --------
        >>> import pumpmodel as pm
        >>> a, b, c, d = pm.Pump.three_roller().outlet.state_space()
        >>> a.shape, b.shape, c.shape, d.shape
        ((2, 2), (2, 1), (1, 2), (1, 1))
        """
    def transfer_function(self, port: Port = "outlet") -> tuple[_Array, _Array]:
        """\
        Return numerator and denominator of the transfer function from the flow at the rollers, mL/s, to the pressure at
        the port above the reservoir's, kPa: +-(L s + R) / (L C s² + R C s + 1), highest power of s first.

        `scipy.signal.TransferFunction(*both)` and `control.tf(*both)` take them.

        Parameters
        ----------
        port : {"outlet", "inlet"}
            Port of the line. At the inlet the sign is negative: a flow into the pump lowers the pressure.

        Returns
        -------
        tuple of numpy.ndarray
            Arrays of float64 of the shapes (2,) and (3,).

        Raises
        ------
        ValueError
            If no port has this name.

        Examples
        --------
        >>> import pumpmodel as pm
        >>> numerator, denominator = pm.Pump.three_roller().outlet.transfer_function()
        >>> float(denominator[-1])
        1.0
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class LineLikelihood:
    """Likelihood of lines, for the pressure over time while a pump turns, with white noise of the sensor.

    The measurement is read once, so that a call is quick: it is made for samplers and minimizers. Samples at equal
    intervals take least. It can be pickled, as pools of processes need it.

    Parameters
    ----------
    pump : Pump
        Pump of the line. Its flow counts as known, and its line stands where a call gives no other value.
    time_s : array_like
        Times, s, rising, shape (n,).
    pressure_kpa : array_like
        Pressures at the port, kPa absolute, shape (n,).
    standard_kpa : float
        Standard deviation of the noise, kPa, more than zero.
    port : {"outlet", "inlet"}
        Port whose pressure was measured.
    speed_rpm : float
        Speed of the pump head, r/min; negative in reverse; not zero.
    speed_rad_s : float
        Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    begin : {"ramp", "step", "steady"}
        Motion at the start of the record: from rest with the pump's acceleration, from rest at full speed, or turning
        long before.
    start_s : float, optional
        Time at which the pump began to turn, s; by default 0.
    start_angle_rad : float, optional
        Angle at the start, or at time 0 of a steady record, rad; by default 0.

    Raises
    ------
    ValueError
        If an argument is not allowed, or if the samples are not finite or not in order of time.
    MemoryError
        If there is no room for the samples.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pump = pm.Pump.three_roller()
    >>> run = pump.simulate(speed_rpm=100, duration_s=1)
    >>> likelihood = pm.LineLikelihood(
    ...     pump, time_s=run.time_s, pressure_kpa=run.outlet_kpa, standard_kpa=0.1, speed_rpm=100, begin="step"
    ... )
    >>> likelihood.log_likelihood() > likelihood.log_likelihood(inertance_kpa_s2_ml=0.006)
    True
    """

    @overload
    def __new__(
        cls,
        pump: Pump,
        *,
        time_s: ArrayLike,
        pressure_kpa: ArrayLike,
        standard_kpa: _Number,
        port: Port = "outlet",
        speed_rpm: _Number,
        speed_rad_s: None = None,
        begin: Begin = "ramp",
        start_s: _Number | None = None,
        start_angle_rad: _Number | None = None,
    ) -> LineLikelihood: ...
    @overload
    def __new__(
        cls,
        pump: Pump,
        *,
        time_s: ArrayLike,
        pressure_kpa: ArrayLike,
        standard_kpa: _Number,
        port: Port = "outlet",
        speed_rpm: None = None,
        speed_rad_s: _Number,
        begin: Begin = "ramp",
        start_s: _Number | None = None,
        start_angle_rad: _Number | None = None,
    ) -> LineLikelihood: ...
    @property
    def line(self) -> Line:
        """Line of the pump, whose values stand where a call gives no other."""
    @overload
    def log_likelihood(
        self,
        *,
        resistance_kpa_s_ml: _Number | None = None,
        compliance_ml_kpa: _Number | None = None,
        inertance_kpa_s2_ml: _Number | None = None,
        reservoir_kpa: _Number | None = None,
        start_angle_rad: _Number | None = None,
        start_s: _Number | None = None,
        standard_kpa: _Number | None = None,
    ) -> float:
        """Return the natural logarithm of the likelihood of a line. Other Python threads run meanwhile.

        It is -S/(2 standard²) - n/2 ln(2 pi standard²), where S is the sum of the squares of measured less model.

        Arguments may be arrays, as of the walkers of a sampler: they are broadcast.

        Parameters
        ----------
        resistance_kpa_s_ml : float or array_like, optional
            R, kPa s/mL, 0 to 1e6; by default that of the pump's line.
        compliance_ml_kpa : float or array_like, optional
            C, mL/kPa, 1e-6 to 1e6; by default that of the pump's line.
        inertance_kpa_s2_ml : float or array_like, optional
            L, kPa s²/mL, 1e-6 to 1e6; by default that of the pump's line.
        reservoir_kpa : float or array_like, optional
            Pressure of the reservoir, kPa absolute, 0.001 to 1e6; by default that of the pump's line.
        start_angle_rad : float or array_like, optional
            Angle at the start, or at time 0 of a steady record, rad; by default as given at the beginning.
        start_s : float or array_like, optional
            Time at which the pump began to turn, s; by default as given at the beginning.
        standard_kpa : float or array_like, optional
            Standard deviation of the noise, kPa, more than zero; by default as given at the beginning.

        Returns
        -------
        float or numpy.ndarray
            Logarithm of the likelihood. Array input gives an array of float64 of the arguments' common shape.

        Raises
        ------
        ValueError
            If a value is outside its range, or if a line without resistance resonates at a steady speed.
        """
    @overload
    def log_likelihood(
        self,
        *,
        resistance_kpa_s_ml: _Number | _Numbers | None = None,
        compliance_ml_kpa: _Number | _Numbers | None = None,
        inertance_kpa_s2_ml: _Number | _Numbers | None = None,
        reservoir_kpa: _Number | _Numbers | None = None,
        start_angle_rad: _Number | _Numbers | None = None,
        start_s: _Number | _Numbers | None = None,
        standard_kpa: _Number | _Numbers | None = None,
    ) -> float | _Array: ...
    @overload
    def value_and_gradient(
        self,
        *,
        resistance_kpa_s_ml: _Number | None = None,
        compliance_ml_kpa: _Number | None = None,
        inertance_kpa_s2_ml: _Number | None = None,
        reservoir_kpa: _Number | None = None,
        start_angle_rad: _Number | None = None,
        start_s: _Number | None = None,
        standard_kpa: _Number | None = None,
    ) -> tuple[float, dict[str, float]]:
        """Return the logarithm of the likelihood with its derivatives, which are exact. Other Python threads run
        meanwhile.

        Where a sample stands at an edge of the flow, its derivative by the angle is that toward the direction of the
        motion.

        Parameters
        ----------
        resistance_kpa_s_ml : float or array_like, optional
            R; this and the others are those of `log_likelihood`.
        compliance_ml_kpa : float or array_like, optional
            C.
        inertance_kpa_s2_ml : float or array_like, optional
            L.
        reservoir_kpa : float or array_like, optional
            Pressure of the reservoir.
        start_angle_rad : float or array_like, optional
            Angle at the start.
        start_s : float or array_like, optional
            Time at which the pump began to turn.
        standard_kpa : float or array_like, optional
            Standard deviation of the noise.

        Returns
        -------
        tuple of (float or numpy.ndarray, dict)
            Logarithm of the likelihood as `log_likelihood` returns it, and its derivatives by the names of the seven
            arguments, over their units: floats, or arrays of its shape.

        Raises
        ------
        ValueError
            If a value is outside its range, or if a line without resistance resonates at a steady speed.

        Examples
        --------
        >>> import pumpmodel as pm
        >>> pump = pm.Pump.three_roller()
        >>> run = pump.simulate(speed_rpm=100, duration_s=1)
        >>> likelihood = pm.LineLikelihood(
        ...     pump, time_s=run.time_s, pressure_kpa=run.outlet_kpa, standard_kpa=0.1, speed_rpm=100, begin="step"
        ... )
        >>> value, gradient = likelihood.value_and_gradient(inertance_kpa_s2_ml=0.0045)
        >>> gradient["inertance_kpa_s2_ml"] < 0
        True
        """
    @overload
    def value_and_gradient(
        self,
        *,
        resistance_kpa_s_ml: _Number | _Numbers | None = None,
        compliance_ml_kpa: _Number | _Numbers | None = None,
        inertance_kpa_s2_ml: _Number | _Numbers | None = None,
        reservoir_kpa: _Number | _Numbers | None = None,
        start_angle_rad: _Number | _Numbers | None = None,
        start_s: _Number | _Numbers | None = None,
        standard_kpa: _Number | _Numbers | None = None,
    ) -> tuple[float | _Array, dict[str, float | _Array]]: ...
    def __len__(self) -> int: ...

@final
class Pump:
    """A roller pump with its two lines, its motor and its fluid, as a pump file describes them.

    `Pump.three_roller`, `Pump.two_roller`, `Pump.named`, `Pump.from_toml`, `Pump.from_drawing`, `Pump.from_dict` and
    `Pump.replace` make pumps. Volumes are in mL, pressures in kPa absolute, angles in rad of the pump head. At angle 0
    a roller begins to leave the outlet.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> pump = pm.Pump.three_roller()
    >>> round(pump.average_flow_ml_s(speed_rpm=100), 4)
    35.5308
    """

    @staticmethod
    def three_roller(variant: Variant = "measured") -> Pump:
        """Return the pump of McIntyre et al. with three rollers.

        Parameters
        ----------
        variant : {"measured", "published", "as-built"}
            "measured" has the paper's dimensions with the measured roller volume of 2.1055 mL, "published" has the
            roller volume of its table, 2.06 mL, and "as-built" has the dimensions of its authors' code.

        Raises
        ------
        ValueError
            If no variant has this name.
        """
    @staticmethod
    def two_roller(variant: Variant = "measured") -> Pump:
        """Return the pump of McIntyre et al. with two rollers.

        Parameters
        ----------
        variant : {"measured", "published", "as-built"}
            "measured" has the paper's dimensions with the measured roller volume of 2.1055 mL, "published" has the
            roller volume of its table, 2.06 mL, and "as-built" has the dimensions of its authors' code.

        Raises
        ------
        ValueError
            If no variant has this name.
        """
    @staticmethod
    def from_toml(path: str | os.PathLike[str]) -> Pump:
        """Read a pump file.

        Parameters
        ----------
        path : str or os.PathLike
            TOML file with `schema = "pump/1"`.

        Raises
        ------
        OSError
            If the file cannot be opened. A missing file is a FileNotFoundError.
        PumpFileError
            If the file is no pump file, or the pump that it describes cannot work. It is a ValueError too.
        """
    @staticmethod
    def named(name: str) -> Pump:
        """\
        Return the pump of a file, of a name in the configuration, or a built-in one, as the command's `--pump` does.

        Parameters
        ----------
        name : str
            Path of a TOML file; or a name in `[pumps]` of the configuration, which `DOSE_CONFIG` or the user's folder
            has; or "three-roller" or "two-roller", each also with "-published" or "-as-built".

        Raises
        ------
        OSError
            If a file cannot be opened. A missing file is a FileNotFoundError.
        PumpFileError
            If no pump has this name, its file or the configuration cannot be used, or another configured name has the
            same record. It is a ValueError too.
        """
    @staticmethod
    def from_drawing(
        id: str,
        *,
        rollers: int,
        bore_radius_mm: _Number,
        tube_outer_radius_mm: _Number,
        backplate_radius_mm: _Number,
        contact_angle_deg: _Number,
        roller_radius_mm: _Number,
        roller_offset_mm: _Number,
        hose_length_mm: _Number,
    ) -> Pump:
        """Return a pump from the dimensions of its drawing, without any measurement.

        Roller volume and engagement angle follow from the drawing. The lines are hoses of the pump's own tube. Motor,
        fluid and ambient, which a drawing does not tell, are assumed as `dose pumps new` says.

        Parameters
        ----------
        id : str
            Name in records: 1 to 64 of a-z, 0-9, - and _.
        rollers : int
            Number of rollers.
        bore_radius_mm : float
            Inner radius of the tube, mm.
        tube_outer_radius_mm : float
            Outer radius of the tube, mm.
        backplate_radius_mm : float
            Radius of the backplate, mm.
        contact_angle_deg : float
            Contact angle beta, deg: the backplate spans 180 + 2 beta.
        roller_radius_mm : float
            Radius of a roller, mm.
        roller_offset_mm : float
            Distance from the shaft to a roller's axis, mm.
        hose_length_mm : float
            Length of the hose on either side, mm.

        Raises
        ------
        ValueError
            If the pump cannot work, for example because its rollers leave the tube open.

        Examples
        --------
        >>> import pumpmodel as pm
        >>> pump = pm.Pump.from_drawing(
        ...     "bench-2", rollers=3, bore_radius_mm=5, tube_outer_radius_mm=7, backplate_radius_mm=63,
        ...     contact_angle_deg=30, roller_radius_mm=20, roller_offset_mm=40, hose_length_mm=331,
        ... )
        >>> pump.is_estimated
        True
        """
    @staticmethod
    def from_ml_per_rev(
        id: str,
        *,
        ml_per_rev: _Number,
        rollers: int,
        tube_bore_mm: _Number | None = None,
        inlet: Line | None = None,
        outlet: Line | None = None,
    ) -> Pump:
        """\
        Return a bought head of which the volume per revolution and the number of rollers are known, and no dimension.

        Whole pitches are exact. Within a pitch a default pulse stands, with a spread that drawings of heads leave. Its
        motor, fluid and ambient are assumed as in the built-in pumps, with water at 25 °C and standard pressure.

        Parameters
        ----------
        id : str
            Name in records: 1 to 64 of a-z, 0-9, - and _.
        ml_per_rev : float
            Volume of a revolution, mL.
        rollers : int
            Number of rollers.
        tube_bore_mm : float, optional
            Diameter of the tube's bore, mm. It tells how far heads of a kind differ.
        inlet : Line, optional
            Line from the inlet's reservoir to the pump. Without it pressures are not known.
        outlet : Line, optional
            Line from the pump to the outlet's reservoir. Without it pressures and settling are not known.

        Raises
        ------
        ValueError
            If the pump cannot work, for example because its volume is not positive, or because no head delivers it
            through such a bore.

        Warns
        -----
        UserWarning
            Of values that are possible and unusual: a volume for its bore, or a number of rollers.

        Examples
        --------
        >>> import pumpmodel as pm
        >>> pump = pm.Pump.from_ml_per_rev("acid", ml_per_rev=0.5, rollers=4)
        >>> round(pump.volume_per_revolution_ml, 6), pump.is_estimated
        (0.5, True)
        """
    @staticmethod
    def from_dict(data: dict[str, Any]) -> Pump:
        """Return the pump of the tables that `to_dict` gave, changed or not.

        Parameters
        ----------
        data : dict
            Tables of a pump file.

        Raises
        ------
        PumpFileError
            If a key is unknown or missing, or its value is not allowed. It is a ValueError too.
        """
    def to_toml(self) -> str:
        """Return the pump as the text of a pump file.

        Returns
        -------
        str
            TOML that `from_toml` reads back as an equal pump.
        """
    def to_dict(self) -> dict[str, Any]:
        """Return the pump as plain data: the tables of its pump file.

        Returns
        -------
        dict
            Numbers, texts, lists and dicts only, under the keys of a pump file.
        """
    def replace(
        self,
        *,
        id: str | None = None,
        name: str | None = None,
        rollers: int | None = None,
        inlet: Line | None = None,
        outlet: Line | None = None,
        roller_volume: VolumeFit | VolumePolynomial | Literal["drawing"] | None = None,
    ) -> Pump:
        """Return this pump with some parts replaced. A part that is left out stays.

        Other rollers make another head, whose record is its own: without an `id` its id ends with a number of that
        head, and without a `name` its name tells the rollers.

        Parameters
        ----------
        id : str, optional
            Name in records.
        name : str, optional
            Name for people.
        rollers : int, optional
            Number of rollers.
        inlet : Line, optional
            Line from the inlet's reservoir to the pump.
        outlet : Line, optional
            Line from the pump to the outlet's reservoir.
        roller_volume : VolumeFit, VolumePolynomial or "drawing", optional
            Volume of a roller from points or a function, from coefficients, or from the pump's dimensions.

        Raises
        ------
        ValueError
            If the pump cannot work, for example because its rollers leave the tube open.
        """
    def check(self) -> str:
        """Check the pump as `dose pumps check` does, and say what it gives.

        Returns
        -------
        str
            A line each for head, volumes, flows, speeds, motor, fluid, lines and uncertainty, with their units, and for
            each of `warnings`.

        Raises
        ------
        ValueError
            If the pump cannot work.
        """
    @property
    def warnings(self) -> list[str]:
        """\
        Warnings of values that are possible and unusual, mostly a slip of a unit or a digit, or rollers that overlap in
        space. Every way to a pump gives them as Python warnings too.
        """
    @property
    def is_estimated(self) -> bool:
        """True if the pump's volumes follow from a drawing, or from a volume per revolution, that no measurement has
        confirmed.
        """
    @property
    def roller_volume_ml(self) -> float:
        """Volume that a roller displaces as it engages, V_r, mL."""
    @property
    def engagement_rad(self) -> float:
        """Angle over which a roller engages, phi, rad."""
    @property
    def bore_radius_mm(self) -> float:
        """Inner radius of the tube r_i, mm."""
    @property
    def tube_outer_radius_mm(self) -> float:
        """Outer radius of the tube r_o, mm."""
    @property
    def backplate_radius_mm(self) -> float:
        """Radius of the backplate (raceway) r_b, mm."""
    @property
    def contact_angle_rad(self) -> float:
        """Contact angle beta, rad: the backplate spans pi + 2 beta."""
    @property
    def roller_radius_mm(self) -> float:
        """Radius of a roller r_roller, mm."""
    @property
    def roller_offset_mm(self) -> float:
        """Distance from the shaft to a roller's axis r_offset, mm."""
    @property
    def rollers_overlap_mm(self) -> float | None:
        """Depth by which neighbouring rollers overlap in space, mm. None if they do not.

        The model computes a head whose rollers overlap, but nobody can build it.
        """
    @property
    def inlet_phase_rad(self) -> float:
        """Inlet phase psi, rad: the inlet's pulse begins this far behind the outlet's.

        Between the two a roller stays fully engaged for `2*pi - engagement_rad - inlet_phase_rad`.
        """
    @property
    def id(self) -> str:
        """Name of the pump in records and reports."""
    @property
    def name(self) -> str:
        """Name for people."""
    @property
    def rollers(self) -> int:
        """Number of rollers."""
    @property
    def pitch_rad(self) -> float:
        """Angle between rollers, rad: the period of the flow."""
    @property
    def volume_per_revolution_ml(self) -> float:
        """Volume of a revolution, mL."""
    @property
    def inlet(self) -> Line:
        """Line from the inlet's reservoir to the pump."""
    @property
    def outlet(self) -> Line:
        """Line from the pump to the outlet's reservoir."""
    @property
    def steps_per_rev(self) -> float:
        """Motor steps per revolution of the pump head, gear included."""
    @property
    def max_speed_rpm(self) -> float:
        """Fastest speed of the pump head, r/min."""
    @property
    def max_acceleration_rad_s2(self) -> float:
        """Largest acceleration of the pump head, rad/s²."""
    @property
    def default_rate_ml_s(self) -> float:
        """Rate of a dose that names no rate, speed or time, mL/s."""
    @overload
    def average_flow_ml_s(
        self, *, speed_rpm: _Number | None = None, speed_rad_s: _Number | None = None
    ) -> float:
        """Return the flow averaged over whole pitches.

        Parameters
        ----------
        speed_rpm : float or array_like
            Speed of the pump head, r/min; negative in reverse.
        speed_rad_s : float or array_like
            Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.

        Returns
        -------
        float or numpy.ndarray
            Flow, mL/s, negative in reverse. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If not exactly one speed is given, or a speed is not finite or beyond 1e4 rad/s.
        """
    @overload
    def average_flow_ml_s(self, *, speed_rpm: _Numbers, speed_rad_s: None = None) -> _Array: ...
    @overload
    def average_flow_ml_s(self, *, speed_rpm: None = None, speed_rad_s: _Numbers) -> _Array: ...
    @overload
    def speed_for_flow_rpm(self, *, flow_ml_s: _Number) -> float:
        """Return the speed of the pump head for an average flow: the inverse of `average_flow_ml_s(speed_rpm=...)`.

        Parameters
        ----------
        flow_ml_s : float or array_like
            Average flow, mL/s; negative in reverse.

        Returns
        -------
        float or numpy.ndarray
            Speed, r/min, which may exceed `max_speed_rpm`. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If the flow is not finite or beyond 1e6 mL/s.
        """
    @overload
    def speed_for_flow_rpm(self, *, flow_ml_s: _Numbers) -> _Array: ...
    @overload
    def outlet_volume_ml(self, angle_rad: _Number) -> float:
        """Return the volume that the outlet rollers deliver from angle 0 to `angle_rad`.

        Parameters
        ----------
        angle_rad : float or array_like
            Angle of the pump head, rad, unwrapped.

        Returns
        -------
        float or numpy.ndarray
            Volume, mL. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If an angle is not finite or beyond 1e9 rad.
        """
    @overload
    def outlet_volume_ml(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def angle_for_volume(self, volume_ml: _Number, start_angle_rad: _Number = 0.0) -> float:
        """Return the angle at which a turn has delivered a volume at the outlet rollers: the inverse of
        `outlet_volume_ml`.

        With it `outlet_volume_ml(angle) - outlet_volume_ml(start_angle_rad)` is `volume_ml`. Where the flow of a head
        reverses, several angles have this volume. The result is the first of them on the way.

        Parameters
        ----------
        volume_ml : float or array_like
            Volume, mL, up to 1e9 either way; negative for a turn in reverse.
        start_angle_rad : float or array_like
            Angle of the pump head at the start, rad, unwrapped; by default 0. Shapes broadcast as NumPy's do.

        Returns
        -------
        float or numpy.ndarray
            Angle at the end, rad, unwrapped. Array input gives an array of float64 of the common shape.

        Raises
        ------
        ValueError
            If a number is not finite or beyond its range, or if the shapes do not broadcast.

        Examples
        --------
        >>> import pumpmodel as pm
        >>> pump = pm.Pump.three_roller()
        >>> end_rad = pump.angle_for_volume(10.0, start_angle_rad=0.4)
        >>> round(pump.outlet_volume_ml(end_rad) - pump.outlet_volume_ml(0.4), 9)
        10.0
        """
    @overload
    def angle_for_volume(self, volume_ml: _Numbers, start_angle_rad: _Number | _Numbers = 0.0) -> _Array: ...
    @overload
    def angle_for_volume(self, volume_ml: _Number, start_angle_rad: _Numbers) -> _Array: ...
    @overload
    def outlet_flow_ml_rad(self, angle_rad: _Number) -> float:
        """Return the flow at the outlet rollers per angle, mL/rad.

        The product with the speed in rad/s is the flow in mL/s.

        Parameters
        ----------
        angle_rad : float or array_like
            Angle of the pump head, rad, unwrapped.

        Returns
        -------
        float or numpy.ndarray
            Flow per angle, mL/rad. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If an angle is not finite or beyond 1e9 rad.
        """
    @overload
    def outlet_flow_ml_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def inlet_volume_ml(self, angle_rad: _Number) -> float:
        """Return the volume that the inlet rollers take in from angle 0 to `angle_rad`, mL.

        Parameters
        ----------
        angle_rad : float or array_like
            Angle of the pump head, rad, unwrapped.

        Returns
        -------
        float or numpy.ndarray
            Volume, mL. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If an angle is not finite or beyond 1e9 rad.
        """
    @overload
    def inlet_volume_ml(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def inlet_flow_ml_rad(self, angle_rad: _Number) -> float:
        """Return the flow at the inlet rollers per angle, mL/rad.

        Parameters
        ----------
        angle_rad : float or array_like
            Angle of the pump head, rad, unwrapped.

        Returns
        -------
        float or numpy.ndarray
            Flow per angle, mL/rad. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If an angle is not finite or beyond 1e9 rad.
        """
    @overload
    def inlet_flow_ml_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: _Number | None = None, speed_rad_s: _Number | None = None) -> float:
        """Deprecated name of `average_flow_ml_s`."""
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: _Numbers, speed_rad_s: None = None) -> _Array: ...
    @overload
    @deprecated("use average_flow_ml_s")
    def average_flow(self, *, speed_rpm: None = None, speed_rad_s: _Numbers) -> _Array: ...
    @overload
    @deprecated("use speed_for_flow_rpm")
    def speed_for_flow(self, *, flow_ml_s: _Number) -> float:
        """Deprecated name of `speed_for_flow_rpm`."""
    @overload
    @deprecated("use speed_for_flow_rpm")
    def speed_for_flow(self, *, flow_ml_s: _Numbers) -> _Array: ...
    @overload
    @deprecated("use outlet_volume_ml")
    def outlet_volume(self, angle_rad: _Number) -> float:
        """Deprecated name of `outlet_volume_ml`."""
    @overload
    @deprecated("use outlet_volume_ml")
    def outlet_volume(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use outlet_flow_ml_rad")
    def outlet_flow_per_rad(self, angle_rad: _Number) -> float:
        """Deprecated name of `outlet_flow_ml_rad`."""
    @overload
    @deprecated("use outlet_flow_ml_rad")
    def outlet_flow_per_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use inlet_volume_ml")
    def inlet_volume(self, angle_rad: _Number) -> float:
        """Deprecated name of `inlet_volume_ml`."""
    @overload
    @deprecated("use inlet_volume_ml")
    def inlet_volume(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    @deprecated("use inlet_flow_ml_rad")
    def inlet_flow_per_rad(self, angle_rad: _Number) -> float:
        """Deprecated name of `inlet_flow_ml_rad`."""
    @overload
    @deprecated("use inlet_flow_ml_rad")
    def inlet_flow_per_rad(self, angle_rad: _Numbers) -> _Array: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: _Number | Callable[[float], float],
        speed_rad_s: None = None,
        duration_s: _Number,
        dt_s: _Number | None = None,
        time_s: None = None,
        output_time_s: None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
        sensitivity: bool = False,
    ) -> Run:
        """\
        Run the model over time. Other Python threads run meanwhile, except while a speed that is a function is asked.

        Parameters
        ----------
        speed_rpm : float, array_like or callable
            Speed of the pump head, r/min; negative in reverse. One number is a constant speed, not zero, from time 0
            on. An array of shape (n,) has the speeds at the times `time_s`, and the speed is a straight line from
            each to the next. A callable takes the time, s, from 0 on and returns the speed. Straight pieces follow
            it to within 1e-6 of 1 rad/s + the speed. Jumps are found to 1e-9 of the time; a pulse that is shorter
            than the samples may be missed.
        speed_rad_s : float, array_like or callable
            Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
        duration_s : float, optional
            Duration, s, up to 1e7, for samples at equal intervals from time 0 on.
        dt_s : float, optional
            Time between samples, s; by default 1e-3. Samples stand at `arange(n + 1)*dt_s`, both ends included.
        time_s : array_like, optional
            Times of the samples in place of `duration_s`, s, rising, from 0 to 1e7, shape (n,). With an array of
            speeds these are the times of the speeds, up to 1e7 either way, and the motion starts at the first.
        output_time_s : array_like, optional
            Times of the samples with an array of speeds, s, rising, within `time_s`, shape (m,); by default `time_s`.
        start_angle_rad : float
            Angle of the pump head at the start, rad, unwrapped, up to 1e9 either way.
        model : {"flow-centric", "roller-centric"}
            "flow-centric": the flows at the rollers drive the lines. "roller-centric": every roller is a valve, and
            every segment of tube between two rollers is a chamber. The roller-centric model is experimental, a
            reconstruction whose parameters are fitted to summary numbers or guessed.
        method : {"auto", "exact", "rodas5p", "radau"}
            "exact" is the exact solution, "rodas5p" the implicit integrator for any model. "radau" is the integrator
            for lines with a constant resistance, in a quarter of the steps. "auto" takes the exact solution, except for
            the roller-centric model and for lines that are hoses, whose friction grows with the flow: "rodas5p".
        initial : {"rest", "steady"} or LineStates
            State at the start. "rest": the lines have the pressures of their reservoirs and no flow. "steady": the
            pump has turned at the speed of the start for long. `LineStates`: pressures and flows of both lines, such
            as `end_state` of an earlier run. The roller-centric model starts from rest.
        tolerance : float, optional
            Error that the integrator allows in a step, relative to 1 kPa plus the pressure above the reservoir's; 1e-13
            to 0.1. The default of 1e-5 keeps the pressures of the built-in pumps within 1e-4 kPa (1e-3 roller-centric).
        segment_scale : float, optional
            Roller-centric: volume between two rollers over the volume of the round tube, 0.5 to 2; by default 0.953.
        distensibility_per_kpa : float, optional
            Roller-centric: relative growth of a segment's volume with pressure, 1/kPa, 1e-9 to 1; by default 2.05e-3.
        valve_resistance_kpa_s_ml : float, optional
            Roller-centric: resistance of a roller that only just touches the tube, kPa s/mL, 1e-9 to 1e3; by default
            1e-3.
        closure_rad : float, optional
            Roller-centric: angle after first contact at which a roller has closed the tube, rad; by default the angle
            that follows from the pump's dimensions.
        sensitivity : bool
            True for the derivatives of pressures and delivered volume by R, C and L of the lines, the start angle and
            the roller volume too, as `run.sensitivity`. They are exact, so `method` must not be the integrator. States
            that are given depend on none of these; those of "steady" do.

        Returns
        -------
        Run
            Flows and pressures over time.

        Raises
        ------
        ValueError
            If an argument is not allowed, or if the speed varies and the pump's volumes depend on the speed.
        PumpError
            If the solver fails on the way.
        MemoryError
            If there is no room for the samples.

        Warns
        -----
        UserWarning
            If a pressure is below 0 kPa absolute, where every liquid cavitates and the model has no meaning: anywhere
            from the start to the last sample, also between two samples. The roller-centric model is judged by its
            samples.

        Examples
        --------
        >>> import pumpmodel as pm
        >>> pump = pm.Pump.three_roller()
        >>> steady = pump.simulate(speed_rpm=100, duration_s=0.6, initial="steady", start_angle_rad=0.5)
        >>> ramp = pump.simulate(
        ...     speed_rpm=[100, 0, 0], time_s=[0, 0.5, 2], output_time_s=[0, 0.25, 0.5, 2], initial=steady.end_state,
        ...     start_angle_rad=steady.angle_rad[-1],
        ... )
        >>> float(ramp.speed_rad_s[-1])
        0.0
        """
    @overload
    def simulate(
        self,
        *,
        speed_rpm: None = None,
        speed_rad_s: _Number | Callable[[float], float],
        duration_s: _Number,
        dt_s: _Number | None = None,
        time_s: None = None,
        output_time_s: None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
        sensitivity: bool = False,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: _Number | Callable[[float], float],
        speed_rad_s: None = None,
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
        sensitivity: bool = False,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: None = None,
        speed_rad_s: _Number | Callable[[float], float],
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
        sensitivity: bool = False,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: _Numbers,
        speed_rad_s: None = None,
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: _Numbers | None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
        sensitivity: bool = False,
    ) -> Run: ...
    @overload
    def simulate(
        self,
        *,
        speed_rpm: None = None,
        speed_rad_s: _Numbers,
        duration_s: None = None,
        dt_s: None = None,
        time_s: _Numbers,
        output_time_s: _Numbers | None = None,
        start_angle_rad: _Number = 0.0,
        model: Model = "flow-centric",
        method: Method = "auto",
        initial: Initial | LineStates = "rest",
        tolerance: _Number | None = None,
        segment_scale: _Number | None = None,
        distensibility_per_kpa: _Number | None = None,
        valve_resistance_kpa_s_ml: _Number | None = None,
        closure_rad: _Number | None = None,
        sensitivity: bool = False,
    ) -> Run: ...
    @overload
    def harmonics(
        self, count: int = 20, *, speed_rpm: _Number, speed_rad_s: None = None, port: Port = "outlet"
    ) -> Harmonics:
        """\
        Return the harmonics of the pulsation in the periodic steady state at constant speed, exact for every number.

        Flow and pressure at a port are their means plus the real part of the sum of `amplitude * exp(1j * rad_s * t)`,
        with angle 0 at t = 0. A line that is a hose has its resistance at the pump's default rate.

        Parameters
        ----------
        count : int
            Number of harmonics, 1 to 10,000. The first has the frequency at which rollers pass.
        speed_rpm : float
            Speed of the pump head, r/min; negative in reverse; not zero.
        speed_rad_s : float
            Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
        port : {"outlet", "inlet"}
            Port whose pulsation is returned.

        Returns
        -------
        Harmonics
            Frequencies `rad_s`, and complex amplitudes `flow_ml_s` of the flow at the rollers and `pressure_kpa` of the
            pressure, of shape (count,), with the means `mean_flow_ml_s` and `mean_kpa`.

        Raises
        ------
        ValueError
            If an argument is not allowed, or if a line without resistance resonates at one of the frequencies.

        Examples
        --------
        >>> import pumpmodel as pm
        >>> found = pm.Pump.three_roller().harmonics(5, speed_rpm=100)
        >>> round(float(found.rad_s.min()), 4), found.pressure_kpa.shape
        (31.4159, (5,))
        """
    @overload
    def harmonics(
        self, count: int = 20, *, speed_rpm: None = None, speed_rad_s: _Number, port: Port = "outlet"
    ) -> Harmonics: ...
    @overload
    def steady_state(
        self, *, speed_rpm: _Number | None = None, speed_rad_s: _Number | None = None
    ) -> SteadyState[float]:
        """Compute the periodic steady state at constant speed. Other Python threads run meanwhile.

        A line that is a hose has its resistance at the pump's default rate. `simulate` follows its friction at every
        flow.

        Parameters
        ----------
        speed_rpm : float or array_like
            Speed of the pump head, r/min; negative in reverse; not zero.
        speed_rad_s : float or array_like
            Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.

        Returns
        -------
        SteadyState
            Attributes are floats for one speed; array input gives arrays of float64 of its shape.

        Raises
        ------
        ValueError
            If a speed is not allowed, or a line without resistance resonates at it.
        PumpError
            If the solver fails on the way.

        Warns
        -----
        UserWarning
            If a pressure is below 0 kPa absolute, where every liquid cavitates and the model has no meaning. An array
            of speeds warns once.
        """
    @overload
    def steady_state(self, *, speed_rpm: _Numbers, speed_rad_s: None = None) -> SteadyState[_Array]: ...
    @overload
    def steady_state(self, *, speed_rpm: None = None, speed_rad_s: _Numbers) -> SteadyState[_Array]: ...
    def plot(self, angle_rad: float = 0.0, *, ax: Axes | None = None) -> Axes:
        """Draw the section through the head, as `pumpmodel.plot_pump` does."""
    def animate(self, run: Run, *, slower: float = 1.0, frames_per_s: float = 25.0) -> FuncAnimation:
        """Return an animation of the head over a run, as `pumpmodel.animate` makes it."""
    def _repr_html_(self) -> str:
        """Return what a notebook shows: a table of the main numbers and a small picture, as HTML."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
