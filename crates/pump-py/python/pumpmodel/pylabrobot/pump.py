"""A pump of PyLabRobot whose volumes are doses of a bench."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Self

from pumpmodel._pumpmodel import Limits
from pumpmodel._results.numbers import Number
from pumpmodel.bench import AsyncBench
from pumpmodel.choices import Finish
from pumpmodel.dose import Dose
from pumpmodel.errors import PumpError, StoppedError
from pumpmodel.pylabrobot import bases, motions
from pumpmodel.pylabrobot.backend import BenchBackend

# Time between two calls of Bench.stop while a call ends.
_AGAIN_S = 0.02


class HaltedError(PumpError):
    """A dose was ended by `halt`. It is on record as unfinished.

    `dose` has the delivered volume. `BenchPump.resume` makes the rest, and `BenchPump.discard` accepts the
    dose as it is.
    """

    def __init__(self, dose: Dose) -> None:
        message = (
            f"halted after {dose.delivered_ml:.4f} of {dose.requested_ml:g} mL, which is on record;"
            " resume() makes the rest, discard() accepts the dose as it is"
        )
        if dose.steps_made == 0:
            message = (
                f"halted before the first step of {dose.requested_ml:g} mL;"
                " only a dose that was unfinished before is unfinished now"
            )
        super().__init__(message)
        self.dose = dose


class BenchPump(bases.Pump):
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
        self._halts = 0

    async def __aenter__(self) -> Self:
        """Set the pump up and return it."""
        await super().__aenter__()
        return self

    async def pump_volume(
        self,
        speed: Number | None = None,
        volume: Number | None = None,
        *,
        rate: str | None = None,
        smooth: bool = False,
        finish: Finish = "any",
        retract: str | None = None,
        limits: Limits | None = None,
    ) -> Dose:
        """Dose a volume. Doses that are requested at one time come one after the other.

        Parameters
        ----------
        speed : float, optional
            Speed of the pump head while cruising, r/min. Give exactly one of `speed` and `rate`.
        volume : float
            Volume, mL; negative in reverse. It is always needed.
        rate : str, optional
            Average flow while cruising, as "10 mL/s"; "max" is the fastest flow that holds every limit.
        smooth : bool
            Let the speed follow the rollers' angle for a flow as smooth as the motor allows.
        finish : {"any", "low-flow"}
            Places in a pitch where the dose may end.
        retract : str, optional
            Volume that is sucked back after the dose, as "0.1mL". The next dose repays it.
        limits : Limits, optional
            Pressure limits that replace the pump file's.

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
        motion = motions.volume_of(
            speed, volume, rate, smooth=smooth, finish=finish, retract=retract, limits=limits
        )
        return await self.made(motion)

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
        self.refuse_running()
        return await self._until_done(lambda bench: bench.resume())

    async def discard(self) -> None:
        """Accept an unfinished dose with the volume that was delivered."""
        bench = self.backend.awaited
        self.refuse_running()
        async with self._moving:
            await bench.discard()

    async def run_revolutions(
        self,
        num_revolutions: Number,
        *,
        speed: Number | None = None,
        rate: str | None = None,
        limits: Limits | None = None,
    ) -> Dose:
        """Turn the pump head by revolutions, and put the volume on record. Complete when the motion is.

        The volume of a part of a revolution depends on the angle of the rollers: the result tells it.

        Parameters
        ----------
        num_revolutions : float
            Revolutions of the pump head, to within two motor steps; negative in reverse.
        speed : float, optional
            Speed of the pump head while cruising, r/min. The default is the pump's rate.
        rate : str, optional
            Average flow while cruising, as "10 mL/s", in place of a speed.
        limits : Limits, optional
            Pressure limits that replace the pump file's.

        Returns
        -------
        Dose
            The planned run and its result, as of `pump_volume`.

        Raises
        ------
        HaltedError
            If `halt` ended the run on its way.
        ValueError
            If an argument is not finite or not allowed.
        PlanError
            If the pump cannot make the run.
        """
        return await self.made(motions.revolutions_of(num_revolutions, speed, rate, limits))

    async def run_continuously(
        self,
        speed: Number | None = None,
        *,
        rate: str | None = None,
        reverse: bool = False,
        limits: Limits | None = None,
    ) -> None:
        """Run at a speed until `halt`. The call returns while the pump runs.

        A run under way is halted before. Speed 0 halts and begins nothing. Errors that come up before the run
        moves are those of `pump_volume` and raised here; those of its motion are raised by `halt`. Other
        calls are refused until `halt`.

        Parameters
        ----------
        speed : float, optional
            Speed of the pump head, r/min; negative in reverse. Give exactly one of `speed` and `rate`.
        rate : str, optional
            Average flow while cruising, as "10 mL/s".
        reverse : bool
            Run in reverse, at a `rate`.
        limits : Limits, optional
            Pressure limits that replace the pump file's.
        """
        await self.halt()
        if speed == 0:
            return
        motion = motions.continuous_of(speed, rate, reverse, limits)
        await self.planned(motion)
        await self.begin(motion)

    async def begin(self, motion: motions.Motion) -> None:
        """Begin a run that was planned, until `halt`. The call returns while the pump runs."""
        self._running = asyncio.create_task(self._until_done(lambda bench: motion(bench, False)))
        while not self._running.done() and not self._moving.locked():
            await asyncio.sleep(0)

    async def run_for_duration(
        self,
        speed: Number | None = None,
        duration: Number | None = None,
        *,
        rate: str | None = None,
        reverse: bool = False,
        limits: Limits | None = None,
    ) -> Dose:
        """Run at a speed for a time, ramps included. Complete when the run is.

        Parameters
        ----------
        speed : float, optional
            Speed of the pump head, r/min; negative in reverse. Give exactly one of `speed` and `rate`.
        duration : float
            Time from the first step to the last, s. It is always needed.
        rate : str, optional
            Average flow while cruising, as "10 mL/s".
        reverse : bool
            Run in reverse, at a `rate`.
        limits : Limits, optional
            Pressure limits that replace the pump file's.

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
        return await self.made(motions.duration_of(speed, duration, rate, reverse, limits))

    async def halt(self) -> Dose | None:
        """Decelerate and hold what is under way. Complete when the motor stands and all is recorded.

        Returns
        -------
        Dose or None
            The run that `run_continuously` began, with its result; None without one, and if it was halted
            before its motion.
        """
        bench = self.backend.bench
        self._halts += 1
        try:
            while self._moving.locked():
                bench.stop()
                await asyncio.sleep(_AGAIN_S)
        finally:
            self._halts -= 1
        running, self._running = self._running, None
        if running is None:
            return None
        try:
            return await running
        except StoppedError:
            return None

    async def stop(self) -> None:
        """Halt and give the pump back."""
        await self.halt()
        await super().stop()

    async def planned(self, motion: motions.Motion) -> Dose:
        """Plan a motion and make nothing of it. What refuses it is raised.

        Raises
        ------
        PumpError
            If a run goes on until `halt`.
        """
        bench = self.backend.awaited
        self.refuse_running()
        async with self._moving:
            return await motion(bench, True)

    async def made(self, motion: motions.Motion) -> Dose:
        """Make a motion.

        Raises
        ------
        PumpError
            If a run goes on until `halt`.
        """
        self.refuse_running()
        return await self._until_done(lambda bench: motion(bench, False))

    def refuse_running(self) -> None:
        """Refuse a call that would wait for a run without end.

        Raises
        ------
        PumpError
            If a run goes on until `halt`.
        """
        if self._running is not None and not self._running.done() and not self._halts:
            message = "the pump runs until halt(), as run_continuously() began it; await halt() first"
            raise PumpError(message)

    async def _until_done(self, work: Callable[[AsyncBench], Awaitable[Dose]]) -> Dose:
        bench = self.backend.awaited
        async with self._moving:
            dose = await work(bench)
        if not dose.completed:
            raise HaltedError(dose)
        return dose
