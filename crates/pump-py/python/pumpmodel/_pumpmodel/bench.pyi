import os
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Any, TypeAlias, final

import numpy as np

from pumpmodel.choices import BalanceProtocol, CalibrationFit, Driver, Missed, Pace
from pumpmodel.weighed import WeighedRun

from .doser import Calibration
from .pump import Pump

# A number of Python or NumPy.
_Number: TypeAlias = float | np.floating[Any] | np.integer[Any]
_Progress: TypeAlias = Callable[[int, int], object]
_Told: TypeAlias = tuple[str, list[str]]
_Found: TypeAlias = tuple[float, float]
# Name, file, or times and flows.
_FlowProfile: TypeAlias = tuple[str, str | os.PathLike[str] | None, list[float], list[float]]

@final
class Balance:
    """Balance under the vessel: at a serial port, read by a program, or read by a function.

    It ends doses (`Bench.dose` with `until_scale`), and `read` gives a reading for `Bench.calibrate_last`,
    `Bench.verify` or `WeighedRun.weighed`. One dose or reading uses it at a time.
    """

    @staticmethod
    def open(
        port: str | os.PathLike[str],
        *,
        protocol: BalanceProtocol = "mt-sics",
        line: str | None = None,
        wait: str | None = None,
    ) -> Balance:
        """Open the balance at a serial port. Nothing is asked yet.

        Parameters
        ----------
        port : str or os.PathLike
            Serial port of the balance, as "/dev/ttyUSB1".
        protocol : {"mt-sics", "sbi"}
            Protocol: MT-SICS of Mettler-Toledo and many others, or SBI of Sartorius.
        line : str, optional
            Speed, 300 to 921600 baud, and framing of the line, as "9600,8N1". By default 9600,8N1, and
            9600,7O1 for "sbi".
        wait : str, optional
            Longest wait for the balance to stand still, up to a day; by default "60s".

        Raises
        ------
        BalanceError
            If the port cannot be opened, or another process has it.
        ValueError
            If the value of a keyword is not allowed.
        """
    @staticmethod
    def command(command: str, *, wait: str | None = None) -> Balance:
        """Read the balance by a command of the system's shell.

        Parameters
        ----------
        command : str
            Command that prints at once what the balance shows, with its unit: kg, g or mg, as "23.45 g". The
            last line counts.
        wait : str, optional
            Longest wait for the command, up to a day; by default "60s".

        Raises
        ------
        ValueError
            If the command is empty, or `wait` no time.
        """
    @staticmethod
    def function(read: Callable[[], str], *, wait: str | None = None) -> Balance:
        """Read the balance by a function.

        Parameters
        ----------
        read : callable
            Function that returns at once what the balance shows, with its unit: kg, g or mg, as "23.45 g". A
            thread of the bench calls it up to 20 times a second during a dose.
        wait : str, optional
            Longest wait for two readings that agree, up to a day; by default "60s".

        Raises
        ------
        ValueError
            If `read` cannot be called, or `wait` is no time.
        """
    def read(self) -> str:
        """Read what the balance shows once it stands still.

        Returns
        -------
        str
            Mass with its unit and the digits of the balance, as "23.45 g"; negative below its tare.

        Raises
        ------
        BalanceError
            If the balance does not stand still in time, tells no mass, or is overloaded.
        """
    def close(self) -> None:
        """Close the balance, after the dose that it ends. Closing twice is no error."""
    def __enter__(self) -> Balance: ...
    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None: ...

# Call of a bench, which a stop reaches.
@final
class _Call:
    """A call that Python has begun. Within its `with` block the calls of the thread are parts of it."""

    def __enter__(self) -> _Call: ...
    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None: ...
    def stop(self, cause: str) -> None:
        """Makes the motor of this call alone decelerate and hold. `cause` is for the log."""
    @property
    def stopped(self) -> bool:
        """True once a stop has reached the call."""
    def end(self) -> None:
        """Ends the call. Ending twice is no error."""

# Compiled half of pumpmodel.Bench. Texts are the command's JSON.
@final
class _Bench:
    """Compiled half of `pumpmodel.Bench`; use that instead."""

    def __new__(
        cls,
        pump: Pump,
        *,
        driver: Driver | None,
        port: str | os.PathLike[str] | None,
        pace: Pace | None,
        state_dir: str | os.PathLike[str] | None,
        configure: bool,
        accept_settings: bool,
        confirm_pump: bool,
        tube_limit: str | None,
        fluid: str | None,
        temperature: str | None,
    ) -> _Bench: ...
    @property
    def pump(self) -> Pump:
        """Pump, with the changes made when the bench was opened."""
    @property
    def driver(self) -> Driver:
        """Name of the driver that turns the motor."""
    @property
    def port(self) -> str | None:
        """Serial port of the motor's controller."""
    @property
    def folder(self) -> os.PathLike[str]:
        """Folder of the journal."""
    @property
    def closed(self) -> bool:
        """True once the bench is closed."""
    @property
    def stands(self) -> tuple[float, float, float]:
        """Angle (rad), half width (rad) and carry (mL) on record."""
    @property
    def calibration(self) -> Calibration | None:
        """Calibration that doses use."""
    def status(self) -> str:
        """Returns the record as `dose status --format json` prints it."""
    def log(self, since: str | None) -> list[str]:
        """Reads the log. Returns the JSON of each dose that began at `since` or later."""
    @property
    def last(self) -> str | None:
        """\
        JSON of the dose or run that ended last, also of one that was interrupted; None if the last one did not move.
        """
    def prepare(self, purpose: str, asked: dict[str, Any]) -> str:
        """Plans a dose from the record without moving. Returns the JSON of a dry run."""
    def connect(self) -> None:
        """Connects the motor, unless a dose is unfinished: then the next dose is refused anyway."""
    def dose(self, purpose: str, asked: dict[str, Any], progress: _Progress | None) -> str:
        """Runs a dose. Returns the JSON of the command."""
    def prepare_profile(self, asked: dict[str, Any], profile: _FlowProfile) -> str:
        """Plans a flow over time from the record without moving. Returns the JSON of a dry run."""
    def run_profile(self, asked: dict[str, Any], profile: _FlowProfile, progress: _Progress | None) -> str:
        """Runs a flow over time. Returns the JSON of the command."""
    def prepare_by_weight(self, asked: dict[str, Any], by_weight: dict[str, Any]) -> str:
        """Plans a dose by weight from the record without moving. Returns the JSON of a dry run."""
    def dose_by_weight(
        self, asked: dict[str, Any], by_weight: dict[str, Any], progress: _Progress | None
    ) -> str:
        """Runs a dose that a balance ends. Returns the JSON of the command."""
    def resume_by_weight(
        self, asked: dict[str, Any], by_weight: dict[str, Any], progress: _Progress | None
    ) -> str:
        """Runs the rest of a dose that a balance was to end. Returns the JSON of the command."""
    def resume(self, asked: dict[str, Any], progress: _Progress | None) -> str:
        """Makes the rest of an unfinished dose. Returns the JSON of the command."""
    def begin(self, name: str, *, lasts: bool = False) -> _Call:
        """\
        Begins a call that can move the motor, so that a stop reaches it. One that lasts has a `with` block for each
        of its motions.
        """
    def stop(self) -> list[str]:
        """Makes every call that has begun decelerate the motor, which holds. Returns the names of the calls."""
    def close(self) -> None:
        """Gives the pump back."""
    def home_set(self, angle_rad: _Number | None, half_width_rad: _Number) -> _Told:
        """Records the angle of the rotor; None records that it is unknown. A damaged journal is moved aside."""
    def home_sensor(self) -> _Told:
        """Turns forward until the index sensor answers. A stop before that is a warning."""
    def home_mark(self, half_width_rad: _Number) -> _Told:
        """Records that the rotor's mark meets the housing's."""
    def jog(self, angle_rad: _Number) -> float:
        """Turns the rotor by about this angle, rad. Returns the angle of the steps made, rad."""
    def discard(self) -> _Told:
        """Accepts the unfinished dose with the volume that was delivered."""
    def release(self) -> _Told:
        """Releases the rotor: the motor holds it no longer."""
    def new_tube(self) -> _Told:
        """Records that the tube is new."""
    def clear_safety(self, reason: str) -> _Told:
        """Clears the stand of the pump at a safety limit."""
    def vessel_emptied(self) -> _Told:
        """Records that the receiving vessel is empty."""
    def calibration_run(
        self, speed_rpm: _Number | None, speed_rad_s: _Number | None, pitches: int, progress: _Progress | None
    ) -> tuple[float, float | None, float, str, bool, list[str]]:
        """Makes a run of whole pitches, to be weighed."""
    def calibrate(
        self,
        runs: Sequence[WeighedRun],
        fit: CalibrationFit,
        scale: str | None,
        tube: str | None,
        note: str | None,
    ) -> Calibration:
        """Fits weighed runs, keeps the calibration and uses it from now on."""
    def calibrate_last(
        self,
        reading: str,
        add: bool,
        anew: bool,
        anyway: bool,
        scale: str | None,
        tube: str | None,
        note: str | None,
    ) -> Calibration:
        """Calibrates by the reading of the last dose."""
    def calibrate_phase(
        self,
        doses: Sequence[tuple[float, float, float, float | None]],
        scale: str | None,
        tube: str | None,
        note: str | None,
    ) -> tuple[Calibration, list[_Found]]:
        """Fits short doses, keeps the zero angle that they show and uses it from now on.

        Returns the calibration, and roller volume (mL), engagement angle (rad) and zero (rad), each with its standard
        uncertainty.
        """
    def calibrations(self) -> list[Calibration]:
        """Returns every calibration of this bench, oldest first."""
    def use_calibration(self, version: int | None) -> None:
        """Makes doses use another calibration, or none, from now on."""
    def verify(
        self,
        nominal: str,
        readings: Sequence[str],
        systematic_percent: _Number | None,
        random_percent: _Number | None,
    ) -> str:
        """Returns the errors of weighed doses of the volume `nominal`, as the command's JSON."""

# Compiled half of pumpmodel.Rack. Texts are the command's JSON.
@final
class _Rack:
    """Compiled half of `pumpmodel.Rack`; use that instead."""

    def __new__(
        cls,
        rack: str,
        text: str | None,
        *,
        pace: Pace | None,
        state_dir: str | os.PathLike[str] | None,
        configure: bool,
        accept_settings: bool,
        confirm_pump: bool,
    ) -> _Rack: ...
    @property
    def name(self) -> str:
        """Name of the rack."""
    @property
    def pumps(self) -> list[str]:
        """Names of the pumps in the rack."""
    @property
    def steps(self) -> int:
        """Number of steps."""
    def plan(self) -> str:
        """Plans and checks every step of every pump. Returns the JSON of a dry run."""
    def run(self, progress: Callable[[str, int, int, int], object] | None) -> str:
        """Runs the rack. Returns the JSON of the command. A fault has it as `_rack`."""
    def stop(self) -> None:
        """Has every motor of the run under way decelerate and hold."""

@final
class _Schedule:
    """Schedule of a batch: the time at which each dose is due."""

    def __new__(cls, count: int, every_s: _Number | None, missed: Missed) -> _Schedule: ...
    def next(self, elapsed_s: _Number) -> tuple[str, float]:
        """Returns the next action, `elapsed_s` after the batch's start.

        The action is "wait" with the time to wait for, s; "dose" or "skip" with the dose's number; or "done".
        """
