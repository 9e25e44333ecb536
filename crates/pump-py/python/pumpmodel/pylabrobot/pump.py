"""A pump of PyLabRobot whose volumes are doses of a bench."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

from pumpmodel._pumpmodel import Limits
from pumpmodel.bench import AsyncBench
from pumpmodel.choices import Finish
from pumpmodel.dose import Dose
from pumpmodel.errors import PumpError
from pumpmodel.pylabrobot import bases
from pumpmodel.pylabrobot.backend import BenchBackend

# Time between two calls of Bench.stop while a call ends.
_AGAIN_S = 0.02

# Steps by which revolutions may miss, and plans in search of their volume.
_NEAR_STEPS = 2
_ROUNDS = 20


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

    async def pump_volume(
        self,
        speed: float | None,
        volume: float,
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
        speed : float or None
            Speed of the pump head while cruising, r/min; None with a `rate`, or for the pump's own rate.
        volume : float
            Volume, mL; negative in reverse.
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
        cruise = None if speed is None else f"{float(speed)!r}rpm"
        return await self._until_done(
            lambda bench: bench.dose(
                f"{float(volume)!r}mL",
                speed=cruise,
                rate=rate,
                smooth=smooth,
                finish=finish,
                retract=retract,
                limits=limits,
            )
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
        bench = self.backend.awaited
        async with self._moving:
            await bench.discard()

    async def run_revolutions(
        self,
        num_revolutions: float,
        *,
        speed: float | None = None,
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
        turns = float(num_revolutions)
        keywords: dict[str, Any] = {"rate": rate, "limits": limits, "reverse": turns < 0}
        keywords["speed"] = None if speed is None else _rpm(speed)
        return await self._until_done(lambda bench: _turn(bench, abs(turns), keywords))

    async def run_continuously(
        self,
        speed: float | None,
        *,
        rate: str | None = None,
        reverse: bool = False,
        limits: Limits | None = None,
    ) -> None:
        """Run at a speed until `halt`. The call returns while the pump runs.

        A run under way is halted before. Speed 0 halts and begins nothing. Errors that come up before the run
        moves are those of `pump_volume` and raised here; those of its motion are raised by `halt`.

        Parameters
        ----------
        speed : float or None
            Speed of the pump head, r/min; negative in reverse. None with a `rate`.
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
        keywords = _cruise(speed, rate, reverse, limits)
        async with self._moving:
            await self.backend.awaited.run(dry_run=True, **keywords)
        self._running = asyncio.create_task(self._until_done(lambda bench: bench.run(**keywords)))
        while not self._running.done() and not self._moving.locked():
            await asyncio.sleep(0)

    async def run_for_duration(
        self,
        speed: float | None,
        duration: float,
        *,
        rate: str | None = None,
        reverse: bool = False,
        limits: Limits | None = None,
    ) -> Dose:
        """Run at a speed for a time, ramps included. Complete when the run is.

        Parameters
        ----------
        speed : float or None
            Speed of the pump head, r/min; negative in reverse. None with a `rate`.
        duration : float
            Time from the first step to the last, s.
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
        keywords = _cruise(speed, rate, reverse, limits)
        return await self._until_done(lambda bench: bench.run(duration=f"{float(duration)!r}s", **keywords))

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

    async def _until_done(self, work: Callable[[AsyncBench], Awaitable[Dose]]) -> Dose:
        bench = self.backend.awaited
        async with self._moving:
            dose = await work(bench)
        if not dose.completed:
            raise HaltedError(dose)
        return dose


def _rpm(speed: float) -> str:
    return f"{abs(float(speed))!r}rpm"


def _cruise(speed: float | None, rate: str | None, reverse: bool, limits: Limits | None) -> dict[str, Any]:
    """Return the keywords of a run. The sign of a speed is a direction too."""
    if speed is None:
        return {"rate": rate, "reverse": reverse, "limits": limits}
    return {"speed": _rpm(speed), "rate": rate, "reverse": (speed < 0) != reverse, "limits": limits}


async def _turn(bench: AsyncBench, turns: float, keywords: dict[str, Any]) -> Dose:
    """Run for the volume that the pump delivers in `turns` revolutions from where the rollers stand."""
    pump = bench.bench.pump
    steps = turns * pump.steps_per_rev
    volume_ml = turns * pump.volume_per_revolution_ml
    for _ in range(_ROUNDS):
        planned = await bench.run(volume=f"{volume_ml!r}mL", dry_run=True, **keywords)
        missing = steps - abs(planned.steps)
        if abs(missing) <= _NEAR_STEPS:
            break
        volume_ml += missing / pump.steps_per_rev * pump.volume_per_revolution_ml
    return await bench.run(volume=f"{volume_ml!r}mL", **keywords)
