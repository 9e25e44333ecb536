import pickle

import numpy as np
import pytest
from numpy.typing import NDArray

import pumpmodel as pm


def off_by_a_byte(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the numbers as a cluster hands them over: in a part of a buffer that begins anywhere."""
    shifted = np.zeros(values.nbytes + 1, np.uint8)[1:].view(np.float64)
    shifted[:] = values
    assert not shifted.flags.aligned
    return shifted


def test_numbers_at_any_address_are_numbers() -> None:
    pump, speeds = pm.Pump.three_roller(), np.linspace(10, 100, 7)
    shifted = off_by_a_byte(speeds)
    np.testing.assert_array_equal(
        pump.steady_state(speed_rpm=shifted).outlet_max_kpa,
        pump.steady_state(speed_rpm=speeds).outlet_max_kpa,
    )
    assert pm.sweep(pump, speed_rpm=shifted) == pm.sweep(pump, speed_rpm=speeds)
    given, run = (pump.simulate(speed_rpm=100, time_s=time_s) for time_s in (shifted, speeds))
    np.testing.assert_array_equal(given.outlet_kpa, run.outlet_kpa)
    assert pm.Run.from_dict(run.to_dict() | {"outlet_kpa": off_by_a_byte(run.outlet_kpa)}) == run


@pytest.mark.parametrize("shift", [0, 1])
def test_a_result_comes_back_from_buffers_at_any_address(shift: int) -> None:
    pump = pm.Pump.three_roller()
    for result in (
        pump.simulate(speed_rpm=100, duration_s=1, dt_s=0.01, sensitivity=True),
        pm.sweep(pump, speed_rpm=[50, 100]),
    ):
        buffers: list[pickle.PickleBuffer] = []
        stream = pickle.dumps(result, protocol=5, buffer_callback=buffers.append)
        moved = [memoryview(b"\0" * shift + bytes(buffer.raw()))[shift:] for buffer in buffers]
        assert pickle.loads(stream, buffers=moved) == result
