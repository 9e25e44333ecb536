"""Pumps of PyLabRobot that run together, each a bench."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NoReturn, Self, TypeVar

import numpy as np

from pumpmodel._pumpmodel import Limits
from pumpmodel._results.numbers import Number
from pumpmodel.dose import Dose
from pumpmodel.errors import UnfinishedError
from pumpmodel.pylabrobot import bases, motions
from pumpmodel.pylabrobot.backend import BenchBackend, refuse
from pumpmodel.pylabrobot.pump import BenchPump

_Result = TypeVar("_Result")


class BenchArrayBackend(bases.PumpArrayBackend):
    """The benches behind a `BenchPumpArray`, one a channel.

    Parameters
    ----------
    pumps : sequence of BenchBackend or dict
        Benches of the channels 0, 1 and so on; or what their `serialize` gave.
    """

    def __init__(self, pumps: Sequence[BenchBackend | dict[str, Any]]) -> None:
        super().__init__()
        backends = [BenchBackend.deserialize(pump) if isinstance(pump, dict) else pump for pump in pumps]
        for pump in backends:
            if not isinstance(pump, BenchBackend):
                message = f"pumps must be BenchBackends, not {type(pump).__name__}"
                raise TypeError(message)
        self.pumps = [BenchPump(pump) for pump in backends]

    @property
    def num_channels(self) -> int:
        """Number of pumps."""
        return len(self.pumps)

    async def setup(self) -> None:
        """Open every bench. If one cannot be opened, none stays open."""
        ready: list[BenchPump] = []
        try:
            for pump in self.pumps:
                await pump.setup()
                ready.append(pump)
        except BaseException:
            for pump in ready:
                await pump.stop()
            raise

    async def stop(self) -> None:
        """Halt every pump and give it back."""
        await asyncio.gather(*(pump.stop() for pump in self.pumps))

    async def halt(self) -> None:
        """Make every motor decelerate and hold."""
        await asyncio.gather(*(pump.halt() for pump in self.pumps))

    async def run_revolutions(self, num_revolutions: list[float], use_channels: list[int]) -> NoReturn:
        """Raise NotImplementedError: `BenchPumpArray.run_revolutions` runs the benches."""
        refuse("revolutions behind the back of its BenchPumpArray")

    async def run_continuously(self, speed: list[float], use_channels: list[int]) -> NoReturn:
        """Raise NotImplementedError: `BenchPumpArray.run_continuously` runs the benches."""
        refuse("a speed behind the back of its BenchPumpArray")

    def serialize(self) -> dict[str, Any]:
        """Return the arguments that make an equal backend."""
        return {**super().serialize(), "pumps": [pump.backend.serialize() for pump in self.pumps]}


class BenchPumpArray(bases.PumpArray):
    """A PyLabRobot pump array whose channels are benches. The channels of a call run at the same time.

    Every channel is planned before one moves: what refuses one channel moves none.

    If one of them fails or the call is cancelled, the others decelerate, hold and are on record; the first
    failure is raised. `pumps` has each channel's `BenchPump`, for `resume` and `discard`.

    Parameters
    ----------
    backend : BenchArrayBackend
        Benches that dose.
    """

    def __init__(self, backend: BenchArrayBackend) -> None:
        if not isinstance(backend, BenchArrayBackend):
            message = f"backend must be a BenchArrayBackend, not {type(backend).__name__}"
            raise TypeError(message)
        super().__init__(backend=backend)
        self.backend: BenchArrayBackend = backend

    async def __aenter__(self) -> Self:
        """Set the pumps up and return the array."""
        await super().__aenter__()
        return self

    @property
    def pumps(self) -> list[BenchPump]:
        """Pump of each channel."""
        return self.backend.pumps

    async def pump_volume(
        self,
        speed: Number | Sequence[Number] | None = None,
        use_channels: int | Sequence[int] | None = None,
        volume: Number | Sequence[Number] | None = None,
        *,
        rate: str | Sequence[str] | None = None,
        retract: str | None = None,
        limits: Limits | None = None,
    ) -> list[Dose]:
        """Dose a volume by each channel.

        Parameters
        ----------
        speed : float or sequence of float, optional
            Speed of every pump head, or of each, r/min. Give exactly one of `speed` and `rate`.
        use_channels : int or sequence of int
            Channels, from 0. They are always needed.
        volume : float or sequence of float
            Volume of every channel, or of each, mL; negative in reverse. It is always needed.
        rate : str or sequence of str, optional
            Average flow of every channel, or of each, as "10 mL/s".
        retract : str, optional
            Volume that is sucked back after each dose, as "0.1mL".
        limits : Limits, optional
            Pressure limits that replace those of the pump files.

        Returns
        -------
        list of Dose
            Result of each channel, in the order of `use_channels`.

        Raises
        ------
        ValueError
            If a channel does not exist or comes twice, or if there is not one value for each. Errors of a
            channel are those of `BenchPump.pump_volume`, and name it.
        """
        return await self._made(
            use_channels,
            lambda speed, volume, rate: motions.volume_of(
                speed, volume, rate, retract=retract, limits=limits
            ),
            speed=speed,
            volume=volume,
            rate=rate,
        )

    async def run_revolutions(
        self,
        num_revolutions: Number | Sequence[Number],
        use_channels: int | Sequence[int],
        *,
        speed: Number | Sequence[Number] | None = None,
        rate: str | Sequence[str] | None = None,
        limits: Limits | None = None,
    ) -> list[Dose]:
        """Turn each channel's pump head by revolutions, as `BenchPump.run_revolutions` does."""
        return await self._made(
            use_channels,
            lambda turns, speed, rate: motions.revolutions_of(turns, speed, rate, limits),
            num_revolutions=num_revolutions,
            speed=speed,
            rate=rate,
        )

    async def run_for_duration(
        self,
        speed: Number | Sequence[Number] | None = None,
        use_channels: int | Sequence[int] | None = None,
        duration: Number | None = None,
        *,
        rate: str | Sequence[str] | None = None,
        reverse: bool = False,
        limits: Limits | None = None,
    ) -> list[Dose]:
        """Run each channel for `duration` seconds, as `BenchPump.run_for_duration` does."""
        return await self._made(
            use_channels,
            lambda speed, rate: motions.duration_of(speed, duration, rate, reverse, limits),
            speed=speed,
            rate=rate,
        )

    async def run_continuously(
        self,
        speed: Number | Sequence[Number] | None = None,
        use_channels: int | Sequence[int] | None = None,
        *,
        rate: str | Sequence[str] | None = None,
        reverse: bool = False,
        limits: Limits | None = None,
    ) -> None:
        """Run each channel at a speed, r/min, or at a `rate`, until `halt`. Speed 0 halts a channel.

        Runs of these channels that are under way are halted before. Arguments are those of
        `BenchPump.run_continuously`.
        """
        rows = self._rows(use_channels, speed=speed, rate=rate)
        runs = []
        for channel, of_channel, rate_of_channel in rows:
            if of_channel != 0:
                with _naming(channel):
                    motion = motions.continuous_of(of_channel, rate_of_channel, reverse, limits)
                runs.append((channel, motion))
        await self._at_once([(channel, self.pumps[channel].halt()) for channel, *_ in rows])
        await self._plan(runs)
        await self._at_once([(channel, self.pumps[channel].begin(run)) for channel, run in runs])

    async def halt(self) -> list[Dose | None]:
        """Decelerate and hold what is under way.

        Returns
        -------
        list of Dose or None
            The run of each channel that `run_continuously` began; None without one.
        """
        return list(await asyncio.gather(*(pump.halt() for pump in self.pumps)))

    async def _made(
        self,
        use_channels: int | Sequence[int] | None,
        motion_of: Callable[..., motions.Motion],
        **values: Any,
    ) -> list[Dose]:
        """Plan the motion of each channel with its values, then make them at the same time."""
        made = []
        for channel, *row in self._rows(use_channels, **values):
            with _naming(channel):
                made.append((channel, motion_of(*row)))
        await self._plan(made)
        return await self._at_once([(channel, self.pumps[channel].made(motion)) for channel, motion in made])

    def _rows(self, use_channels: int | Sequence[int] | None, **values: Any) -> list[tuple[Any, ...]]:
        """Return each channel with its values."""
        if use_channels is None:
            message = "use_channels is missing; give channels, as use_channels=[0, 1]"
            raise TypeError(message)
        channels = [use_channels] if isinstance(use_channels, int) else list(use_channels)
        for channel in channels:
            if not 0 <= channel < len(self.pumps):
                message = f"use_channels has {channel}; allowed: 0 to {len(self.pumps) - 1}"
                raise ValueError(message)
        if len(set(channels)) != len(channels):
            message = f"use_channels is {channels}; allowed: each channel once"
            raise ValueError(message)
        columns = [_column(name, value, len(channels)) for name, value in values.items()]
        return list(zip(channels, *columns, strict=True))

    async def _plan(self, planned: list[tuple[int, motions.Motion]]) -> None:
        """Plan the motion of every channel, so that one that is refused moves none."""
        for channel, motion in planned:
            with _naming(channel):
                self.pumps[channel].refuse_running()
                unfinished = (await self.pumps[channel].backend.awaited.status()).unfinished
                if unfinished is not None:
                    message = "a dose is unfinished; its pump's resume() makes the rest, discard() accepts it"
                    raise UnfinishedError(message)
                await self.pumps[channel].planned(motion)

    async def _at_once(self, works: list[tuple[int, Awaitable[_Result]]]) -> list[_Result]:
        """Do the work of each channel at the same time."""

        async def named(channel: int, work: Awaitable[_Result]) -> _Result:
            with _naming(channel):
                return await work

        tasks = [asyncio.ensure_future(named(channel, work)) for channel, work in works]
        try:
            return list(await asyncio.gather(*tasks))
        except BaseException:
            # A pump that still runs decelerates and is on record before the failure is told.
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            raise


@contextmanager
def _naming(channel: int) -> Iterator[None]:
    """Put the channel before the message of an error."""
    try:
        yield
    except Exception as error:
        if error.args and isinstance(error.args[0], str):
            error.args = (f"channel {channel}: {error.args[0]}", *error.args[1:])
        else:
            error.add_note(f"channel {channel}")
        raise


def _column(name: str, value: Any, count: int) -> list[Any]:
    if value is None or isinstance(value, int | float | str | np.generic):
        return [value] * count
    values = list(value)
    if len(values) != count:
        message = (
            f"{name} has {len(values)} values for {count} channels; allowed: one for each, or one for all"
        )
        raise ValueError(message)
    return values
