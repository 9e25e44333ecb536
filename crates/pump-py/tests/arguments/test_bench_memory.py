"""First calls that start threads, in processes that are short of memory by every 100 kB: none is aborted."""

import subprocess
import sys

import pytest

# The parent has loaded the module and made nothing. A child for each limit opens its own bench.
PARENT = """
import os, resource, sys, tempfile
import pumpmodel as pm

call, begins = sys.argv[1:]
folder = tempfile.mkdtemp()
pump = pm.Pump.three_roller()

def limit(kilobytes):
    with open("/proc/self/statm") as file:
        size = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE") + kilobytes * 1000
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (size, size))

def work(kilobytes):
    if begins == "before":
        limit(kilobytes)
    if call != "sweep_in_parts":
        bench = pm.Bench.open("three-roller", state_dir=os.path.join(folder, f"{kilobytes}"))
    if begins == "after":
        limit(kilobytes)
    if call == "dose":
        bench.dose("1mL")
    elif call == "calibration_run":
        bench.calibration_run(speed_rpm=60, pitches=3)
    elif call == "run":
        bench.run(rate="10 mL/s", volume="50mL")
    else:
        for _ in pm.sweep_in_parts([pump] * 40, speed_rpm=range(1, 51), points=500):
            pass

told = {0: 0, 3: 0}
for kilobytes in range(0, 16100, 100):
    child = os.fork()
    if child == 0:
        code = 0
        try:
            work(kilobytes)
        except MemoryError:
            code = 3
        except (OSError, pm.PumpError) as error:
            code = 3 if "thread" in str(error) or "allocate memory" in str(error) else 4
            os.write(2, repr(error).encode()[:500])
        except BaseException as error:
            os.write(2, repr(error).encode()[:500])
            code = 5
        os._exit(code)
    _, status = os.waitpid(child, 0)
    code = os.waitstatus_to_exitcode(status)
    if code not in told:
        sys.exit(f"with {kilobytes} kB {call} ended with {code}")
    told[code] += 1
print(told[0], told[3])
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are those of Linux")
@pytest.mark.parametrize("begins", ["after", "before"])
@pytest.mark.parametrize("call", ["dose", "calibration_run", "run", "sweep_in_parts"])
def test_a_call_that_starts_threads_answers_or_raises_a_memory_error(call: str, begins: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", PARENT, call, begins], capture_output=True, text=True, timeout=300, check=False
    )
    assert ended.returncode == 0, ended.stderr
    answered, refused = map(int, ended.stdout.split())
    assert answered >= 1
    assert refused >= 1
