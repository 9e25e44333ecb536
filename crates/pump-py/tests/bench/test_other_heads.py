"""Records of heads that change."""

from pathlib import Path

import pytest

import pumpmodel as pm


def test_a_pump_with_other_rollers_has_a_name_and_a_record_of_its_own(tmp_path: Path) -> None:
    three = pm.Pump.three_roller()
    four, five = three.replace(rollers=4), three.replace(rollers=5)
    assert len({three.id, four.id, five.id}) == 3
    assert four.id.startswith("three-roller-")
    assert four.name == f"{three.name}, 4 rollers"
    assert four.replace(rollers=5).id == five.id, "endings do not pile up"
    assert three.replace(rollers=3) == three
    assert three.replace(rollers=4, id="mine").id == "mine"
    with pm.Bench.open(three, state_dir=tmp_path) as bench:
        bench.dose("7mL")
    with pm.Bench.open(four, state_dir=tmp_path) as bench:
        assert bench.status().recorded is False


def test_the_angle_of_another_head_under_the_same_name_is_unknown(tmp_path: Path) -> None:
    tables = pm.Pump.three_roller().to_dict()
    with pm.Bench.open(pm.Pump.from_dict(tables), state_dir=tmp_path) as bench:
        bench.dose("7.003mL")
        angle_deg = bench.status().angle_deg
    # Another rate is no other head.
    tables["pump"]["default_rate_ml_s"] = 5.0
    with pm.Bench.open(pm.Pump.from_dict(tables), state_dir=tmp_path) as bench:
        assert bench.status().angle_deg == angle_deg
    tables["rollers"]["count"] = 4
    with pm.Bench.open(pm.Pump.from_dict(tables), state_dir=tmp_path) as bench:
        assert bench.dose("5mL", dry_run=True).phase.known is False
        assert bench.status().carry_ml == 0
        with pytest.warns(UserWarning, match="is of another head than this one with 4 rollers"):
            dose = bench.dose("5mL")
        assert dose.phase.known is False
        [warning] = [warning for warning in dose.warnings if "another head" in warning]
        assert "the record of three-roller is of another head than this one with 4 rollers" in warning
        with pytest.warns(UserWarning, match="is forgotten"):
            bench.home_set(0.0)
        again = bench.dose("5mL")
        assert again.phase.known
        assert not any("another head" in warning for warning in again.warnings)


def test_nothing_moves_if_the_warning_of_another_head_is_made_an_error(tmp_path: Path) -> None:
    tables = pm.Pump.three_roller().to_dict()
    with pm.Bench.open(pm.Pump.from_dict(tables), state_dir=tmp_path) as bench:
        bench.dose("7mL")
    tables["rollers"]["count"] = 4
    with pm.Bench.open(pm.Pump.from_dict(tables), state_dir=tmp_path) as bench:
        doses = len(bench.log())
        for _ in range(2):
            with pytest.raises(UserWarning, match="another head"):
                bench.dose("5mL")
        assert len(bench.log()) == doses


def test_a_pump_is_checked_and_warns_as_the_command_does() -> None:
    with pytest.warns(UserWarning, match="the rollers overlap"):
        pump = pm.Pump.three_roller().replace(rollers=8)
    [warning] = pump.warnings
    assert warning.startswith("the rollers overlap")
    assert f"warning   {warning}" in pump.check()
    three = pm.Pump.three_roller()
    assert three.warnings == []
    assert "21.3185 mL per revolution" in three.check()
