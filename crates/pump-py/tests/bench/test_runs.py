import threading
import time
from pathlib import Path

import numpy as np
import pytest

import pumpmodel as pm

ROWS = [(0, 0), (5, 2), (11, 2), (11, 1.9), (12, 0)]


def test_a_run_has_its_rate_and_its_time_and_leaves_the_carry(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        carry_ml = bench.dose("25mL").carry_ml
        run = bench.run(rate="600mL/min", duration="30s")
        assert run.purpose == "run"
        assert run.completed
        assert run.motion_s == pytest.approx(30, abs=0.3)
        assert run.delivered_ml is not None
        assert run.measured_motion_s is not None
        assert run.delivered_ml == pytest.approx(300, abs=8)
        assert run.run is not None
        assert (run.run.until, run.run.asked_s, run.run.was_stopped) == ("time", 30, False)
        assert run.run.mean_flow_ml_s == pytest.approx(run.delivered_ml / run.measured_motion_s)
        assert run.to_dict()["run"]["until"] == "time"
        assert bench.status().carry_ml == carry_ml
        back = bench.run(volume="50mL", reverse=True)
        assert back.delivered_ml == pytest.approx(-50, abs=0.01)
        assert bench.dose("1mL").run is None


@pytest.mark.parametrize("purpose", ["prime", "purge"])
def test_a_line_is_primed_and_purged_for_a_time(tmp_path: Path, purpose: str) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        motion = {"prime": bench.prime, "purge": bench.purge}[purpose]
        report = motion(duration="20s", rate="5mL/s")
        assert (report.purpose, report.completed) == (purpose, True)
        assert report.motion_s == pytest.approx(20, abs=0.2)
        assert report.run is not None
        assert (report.run.until, report.run.asked_s) == ("time", 20)
        assert report.run.mean_flow_ml_s == pytest.approx(5, abs=0.4)
        assert bench.status().carry_ml == 0
        back = motion(duration="2s", rate="5mL/s", reverse=True)
        assert back.delivered_ml is not None
        assert back.delivered_ml < -8
        with pytest.raises(ValueError, match="give one of them"):
            motion()
        with pytest.raises(ValueError, match="give one of them"):
            motion(volume="1mL", duration="1s")


def test_a_run_until_it_is_stopped_is_complete_once_it_is(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        timer = threading.Timer(1.5, bench.stop)
        timer.start()
        began = time.monotonic()
        run = bench.run(rate="600mL/min")
        took_s = time.monotonic() - began
        timer.join()
        assert took_s > 1.4
        assert run.completed
        assert run.run is not None
        assert (run.run.until, run.run.was_stopped) == ("stop", True)
        assert run.measured_motion_s is not None
        assert run.delivered_ml == pytest.approx(10 * run.measured_motion_s, abs=5)
        assert bench.status().unfinished is None


def test_ends_that_no_run_has_are_refused(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        with pytest.raises(ValueError, match="give one of them"):
            bench.run(duration="1s", volume="1mL")
        with pytest.raises(ValueError, match="both mean reverse"):
            bench.run(volume="-1mL", reverse=True)
        with pytest.raises(TypeError):
            bench.run(duration=5)  # type: ignore[arg-type]
        with pytest.raises(pm.PlanError, match="cannot be done within"):
            bench.run(duration="1ms")
        assert not bench.status().recorded


def test_a_profile_is_followed_from_an_array_and_from_a_file(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        planned = bench.run(profile=np.array(ROWS), dry_run=True)
        assert planned.delivered_ml is None
        run = bench.run(profile=ROWS)
        assert run.delivered_ml == pytest.approx(17.95, abs=0.003)
        assert run.run is not None
        assert (run.run.until, run.run.was_stopped) == ("profile", False)
        assert run.run.profile is not None
        assert run.run.profile.volume_ml == pytest.approx(17.95)
        assert run.run.profile.largest_departure_ml is not None
        assert run.run.profile.largest_departure_ml < 0.003
        assert pm.Dose.from_dict(run.to_dict()) == run
        file = tmp_path / "flow.csv"
        file.write_text("time_s,flow_ml_s\n" + "".join(f"{t},{q}\n" for t, q in ROWS))
        back = bench.run(profile=file, reverse=True)
        assert back.delivered_ml == pytest.approx(-17.95, abs=0.003)
        assert back.run is not None
        assert back.run.profile is not None
        assert back.run.profile.name == "flow.csv"


def test_a_profile_that_cannot_be_met_is_refused_with_its_instant(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        with pytest.raises(pm.PlanError, match="in row 1, the flow steps from 0 to 10 mL/s"):
            bench.run(profile=[(0, 10), (10, 10)])
        with pytest.raises(pm.PlanError, match="row 2 has the flow NaN mL/s"):
            bench.run(profile=[(0, 0), (10, float("nan"))])
        with pytest.raises(ValueError, match="shape"):
            bench.run(profile=[0, 1, 2])
        with pytest.raises(ValueError, match="duration, volume and profile"):
            bench.run(profile=ROWS, volume="1L")
        with pytest.raises(pm.PlanError, match="neither a rate nor ramps"):
            bench.run(profile=ROWS, rate="1mL/s")
        assert bench.status().wear.volume_ml == 0


def test_a_run_until_stopped_that_its_tube_ends_raises_and_is_on_record(tmp_path: Path) -> None:
    worn = tmp_path / "worn.toml"
    worn.write_text(pm.Pump.three_roller().to_toml().replace("[tube]\n", "[tube]\nlife_ml = 4.0\n"))
    with pm.Bench.open(worn, state_dir=tmp_path) as bench:
        worn_out = r"ended by itself after .* the tube is nearly used up"
        with pytest.raises(pm.PumpError, match=worn_out) as caught:
            bench.run(rate="8mL/s")
        assert "were delivered" in caught.value.__notes__[0]
        assert bench.log()[-1].delivered_ml == pytest.approx(3.96, abs=0.01)
        assert bench.status().unfinished is None
