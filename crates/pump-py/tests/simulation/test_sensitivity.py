"""Derivatives of runs, against central differences with Richardson extrapolation of runs without them."""

import pickle
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import pumpmodel as pm

Array = NDArray[np.float64]
ROLLER_ML = 1.7
KNOTS_S = [0.0, 0.13, 0.6, 0.9]
TIMES_S = [0.05, 0.31, 0.62, 0.9]


def with_roller_volume(pump: pm.Pump, roller_ml: float) -> pm.Pump:
    """Return the pump with another roller volume and the same shape of the pulse."""
    tables = pump.to_dict()
    factor = roller_ml / pump.roller_volume_ml
    roller = tables["roller_volume"]
    roller["polynomial_ml_deg"] = [factor * c for c in roller["polynomial_ml_deg"]]
    return pm.Pump.from_dict(tables)


def quantities(run: pm.Run) -> Array:
    return np.stack([run.inlet_kpa, run.outlet_kpa, run.delivered_ml])


def richardson(change: Callable[[float], Array], size: float) -> Array:
    def central(step: float) -> Array:
        slope: Array = (change(step) - change(-step)) / (2 * step)
        return slope

    differences: Array = (4 * central(2e-4 * size) - central(4e-4 * size)) / 3
    return differences


def with_line(pump: pm.Pump, name: str, change: float) -> pm.Pump:
    inlet, outlet = (
        line.replace(**{name: getattr(line, name) + change}) for line in (pump.inlet, pump.outlet)
    )
    return pump.replace(inlet=inlet, outlet=outlet)


@pytest.mark.parametrize("initial", ["rest", "steady"])
@pytest.mark.parametrize("speed_rpm", [83.0, -140.0])
@pytest.mark.parametrize("rollers", [2, 3, 6])
def test_derivatives_are_the_limits_of_differences(
    rollers: int, speed_rpm: float, initial: pm.choices.Initial
) -> None:
    pump = with_roller_volume(pm.Pump.three_roller().replace(rollers=rollers), ROLLER_ML)
    times = np.array([0.013, 0.1171, 0.4007, 0.87])

    def run(pump: pm.Pump, angle_rad: float = 0.37) -> pm.Run:
        return pump.simulate(
            speed_rpm=speed_rpm, time_s=times, initial=initial, start_angle_rad=angle_rad, sensitivity=False
        )

    asked = pump.simulate(
        speed_rpm=speed_rpm, time_s=times, initial=initial, start_angle_rad=0.37, sensitivity=True
    )
    found = asked.sensitivity
    rows = np.stack([found.inlet_kpa_by, found.outlet_kpa_by, found.delivered_ml_by])
    np.testing.assert_allclose(quantities(asked), quantities(run(pump)), rtol=0, atol=1e-9)
    changes: dict[str, tuple[Callable[[float], Array], float]] = {
        "start_angle_rad": (lambda change: quantities(run(pump, 0.37 + change)), 0.3),
        "roller_volume_ml": (
            lambda change: quantities(run(with_roller_volume(pump, ROLLER_ML + change))),
            1.0,
        ),
    }
    for name in found.parameters[:3]:
        size = getattr(pump.outlet, name)

        def changed(change: float, name: str = name) -> Array:
            return quantities(run(with_line(pump, name, change)))

        changes[name] = (changed, size)
    for k, name in enumerate(found.parameters):
        change, size = changes[name]
        expected = richardson(change, size)
        np.testing.assert_allclose(rows[:, k], expected, rtol=2e-8, atol=2e-7 / size, err_msg=name)


def test_equal_intervals_and_times_give_the_same_derivatives() -> None:
    pump = pm.Pump.three_roller()
    grid = pump.simulate(speed_rpm=100, duration_s=2, start_angle_rad=0.1, sensitivity=True)
    times = pump.simulate(speed_rpm=100, time_s=grid.time_s, start_angle_rad=0.1, sensitivity=True)
    for one, other in zip(grid.sensitivity, times.sensitivity, strict=True):
        scale = np.abs(one).max(axis=-1, keepdims=True)
        assert np.all(np.abs(one - other) <= 1e-9 * scale + 1e-12)


def test_a_motion_between_knots_has_derivatives_too() -> None:
    pump = pm.Pump.three_roller()

    def run(angle_rad: float) -> pm.Run:
        return pump.simulate(
            speed_rpm=[0, 120, 120, -60],
            time_s=KNOTS_S,
            output_time_s=TIMES_S,
            start_angle_rad=angle_rad,
            sensitivity=True,
        )

    found = run(0.4).sensitivity
    expected = richardson(lambda change: quantities(run(0.4 + change)), 0.1)
    by_angle = np.stack([found.inlet_kpa_by[3], found.outlet_kpa_by[3], found.delivered_ml_by[3]])
    np.testing.assert_allclose(by_angle, expected, rtol=1e-7, atol=1e-6)


def test_a_run_without_derivatives_has_none_and_the_integrator_is_refused() -> None:
    pump = pm.Pump.three_roller()
    with pytest.raises(AttributeError, match=r"this run has no sensitivity; allowed: .*sensitivity=True"):
        _ = pump.simulate(speed_rpm=100, duration_s=0.1).sensitivity
    with pytest.raises(ValueError, match="sensitivity is True"):
        pump.simulate(speed_rpm=100, duration_s=0.1, method="rodas5p", sensitivity=True)
    with pytest.raises(ValueError, match="sensitivity is True"):
        pump.simulate(speed_rpm=100, duration_s=0.1, model="roller-centric", sensitivity=True)


def test_derivatives_go_into_tables_and_pickles() -> None:
    run = pm.Pump.two_roller().simulate(speed_rpm=60, duration_s=0.2, sensitivity=True)
    found = run.sensitivity
    assert found.outlet_kpa_by.shape == (5, len(run))
    assert not found.outlet_kpa_by.flags.writeable
    frame = found.to_dataframe()
    assert frame.attrs["units"]["outlet_kpa_by_compliance_ml_kpa"] == "kPa/(mL/kPa)"
    np.testing.assert_array_equal(frame["delivered_ml_by_roller_volume_ml"], found.delivered_ml_by[4])
    dataset = found.to_xarray()
    np.testing.assert_array_equal(
        dataset["inlet_kpa_by"].sel(parameter="inertance_kpa_s2_ml"), found.inlet_kpa_by[2]
    )
    again = pickle.loads(pickle.dumps(run))
    assert again == run
    np.testing.assert_array_equal(again.sensitivity.outlet_kpa_by, found.outlet_kpa_by)


def test_derivatives_are_columns_of_a_run_that_from_dict_takes() -> None:
    run = pm.Pump.two_roller().simulate(speed_rpm=60, duration_s=0.2, sensitivity=True)
    columns = run.to_dict()
    assert len(columns) == 8 + 15
    np.testing.assert_array_equal(columns["outlet_kpa_by_start_angle_rad"], run.sensitivity.outlet_kpa_by[3])
    again = pm.Run.from_dict({name: numbers.tolist() for name, numbers in columns.items()})
    assert again == run
    for name in ("time_s", "inlet_kpa_by", "outlet_kpa_by", "delivered_ml_by"):
        np.testing.assert_array_equal(getattr(again.sensitivity, name), getattr(run.sensitivity, name))
    assert not again.sensitivity.inlet_kpa_by.flags.writeable
    assert list(run.to_dataframe().columns) == list(columns)
    assert len(run.to_xarray().data_vars) == 7 + 15
    with pytest.raises(
        ValueError, match="the column inlet_kpa_by_inertance_kpa_s2_ml is missing; allowed: all"
    ):
        pm.Run.from_dict({k: v for k, v in columns.items() if k != "inlet_kpa_by_inertance_kpa_s2_ml"})
    with pytest.raises(ValueError, match=r"delivered_ml_by_roller_volume_ml has the shape \(3,\); allowed: "):
        pm.Run.from_dict({**columns, "delivered_ml_by_roller_volume_ml": [1, 2, 3]})
    with pytest.raises(ValueError, match="outlet_kpa_by_luck is not a column of a run"):
        pm.Run.from_dict({**columns, "outlet_kpa_by_luck": columns["time_s"]})
