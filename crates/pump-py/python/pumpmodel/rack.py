"""A rack: several pumps by one timetable."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Self, TypeAlias

from pumpmodel._pumpmodel import _Rack
from pumpmodel._results.record import Record
from pumpmodel.choices import Pace, RackEnd
from pumpmodel.dose import Dose
from pumpmodel.errors import PumpError

#: Called with the name of a pump, its step (from 1), the motor steps made of it, and those planned.
RackProgress: TypeAlias = Callable[[str, int, int, int], object]


@dataclass(frozen=True)
class RackDose(Record):
    """Part of a step that a pump has run, or a plan of it. `begin_s` counts from the begin of the rack."""

    _records: ClassVar[dict[str, type[Record]]] = {"dose": Dose}

    step: int
    begin_s: float
    unfinished: bool
    dose: Dose


@dataclass(frozen=True)
class RackPump(Record):
    """Row of a pump: `name` in the rack, `pump` by its id, and what its steps delivered together.

    `delivered_ml` is the planned volume in a plan. After a fault it is the middle of the volumes that may
    have been delivered. The expanded uncertainty is as if every step erred the same way.
    """

    _records: ClassVar[dict[str, type[Record]]] = {"doses": RackDose}

    name: str
    pump: str
    driver: str
    simulated: bool
    device: str | None
    requested_ml: float
    delivered_ml: float
    delivered_least_ml: float
    delivered_most_ml: float
    expanded_uncertainty_ml: float
    carry_ml: float | None
    steps: int
    steps_completed: int
    steps_not_begun: int
    completed: bool
    unfinished: bool
    error: str | None
    warnings: tuple[str, ...]
    doses: tuple[RackDose, ...]


@dataclass(frozen=True)
class RackTotal(Record):
    """Sum over the pumps, which err independently of each other."""

    requested_ml: float
    delivered_ml: float
    delivered_least_ml: float
    delivered_most_ml: float
    expanded_uncertainty_ml: float


@dataclass(frozen=True)
class RackReport(Record):
    """Report of a rack, with a row for each pump. `fault` is the name of the pump that failed first."""

    _records: ClassVar[dict[str, type[Record]]] = {"pumps": RackPump, "total": RackTotal}

    schema: str
    rack: str
    time: str | None
    simulated: bool
    end: RackEnd
    completed: bool
    fault: str | None
    steps: int
    planned_s: float
    ended_s: float | None
    pumps: tuple[RackPump, ...]
    total: RackTotal


class Rack:
    """Several pumps that run by one timetable, as `dose run RACK.toml` runs them.

    Every step of every pump is checked before the first one moves. A stop, or a fault of one pump, stops all,
    and the rest of each is on record. While the rack runs, no other process can use its pumps.

    A motor moves only if its pump file has a `[drive]`. Ctrl-C in a call decelerates every motor.

    Examples
    --------
    >>> import tempfile
    >>> import pumpmodel as pm
    >>> text = '''
    ... schema = "rack/1"
    ... [pumps]
    ... acid = "three-roller"
    ... base = "two-roller"
    ... [[step]]
    ... ratio = { acid = 2, base = 1 }
    ... volume = "6mL"
    ... rate = "6mL/s"
    ... '''
    >>> with tempfile.TemporaryDirectory() as tmp:
    ...     report = pm.Rack.parse(text, state_dir=tmp).run()
    >>> [(row.name, round(row.delivered_ml, 2)) for row in report.pumps]
    [('acid', 4.0), ('base', 2.0)]
    """

    def __init__(self, core: _Rack) -> None:
        """Wrap the compiled half; `open` and `parse` make a rack."""
        self._core = core

    @classmethod
    def open(
        cls,
        rack: str | os.PathLike[str],
        *,
        pace: Pace | None = None,
        state_dir: str | os.PathLike[str] | None = None,
        configure: bool = False,
        accept_settings: bool = False,
        confirm_pump: bool = False,
    ) -> Self:
        """Open the file of a rack. Nothing moves, and nothing is created.

        Parameters
        ----------
        rack : str or os.PathLike
            Path of the file, or its name in `[racks]` of the configuration.
        pace : {"real", "fast"}, optional
            Pace of simulated motors: "real" takes the time of their plans, "fast" no time. The default is
            "fast" if all motors are simulated. A real motor keeps real time.
        state_dir : str or os.PathLike, optional
            Folder of the records, as that of `Bench.open`.
        configure, accept_settings, confirm_pump : bool
            Words to the boards of all pumps, as those of `Bench.open`.

        Raises
        ------
        ValueError
            If a value of the file is not allowed, or two pumps share what they cannot.
        FileNotFoundError
            If the file is missing.
        PumpFileError
            If no rack or no pump has a name, or a pump file cannot be used.
        """
        return cls(
            cls._core_of(os.fspath(rack), None, pace, state_dir, configure, accept_settings, confirm_pump)
        )

    @classmethod
    def parse(
        cls,
        text: str,
        *,
        path: str | os.PathLike[str] = "rack.toml",
        pace: Pace | None = None,
        state_dir: str | os.PathLike[str] | None = None,
        configure: bool = False,
        accept_settings: bool = False,
        confirm_pump: bool = False,
    ) -> Self:
        """Return the rack of a text, as its file would have it.

        Parameters
        ----------
        text : str
            TOML of the rack.
        path : str or os.PathLike
            Path that the file would have. The rack has its name, and paths in the text are relative to its
            folder.
        pace, state_dir, configure, accept_settings, confirm_pump
            As those of `open`.

        Raises
        ------
        ValueError
            If a value of the text is not allowed, or two pumps share what they cannot.
        PumpFileError
            If no pump has a name, or its file cannot be used.
        """
        return cls(
            cls._core_of(os.fspath(path), text, pace, state_dir, configure, accept_settings, confirm_pump)
        )

    @staticmethod
    def _core_of(
        rack: str,
        text: str | None,
        pace: Pace | None,
        state_dir: str | os.PathLike[str] | None,
        configure: bool,
        accept_settings: bool,
        confirm_pump: bool,
    ) -> _Rack:
        return _Rack(
            rack,
            text,
            pace=pace,
            state_dir=state_dir,
            configure=configure,
            accept_settings=accept_settings,
            confirm_pump=confirm_pump,
        )

    @property
    def name(self) -> str:
        """Name of the rack: that of its file without `.toml`."""
        return self._core.name

    @property
    def pumps(self) -> list[str]:
        """Names of the pumps in the rack."""
        return self._core.pumps

    @property
    def steps(self) -> int:
        """Number of steps."""
        return self._core.steps

    def plan(self) -> RackReport:
        """Plan and check every step of every pump. Nothing moves, and nothing is recorded.

        Returns
        -------
        RackReport
            The planned volumes and times.

        Raises
        ------
        PumpError
            If a pump refuses its part: the error of its `Bench`, with the pump and the step.
        ValueError
            If a step begins before its pump is done with another.
        """
        return RackReport._from_json(self._core.plan())

    def run(self, *, progress: RackProgress | None = None) -> RackReport:
        """Run every step. Returns once every motor stands.

        Parameters
        ----------
        progress : callable, optional
            Called with the name of a pump, its step (from 1), the motor steps made of it and those planned, a
            few times a second. An exception from it stops every motor.

        Returns
        -------
        RackReport
            What each pump delivered. `end` is "stopped" after `stop`.

        Raises
        ------
        PumpError
            If a pump refuses its part, or `stop` came before the first motor began; nothing has moved then.
            If a motor fails on the way, the error has the report as `report`.
        ValueError
            If a step begins before its pump is done with another.
        """
        try:
            return RackReport._from_json(self._core.run(progress))
        except PumpError as error:
            told: Any = getattr(error, "_rack", None)
            if told is not None:
                error.report = RackReport._from_json(told)
            raise

    def stop(self) -> None:
        """Have every motor of a run in another thread decelerate and hold."""
        self._core.stop()

    def __repr__(self) -> str:
        """Tell the name and the pumps."""
        return f"<Rack '{self.name}' of {', '.join(self.pumps)}: {self.steps} steps>"
