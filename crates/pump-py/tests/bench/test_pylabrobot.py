import asyncio
import json
import subprocess
import sys
import warnings
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pumpmodel as pm
from pumpmodel.pylabrobot import (
    BenchArrayBackend,
    BenchBackend,
    BenchPump,
    BenchPumpArray,
    HaltedError,
    bases,
)

# At 170 r/min this takes minutes of simulation: long enough to be interrupted.
LONG_ML = 20_000


def bench_pump(folder: Path) -> BenchPump:
    return BenchPump(BenchBackend("three-roller", driver="sim", state_dir=folder))


def run(work: Coroutine[Any, Any, None]) -> None:
    """Run a test's own coroutine; a minute is more than any of them needs."""
    asyncio.run(asyncio.wait_for(work, 60))


async def in_motion(pump: BenchPump) -> None:
    """Wait until the record says that steps of a dose are made."""
    while (dose := pump.backend.bench.status().unfinished) is None or dose.steps_made_least == 0:
        await asyncio.sleep(0.01)


def test_a_volume_is_a_dose_of_the_bench_from_the_rollers_angle(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            assert isinstance(pump, bases.Pump)
            owed = 0.0
            for volume in (3, 3.0, -1, 0.5):
                dose = await pump.pump_volume(speed=50, volume=volume)
                assert dose.completed
                assert dose.delivered_ml == pytest.approx(volume + owed, abs=2e-3)
                assert dose.cruise_speed_rpm <= 50 + 1e-9
                owed = dose.carry_ml
                status = pump.backend.bench.status()
                assert status.unfinished is None, "the command completes when the motion has"
                assert status.carry_ml == dose.carry_ml
        with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
            assert bench.status().carry_ml == owed, "the record is the bench's own"

    run(work())


def test_other_tasks_run_during_a_dose_and_doses_come_one_after_the_other(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            doses = asyncio.gather(*(pump.pump_volume(speed=100, volume=200) for _ in range(3)))
            ticks = 0
            while not doses.done():
                await asyncio.sleep(0.001)
                ticks += 1
            first, second, third = await doses
            assert (second.carry_in_ml, third.carry_in_ml) == (first.carry_ml, second.carry_ml)
            assert ticks > 3

    run(work())


def test_a_cancelled_dose_decelerates_and_is_on_record(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            dose = asyncio.create_task(pump.pump_volume(speed=170, volume=LONG_ML))
            await in_motion(pump)
            dose.cancel()
            with pytest.raises(asyncio.CancelledError):
                await dose
            unfinished = pump.backend.bench.status().unfinished
            assert unfinished is not None
            assert unfinished.steps_made_least == unfinished.steps_made_most < unfinished.steps
            with pytest.raises(pm.UnfinishedError, match="20000 mL is unfinished"):
                await pump.pump_volume(speed=50, volume=1)
            await pump.discard()
            assert (await pump.pump_volume(speed=50, volume=1)).completed

    run(work())


def test_a_dose_cancelled_before_it_begins_moves_nothing(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            dose = asyncio.create_task(pump.pump_volume(speed=170, volume=LONG_ML))
            await asyncio.sleep(0)
            dose.cancel()
            with pytest.raises((asyncio.CancelledError, pm.PumpError)):
                await dose
            unfinished = pump.backend.bench.status().unfinished
            assert unfinished is None or unfinished.steps_made_most < 0.01 * unfinished.steps

    run(work())


def test_a_halted_dose_says_what_was_delivered_and_can_be_resumed(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            await pump.halt()
            dose = asyncio.create_task(pump.pump_volume(speed=170, volume=1000))
            await in_motion(pump)
            await pump.run_continuously(speed=0)
            with pytest.raises(HaltedError, match="of 1000 mL, which is on record") as halted:
                await dose
            made = halted.value.dose.delivered_ml
            assert made is not None
            assert 0 < made < 1000
            rest = await pump.resume()
            assert rest.completed
            assert rest.delivered_ml == pytest.approx(1000 - made, abs=0.01)

    run(work())


def test_the_end_of_the_block_halts_what_still_runs(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            dose = asyncio.create_task(pump.pump_volume(speed=170, volume=LONG_ML))
            await in_motion(pump)
        with pytest.raises(HaltedError):
            await dose
        for unready in (pump.pump_volume(speed=50, volume=1), pump.halt(), pump.resume(), pump.discard()):
            with pytest.raises(RuntimeError, match="not set up"):
                await unready
        with pytest.raises(RuntimeError, match="not set up"):
            pump.backend.halt()
        await pump.setup()
        with pytest.raises(RuntimeError, match="set up already"):
            await pump.setup()
        await pump.stop()

    run(work())


def test_what_is_no_volume_is_refused(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            with pytest.raises(NotImplementedError):
                pump.backend.run_revolutions(1)
            with pytest.raises(NotImplementedError):
                pump.backend.run_continuously(1)
            for speed, volume, message in ((0, 1, "zero"), (-5, 1, "negative"), (50, 0, "zero")):
                with pytest.raises(ValueError, match=message):
                    await pump.pump_volume(speed=speed, volume=volume)
            with pytest.raises(ValueError, match=r"^volume is nan; allowed: a finite number in mL"):
                await pump.pump_volume(speed=50, volume=float("nan"))
            with pytest.raises(ValueError, match=r"^speed and rate are both given; give exactly one$"):
                await pump.pump_volume(speed=50, volume=1, rate="1 mL/s")
            with pytest.raises(pm.PlanError, match=r"limit of 170"):
                await pump.pump_volume(speed=500, volume=1)
            assert not pump.backend.bench.status().recorded

    run(work())


def test_it_is_made_of_a_bench_and_without_a_constant(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="backend must be a BenchBackend, not str"):
        BenchPump("three-roller")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="calibration"):
        BenchPump(BenchBackend("three-roller"), calibration=[1.0])  # type: ignore[call-arg]
    pump = bench_pump(tmp_path)
    again = BenchPump.deserialize(json.loads(json.dumps(pump.serialize())))
    assert isinstance(again, BenchPump)
    assert again.serialize() == pump.serialize()


def test_without_pylabrobot_the_extra_is_named() -> None:
    script = "import sys; sys.modules['pylabrobot'] = None; import pumpmodel; import pumpmodel.pylabrobot"
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert ended.returncode == 1
    assert ended.stderr.rstrip().endswith('pip install "./crates/pump-py[pylabrobot]"')


def test_a_run_for_a_duration_takes_that_time_at_that_speed(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            for speed in (60, -60):
                dose = await pump.run_for_duration(speed=speed, duration=10)
                assert dose.purpose == "run"
                assert dose.motion_s == pytest.approx(10, abs=0.1)
                assert dose.run is not None
                assert dose.run.asked_s == 10
                assert dose.delivered_ml is not None
                assert (dose.delivered_ml < 0) == (speed < 0)
            for duration in (0, -1, float("nan")):
                with pytest.raises(ValueError, match=r"^duration is .*; allowed: a .* number in s"):
                    await pump.run_for_duration(speed=60, duration=duration)

    run(work())


def test_a_continuous_run_goes_on_until_halt_and_leaves_nothing_unfinished(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            with pytest.raises(pm.PlanError, match=r"limit of 170"):
                await pump.run_continuously(speed=500)
            await pump.run_continuously(speed=60)
            await in_motion(pump)
            await asyncio.sleep(0.5)
            # Another speed takes the place of the first.
            await pump.run_continuously(speed=-60)
            await in_motion(pump)
            dose = await pump.halt()
            assert dose is not None
            assert dose.completed
            assert dose.run is not None
            assert dose.run.until == "stop"
            assert dose.delivered_ml is not None
            assert dose.delivered_ml < 0
            assert pump.backend.bench.status().unfinished is None
            assert await pump.halt() is None

    run(work())


def test_other_calls_are_refused_until_a_continuous_run_is_halted(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            await pump.run_continuously(rate="10 mL/s")
            await in_motion(pump)
            for call in (
                pump.pump_volume(speed=50, volume=1),
                pump.run_revolutions(1),
                pump.run_for_duration(50, 1),
                pump.resume(),
                pump.discard(),
            ):
                with pytest.raises(pm.PumpError, match=r"runs until halt\(\).*await halt\(\) first"):
                    await call
            assert await pump.halt() is not None
            assert (await pump.pump_volume(speed=50, volume=1)).completed

    run(work())


def test_a_rate_takes_the_place_of_a_speed_and_one_of_them_is_needed(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            dose = await pump.pump_volume(rate="8 mL/s", volume=np.float32(5))
            assert dose.cruise_flow_ml_s == pytest.approx(8)
            assert (await pump.run_for_duration(rate="8 mL/s", duration=2)).completed
            for unclear in (
                pump.pump_volume(None, 25),
                pump.run_for_duration(None, 5),
                pump.run_continuously(None),
            ):
                with pytest.raises(ValueError, match="neither speed nor rate is given"):
                    await unclear
            wrong: Any = "25mL"
            with pytest.raises(TypeError, match="volume must be a number in mL, not str"):
                await pump.pump_volume(50, wrong)
            with pytest.raises(TypeError, match="speed must be a number in r/min, not str"):
                await pump.run_for_duration(wrong, 5)
            with pytest.raises(TypeError, match="volume is missing; give it in mL"):
                await pump.pump_volume(50)

    run(work())


def test_revolutions_are_turned_from_any_angle_and_their_volume_is_on_record(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            steps_per_rev = pump.backend.bench.pump.steps_per_rev
            for turns, speed in ((2, 60), (0.37, None), (-0.5, 30)):
                dose = await pump.run_revolutions(turns, speed=speed)
                assert dose.steps == pytest.approx(turns * steps_per_rev, abs=2)
                logged = pump.backend.bench.log()[-1]
                assert logged.delivered_ml == pytest.approx(dose.delivered_ml, abs=1e-3)

    run(work())


def test_a_call_has_its_own_rate_limits_and_retraction(tmp_path: Path) -> None:
    async def work() -> None:
        async with bench_pump(tmp_path) as pump:
            dose = await pump.pump_volume(None, 5, rate="8 mL/s", retract="0.1mL")
            assert dose.cruise_flow_ml_s == pytest.approx(8)
            assert dose.retraction_completed
            timed = await pump.run_for_duration(None, 5, rate="8 mL/s", reverse=True)
            assert timed.delivered_ml is not None
            assert timed.delivered_ml < -30
            with pytest.raises(pm.PlanError):
                await pump.pump_volume(150, 50, limits=pm.Limits(max_outlet_kpa=101.4))

    run(work())


def test_the_channels_of_an_array_dose_at_the_same_time_each_by_its_own_record(tmp_path: Path) -> None:
    backends = [BenchBackend(name, state_dir=tmp_path) for name in ("three-roller", "two-roller")]
    array = BenchPumpArray(BenchArrayBackend(backends))

    async def work() -> None:
        async with array:
            assert array.num_channels == 2
            first, second = await array.pump_volume([50, 60], [0, 1], [3, 5])
            assert (first.pump, second.pump) == ("three-roller", "two-roller")
            assert (first.completed, second.completed) == (True, True)
            [alone] = await array.run_for_duration(60, 1, 2)
            assert alone.pump == "two-roller"
            assert [dose.steps > 0 for dose in await array.run_revolutions(1, [1, 0])] == [True, True]
            for channels, message in ((2, "allowed: 0 to 1"), ([0, 0], "each channel once")):
                with pytest.raises(ValueError, match=message):
                    await array.pump_volume(50, channels, 1)
            with pytest.raises(ValueError, match="volume has 3 values for 2 channels"):
                await array.pump_volume(50, [0, 1], [1, 2, 3])
            # The one that is refused is named, and moves none.
            doses = len(array.pumps[0].backend.bench.log())
            refused = (
                array.pump_volume([170, 500], [0, 1], [LONG_ML, 1]),
                array.run_revolutions([1, 1], [0, 1], speed=[50, 500]),
                array.run_for_duration([50, 500], [0, 1], 2),
                array.run_continuously([50, 500], [0, 1]),
            )
            for call in refused:
                with pytest.raises(pm.PlanError, match=r"^channel 1: .*limit of 300"):
                    await call
            wrong: Any = "1mL"
            with pytest.raises(TypeError, match="channel 1: volume must be a number in mL, not str"):
                await array.pump_volume(50, [0, 1], [1, wrong])
            assert len(array.pumps[0].backend.bench.log()) == doses
            # One that stops ends the other.
            both = asyncio.create_task(array.pump_volume(170, [0, 1], [LONG_ML, LONG_ML]))
            await in_motion(array.pumps[0])
            await in_motion(array.pumps[1])
            await array.pumps[1].halt()
            with pytest.raises(HaltedError, match="channel 1: halted after"):
                await both
            with pytest.raises(pm.UnfinishedError, match="channel 1: a dose is unfinished"):
                await array.pump_volume(50, [1, 0], 1)
            with warnings.catch_warnings():
                # The carry may be forgotten.
                warnings.simplefilter("ignore")
                for pump in array.pumps:
                    await pump.discard()
            await array.run_continuously(30, [0, 1])
            await asyncio.sleep(0.2)
            assert all(run is not None and run.completed for run in await array.halt())

    run(work())
    again = BenchPumpArray.deserialize(json.loads(json.dumps(array.serialize())))
    assert again.serialize() == array.serialize()


def test_an_array_takes_a_rate_and_limits_in_every_call(tmp_path: Path) -> None:
    backends = [BenchBackend(name, state_dir=tmp_path) for name in ("three-roller", "two-roller")]
    array = BenchPumpArray(BenchArrayBackend(backends))

    async def work() -> None:
        async with array:
            rates = ["8 mL/s", "5 mL/s"]
            for made in (
                array.pump_volume(use_channels=[0, 1], volume=3, rate=rates),
                array.run_revolutions(1, [0, 1], rate=rates),
                array.run_for_duration(use_channels=[0, 1], duration=2, rate=rates),
            ):
                assert [dose.cruise_flow_ml_s for dose in await made] == pytest.approx([8, 5])
            [reverse] = await array.run_for_duration(use_channels=0, duration=2, rate="8 mL/s", reverse=True)
            assert reverse.steps < 0
            await array.run_continuously(use_channels=[0, 1], rate="8 mL/s")
            await in_motion(array.pumps[0])
            assert [dose is not None and dose.cruise_flow_ml_s for dose in await array.halt()] == (
                pytest.approx([8, 8])
            )
            tight = pm.Limits(max_outlet_kpa=101.4)
            for refused in (
                array.run_revolutions(5, 0, speed=150, limits=tight),
                array.run_for_duration(150, 0, 10, limits=tight),
                array.run_continuously(150, 0, limits=tight),
            ):
                with pytest.raises(pm.PlanError, match="channel 0: "):
                    await refused
            with pytest.raises(
                TypeError, match=r"use_channels is missing; give channels, as use_channels=\["
            ):
                await array.pump_volume(50, volume=1)
            with pytest.raises(TypeError, match="channel 0: volume is missing; give it in mL"):
                await array.pump_volume(50, 0)
            with pytest.raises(ValueError, match="channel 1: neither speed nor rate is given"):
                await array.run_continuously(None, 1)

    run(work())


def test_a_channel_that_runs_on_is_told_to_halt_and_its_run_is_no_dose(tmp_path: Path) -> None:
    array = BenchPumpArray(BenchArrayBackend([BenchBackend("three-roller", state_dir=tmp_path)]))

    async def work() -> None:
        async with array:
            await array.run_continuously(60, 0)
            await in_motion(array.pumps[0])
            for call in (array.pump_volume(50, 0, 1), array.run_revolutions(1, 0)):
                with pytest.raises(
                    pm.PumpError, match=r"channel 0: .*runs until halt\(\).*await halt\(\) first"
                ):
                    await call
            [made] = await array.halt()
            assert made is not None
            assert repr(made).startswith("<Run on 'three-roller' (sim): delivered_ml ")
            assert "Run on three-roller" in made._repr_html_()
            assert "99000" not in repr(made) + made._repr_html_()
            [dose] = await array.pump_volume(50, 0, 1)
            assert repr(dose).startswith("<Dose of 1.0 mL on 'three-roller'")

    run(work())
