import sys
from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest

import pumpmodel as pm

MASKED = np.ma.masked_array([1.0, 1e9, 3.0], mask=[False, True, False])


def test_an_array_with_masked_numbers_is_refused_wherever_arrays_are_taken() -> None:
    pump = pm.Pump.three_roller()
    calls: dict[str, Callable[[], object]] = {
        "angle_rad": lambda: pump.outlet_volume_ml(MASKED),
        "speed_rpm": lambda: pump.steady_state(speed_rpm=MASKED),
        "flow_ml_s": lambda: pump.speed_for_flow_rpm(flow_ml_s=MASKED),
        "model": lambda: pm.rmse(MASKED, [1.0, 2.0, 3.0]),
        "measured": lambda: pm.rmse([1.0, 2.0, 3.0], MASKED),
        "pressure_kpa": lambda: pm.identify_line(pump, time_s=[0, 1, 2], pressure_kpa=MASKED, speed_rpm=60),
        "volume_ml": lambda: pm.VolumeFit([0, 10, 20], MASKED),
    }
    for name, call in calls.items():
        with pytest.raises(ValueError, match=f"{name} has 1 masked numbers; allowed: none; leave them out"):
            call()
    with pytest.raises(ValueError, match="speed_rpm has 1 masked"):
        pm.sweep([pump], speed_rpm=MASKED)


def test_masks_inside_a_list_are_seen_too() -> None:
    with pytest.raises(ValueError, match="angle_rad has 1 masked"):
        pm.Pump.three_roller().outlet_volume_ml([np.ones(3), MASKED])


def test_an_array_whose_mask_hides_nothing_is_an_array() -> None:
    pump = pm.Pump.three_roller()
    unmasked = np.ma.masked_array([1.0, 2.0], mask=False)
    np.testing.assert_array_equal(pump.outlet_volume_ml(unmasked), pump.outlet_volume_ml([1.0, 2.0]))


def test_a_numpy_ma_that_another_thread_still_loads_is_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numpy.ma", ModuleType("numpy.ma"))
    pump = pm.Pump.three_roller()
    assert pump.outlet_volume_ml([1.0]).shape == (1,)
