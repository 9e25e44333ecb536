"""Calls with less memory than their arrays need, each in a process of its own with a limit of its memory."""

import subprocess
import sys

import pytest

# Limits rise by half an array until the call has enough, so that each allocation of the call is the first
# that fails once. Arrays of 40 MB come from the operating system and go back to it.
CHILD = """
import os, resource, signal, sys
import numpy as np
import pumpmodel as pm

N = 5_000_000
pump = pm.Pump.three_roller()
line = pump.outlet
hose = pm.Hose(bore_radius_mm=4, outer_radius_mm=6, length_mm=500, modulus_mpa=3.5)
water = pm.Fluid.water(temperature_degc=20)
numbers = np.full(N, 1.0)
run = pump.simulate(speed_rpm=100, duration_s=1)
NAMES = tuple(run.to_dict())

def make(n):
    x = numbers[:n]
    rising = np.arange(n) * 1e-3
    return {
        "outlet_volume_ml": lambda: pump.outlet_volume_ml(x),
        "inlet_flow_ml_rad": lambda: pump.inlet_flow_ml_rad(x),
        "average_flow_ml_s": lambda: pump.average_flow_ml_s(speed_rpm=x),
        "speed_for_flow_rpm": lambda: pump.speed_for_flow_rpm(flow_ml_s=x),
        "angle_for_volume": lambda: pump.angle_for_volume(x, x),
        "pressure_drop_kpa": lambda: hose.pressure_drop_kpa(water, flow_ml_s=x),
        "reynolds": lambda: hose.reynolds(water, flow_ml_s=x),
        "rmse": lambda: pm.rmse(x, x),
        "nrmse": lambda: pm.nrmse(x, x),
        "from_dict": lambda: pm.Run.from_dict({**dict.fromkeys(NAMES, x), "time_s": rising}),
        "simulate": lambda: pump.simulate(speed_rpm=100, duration_s=n * 1e-3, dt_s=1e-3),
        "identify_resistance": lambda: pm.identify_resistance(rising + 1, drop_kpa=rising + 1.1),
        "identify_compliance": lambda: pm.identify_compliance(rising + 1, rising + 1.1),
        "LineLikelihood": lambda: pm.LineLikelihood(
            pump, time_s=rising, pressure_kpa=x, standard_kpa=1, speed_rpm=1
        ),
        "sweep": lambda: pm.sweep([pump], speed_rpm=x),
        "steady_state": lambda: pump.steady_state(speed_rpm=x),
    }

call = sys.argv[1]
make(100)[call]()  # Whatever is loaded once is loaded before the limit.
ready = make(N)[call]
with open("/proc/self/statm") as file:
    used = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
raised = 0
for halves in range(30):
    child = os.fork()
    if child == 0:
        size = used + halves * N * 4
        resource.setrlimit(resource.RLIMIT_AS, (size, size))
        code = 0
        try:
            # An answer that would take minutes to compute is not awaited: its memory is there.
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.setitimer(signal.ITIMER_REAL, 4.0)
            ready()
        except MemoryError:
            code = 3
        except OSError as error:
            # A thread needs memory for its stack, and the system does not say that this is missing.
            code = 3 if call == "sweep" and "no thread could be started" in str(error) else 4
        except BaseException as error:
            os.write(2, repr(error).encode()[:500])
            code = 5
        os._exit(code)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGALRM:
        break
    code = os.waitstatus_to_exitcode(status)
    if code == 0:
        break
    if code == 3:
        raised += 1
    else:
        sys.exit(f"with {halves} halves of an array {call} ended with {code}")
print(raised)
"""

CALLS = (
    "outlet_volume_ml",
    "inlet_flow_ml_rad",
    "average_flow_ml_s",
    "speed_for_flow_rpm",
    "angle_for_volume",
    "pressure_drop_kpa",
    "reynolds",
    "rmse",
    "nrmse",
    "from_dict",
    "simulate",
    "identify_resistance",
    "identify_compliance",
    "LineLikelihood",
    "sweep",
    "steady_state",
)


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")
@pytest.mark.parametrize("call", CALLS)
def test_too_little_memory_is_a_memory_error_and_the_process_lives(call: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", CHILD, call], capture_output=True, text=True, timeout=300, check=False
    )
    assert ended.returncode == 0, ended.stderr
    assert int(ended.stdout) >= 1
