"""Ctrl-C during calls over long arrays."""

import os
import signal
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import pumpmodel as pm

PUMP = pm.Pump.three_roller()
HOSE = pm.Hose(bore_radius_mm=4, outer_radius_mm=6, length_mm=500, modulus_mpa=3.5)
WATER = pm.Fluid.water(temperature_degc=20)


def repeat(call: Callable[[NDArray[np.float64]], object], angles: NDArray[np.float64]) -> None:
    """Call again and again: a quick machine ends the first call before the signal."""
    for _ in range(100):
        call(angles)


@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize(
    "call",
    [
        lambda angles: PUMP.outlet_volume_ml(angles),
        lambda angles: PUMP.angle_for_volume(angles),
        lambda angles: PUMP.angle_for_volume(angles, angles),
        lambda angles: HOSE.pressure_drop_kpa(WATER, flow_ml_s=angles),
        lambda angles: PUMP.average_flow_ml_s(speed_rpm=angles),
        lambda angles: pm.sweep([PUMP], speed_rpm=angles[:2_000_000]),
    ],
    ids=["outlet_volume_ml", "angle_for_volume", "both", "pressure_drop_kpa", "average_flow_ml_s", "sweep"],
)
def test_a_call_over_a_long_array_answers_ctrl_c(call: Callable[[NDArray[np.float64]], object]) -> None:
    angles = np.linspace(1.0, 2.0, 40_000_000)
    sent_s: list[float] = []

    def interrupt() -> None:
        sent_s.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.1, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        repeat(call, angles)
    late_s = time.monotonic() - sent_s[0]
    timer.join()
    # 0.2 s on cores of its own; other tests share them.
    assert late_s < 0.6
