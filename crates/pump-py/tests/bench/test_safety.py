from pathlib import Path

import pytest

import pumpmodel as pm

SAFETY = """
[safety]
max_ml_per_day = 30.0
vessel_ml = 40.0
"""


def test_a_bench_obeys_the_limits_of_the_command(tmp_path: Path) -> None:
    tank = tmp_path / "tank.toml"
    tank.write_text(pm.Pump.three_roller().to_toml() + SAFETY)
    with pm.Bench.open(tank, state_dir=tmp_path) as bench:
        bench.dose("25mL")
        with pytest.raises(pm.SafetyError, match=r"clear_safety") as caught:
            bench.dose("6mL")
        assert caught.value.allowed_ml == 30
        assert caught.value.used_ml == pytest.approx(25, abs=0.01)
        stand = bench.status().safety.stand
        assert stand is not None
        assert stand.limit == "day"
        with pytest.raises(ValueError, match="empty"):
            bench.clear_safety(" ")
        assert bench.clear_safety("a test").safety.stand is None
        with pytest.raises(pm.SafetyError):
            bench.dose("16mL")
        assert bench.vessel_emptied().safety.received_ml == 0
        bench.clear_safety("emptied")
        bench.dose("16mL")


def test_a_run_until_stopped_that_a_limit_ends_raises_and_is_on_record(tmp_path: Path) -> None:
    tank = tmp_path / "tank.toml"
    tank.write_text(pm.Pump.three_roller().to_toml() + "\n[safety]\nvessel_ml = 5.0\n")
    with pm.Bench.open(tank, state_dir=tmp_path) as bench:
        with pytest.raises(pm.SafetyError, match="a run until it is stopped ends at the limit") as caught:
            bench.run(rate="6mL/s")
        assert caught.value.planned_ml == 0
        assert "were delivered" in caught.value.__notes__[0]
        assert bench.log()[-1].delivered_ml == pytest.approx(4.95, abs=0.05)
        with pytest.raises(pm.SafetyError):
            bench.dose("0.01mL")
