"""Pressures below 0 kPa absolute warn, as the command does."""

import re
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import pumpmodel as pm

WORDS = r"no liquid can be at -{} kPa absolute \({}\): it would cavitate"


def narrow() -> pm.Pump:
    pump = pm.Pump.three_roller()
    return pump.replace(inlet=pump.inlet.replace(resistance_kpa_s_ml=5))


def test_a_run_below_zero_warns_once() -> None:
    with pytest.warns(UserWarning, match="no liquid") as told:
        run = narrow().simulate(speed_rpm=170, duration_s=2)
    assert len(told) == 1
    lowest = f"{-run.inlet_kpa.min():.1f}"
    assert str(told[0].message) == (f"no liquid can be at -{lowest} kPa absolute (inlet): it would cavitate")
    assert told[0].filename == __file__


def test_a_steady_state_below_zero_warns_once() -> None:
    with pytest.warns(UserWarning, match=WORDS.format(r"\d+\.\d", "inlet")) as told:
        narrow().steady_state(speed_rpm=170)
    assert len(told) == 1
    place = "inlet at 170 r/min, the lowest of 2 of 3 speeds below 0"
    with pytest.warns(UserWarning, match=WORDS.format(r"\d+\.\d", place)) as told:
        narrow().steady_state(speed_rpm=[1, 100, 170])
    assert len(told) == 1


def test_a_sweep_below_zero_warns_once() -> None:
    pumps = [pm.Pump.three_roller(), narrow()]
    place = r"inlet of pumps\[1\] at 170 r/min, the lowest of 2 of 6 points below 0"
    for executor in (None, ThreadPoolExecutor(1)):
        with pytest.warns(UserWarning, match=WORDS.format(r"\d+\.\d", place)) as told:
            result = pm.sweep(pumps, speed_rpm=[1, 100, 170], executor=executor)
        assert len(told) == 1
        assert told[0].filename == __file__
        assert np.count_nonzero(result.inlet_min_kpa < 0) == 2


def test_what_falls_below_zero_between_two_samples_is_warned_of() -> None:
    with pytest.warns(UserWarning, match="no liquid"):
        lowest = narrow().simulate(speed_rpm=170, duration_s=1, dt_s=1e-5)
    words = WORDS.format(f"{-lowest.inlet_kpa.min():.1f}", "inlet")
    calls: list[Callable[[], object]] = [
        lambda: narrow().simulate(speed_rpm=170, time_s=[0, 1e-6, 1]),
        lambda: narrow().simulate(speed_rpm=[170, 170], time_s=[0, 1], output_time_s=[0]),
        lambda: narrow().simulate(speed_rpm=[170] * 500, time_s=np.linspace(0, 1, 500), output_time_s=[1]),
        lambda: narrow().simulate(speed_rpm=[170] * 5000, time_s=np.linspace(0, 1, 5000)),
        lambda: pm.Pump.three_roller().simulate(speed_rpm=[170] * 5000, time_s=np.linspace(0, 1, 5000)),
        lambda: narrow().simulate(speed_rpm=170, duration_s=1, dt_s=1, method="rodas5p"),
        lambda: narrow().simulate(speed_rpm=170, duration_s=1, dt_s=1, method="radau"),
    ]
    for call, warns in zip(calls, (True, False, True, True, False, True, True), strict=True):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            call()
        assert len(told) == warns
        assert all(re.search(words, str(warning.message)) for warning in told)


def test_long_motions_are_searched_quickly() -> None:
    pump = pm.Pump.three_roller()
    # A speed up and down over an hour, then a constant speed for a day.
    pump.simulate(speed_rpm=[0, 100, 0, 60, 60], time_s=[0, 1800, 3600, 3601, 90_000], output_time_s=[90_000])


def test_a_trace_of_a_plan_below_zero_warns_once() -> None:
    data = narrow().to_dict()
    # A head of which neither tube nor fluid sets a lowest pressure.
    data["tube"] = {"bore_radius_mm": 5.0, "outer_radius_mm": 7.0}
    data["fluid"] = {"name": "broth", "temperature_degc": 25.0, "density_kg_m3": 997.0}
    plan = pm.Doser(pm.Pump.from_dict(data)).plan("25mL", speed="170rpm")
    assert any("inlet pressure would fall to -" in warning for warning in plan.warnings)
    with pytest.warns(UserWarning, match=WORDS.format(r"\d+\.\d", "inlet")) as told:
        plan.trace(dt_s=0.5)
    assert len(told) == 1
    assert told[0].filename == __file__
    assert plan.inlet_min_kpa is not None
    assert f"{plan.inlet_min_kpa:.1f}" in str(told[0].message)
