import pickle
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import pumpmodel as pm
from pumpmodel.sweeps import RESULTS


def pumps() -> list[pm.Pump]:
    three = pm.Pump.three_roller()
    return [three.replace(rollers=count) for count in (2, 3, 4, 8)]


def test_each_row_is_a_pumps_own_steady_states() -> None:
    speeds = np.linspace(-170, 170, 120)
    result = pm.sweep(pumps(), speed_rpm=speeds)
    assert result.shape == (4, 120)
    assert result.pumps == tuple(pumps())
    for row, pump in enumerate(pumps()):
        alone = pump.steady_state(speed_rpm=speeds)
        for name in RESULTS:
            np.testing.assert_array_equal(getattr(result, name)[row], getattr(alone, name))
    assert result == pm.sweep(pumps(), speed_rpm=speeds)
    assert result != pm.sweep(pumps(), speed_rpm=speeds[1:])


def test_speeds_are_known_in_both_units() -> None:
    pump = pm.Pump.three_roller()
    by_rpm = pm.sweep(pump, speed_rpm=[50, 100])
    by_rad_s = pm.sweep(pump, speed_rad_s=by_rpm.speed_rad_s)
    np.testing.assert_array_equal(by_rad_s.inlet_min_kpa, by_rpm.inlet_min_kpa)
    np.testing.assert_allclose(by_rad_s.speed_rpm, [50, 100], rtol=1e-15)


def test_one_speed_is_one_column_and_none_are_none() -> None:
    assert pm.sweep(pumps(), speed_rpm=100).ripple_rms.shape == (4, 1)
    assert pm.sweep([], speed_rpm=[50, 100]).ripple_rms.shape == (0, 2)
    assert pm.sweep(pumps(), speed_rad_s=[]).ripple_rms.shape == (4, 0)
    assert repr(pm.sweep(pumps(), speed_rpm=[])) == "<Sweep of 4 pumps at 0 speeds>"
    assert "speed_rpm 50 to 100" in repr(pm.sweep(pumps(), speed_rpm=[50, 100]))


def test_results_are_read_only_also_when_unpickled() -> None:
    result = pm.sweep(pumps(), speed_rpm=[50, 100])
    again = pickle.loads(pickle.dumps(result))
    assert again == result
    for one in (result, again):
        with pytest.raises(ValueError, match="read-only"):
            one.outlet_max_kpa[0, 0] = 0
    with pytest.raises(TypeError, match="unhashable"):
        hash(result)


@pytest.mark.parametrize("executor", [None, "threads"])
def test_the_first_pump_that_is_refused_is_named(executor: str | None) -> None:
    line = pm.Line(
        resistance_kpa_s_ml=0, compliance_ml_kpa=0.04, inertance_kpa_s2_ml=0.0064, reservoir_kpa=88.0
    )
    undamped = pm.Pump.three_roller().replace(outlet=line)
    # Natural frequency 62.5 rad/s; three pulses a revolution. Whole rows go to one task of the executor.
    rows = [*pumps(), undamped, undamped]
    speeds = np.append(np.linspace(1, 10, 1000), 62.5 / 3)
    pool = ThreadPoolExecutor(2) if executor else None
    for _ in range(3):
        with pytest.raises(ValueError, match=r"^pumps\[4\]: .*resonance of the outlet line"):
            pm.sweep(rows, speed_rad_s=speeds, executor=pool)


def test_bad_arguments_are_refused_by_name() -> None:
    pump = pm.Pump.three_roller()
    with pytest.raises(ValueError, match="exactly one of speed_rpm and speed_rad_s"):
        pm.sweep(pump)
    with pytest.raises(ValueError, match="exactly one of speed_rpm and speed_rad_s"):
        pm.sweep(pump, speed_rpm=1, speed_rad_s=1)
    with pytest.raises(ValueError, match=r"speed_rpm has shape \(1, 2\)"):
        pm.sweep(pump, speed_rpm=[[1, 2]])
    with pytest.raises(ValueError, match="speed_rpm is inf"):
        pm.sweep(pump, speed_rpm=[1, np.inf])
    with pytest.raises(ValueError, match="speed_rpm is 0"):
        pm.sweep(pump, speed_rpm=[1, 0])
    with pytest.raises(TypeError, match=r"pumps\[1\] must be a Pump, not the text"):
        pm.sweep([pump, "two-roller"], speed_rpm=1)  # type: ignore[list-item]
    with pytest.raises(TypeError, match="speed_rpm must be a number"):
        pm.sweep(pump, speed_rpm=["100"])


def test_progress_rises_to_the_end() -> None:
    seen: list[tuple[int, int]] = []
    pm.sweep(pumps(), speed_rpm=np.linspace(1, 170, 50_000), progress=lambda *now: seen.append(now))
    done = [points for points, _ in seen]
    assert done == sorted(done)
    assert seen[-1] == (200_000, 200_000)
    assert len(seen) > 1


def test_progress_on_request_is_a_line_on_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    pm.sweep(pumps(), speed_rpm=[50, 100])
    assert capsys.readouterr().err == ""
    pm.sweep(pumps(), speed_rpm=[50, 100], progress=True)
    assert capsys.readouterr().err == "\r100% of 8 steady states\n"


def test_what_progress_raises_ends_the_sweep() -> None:
    class EnoughError(Exception):
        pass

    def stop(done: int, total: int) -> None:
        raise EnoughError

    with pytest.raises(EnoughError):
        pm.sweep(pumps(), speed_rpm=np.linspace(1, 170, 10_000), progress=stop)


@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_an_executor_gives_the_same_bits(kind: str) -> None:
    speeds = np.linspace(5, 170, 4500)
    seen: list[int] = []
    pool: Executor
    if kind == "threads":
        pool = ThreadPoolExecutor(2)
    else:
        pool = ProcessPoolExecutor(2, mp_context=get_context("spawn"))
    with pool:
        spread = pm.sweep(pumps(), speed_rpm=speeds, executor=pool, progress=lambda now, _: seen.append(now))
        rows = pm.sweep(pumps(), speed_rpm=[10, 20], executor=pool)
    assert spread == pm.sweep(pumps(), speed_rpm=speeds)
    assert rows == pm.sweep(pumps(), speed_rpm=[10, 20])
    assert len(seen) == 12
    assert seen[-1] == 18_000


def test_tables_carry_their_units() -> None:
    result = pm.sweep(pumps(), speed_rpm=[50, 100, 150])
    frame = result.to_dataframe()
    assert len(frame) == 12
    assert list(frame["rollers"].unique()) == [2, 3, 4, 8]
    one = frame[(frame["rollers"] == 3) & (frame["speed_rpm"] == 100)]
    assert one["outlet_max_kpa"].item() == result.outlet_max_kpa[1, 1]
    assert frame.attrs["units"]["mean_flow_ml_s"] == "mL/s"
    data = result.to_xarray()
    assert dict(data.sizes) == {"pump": 4, "speed_rpm": 3}
    assert data["outlet_max_kpa"].sel(pump=1, speed_rpm=100).item() == result.outlet_max_kpa[1, 1]
    assert data["outlet_max_kpa"].attrs["units"] == "kPa"
    assert data["speed_rpm"].attrs["units"] == "r/min"


def test_what_is_not_installed_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    result = pm.sweep(pumps(), speed_rpm=[50])
    for package, extra, table in (
        ("pandas", "dataframe", result.to_dataframe),
        ("xarray", "xarray", result.to_xarray),
    ):
        monkeypatch.setitem(sys.modules, package, None)
        with pytest.raises(
            ImportError, match=rf'{package} is not installed; .*"./crates/pump-py\[{extra}\]"'
        ):
            table()


# A point without damping and next to standstill takes minutes, which no look at a flag could cut short.
ENDLESS = """
import signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)
import pumpmodel as pm
line = pm.Line(
    resistance_kpa_s_ml=1e-6, compliance_ml_kpa=0.0361, inertance_kpa_s2_ml=0.0042, reservoir_kpa=88.6
)
pump = pm.Pump.three_roller().replace(rollers=11, inlet=line, outlet=line)
def progress(done, total):
    if not begun:
        begun.append(done)
        print("begun", flush=True)
for _ in range(3):
    begun = []
    try:
        pm.sweep(pump, speed_rpm=[1e-3] * 100, progress=progress)
    except KeyboardInterrupt:
        print(time.monotonic(), flush=True)
"""


def test_ctrl_c_ends_a_sweep_within_a_fifth_of_a_second() -> None:
    delays_s = []
    with subprocess.Popen([sys.executable, "-c", ENDLESS], stdout=subprocess.PIPE, text=True) as child:
        guard = threading.Timer(60, child.kill)
        guard.start()
        try:
            assert child.stdout
            for _ in range(3):
                assert child.stdout.readline() == "begun\n"
                sent_s = time.monotonic()
                child.send_signal(signal.SIGINT)
                delays_s.append(float(child.stdout.readline()) - sent_s)
            assert child.wait() == 0
        finally:
            guard.cancel()
    # The least of three: a machine that is busy otherwise may hold one up.
    assert min(delays_s) < 0.2
    assert max(delays_s) < 5
