import copy
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import pumpmodel as pm
from pumpmodel._results.renamed import COLUMNS


def line(resistance_kpa_s_ml: float = 0.1) -> pm.Line:
    return pm.Line(
        resistance_kpa_s_ml=resistance_kpa_s_ml,
        compliance_ml_kpa=0.04,
        inertance_kpa_s2_ml=0.004,
        reservoir_kpa=90,
    )


CALIBRATION = pm.Calibration.from_runs(
    pm.Pump.three_roller().replace(rollers=4),
    [pm.WeighedRun(speed_rpm=60, turned_deg=720, mass_g=40.5)],
)


def every_object() -> list[object]:
    pump = pm.Pump.three_roller().replace(rollers=4, outlet=line())
    doser = pm.Doser(pump, pm.Limits(max_outlet_kpa=150))
    return [
        line(),
        pump,
        pm.Limits(),
        pm.Limits(max_outlet_kpa=150, min_inlet_kpa=30),
        doser,
        doser.plan("2mL"),
        doser.plan("2mL", rate="1mL/s", start_angle_rad=1.0, carry_in_ml=0.1),
        doser.plan("-2mL", speed="50rpm"),
        doser.plan("2mL", within="5s"),
        doser.plan("2mL").trace(),
        pump.simulate(speed_rpm=50, duration_s=0.1),
        pm.Doser(pump, calibration=CALIBRATION).plan("2mL", speed="60rpm", retract="0.1mL"),
        copy.copy(CALIBRATION),
        pm.Fluid.water(temperature_degc=20),
        pm.SpeedLaw.published(),
        pm.VolumeFit([0, 12, 24, 36, 48], [0, 0.1, 0.8, 1.7, 2.1]),
        pm.VolumePolynomial([-3.2e-5, 0.0024, 0, 0], 50),
        pm.WeighedRun(speed_rpm=60, turned_deg=720),
        pm.ShortDose(start_angle_deg=0, turned_deg=24, volume_ml=1),
        pump.harmonics(4, speed_rpm=50),
        pm.monte_carlo(doser.plan("2mL", start_angle_rad=0.3), trials=100, seed=1),
        pm.PressureRecord(np.array([0.0, 1.0]), np.array([88.0, 89.0]), speed_rpm=60),
        pump.steady_state(speed_rpm=50),
        pump.steady_state(speed_rpm=[[50, 100]]),
    ]


PAIRS = list(zip(every_object(), every_object(), strict=True))


@pytest.mark.parametrize(("one", "same"), PAIRS)
def test_equal_contents_are_equal_objects(one: object, same: object) -> None:
    assert one is not same
    assert one == same
    assert not one != same  # noqa: SIM202
    assert all(one != other for other, _ in PAIRS if other is not one)
    assert one != "text"
    assert one != None  # noqa: E711


@pytest.mark.parametrize(("one", "same"), PAIRS)
def test_values_hash_and_arrays_do_not(one: object, same: object) -> None:
    if isinstance(one, pm.Run | pm.SteadyState | pm.Harmonics | pm.VolumeTrials | pm.PressureRecord):
        with pytest.raises(TypeError, match="unhashable"):
            hash(one)
    else:
        assert hash(one) == hash(same)


def test_signed_zeros_are_equal_and_hash_alike() -> None:
    assert line(0.0) == line(-0.0)
    assert hash(line(0.0)) == hash(line(-0.0))


@pytest.mark.parametrize("one", every_object())
def test_objects_pickle_and_copy(one: object) -> None:
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        again = pickle.loads(pickle.dumps(one, protocol))
        assert type(again) is type(one)
        assert again == one
    assert copy.copy(one) == one
    assert copy.deepcopy(one) == one


def test_an_unpickled_run_is_read_only() -> None:
    run = pm.Pump.three_roller().simulate(speed_rpm=50, duration_s=0.1)
    again = pickle.loads(pickle.dumps(run))
    assert not again.inlet_kpa.flags.writeable
    np.testing.assert_array_equal(again.inlet_kpa, run.inlet_kpa)


def simulate(pump: pm.Pump, speed_rpm: float) -> pm.Run:
    return pump.simulate(speed_rpm=speed_rpm, duration_s=0.1)


def test_pumps_and_runs_travel_between_processes() -> None:
    pump = pm.Pump.two_roller()
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert pool.submit(simulate, pump, 50.0).result() == simulate(pump, 50.0)


def test_errors_pickle() -> None:
    for error in (
        pm.PumpError("a"),
        pm.PlanError("b"),
        pm.PumpFileError("c"),
        pm.DriveError("d"),
        pm.UnfinishedError("e"),
    ):
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error)
        assert again.args == error.args


@pytest.mark.parametrize("one", every_object())
def test_objects_are_immutable(one: object) -> None:
    former = COLUMNS if isinstance(one, pm.Run) else {}
    names = [name for name in dir(one) if not name.startswith("_") and name not in former]
    names = [name for name in names if not callable(getattr(one, name, None))]
    assert names
    for name in names:
        with pytest.raises(AttributeError):
            setattr(one, name, 1)
    with pytest.raises(AttributeError):
        one.surprise = 1  # type: ignore[attr-defined]


def test_objects_print_usefully() -> None:
    pump = pm.Pump.three_roller()
    assert repr(pump) == "Pump(id='three-roller', rollers=3, volume_per_revolution_ml=21.3185)"
    assert eval(repr(line()), {"Line": pm.Line}) == line()
    limits = pm.Limits(max_outlet_kpa=150)
    assert repr(limits) == "Limits(max_outlet_kpa=150.0, min_inlet_kpa=None)"
    assert repr(pm.Doser(pump, limits)) == f"Doser({pump!r}, {limits!r})"
    plan = pm.Doser(pump).plan("25mL", rate="10 mL/s")
    assert repr(plan).startswith("<Plan of 25.0 mL on 'three-roller': planned_ml 24.999")
    run = pump.simulate(speed_rpm=100, duration_s=0.1)
    assert repr(run).startswith("<Run of 101 samples: time_s 0.0000 to 0.1000, inlet_kpa ")
    assert "mean_flow_ml_s=35.53" in repr(pump.steady_state(speed_rpm=100))


@pytest.mark.parametrize("made", [pm.Pump, pm.Run, pm.SteadyState, pm.Plan, pm.Calibration])
def test_what_is_made_by_others_has_no_constructor(made: type) -> None:
    with pytest.raises(TypeError, match=r"No constructor defined|cannot create"):
        made()
