import threading
from pathlib import Path

import pytest

import pumpmodel as pm

MIX = """
schema = "rack/1"
[pumps]
acid = "three-roller"
base = "two-roller"
[[step]]
ratio = { acid = 2, base = 1 }
volume = "6mL"
rate = "6mL/s"
[[step]]
pump = "base"
volume = "3mL"
"""


def test_a_rack_delivers_what_each_pump_is_asked_for(tmp_path: Path) -> None:
    rack = pm.Rack.parse(MIX, path="mix.toml", state_dir=tmp_path)
    assert (rack.name, rack.pumps, rack.steps) == ("mix", ["acid", "base"], 2)
    planned = rack.plan()
    assert (planned.end, planned.completed) == ("planned", False)
    assert not list(tmp_path.iterdir())
    told: list[tuple[str, int, int, int]] = []
    report = rack.run(progress=lambda *stands: told.append(stands))
    assert (report.end, report.completed, report.simulated) == ("completed", True, True)
    acid, base = report.pumps
    assert acid.delivered_ml == pytest.approx(4, abs=0.002)
    assert base.delivered_ml == pytest.approx(5, abs=0.002)
    assert report.total.delivered_ml == pytest.approx(acid.delivered_ml + base.delivered_ml)
    assert [part.step for part in base.doses] == [1, 2]
    assert isinstance(base.doses[1].dose, pm.Dose)
    # The last word of each pump is that its step is made.
    last = {pump: (made, steps) for pump, _, made, steps in told}
    assert set(last) == {"acid", "base"}
    assert all(made == steps for made, steps in last.values())
    assert pm.RackReport.from_dict(report.to_dict()) == report
    with pm.Bench.open("two-roller", state_dir=tmp_path) as bench:
        assert bench.status().wear.volume_ml == pytest.approx(base.delivered_ml, rel=1e-3)


def test_a_rack_of_a_file_finds_its_pumps_beside_it(tmp_path: Path) -> None:
    (tmp_path / "tank.toml").write_text(pm.Pump.three_roller().to_toml())
    file = tmp_path / "mix.toml"
    file.write_text(MIX.replace('"three-roller"', '"./tank.toml"'))
    assert pm.Rack.open(file, state_dir=tmp_path / "state").run().completed


def test_a_stop_or_an_exception_stops_every_pump_and_each_rest_is_on_record(tmp_path: Path) -> None:
    slow = MIX.replace('rate = "6mL/s"', 'rate = "1mL/s"')
    rack = pm.Rack.parse(slow, pace="real", state_dir=tmp_path)

    def stops(pump: str, step: int, made: int, steps: int) -> None:
        if made > 0:
            threading.Thread(target=rack.stop).start()

    report = rack.run(progress=stops)
    assert (report.end, report.completed) == ("stopped", False)
    assert 0 < report.total.delivered_ml < 6
    with pytest.raises(pm.UnfinishedError, match="pump `"):
        rack.run()
    other = pm.Rack.parse(slow, pace="real", state_dir=tmp_path / "other")

    def heard(pump: str, step: int, made: int, steps: int) -> None:
        raise RuntimeError(f"{pump} is at {made} of {steps} steps of step {step}")

    with pytest.raises(RuntimeError, match="of step 1") as caught:
        other.run(progress=heard)
    assert "are on record" in caught.value.__notes__[0]


def test_a_rack_that_cannot_run_is_refused_by_the_pump_or_the_value(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="step 1, ratio of base is `0`"):
        pm.Rack.parse(MIX.replace("base = 1", "base = 0"), state_dir=tmp_path)
    with pytest.raises(FileNotFoundError):
        pm.Rack.open(tmp_path / "none.toml")
    with pytest.raises(pm.PumpFileError, match="no-such-rack"):
        pm.Rack.open("no-such-rack", state_dir=tmp_path)
    with pytest.raises(ValueError, match="pace"):
        pm.Rack.parse(MIX, pace="slow", state_dir=tmp_path)  # type: ignore[arg-type]
    fast = pm.Rack.parse(MIX.replace('rate = "6mL/s"', 'rate = "600mL/s"'), state_dir=tmp_path)
    with pytest.raises(pm.PlanError, match=r"pump `(acid|base)` of the rack"):
        fast.run()
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        assert not bench.status().recorded
