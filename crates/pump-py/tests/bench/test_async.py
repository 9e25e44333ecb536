import asyncio
import inspect
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

import pytest

import pumpmodel as pm


def run(work: Coroutine[Any, Any, None]) -> None:
    """Run a test's own coroutine; a minute is more than any of them needs."""
    asyncio.run(asyncio.wait_for(work, 60))


async def in_motion(bench: pm.AsyncBench) -> None:
    """Wait until the record says that steps of a dose are made."""
    while (dose := (await bench.status()).unfinished) is None or dose.steps_made_least == 0:
        await asyncio.sleep(0.01)


def test_every_method_of_a_bench_that_moves_or_records_is_awaited_by_the_same_arguments() -> None:
    at_once = {"open", "stop", "close", "jog"}
    methods = {name for name, _ in inspect.getmembers(pm.Bench, inspect.isfunction) if name[0] != "_"}
    for name in methods - at_once:
        method = getattr(pm.AsyncBench, name)
        assert inspect.iscoroutinefunction(method) or inspect.isasyncgenfunction(method), name
        assert inspect.signature(method) == inspect.signature(getattr(pm.Bench, name)), name
        assert method.__doc__ == getattr(pm.Bench, name).__doc__


def test_the_properties_of_a_bench_are_those_of_its_asynchronous_one(tmp_path: Path) -> None:
    names = {name for name, _ in inspect.getmembers(pm.Bench, lambda member: isinstance(member, property))}
    assert {"pump", "calibration", "driver", "port", "folder", "closed"} <= names

    async def work() -> None:
        async with pm.AsyncBench.open("three-roller", state_dir=tmp_path) as bench:
            for name in names:
                assert getattr(bench, name) == getattr(bench.bench, name), name
            assert await bench.calibrations() == []
            assert len((await bench.verify("10mL", ["9.98g", "9.97g"])).volumes_ml) == 2
        assert bench.closed

    run(work())


def test_other_tasks_run_while_a_dose_is_awaited(tmp_path: Path) -> None:
    async def work() -> None:
        async with pm.AsyncBench.open("three-roller", state_dir=tmp_path) as bench:
            task = asyncio.create_task(bench.dose("500mL", rate="20mL/s"))
            ticks = 0
            while not task.done():
                await asyncio.sleep(1e-3)
                ticks += 1
            dose = await task
            assert dose.completed
            assert bench.last_dose is dose
            assert ticks > 3
            assert [dose.completed async for dose in bench.batch("1mL", 3)] == [True, True, True]
        assert bench.bench.closed

    run(work())


def test_a_cancelled_dose_decelerates_and_its_exception_has_the_delivered_volume(tmp_path: Path) -> None:
    async def work() -> None:
        async with pm.AsyncBench.open("three-roller", state_dir=tmp_path) as bench:
            task = asyncio.create_task(bench.dose("9000mL", rate="20mL/s"))
            await in_motion(bench)
            task.cancel()
            with pytest.raises(asyncio.CancelledError) as cancelled:
                await task
            dose = bench.last_dose
            assert dose is not None
            assert cancelled.value.dose is dose  # type: ignore[attr-defined]
            assert not dose.completed
            assert dose.delivered_ml is not None
            assert 0 < dose.delivered_ml < 9000
            assert cancelled.value.__notes__ == [
                f"{dose.delivered_ml:.4f} mL were delivered and are on record"
            ]
            unfinished = (await bench.status()).unfinished
            assert unfinished is not None
            assert unfinished.delivered_most_ml == pytest.approx(dose.delivered_ml)
            assert (await bench.log())[-1].cause == "asyncio.CancelledError"
            with pytest.raises(pm.UnfinishedError):
                await bench.dose("1mL")
            await bench.discard()
            assert (await bench.dose("1mL")).completed

    run(work())


def test_a_cancelled_call_that_waits_ends_at_once_and_the_one_before_it_goes_on(tmp_path: Path) -> None:
    async def work() -> None:
        async with pm.AsyncBench.open("three-roller", state_dir=tmp_path) as bench:
            first = asyncio.create_task(bench.dose("500mL", rate="20mL/s"))
            second = asyncio.create_task(bench.dose("1mL"))
            await asyncio.sleep(0)
            second.cancel()
            with pytest.raises(asyncio.CancelledError):
                await second
            assert not first.done()
            assert (await first).completed
            assert len(await bench.log()) == 1

    run(work())


def test_a_cancelled_batch_makes_no_more_doses_even_between_two(tmp_path: Path) -> None:
    async def work() -> None:
        made: list[pm.Dose] = []

        async def batch(bench: pm.AsyncBench) -> None:
            async for dose in bench.batch("1mL", 100, every_s=3600):
                made.append(dose)

        async with pm.AsyncBench.open("three-roller", state_dir=tmp_path) as bench:
            task = asyncio.create_task(batch(bench))
            while not made:
                await asyncio.sleep(0.01)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            assert bench.stop() is None, "the batch is over"
            assert len(await bench.log()) == len(made) == 1

    run(work())


def test_a_stop_ends_an_awaited_run(tmp_path: Path) -> None:
    async def work() -> None:
        async with pm.AsyncBench.open("three-roller", state_dir=tmp_path) as bench:
            task = asyncio.create_task(bench.run(rate="10mL/s"))
            await in_motion(bench)
            assert bench.stop() == "run"
            assert (await task).completed

    run(work())
