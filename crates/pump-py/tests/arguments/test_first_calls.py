"""First calls of a process that has used up its memory: they answer or raise, and the process lives."""

import subprocess
import sys

import pytest

# A child for each call has a megabyte more than it takes, and then fills that with blocks of 16 kB.
PARENT = """
import os, resource, sys, tempfile
import numpy as np
import pumpmodel as pm

pump = pm.Pump.three_roller()
folder = tempfile.mkdtemp()
times = np.arange(1000) * 1e-3
run_kpa = 90 + np.sin(30 * times)
hose = pm.Hose(bore_radius_mm=4, outer_radius_mm=6, length_mm=500, modulus_mpa=3.5)
water = pm.Fluid.water(temperature_degc=20)
bench = None
CALLS = {
    "Doser.plan": lambda: pm.Doser(pump).plan("50L"),
    "plan.smooth": lambda: pm.Doser(pump).plan("25mL", smooth=True, retract="0.1mL"),
    "simulate": lambda: pump.simulate(speed_rpm=100, duration_s=1),
    "simulate.roller": lambda: pump.simulate(speed_rpm=100, duration_s=0.1, model="roller-centric"),
    "steady_state": lambda: pump.steady_state(speed_rpm=[10, 20]),
    "sweep": lambda: pm.sweep([pump], speed_rpm=[10, 20]),
    "rmse": lambda: pm.rmse([1, 2], [1, 3]),
    "angle_for_volume": lambda: pump.angle_for_volume([1.0, 2.0]),
    "harmonics": lambda: pump.harmonics(5, speed_rpm=60),
    "pressure_drop_kpa": lambda: hose.pressure_drop_kpa(water, flow_ml_s=[1, 2]),
    "water": lambda: pm.Fluid.water(temperature_degc=25),
    "VolumeFit": lambda: pm.VolumeFit([0, 10, 20, 30, 40, 50], [0, 0.23, 0.83, 1.49, 1.96, 2.1]),
    "identify_line": lambda: pm.identify_line(pump, time_s=times, pressure_kpa=run_kpa, speed_rpm=60),
    "identify_resistance": lambda: pm.identify_resistance([1, 2, 4], drop_kpa=[0.1, 0.2, 0.41]),
    "LineLikelihood": lambda: pm.LineLikelihood(
        pump, time_s=times, pressure_kpa=run_kpa, standard_kpa=1, speed_rpm=60
    ).log_likelihood(),
    "heads": pm.heads,
    "Pump.named": lambda: pm.Pump.named("two-roller"),
    "replace": lambda: pump.replace(rollers=4),
    "to_dict": lambda: pm.Pump.from_dict(pump.to_dict()),
    "check": pump.check,
    "Calibration": lambda: pm.Calibration.from_runs(
        pump, [pm.WeighedRun(speed_rpm=60, turned_deg=720, mass_g=42.4)], scale="0.01g"
    ),
    "Bench.open": lambda: pm.Bench.open("three-roller", state_dir=folder),
    "Bench.status": lambda: bench.status(),
    "Bench.dose": lambda: bench.dose("1mL"),
    "Bench.log": lambda: bench.log(),
    "Bench.stop": lambda: bench.stop(),
}

def size():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")

call = CALLS[sys.argv[1]]
if sys.argv[1].startswith("Bench.") and sys.argv[1] != "Bench.open":
    bench = pm.Bench.open("three-roller", state_dir=folder)
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
most = size() + (1 << 20)
resource.setrlimit(resource.RLIMIT_AS, (most, most))
blocks = []
try:
    while True:
        blocks.append(bytearray(16384))
except MemoryError:
    pass
try:
    call()
    told = "answered"
except MemoryError:
    told = "MemoryError"
except (OSError, pm.PumpError) as error:
    # The system does not say that a thread has no memory for its stack.
    told = "MemoryError" if "thread" in str(error) else repr(error)
except ValueError as error:
    # The wave of the test is no pump's.
    told = "answered" if "the fit explains" in str(error) else repr(error)
except BaseException as error:
    told = repr(error)
del blocks
os.write(1, told.encode())
os._exit(0)
"""

CALLS = (
    "Doser.plan",
    "plan.smooth",
    "simulate",
    "simulate.roller",
    "steady_state",
    "sweep",
    "rmse",
    "angle_for_volume",
    "harmonics",
    "pressure_drop_kpa",
    "water",
    "VolumeFit",
    "identify_line",
    "identify_resistance",
    "LineLikelihood",
    "heads",
    "Pump.named",
    "replace",
    "to_dict",
    "check",
    "Calibration",
    "Bench.open",
    "Bench.status",
    "Bench.dose",
    "Bench.log",
    "Bench.stop",
)


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")
@pytest.mark.parametrize("call", CALLS)
def test_the_first_call_without_memory_answers_or_raises_a_memory_error(call: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", PARENT, call], capture_output=True, text=True, timeout=120, check=False
    )
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout in ("answered", "MemoryError")
