"""Doses of a `pumpmodel.Bench` from PyLabRobot (`pip install 'pumpmodel[pylabrobot]'`).

PyLabRobot's own `Pump.pump_volume` divides the volume by a constant before its backend sees anything, so that
a backend could not know what was asked. `BenchPump` takes its place: the bench plans from the rollers' angle.

    from pumpmodel.pylabrobot import BenchBackend, BenchPump

    async with BenchPump(BenchBackend("my-pump.toml")) as pump:
        await pump.pump_volume(speed=50, volume=25)
"""

import asyncio
import os
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Literal, NoReturn

from pumpmodel._tables import optional
from pumpmodel.bench import Bench
from pumpmodel.dose import Dose
from pumpmodel.errors import PumpError

# Without types, so that type checkers take them for anything.
_Pump: Any = optional("pylabrobot.pumps", "pylabrobot").Pump
_PumpBackend: Any = optional("pylabrobot.pumps.backend", "pylabrobot").PumpBackend

__all__ = ["BenchBackend", "BenchPump", "HaltedError"]

# Between two calls of Bench.stop: one that comes before the bench has begun says nothing to it.
_AGAIN_S = 0.02


class HaltedError(PumpError):
    """A dose that `halt` ended. It is on record as unfinished.

    `dose` says what was delivered; `BenchPump.resume` makes the rest, `BenchPump.discard` leaves it.
    """

    def __init__(self, dose: Dose) -> None:
        super().__init__(
            f"halted after {dose.delivered_ml:.4f} of {dose.requested_ml:g} mL, which is on record;"
            " resume() makes the rest, discard() leaves it"
        )
        self.dose = dose


class BenchBackend(_PumpBackend):
    """The bench behind a `BenchPump`: opened by its `setup`, closed by its `stop`.

    Parameters
    ----------
    pump : str or os.PathLike
        Built-in pump or pump file.
    driver, port, state_dir : optional
        As of `pumpmodel.Bench.open`: a motor moves only if the pump file or `driver` names one.
    """

    def __init__(
        self,
        pump: str | os.PathLike[str],
        driver: Literal["sim", "grbl"] | None = None,
        port: str | None = None,
        state_dir: str | os.PathLike[str] | None = None,
    ) -> None:
        super().__init__()
        self._pump = os.fspath(pump)
        self._driver = driver
        self._port = port
        self._state_dir = None if state_dir is None else os.fspath(state_dir)
        self._bench: Bench | None = None

    @property
    def bench(self) -> Bench:
        """The bench, for all that PyLabRobot has no name for; a RuntimeError before `setup`."""
        if self._bench is None:
            message = "the pump is not set up; await its setup() first"
            raise RuntimeError(message)
        return self._bench

    async def setup(self) -> None:
        """Open the bench. Its pump is taken by the first dose."""
        if self._bench is not None:
            message = "the pump is set up already; await its stop() first"
            raise RuntimeError(message)
        self._bench = await asyncio.to_thread(
            Bench.open, self._pump, driver=self._driver, port=self._port, state_dir=self._state_dir
        )

    async def stop(self) -> None:
        """Let the dose under way end, and give the pump back."""
        bench, self._bench = self.bench, None
        await asyncio.to_thread(bench.close)

    def serialize(self) -> dict[str, Any]:
        """Return what makes the same backend again."""
        return {
            **super().serialize(),
            "pump": self._pump,
            "driver": self._driver,
            "port": self._port,
            "state_dir": self._state_dir,
        }

    def run_revolutions(self, num_revolutions: float) -> NoReturn:
        """Raise NotImplementedError: see `BenchPump.run_revolutions`."""
        _refuse("revolutions")

    def run_continuously(self, speed: float) -> NoReturn:
        """Raise NotImplementedError: see `BenchPump.run_continuously`."""
        _refuse("a speed without an end")

    def halt(self) -> None:
        """Have the motor of the dose under way decelerate and hold."""
        self.bench.stop()


class BenchPump(_Pump):
    """A PyLabRobot pump whose volumes are doses of a bench, exact from whatever angle the rollers stand at.

    Its commands complete when the motion has. A dose that is cancelled decelerates, holds and goes on record
    as unfinished before CancelledError is raised; until `resume` or `discard` the next one is refused.

    Parameters
    ----------
    backend : BenchBackend
        The bench.
    """

    def __init__(self, backend: BenchBackend) -> None:
        if not isinstance(backend, BenchBackend):
            message = f"backend must be a BenchBackend, not {type(backend).__name__}"
            raise TypeError(message)
        super().__init__(backend=backend)
        self.backend: BenchBackend = backend
        self._moving = asyncio.Lock()

    async def pump_volume(self, speed: float, volume: float) -> Dose:
        """Dose a volume; doses that are asked for at the same time come one after the other.

        Parameters
        ----------
        speed : float
            Speed of the pump head while cruising, r/min.
        volume : float
            Volume, mL; negative in reverse.

        Returns
        -------
        Dose
            What was planned and delivered.

        Raises
        ------
        HaltedError
            If `halt` ended it.
        ValueError, PlanError, UnfinishedError, DriveError
            As `pumpmodel.Bench.dose` does.
        """
        return await self._until_done(
            lambda bench: bench.dose(f"{float(volume)!r}mL", speed=f"{float(speed)!r}rpm")
        )

    async def resume(self) -> Dose:
        """Make the rest of an unfinished dose; returns and raises as `pump_volume`."""
        return await self._until_done(lambda bench: bench.resume())

    async def discard(self) -> None:
        """Accept an unfinished dose as it is."""
        bench = self.backend.bench
        async with self._moving:
            await asyncio.to_thread(bench.discard)

    async def run_revolutions(self, num_revolutions: float) -> NoReturn:
        """Raise NotImplementedError: what revolutions deliver depends on the angle they start from."""
        _refuse("revolutions")

    async def run_continuously(self, speed: float) -> None:
        """Halt if the speed is 0, raise NotImplementedError otherwise: a bench records what it doses."""
        if speed != 0:
            _refuse("a speed without an end")
        await self.halt()

    async def run_for_duration(self, speed: float, duration: float) -> NoReturn:
        """Raise NotImplementedError: a bench doses volumes."""
        _refuse("a duration")

    async def halt(self) -> None:
        """Decelerate and hold, if a dose is under way; completes when the motor stands, all on record."""
        bench = self.backend.bench
        while self._moving.locked():
            bench.stop()
            await asyncio.sleep(_AGAIN_S)

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
                # A motor that failed on the way is worse news than the cancellation.
                if failure := task.exception():
                    raise failure from cancelled
                raise
        if not dose.completed:
            raise HaltedError(dose)
        return dose


def _refuse(what: str) -> NoReturn:
    message = f"a bench doses volumes, not {what}; use pump_volume"
    raise NotImplementedError(message)
