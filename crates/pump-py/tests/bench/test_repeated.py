"""Batches, and the verification of weighed doses."""

import time
from pathlib import Path

import pytest

import pumpmodel as pm


def test_a_batch_carries_what_a_dose_leaves_over(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        doses = list(bench.batch("0.1mL", 20, start_angle_rad=0.5))
        assert len(doses) == 20
        assert sum(dose.planned_ml for dose in doses) + doses[-1].carry_ml == pytest.approx(2, abs=1e-9)
        assert all(dose.completed for dose in doses)
        assert [dose.phase.source for dose in doses[:2]] == ["given", "recorded"]


def test_doses_come_in_their_interval_and_a_missed_one_is_skipped_or_made(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        started = time.monotonic()
        assert len(list(bench.batch("0.1mL", 3, every_s=0.2))) == 3
        assert time.monotonic() - started >= 0.4
        # The second dose is due after 1 s, the third after 2 s.
        skipping = bench.batch("0.1mL", 3, every_s=1)
        next(skipping)
        time.sleep(1.3)
        with pytest.warns(RuntimeWarning, match="dose 2 of 3 was skipped"):
            assert len(list(skipping)) == 1
        catching_up = bench.batch("0.1mL", 3, every_s=1, missed="now")
        next(catching_up)
        time.sleep(1.3)
        assert len(list(catching_up)) == 2


def test_what_a_batch_cannot_be_is_refused(tmp_path: Path) -> None:
    bench = pm.Bench.open("three-roller", state_dir=tmp_path)
    with pytest.raises(ValueError, match="count is 0; allowed: 1 to 1000000"):
        next(bench.batch("1mL", 0))
    with pytest.raises(ValueError, match="missed is 'later'"):
        next(bench.batch("1mL", 2, missed="later"))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="time between doses in s is -1"):
        next(bench.batch("1mL", 2, every_s=-1))
    assert not bench.status().recorded


def test_weighed_doses_are_judged_as_the_standard_does(tmp_path: Path) -> None:
    bench = pm.Bench.open("three-roller", state_dir=tmp_path)
    found = bench.verify("10mL", ["10.02mL", "10.00mL", "10.01mL"])
    assert found.mean_ml == pytest.approx(10.01)
    assert found.systematic_percent == pytest.approx(0.1)
    assert found.random_ml == pytest.approx(0.01)
    assert found.passed
    assert (found.tolerance.systematic_percent, found.tolerance.random_percent) == (0.6, 0.2)
    assert pm.Verification.from_dict(found.to_dict()) == found
    # A gram of water is a little more than a millilitre.
    weighed = bench.verify("10mL", ["10g", "10g"])
    assert 10.03 < weighed.mean_ml < 10.05
    assert not bench.verify("10mL", ["9mL", "11mL"]).passed
    assert bench.verify("5mL", ["5mL", "5.1mL"], systematic_percent=2, random_percent=2).passed
    with pytest.raises(ValueError, match="give systematic_percent"):
        bench.verify("5mL", ["5mL", "5mL"])
    with pytest.raises(ValueError, match="1 doses; 2 at least"):
        bench.verify("10mL", ["10mL"])
    with pytest.raises(ValueError, match="nominal is -10 mL"):
        bench.verify("-10mL", ["10mL", "10mL"])
    with pytest.raises(ValueError, match="random_percent is 0"):
        bench.verify("10mL", ["10mL", "10mL"], random_percent=0)


def test_a_batch_ends_where_a_stop_lands_in_a_suck_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        whole = bench.dose("1mL", retract="0.1mL")
        assert whole.retraction_completed
        stopped = pm.Dose.from_dict({**whole.to_dict(), "retraction_completed": False})
        doses = iter([whole, stopped, whole])
        monkeypatch.setattr(pm.Bench, "dose", lambda *_, **__: next(doses))
        assert list(bench.batch("1mL", 3, retract="0.1mL")) == [whole, stopped]
