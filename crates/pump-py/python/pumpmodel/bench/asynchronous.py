"""A bench for asyncio: its motions are awaited, and a cancelled one decelerates and is on record."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import wraps
from types import TracebackType
from typing import Any, Concatenate, ParamSpec, Self, TypeVar

from pumpmodel._pumpmodel import Calibration, Pump, _Call
from pumpmodel.bench.bench import Bench
from pumpmodel.dose import Dose
from pumpmodel.errors import StoppedError

_P = ParamSpec("_P")
_Result = TypeVar("_Result")


def _opening(open_bench: Callable[_P, Bench]) -> Callable[_P, AsyncBench]:
    @wraps(open_bench)
    def opened(*arguments: _P.args, **keywords: _P.kwargs) -> AsyncBench:
        return AsyncBench(open_bench(*arguments, **keywords))

    return opened


def _moving(
    method: Callable[Concatenate[Bench, _P], _Result],
) -> Callable[Concatenate[AsyncBench, _P], Coroutine[Any, Any, _Result]]:
    @wraps(method)
    async def call(self: AsyncBench, /, *arguments: _P.args, **keywords: _P.kwargs) -> _Result:
        begun = self.bench._core.begin(method.__name__)
        try:
            return await self._moved(begun, lambda: method(self.bench, *arguments, **keywords))
        finally:
            begun.end()

    return call


def _repeating(
    method: Callable[Concatenate[Bench, _P], Iterator[Dose]],
) -> Callable[Concatenate[AsyncBench, _P], AsyncIterator[Dose]]:
    @wraps(method)
    async def doses(self: AsyncBench, /, *arguments: _P.args, **keywords: _P.kwargs) -> AsyncIterator[Dose]:
        begun = self.bench._core.begin(method.__name__, lasts=True)
        try:
            made = method(self.bench, *arguments, **keywords)
            while (dose := await self._moved(begun, lambda: next(made, None))) is not None:
                yield dose
        finally:
            begun.end()

    return doses


def _asking(
    method: Callable[Concatenate[Bench, _P], _Result],
) -> Callable[Concatenate[AsyncBench, _P], Coroutine[Any, Any, _Result]]:
    @wraps(method)
    async def call(self: AsyncBench, /, *arguments: _P.args, **keywords: _P.kwargs) -> _Result:
        return await asyncio.to_thread(method, self.bench, *arguments, **keywords)

    return call


class AsyncBench:
    """A bench for asyncio. Its methods are those of `Bench`, awaited, with the same arguments and errors.

    `stop` and the properties are not awaited.

    Other tasks run meanwhile. Calls come one after the other. A cancelled call decelerates the motor, which
    then holds; once all is on record, CancelledError is raised. Its `dose` has the result with the delivered
    volume, and so has `last_dose`; both are None if nothing moved. The rest is there for `resume` and
    `discard`, as after `stop`. An unfinished `batch` makes no more doses. A motor that fails while it stops
    raises its own error in place of CancelledError.

    Parameters
    ----------
    bench : Bench
        Bench to use, which `AsyncBench.close` or the end of an `async with` block closes.

    Examples
    --------
    >>> import asyncio, tempfile
    >>> import pumpmodel as pm
    >>> async def work(folder):
    ...     async with pm.AsyncBench.open("three-roller", state_dir=folder) as bench:
    ...         return await bench.dose("25mL")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     dose = asyncio.run(work(folder))
    >>> f"{dose.delivered_ml:.2f} mL"
    '25.00 mL'
    """

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        self._last_dose: Dose | None = None
        # Calls come one after the other, so one thread makes them all.
        self._thread = ThreadPoolExecutor(1, "pumpmodel async bench")

    open = staticmethod(_opening(Bench.open))

    @property
    def bench(self) -> Bench:
        """The bench itself, for what neither moves nor waits."""
        return self._bench

    @property
    def last_dose(self) -> Dose | None:
        """Result of the call that ended last, if that was a dose or a run: of a cancelled one too."""
        return self._last_dose

    dose = _moving(Bench.dose)
    prime = _moving(Bench.prime)
    purge = _moving(Bench.purge)
    run = _moving(Bench.run)
    resume = _moving(Bench.resume)
    batch = _repeating(Bench.batch)
    calibration_run = _moving(Bench.calibration_run)
    home_sensor = _moving(Bench.home_sensor)
    jog_rad = _moving(Bench.jog_rad)

    plan = _asking(Bench.plan)
    status = _asking(Bench.status)
    log = _asking(Bench.log)
    discard = _asking(Bench.discard)
    home_set = _asking(Bench.home_set)
    home_mark = _asking(Bench.home_mark)
    release = _asking(Bench.release)
    new_tube = _asking(Bench.new_tube)
    clear_safety = _asking(Bench.clear_safety)
    vessel_emptied = _asking(Bench.vessel_emptied)
    calibrate = _asking(Bench.calibrate)
    calibrate_last = _asking(Bench.calibrate_last)
    calibrate_phase = _asking(Bench.calibrate_phase)
    use_calibration = _asking(Bench.use_calibration)
    calibrations = _asking(Bench.calibrations)
    verify = _asking(Bench.verify)

    @property
    def pump(self) -> Pump:
        """Pump of the bench."""
        return self._bench.pump

    @property
    def calibration(self) -> Calibration | None:
        """Calibration that doses use; None without one."""
        return self._bench.calibration

    @property
    def driver(self) -> str:
        """Driver of the motor: "sim", "grbl", "node" or "klipper"."""
        return self._bench.driver

    @property
    def port(self) -> str | None:
        """Serial port of the controller; None without one."""
        return self._bench.port

    @property
    def folder(self) -> str:
        """Folder of the journal."""
        return self._bench.folder

    @property
    def closed(self) -> bool:
        """True once the bench is closed."""
        return self._bench.closed

    def stop(self) -> str | None:
        """Make every call under way decelerate the motor, as `Bench.stop` does. It does not wait."""
        return self._bench.stop()

    async def close(self) -> None:
        """Give the pump back after the call under way. Closing twice is no error."""
        await asyncio.to_thread(self._bench.close)
        self._thread.shutdown(wait=False)

    async def __aenter__(self) -> Self:
        """Return the bench itself."""
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Close the bench."""
        await self.close()

    def __repr__(self) -> str:
        """Tell pump, driver and folder of the record."""
        return f"<AsyncBench of {self._bench!r}>"

    async def _moved(self, begun: _Call, work: Callable[[], _Result]) -> _Result:
        """Do `work` as the call `begun` in the bench's thread. A cancellation stops that call alone."""

        def made() -> _Result:
            with begun:
                return work()

        self._last_dose = None
        submitted = self._thread.submit(made)
        task = asyncio.wrap_future(submitted)
        try:
            result = await asyncio.shield(task)
        except asyncio.CancelledError as cancelled:
            begun.stop("asyncio.CancelledError")
            if submitted.cancel():
                # It still waited for an earlier call.
                raise
            while not task.done():
                with suppress(asyncio.CancelledError):
                    await asyncio.wait([task])
            self._tell(cancelled, task)
            raise
        self._last_dose = result if isinstance(result, Dose) else None
        return result

    def _tell(self, cancelled: asyncio.CancelledError, task: asyncio.Future[Any]) -> None:
        """Give a cancellation the result of the call, or raise what failed meanwhile."""
        failure = task.exception()
        if failure is not None and not isinstance(failure, StoppedError):
            # A failed motor matters more than the cancellation.
            raise failure from cancelled
        dose = None if failure is not None else task.result()
        self._last_dose = dose if isinstance(dose, Dose) else None
        cancelled.dose = self._last_dose  # type: ignore[attr-defined]
        if self._last_dose is None:
            cancelled.add_note("nothing was delivered")
        else:
            cancelled.add_note(f"{self._last_dose.delivered_ml:.4f} mL were delivered and are on record")
