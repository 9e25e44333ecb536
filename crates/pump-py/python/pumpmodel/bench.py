"""A bench: one pump, what turns it, and what is recorded of it."""

import os
import time
import warnings
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import Any, Literal, Self

from pumpmodel._bench_calibration import BenchCalibration
from pumpmodel._bench_record import BenchRecord
from pumpmodel._pumpmodel import Doser, Limits, Plan, Pump, _Bench, _Schedule
from pumpmodel.dose import Dose

Progress = Callable[[int, int], object]


class Bench(BenchRecord, BenchCalibration):
    """A pump with its driver, its journal and its lock: the same that the command `dose` uses.

    Opening moves and creates nothing. The first call that moves or records takes the pump, and keeps it until
    `close`, or the end of a `with` block: until then other processes, the command among them, are refused it.
    Calls from several threads come one after the other; other Python threads run meanwhile.

    A motor moves only if the pump file has a `[drive]` or `driver` names one. Ctrl-C in a call decelerates
    the motor, which then holds; what was delivered is on record, and KeyboardInterrupt is raised.

    Examples
    --------
    >>> import tempfile
    >>> import pumpmodel as pm
    >>> with tempfile.TemporaryDirectory() as tmp, pm.Bench.open("three-roller", state_dir=tmp) as bench:
    ...     dose = bench.dose("25mL")
    ...     print(f"{dose.delivered_ml:.2f} mL, {bench.status().angle_deg:.1f} deg")
    25.00 mL, 75.4 deg
    """

    def __init__(self, core: _Bench) -> None:
        """Wrap the compiled half; `open` opens a bench."""
        self._core = core

    @classmethod
    def open(
        cls,
        pump: Pump | str | os.PathLike[str],
        *,
        driver: Literal["sim", "grbl"] | None = None,
        port: str | os.PathLike[str] | None = None,
        state_dir: str | os.PathLike[str] | None = None,
        configure: bool = False,
        tube_limit: str | None = None,
        fluid: str | None = None,
        temperature: str | None = None,
    ) -> Self:
        """Open a bench. Moves and creates nothing.

        Parameters
        ----------
        pump : Pump, str or os.PathLike
            The pump; or a built-in name or a pump file.
        driver : {"sim", "grbl"}, optional
            What turns the motor; by default the pump file's `[drive]`, else "sim".
        port : str or os.PathLike, optional
            Serial port of the controller, as "/dev/ttyUSB0"; by default the pump file's.
        state_dir : str or os.PathLike, optional
            Where angle, journal and lock are kept; by default `DOSE_STATE_DIR`, else as the command.
        configure : bool
            Write the controller's settings where they do not fit the pump.
        tube_limit : str, optional
            Volume that a tube lasts, as "100L"; by default the pump file's.
        fluid, temperature : str, optional
            What is pumped, as "water", and its temperature, as "20degC"; by default the pump file's.

        Raises
        ------
        ValueError
            If a keyword is not allowed.
        FileNotFoundError
            If there is no such file.
        PumpFileError
            If there is no such pump, or its file cannot be used.
        """
        named = pump if isinstance(pump, Pump) else Pump.named(os.fspath(pump))
        return cls(
            _Bench(
                named,
                driver=driver,
                port=port,
                state_dir=state_dir,
                configure=configure,
                tube_limit=tube_limit,
                fluid=fluid,
                temperature=temperature,
            )
        )

    @property
    def pump(self) -> Pump:
        """The pump, with what was changed as it was opened."""
        return self._core.pump

    @property
    def driver(self) -> str:
        """What turns the motor: "sim" or "grbl"."""
        return self._core.driver

    @property
    def port(self) -> str | None:
        """Serial port of the controller; None if it has none."""
        return self._core.port

    @property
    def folder(self) -> str:
        """Folder of the journal."""
        return os.fspath(self._core.folder)

    @property
    def closed(self) -> bool:
        """Whether it was closed."""
        return self._core.closed

    def dose(
        self,
        volume: str,
        *,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        finish: Literal["any", "low-flow"] = "any",
        retract: str | None = None,
        start_angle_rad: float | None = None,
        limits: Limits | None = None,
        dry_run: bool = False,
        progress: Progress | None = None,
    ) -> Dose:
        """Plan, run and record one dose.

        Parameters
        ----------
        volume : str
            Volume or mass with its unit, as "25mL", "250uL", "25 g"; negative in reverse.
        rate, speed, within : str, optional
            Average flow while cruising ("10 mL/s", or "max" for the fastest that holds every limit), speed of
            the pump head ("100rpm") or total time with ramps and settling ("10s"); one at most.
        smooth : bool
            Let the speed follow the rollers' angle for a flow as smooth as the motor allows.
        finish : {"any", "low-flow"}
            Where in a pitch the dose may end.
        retract : str, optional
            What is sucked back after the dose, as "0.1mL"; the next dose repays it.
        start_angle_rad : float, optional
            Where the rollers stand, rad; overrides the record.
        limits : Limits, optional
            Pressures to keep in place of the pump file's.
        dry_run : bool
            Plan and predict; move nothing, record nothing.
        progress : callable, optional
            Called with the steps made and the steps planned, a few times a second; what it raises stops the
            motor.

        Returns
        -------
        Dose
            What was planned and what came of it. `completed` is False if `stop` stopped it.

        Raises
        ------
        TypeError
            If a quantity is a bare number.
        ValueError
            If a text is no such quantity.
        PlanError
            If the pump cannot do it.
        UnfinishedError
            If an earlier dose is unfinished.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.
        """
        asked = _asked(volume, rate, speed, within, smooth, finish, retract, start_angle_rad, limits)
        return self._run("dose", asked, dry_run, progress)

    def prime(
        self,
        volume: str,
        *,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        start_angle_rad: float | None = None,
        limits: Limits | None = None,
        dry_run: bool = False,
        progress: Progress | None = None,
    ) -> Dose:
        """Fill the line before a dose; what doses owe each other stays as it is.

        Parameters, returns and errors are those of `dose`.
        """
        asked = _asked(volume, rate, speed, within, smooth, "any", None, start_angle_rad, limits)
        return self._run("prime", asked, dry_run, progress)

    def purge(
        self,
        volume: str,
        *,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        start_angle_rad: float | None = None,
        limits: Limits | None = None,
        dry_run: bool = False,
        progress: Progress | None = None,
    ) -> Dose:
        """Empty the line: like `prime`, for the record; a negative volume runs back.

        Parameters, returns and errors are those of `dose`.
        """
        asked = _asked(volume, rate, speed, within, smooth, "any", None, start_angle_rad, limits)
        return self._run("purge", asked, dry_run, progress)

    def plan(
        self,
        volume: str,
        *,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        finish: Literal["any", "low-flow"] = "any",
        retract: str | None = None,
        start_angle_rad: float | None = None,
        limits: Limits | None = None,
    ) -> Plan:
        """Plan a dose from the record, with the calibration in use, for its steps and waveform.

        Moves and records nothing.

        Parameters and errors are those of `dose`.

        Returns
        -------
        Plan
            Steps, times and predicted pressures.
        """
        asked = _asked(volume, rate, speed, within, smooth, finish, retract, start_angle_rad, limits)
        self._core.prepare("dose", asked)
        angle_rad, half_width_rad, carry_ml = self._core.stands
        if start_angle_rad is not None:
            angle_rad, half_width_rad = start_angle_rad, 0.0
        keywords: dict[str, Any] = {"rate": rate, "speed": speed, "within": within}
        return Doser(self.pump, limits, self.calibration).plan(
            volume,
            smooth=smooth,
            finish=finish,
            retract=retract,
            start_angle_rad=angle_rad,
            start_half_width_rad=half_width_rad,
            carry_in_ml=carry_ml,
            **keywords,
        )

    def batch(
        self,
        volume: str,
        count: int,
        *,
        every_s: float | None = None,
        missed: Literal["skip", "now"] = "skip",
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        finish: Literal["any", "low-flow"] = "any",
        retract: str | None = None,
        start_angle_rad: float | None = None,
        limits: Limits | None = None,
    ) -> Iterator[Dose]:
        """Dose again and again: each dose is made as it is asked for, as by `for dose in bench.batch(...)`.

        What a dose leaves over is carried to the next. A batch that is left early makes no more doses.

        Parameters
        ----------
        volume : str
            Of every dose.
        count : int
            How many doses, 1 to 1,000,000.
        every_s : float, optional
            Time from the start of a dose to the start of the next, s; by default one follows the other. It
            counts from the first `next`; what is done between two doses takes of it.
        missed : {"skip", "now"}
            Whether a dose whose time has passed is left out, which is warned of, or made at once.
        rate, speed, within, smooth, finish, retract, start_angle_rad, limits
            As of `dose`; the start angle is the first dose's.

        Yields
        ------
        Dose
            What came of each.

        Raises
        ------
        ValueError
            If count, every_s or missed is not allowed.

        Warns
        -----
        RuntimeWarning
            Of each dose that was left out.
        """
        schedule = _Schedule(count, every_s, missed)
        started = time.monotonic()
        while True:
            action, number = schedule.next(time.monotonic() - started)
            if action == "done":
                return
            if action == "wait":
                time.sleep(max(0.0, number - (time.monotonic() - started)))
            elif action == "skip":
                message = f"dose {number:.0f} of {count} was skipped: its time had passed"
                warnings.warn(message, RuntimeWarning, stacklevel=2)
            else:
                yield self.dose(
                    volume,
                    rate=rate,
                    speed=speed,
                    within=within,
                    smooth=smooth,
                    finish=finish,
                    retract=retract,
                    start_angle_rad=start_angle_rad,
                    limits=limits,
                )
                start_angle_rad = None

    def resume(
        self,
        *,
        rate: str | None = None,
        speed: str | None = None,
        within: str | None = None,
        smooth: bool = False,
        finish: Literal["any", "low-flow"] = "any",
        limits: Limits | None = None,
        progress: Progress | None = None,
    ) -> Dose:
        """Make the rest of a dose that was stopped or cut off.

        Parameters, returns and errors are those of `dose`; a PumpError if nothing is unfinished.
        """
        asked = _asked(None, rate, speed, within, smooth, finish, None, None, limits)
        return Dose._from_json(self._core.resume(asked, progress))

    def stop(self) -> None:
        """Have the motor of a call in another thread decelerate and hold; that call then returns."""
        self._core.stop()

    def close(self) -> None:
        """Give the pump back; a call under way ends first. Closing twice is no error."""
        self._core.close()

    def __enter__(self) -> Self:
        """Return the bench itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Close it."""
        self.close()

    def __repr__(self) -> str:
        """Say which pump it is, what turns it, and where its record is."""
        at = "" if self.port is None else f" at {self.port}"
        closed = ", closed" if self.closed else ""
        return f"<Bench of '{self.pump.id}' ({self.driver}{at}) in {self.folder}{closed}>"

    def _run(self, purpose: str, asked: dict[str, Any], dry_run: bool, progress: Progress | None) -> Dose:
        if dry_run:
            return Dose._from_json(self._core.prepare(purpose, asked))
        return Dose._from_json(self._core.dose(purpose, asked, progress))


def _asked(
    volume: str | None,
    rate: str | None,
    speed: str | None,
    within: str | None,
    smooth: bool,
    finish: str,
    retract: str | None,
    start_angle_rad: float | None,
    limits: Limits | None,
) -> dict[str, Any]:
    return {
        "volume": volume,
        "rate": rate,
        "speed": speed,
        "within": within,
        "smooth": smooth,
        "finish": finish,
        "retract": retract,
        "start_angle_rad": start_angle_rad,
        "limits": limits,
    }
