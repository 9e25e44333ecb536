import json
import os
import signal
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import pumpmodel as pm


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[pm.Bench]:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        yield bench


def another(bench: pm.Bench) -> pm.Bench:
    return pm.Bench.open("three-roller", state_dir=Path(bench.folder).parents[1])


def stop_at_once(made: int, planned: int) -> None:
    signal.raise_signal(signal.SIGINT)


def test_a_dose_is_on_record_for_the_next_one(bench: pm.Bench) -> None:
    first = bench.dose("25mL", rate="10 mL/s")
    assert first.completed
    assert first.delivered_ml == pytest.approx(25, abs=2e-3)
    assert (first.phase.known, first.phase.source, first.start_angle_deg) == (True, "home", 0)
    status = bench.status()
    assert status.angle_deg == pytest.approx(first.end_angle_deg % 360)
    assert status.carry_ml == first.carry_ml
    second = bench.dose("5mL")
    assert (second.phase.source, second.start_angle_deg) == ("recorded", status.angle_deg)
    assert second.carry_in_ml == first.carry_ml


def test_opening_and_planning_creates_nothing(tmp_path: Path) -> None:
    bench = pm.Bench.open("three-roller", state_dir=tmp_path / "state")
    assert bench.dose("25mL", dry_run=True).delivered_ml is None
    assert bench.plan("25mL").steps == 15_480
    assert bench.status().recorded is False
    assert not (tmp_path / "state").exists()


def test_a_plan_of_a_bench_is_the_dose_that_it_will_make(bench: pm.Bench) -> None:
    bench.dose("3mL")
    plan = bench.plan("7mL", within="10s")
    dose = bench.dose("7mL", within="10s")
    assert (plan.steps, plan.planned_ml, plan.motion_s) == (dose.steps, dose.planned_ml, dose.motion_s)
    assert plan.carry_in_ml == dose.carry_in_ml


def test_an_angle_is_as_well_known_as_it_is_stated(bench: pm.Bench) -> None:
    def angle_share_ml(dose: pm.Dose) -> float:
        return next(share.standard_ml for share in dose.uncertainty_budget if share.source == "angle")

    exact = bench.dose("1mL", start_angle_rad=0.5, dry_run=True)
    assert exact.phase.half_width_deg == 0
    assert angle_share_ml(exact) == 0
    stated = bench.dose("1mL", start_angle_rad=0.5, start_half_width_rad=0.02, dry_run=True)
    assert (stated.steps, stated.planned_ml, stated.warnings) == (exact.steps, exact.planned_ml, ())
    assert stated.volume_least_ml < stated.planned_ml < stated.volume_most_ml
    assert stated.expanded_uncertainty_ml > exact.expanded_uncertainty_ml
    assert angle_share_ml(stated) > 0
    plan = bench.plan("1mL", start_angle_rad=0.5, start_half_width_rad=0.02)
    assert (plan.steps, plan.start_half_width_rad) == (stated.steps, 0.02)
    # The width is on record until the rotor is homed anew.
    bench.dose("1mL", start_angle_rad=0.5, start_half_width_rad=0.02)
    assert bench.status().half_width_deg == pytest.approx(1.1459, abs=1e-4)
    assert angle_share_ml(bench.dose("2.5mL")) > 0
    with pytest.raises(ValueError, match="start_half_width_rad is -1"):
        bench.dose("1mL", start_angle_rad=0.5, start_half_width_rad=-1.0)
    with pytest.raises(ValueError, match="without a start_angle_rad"):
        bench.dose("1mL", start_half_width_rad=0.1)


def test_a_dose_from_an_unknown_angle_tells_its_range(bench: pm.Bench) -> None:
    bench.home_set(None)
    dose = bench.dose("25mL")
    assert "between 23.9477 and 26.0531 mL, planned_ml 25.0004" in repr(dose)


def test_all_that_the_command_reports_are_attributes_and_return_from_a_dict(bench: pm.Bench) -> None:
    dose = bench.dose("25mL", retract="0.1mL", finish="low-flow")
    data = dose.to_dict()
    assert json.loads(json.dumps(data)) == data
    assert pm.Dose.from_dict(data) == dose
    assert hash(pm.Dose.from_dict(data)) == hash(dose)
    assert set(data) == set(pm.Doser(bench.pump).plan("25mL").to_dict())
    assert sum(share.variance_percent for share in dose.uncertainty_budget) == pytest.approx(100)
    assert {"drop", "backflow", "speed"} <= {share.source for share in dose.uncertainty_budget}
    status = bench.status()
    assert pm.Status.from_dict(status.to_dict()) == status
    assert repr(dose).startswith("<Dose of 25.0 mL on 'three-roller' (sim): delivered_ml 2")


def test_the_pump_is_taken_until_the_bench_is_closed(bench: pm.Bench) -> None:
    bench.dose("1mL")
    with another(bench) as other:
        assert other.status() == bench.status()
        with pytest.raises(pm.DriveError, match=f"in use by process {os.getpid()}"):
            other.prime("1mL")
        bench.close()
        assert other.prime("1mL").purpose == "prime"


def test_a_closed_bench_refuses_what_would_take_the_pump(bench: pm.Bench) -> None:
    assert not bench.closed
    bench.close()
    bench.close()
    assert bench.closed
    assert repr(bench).endswith(", closed>")
    with pytest.raises(pm.PumpError, match="closed"):
        bench.dose("1mL")


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_stops_the_motor_and_leaves_the_rest_to_be_resumed(bench: pm.Bench) -> None:
    with pytest.raises(KeyboardInterrupt) as raised:
        bench.dose("300mL", rate="30mL/s", progress=stop_at_once)
    assert "bench.resume() makes the rest" in raised.value.__notes__[0]
    part = bench.status().unfinished
    assert part is not None
    assert 0 < part.delivered_most_ml < 300
    assert part.delivered_least_ml == part.delivered_most_ml
    with pytest.raises(pm.UnfinishedError, match=r"bench\.resume\(\)") as refused:
        bench.dose("1mL")
    assert refused.value.requested_ml == 300
    assert refused.value.delivered_most_ml == part.delivered_most_ml
    rest = bench.resume(rate="30mL/s")
    assert rest.requested_ml == pytest.approx(300 - part.delivered_most_ml)
    assert bench.status().unfinished is None


def test_what_progress_raises_stops_the_motor_too(bench: pm.Bench) -> None:
    def fail(made: int, planned: int) -> None:
        raise ArithmeticError(f"{made} of {planned}")

    with pytest.raises(ArithmeticError, match=r"\d+ of 600688"):
        bench.dose("1000mL", rate="30mL/s", progress=fail)
    assert bench.log()[-1].cause == "ArithmeticError"
    assert bench.status().unfinished is not None
    assert bench.discard().unfinished is None
    assert bench.dose("1mL").completed


def test_another_thread_can_stop_a_dose(bench: pm.Bench) -> None:
    moving = threading.Event()

    def watch() -> None:
        moving.wait()
        bench.stop()

    thread = threading.Thread(target=watch)
    thread.start()
    dose = bench.dose("2000mL", rate="30mL/s", progress=lambda made, planned: moving.set())
    thread.join()
    assert not dose.completed
    assert dose.delivered_ml is not None
    assert 0 < dose.delivered_ml < 2000
    assert dose.steps_made is not None
    assert 0 < dose.steps_made < dose.steps
    logged = bench.log()[-1]
    assert (logged.end, logged.cause, logged.rack) == ("stopped", "Bench.stop()", None)


def test_progress_ends_at_the_last_step(bench: pm.Bench) -> None:
    told: list[tuple[int, int]] = []
    cases: list[dict[str, Any]] = [{}, {"retract": "0.2mL"}, {"speed": "170rpm"}]
    for keywords in cases:
        told.clear()
        dose = bench.dose("25mL", progress=lambda made, planned: told.append((made, planned)), **keywords)
        assert told == sorted(told)
        assert told[-1] == (dose.steps, dose.steps) == (dose.steps_made, dose.steps)
    told.clear()
    bench.calibration_run(speed_rpm=60, pitches=2, progress=lambda *stand: told.append(stand))
    assert told[-1][0] == told[-1][1] > 0
    told.clear()
    dose = bench.run(profile=[[0, 0], [1, 3], [2, 0]], progress=lambda *stand: told.append(stand))
    assert told[-1] == (dose.steps_made, dose.steps)


def test_a_dose_at_real_pace_can_be_stopped_and_resumed(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path, pace="real") as bench:
        told: list[tuple[int, int]] = []
        begun = time.monotonic()
        threading.Timer(0.4, bench.stop).start()
        dose = bench.dose("25mL", rate="10 mL/s", progress=lambda made, planned: told.append((made, planned)))
        assert 0.4 <= time.monotonic() - begun < 2
        assert not dose.completed
        assert told[-1] == (dose.steps_made, dose.steps)
        rest = bench.resume(rate="max")
        assert rest.completed
        begun = time.monotonic()
        motion_s = bench.dose("5mL", rate="10 mL/s").measured_motion_s
        assert motion_s is not None
        assert time.monotonic() - begun >= 0.9 * motion_s
    with pm.Bench.open("three-roller", state_dir=tmp_path, pace="fast") as bench:
        begun = time.monotonic()
        bench.dose("100mL", rate="10 mL/s")
        assert time.monotonic() - begun < 5


def test_a_pace_that_is_none_or_of_a_real_motor_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="pace is 'slow'; allowed: 'real', 'fast'"):
        pm.Bench.open("three-roller", state_dir=tmp_path, pace="slow")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="pace is given, but a real motor takes its time"):
        pm.Bench.open("three-roller", state_dir=tmp_path, pace="real", driver="grbl", port="/dev/null")


def test_a_process_that_is_killed_leaves_bounds_on_record(tmp_path: Path) -> None:
    code = (
        "import os, sys, pumpmodel as pm\n"
        "bench = pm.Bench.open('three-roller', state_dir=sys.argv[1])\n"
        "bench.dose('2000mL', rate='30mL/s', progress=lambda made, planned: os._exit(9))\n"
    )
    ended = subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=False)
    assert ended.returncode == 9
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        part = bench.status().unfinished
        assert part is not None
        assert 0 <= part.delivered_least_ml < part.delivered_most_ml < 2000


def test_a_forked_process_is_told_to_open_its_own(bench: pm.Bench) -> None:
    with warnings.catch_warnings():
        # Python warns of forks beside threads; that is the case here.
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        try:
            bench.dose("1mL")
        except pm.PumpError as error:
            os._exit(7 if "another process" in str(error) else 8)
        os._exit(9)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7


def test_a_pump_is_free_once_it_is_closed_although_a_forked_process_lives(tmp_path: Path) -> None:
    bench = pm.Bench.open("three-roller", state_dir=tmp_path)
    bench.dose("1mL")
    wait, go = os.pipe()
    with warnings.catch_warnings():
        # Python warns of forks beside threads; that is the case here.
        warnings.simplefilter("ignore", DeprecationWarning)
        lives, leaves = os.fork(), -1
        if lives:
            leaves = os.fork()
    if lives == 0:
        # It keeps all that it inherited until its parent closes the pipe.
        os.close(go)
        os.read(wait, 1)
        os._exit(0)
    if leaves == 0:
        os._exit(0)
    try:
        os.waitpid(leaves, 0)
        with (
            pm.Bench.open("three-roller", state_dir=tmp_path) as other,
            pytest.raises(pm.DriveError, match="in use by"),
        ):
            other.dose("1mL")
        bench.close()
        with pm.Bench.open("three-roller", state_dir=tmp_path) as again:
            assert again.dose("1mL").completed
    finally:
        os.close(go)
        os.close(wait)
        os.waitpid(lives, 0)


def test_angles_are_set_jogged_and_forgotten(bench: pm.Bench) -> None:
    status = bench.home_set(0.5, half_width_rad=0.01)
    assert status.angle_source == "home"
    assert status.half_width_deg == pytest.approx(0.573, abs=1e-3)
    turned = bench.jog_rad(-0.2)
    assert turned == pytest.approx(-0.2, abs=5e-4)
    assert bench.status().angle_deg == pytest.approx((0.5 + turned) * 57.29577951308232)
    assert not bench.home_set(None).angle_known
    assert not bench.dose("25mL", dry_run=True).phase.known
    with pytest.raises(pm.DriveError, match="no index sensor"):
        bench.home_sensor()
    with pytest.raises(pm.PumpFileError, match="mark_angle_deg"):
        bench.home_mark(half_width_rad=0.01)
    for bad in (float("nan"), float("inf")):
        with pytest.raises(ValueError, match="allowed: a finite angle"):
            bench.home_set(bad)
        with pytest.raises(ValueError, match="angle_rad is"):
            bench.jog_rad(bad)
    with pytest.raises(ValueError, match="half_width_rad is -1"):
        bench.home_set(0.0, half_width_rad=-1.0)


def test_a_damaged_journal_is_put_aside_by_setting_the_angle(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        bench.dose("1mL")
    journal = Path(bench.folder) / "journal.jsonl"
    text = journal.read_text()
    journal.write_text(text[:-20] + "?" + text[-19:])
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        with pytest.raises(pm.PumpError, match="journal"):
            bench.status()
        with pytest.warns(UserWarning, match="the damaged journal is now"):
            assert bench.home_set(0.0).angle_known
        assert bench.dose("1mL").completed


def test_release_and_a_new_tube_are_on_record(bench: pm.Bench) -> None:
    bench.dose("-5mL")
    assert bench.status().wear.volume_ml == pytest.approx(5, abs=2e-3)
    assert bench.release().disturbances == 1
    with pytest.warns(UserWarning, match="is forgotten"):
        assert bench.new_tube().wear.volume_ml == 0


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"driver": "stepper"}, "driver is 'stepper'; allowed: 'sim', 'grbl', 'node'"),
        ({"port": "/dev/null"}, "port is given, but the motor is simulated"),
        ({"configure": True}, "configure is given, but the motor is simulated"),
        ({"tube_limit": "-1L"}, "is negative"),
        ({"temperature": "20"}, "has no unit"),
        ({"fluid": "oil"}, "nothing is known of the fluid `oil`"),
    ],
)
def test_a_bench_that_cannot_be_is_a_value_error(
    keywords: dict[str, object], message: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=message):
        pm.Bench.open("three-roller", state_dir=tmp_path, **keywords)  # type: ignore[arg-type]


def test_errors_of_doses_are_as_those_of_plans(bench: pm.Bench, tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="volume must be text with its unit"):
        bench.dose(25)  # type: ignore[arg-type]
    with pytest.raises(pm.PlanError, match=r"mL/s"):
        bench.dose("25mL", rate="1L/s")
    with pytest.raises(pm.PlanError, match="outlet"):
        bench.dose("25mL", rate="30mL/s", limits=pm.Limits(max_outlet_kpa=90))
    with pytest.raises(pm.PumpError, match="nothing to resume"):
        bench.resume()
    with pytest.raises(FileNotFoundError):
        pm.Bench.open(tmp_path / "none.toml")
    with pytest.raises(pm.PumpFileError, match="there is no pump `four-roller`"):
        pm.Bench.open("four-roller")
    with pytest.raises(pm.DriveError, match=r"no-such-port"):
        pm.Bench.open(
            "three-roller", driver="grbl", port="/dev/no-such-port", state_dir=tmp_path, confirm_pump=True
        ).dose("1mL")


def test_a_configured_name_finds_its_pump_and_its_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "acid.toml").write_text(pm.Pump.two_roller().replace(id="acid").to_toml())
    (tmp_path / "config.toml").write_text(
        'schema = "config/1"\nstate_dir = "records"\n[pumps]\nph-down = "acid.toml"\n'
    )
    monkeypatch.setenv("DOSE_CONFIG", str(tmp_path / "config.toml"))
    monkeypatch.delenv("DOSE_STATE_DIR", raising=False)
    with pm.Bench.open("ph-down") as bench:
        assert bench.dose("1mL").completed
    assert (tmp_path / "records/acid/sim/journal.jsonl").exists()
    with pytest.raises(pm.PumpFileError, match=r"there is no pump `ph-up`; configured in .*: ph-down"):
        pm.Bench.open("ph-up")
    monkeypatch.setenv("DOSE_CONFIG", str(tmp_path / "none.toml"))
    with pytest.raises(FileNotFoundError):
        pm.Bench.open("ph-down")


def test_a_worn_tube_refuses_doses(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path, tube_limit="10mL") as bench:
        assert bench.dose("9mL").completed
        with pytest.raises(pm.PlanError, match="would exceed its life"):
            bench.dose("2mL")
