"""Doses of a `pumpmodel.Bench` from PyLabRobot (`pip install 'pumpmodel[pylabrobot]'`).

PyLabRobot's own `Pump.pump_volume` divides the volume by a constant before it calls its backend, so a backend
cannot know the requested volume. `BenchPump` replaces it: the bench plans from the rollers' angle.

    from pumpmodel.pylabrobot import BenchBackend, BenchPump

    async with BenchPump(BenchBackend("my-pump.toml")) as pump:
        await pump.pump_volume(speed=50, volume=25)
"""

import asyncio
import os
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NoReturn

from pumpmodel._results.optional import optional
from pumpmodel.bench import Bench
from pumpmodel.choices import Driver
from pumpmodel.dose import Dose
from pumpmodel.errors import PumpError

# PyLabRobot has no types: type checkers treat these bases as Any.
_Pump: Any = optional("pylabrobot.pumps", "pylabrobot").Pump
_PumpBackend: Any = optional("pylabrobot.pumps.backend", "pylabrobot").PumpBackend

__all__ = ["BenchBackend", "BenchPump", "HaltedError"]

# Time between two calls of Bench.stop. A call before the bench has begun has no effect.
_AGAIN_S = 0.02


class HaltedError(PumpError):
    """A dose was ended by `halt`. It is on record as unfinished.

    `dose` has the delivered volume. `BenchPump.resume` makes the rest, and `BenchPump.discard` accepts the
    dose as it is.
    """

    def __init__(self, dose: Dose) -> None:
        super().__init__(
            f"halted after {dose.delivered_ml:.4f} of {dose.requested_ml:g} mL, which is on record;"
            " resume() makes the rest, discard() accepts the dose as it is"
        )
        self.dose = dose


class BenchBackend(_PumpBackend):
    """The bench behind a `BenchPump`, which opens it in `setup` and closes it in `stop`.

    Parameters
    ----------
    pump : str or os.PathLike
        Path of a pump file, name in `[pumps]` of the configuration, or name of a built-in pump.
    driver : {"sim", "grbl", "node"}, optional
        Driver of the motor; by default the pump file's `[drive]`, otherwise "sim". A motor moves only if the
        pump file or `driver` names one.
    port : str, optional
        Serial port of the controller, as "/dev/ttyUSB0"; by default the pump file's.
    state_dir : str or os.PathLike, optional
        Folder of angle, journal and lock; by default `DOSE_STATE_DIR`, otherwise the command's folder.
    confirm_pump : bool
        Say that the pump's values are those of the pump at the motor, as `Bench.open` asks for.
    """

    def __init__(
        self,
        pump: str | os.PathLike[str],
        driver: Driver | None = None,
        port: str | None = None,
        state_dir: str | os.PathLike[str] | None = None,
        *,
        confirm_pump: bool = False,
    ) -> None:
        super().__init__()
        self._confirm_pump = confirm_pump
        self._pump = os.fspath(pump)
        self._driver = driver
        self._port = port
        self._state_dir = None if state_dir is None else os.fspath(state_dir)
        self._bench: Bench | None = None

    @property
    def bench(self) -> Bench:
        """Bench, for everything that PyLabRobot does not offer. A RuntimeError before `setup`."""
        if self._bench is None:
            message = "the pump is not set up; await its setup() first"
            raise RuntimeError(message)
        return self._bench

    async def setup(self) -> None:
        """Open the bench. The first dose takes the pump."""
        if self._bench is not None:
            message = "the pump is set up already; await its stop() first"
            raise RuntimeError(message)
        self._bench = await asyncio.to_thread(
            Bench.open,
            self._pump,
            driver=self._driver,
            port=self._port,
            state_dir=self._state_dir,
            confirm_pump=self._confirm_pump,
        )

    async def stop(self) -> None:
        """Wait for the dose under way, and give the pump back."""
        bench, self._bench = self.bench, None
        await asyncio.to_thread(bench.close)

    def serialize(self) -> dict[str, Any]:
        """Return the arguments that make an equal backend."""
        return {
            **super().serialize(),
            "pump": self._pump,
            "driver": self._driver,
            "port": self._port,
            "state_dir": self._state_dir,
            "confirm_pump": self._confirm_pump,
        }

    def run_revolutions(self, num_revolutions: float) -> NoReturn:
        """Raise NotImplementedError: see `BenchPump.run_revolutions`."""
        _refuse("revolutions")

    def run_continuously(self, speed: float) -> NoReturn:
        """Raise NotImplementedError: `BenchPump.run_continuously` runs the bench."""
        _refuse("a speed behind the back of its BenchPump")

    def halt(self) -> None:
        """Make the motor of the dose under way decelerate and hold."""
        self.bench.stop()


class BenchPump(_Pump):
    """A PyLabRobot pump whose volumes are doses of a bench, exact from any angle of the rollers.

    A command completes when its motion has. A cancelled dose decelerates, holds and goes on record as
    unfinished before CancelledError is raised. The next dose is refused until `resume` or `discard`.

    Parameters
    ----------
    backend : BenchBackend
        Bench that doses.
    """

    def __init__(self, backend: BenchBackend) -> None:
        if not isinstance(backend, BenchBackend):
            message = f"backend must be a BenchBackend, not {type(backend).__name__}"
            raise TypeError(message)
        super().__init__(backend=backend)
        self.backend: BenchBackend = backend
        self._moving = asyncio.Lock()
        self._running: asyncio.Task[Dose] | None = None

    async def pump_volume(self, speed: float, volume: float) -> Dose:
        """Dose a volume. Doses that are requested at one time come one after the other.

        Parameters
        ----------
        speed : float
            Speed of the pump head while cruising, r/min.
        volume : float
            Volume, mL; negative in reverse.

        Returns
        -------
        Dose
            The planned dose and its result.

        Raises
        ------
        HaltedError
            If `halt` ended the dose.
        ValueError
            If speed or volume is not finite or not allowed.
        PlanError
            If the pump cannot make the dose.
        UnfinishedError
            If an earlier dose is unfinished.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.
        """
        return await self._until_done(
            lambda bench: bench.dose(f"{float(volume)!r}mL", speed=f"{float(speed)!r}rpm")
        )

    async def resume(self) -> Dose:
        """Make the rest of an unfinished dose.

        Returns
        -------
        Dose
            The rest as a dose, with its result.

        Raises
        ------
        HaltedError
            If `halt` ended the dose.
        PumpError
            If no dose is unfinished.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.
        """
        return await self._until_done(lambda bench: bench.resume())

    async def discard(self) -> None:
        """Accept an unfinished dose with the volume that was delivered."""
        bench = self.backend.bench
        async with self._moving:
            await asyncio.to_thread(bench.discard)

    async def run_revolutions(self, num_revolutions: float) -> NoReturn:
        """Raise NotImplementedError: the volume of revolutions depends on their start angle."""
        _refuse("revolutions")

    async def run_continuously(self, speed: float) -> None:
        """Run at a speed until `halt`. The call returns while the pump runs.

        A run under way is halted before. Speed 0 halts and begins nothing. Errors that come up before the run
        moves are those of `pump_volume` and raised here; those of its motion are raised by `halt`.

        Parameters
        ----------
        speed : float
            Speed of the pump head, r/min; negative in reverse.
        """
        await self.halt()
        if speed == 0:
            return
        keywords: dict[str, Any] = {"speed": _rpm(speed), "reverse": speed < 0}
        async with self._moving:
            await asyncio.to_thread(self.backend.bench.run, dry_run=True, **keywords)
        self._running = asyncio.create_task(self._until_done(lambda bench: bench.run(**keywords)))
        while not self._running.done() and not self._moving.locked():
            await asyncio.sleep(0)

    async def run_for_duration(self, speed: float, duration: float) -> Dose:
        """Run at a speed for a time, ramps included. Complete when the run is.

        Parameters
        ----------
        speed : float
            Speed of the pump head, r/min; negative in reverse.
        duration : float
            Time from the first step to the last, s.

        Returns
        -------
        Dose
            The planned run and its result.

        Raises
        ------
        HaltedError
            If `halt` ended the run before its time.
        ValueError
            If speed or duration is not finite or not allowed.
        PlanError
            If the pump cannot make the run.
        UnfinishedError
            If an earlier dose is unfinished.
        DriveError
            If another process holds the pump, or the motor cannot be used or fails.
        """
        return await self._until_done(
            lambda bench: bench.run(speed=_rpm(speed), duration=f"{float(duration)!r}s", reverse=speed < 0)
        )

    async def halt(self) -> Dose | None:
        """Decelerate and hold what is under way. Complete when the motor stands and all is recorded.

        Returns
        -------
        Dose or None
            The run that `run_continuously` began, with its result; None without one.
        """
        bench = self.backend.bench
        while self._moving.locked():
            bench.stop()
            await asyncio.sleep(_AGAIN_S)
        running, self._running = self._running, None
        return None if running is None else await running

    async def stop(self) -> None:
        """Halt and give the pump back."""
        await self.halt()
        await super().stop()

    async def _until_done(self, work: Callable[[Bench], Dose]) -> Dose:
        bench = self.backend.bench
        async with self._moving:
            task = asyncio.create_task(asyncio.to_thread(work, bench))
            try:
                dose = await asyncio.shield(task)
            except asyncio.CancelledError as cancelled:
                while not task.done():
                    bench.stop()
                    with suppress(asyncio.CancelledError):
                        await asyncio.wait([task], timeout=_AGAIN_S)
                # A failed motor matters more than the cancellation.
                if failure := task.exception():
                    raise failure from cancelled
                raise
        if not dose.completed:
            raise HaltedError(dose)
        return dose


def _rpm(speed: float) -> str:
    return f"{abs(float(speed))!r}rpm"


def _refuse(amount: str) -> NoReturn:
    message = f"a bench doses volumes, not {amount}; use pump_volume"
    raise NotImplementedError(message)
