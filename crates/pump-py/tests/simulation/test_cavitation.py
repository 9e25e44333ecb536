"""Pressures below 0 kPa absolute warn, as the command does."""

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
