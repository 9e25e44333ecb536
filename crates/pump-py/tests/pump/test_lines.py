import dataclasses
from typing import Any

import numpy as np
import pytest

import pumpmodel as pm

WATER = pm.Fluid.water(temperature_degc=25)
HOSE = pm.Hose(bore_radius_mm=5, outer_radius_mm=7, length_mm=331, modulus_mpa=3.5, minor_loss=5.75)


def test_the_papers_line_is_that_of_its_hose() -> None:
    line = HOSE.line(WATER, reservoir_kpa=88.637, flow_ml_s=210)
    published = pm.Pump.three_roller().outlet
    assert line.resistance_kpa_s_ml == pytest.approx(published.resistance_kpa_s_ml, abs=2e-4)
    assert line.inertance_kpa_s2_ml == pytest.approx(published.inertance_kpa_s2_ml, abs=1e-5)
    assert line.reservoir_kpa == published.reservoir_kpa
    assert HOSE.volume_ml == pytest.approx(np.pi * 25 * 331 / 1000)
    pump = pm.Pump.three_roller().replace(outlet=line)
    assert pump.outlet == line


def test_the_pressure_drop_takes_arrays_of_any_shape() -> None:
    flows = np.array([[-200.0, 0.0, 200.0], [1.0, 2.0, 4.0]], dtype=np.float32)
    drop = HOSE.pressure_drop_kpa(WATER, flow_ml_s=flows)
    assert drop.shape == flows.shape
    assert drop.dtype == np.float64
    assert drop[0, 0] == -drop[0, 2]
    assert drop[0, 1] == 0
    line = HOSE.line(WATER, reservoir_kpa=100, flow_ml_s=200)
    assert HOSE.pressure_drop_kpa(WATER, flow_ml_s=200) == pytest.approx(200 * line.resistance_kpa_s_ml)
    # rho v d/mu of 200 mL/s in a bore of 10 mm.
    reynolds = 997.05 * (200e-6 / (np.pi * 25e-6)) * 0.01 / 0.890e-3
    assert HOSE.reynolds(WATER, flow_ml_s=200) == pytest.approx(reynolds, rel=1e-3)


@pytest.mark.parametrize(
    ("of", "field", "value"),
    [
        (WATER, "density_kg_m3", 0.0),
        (WATER, "viscosity_mpa_s", float("nan")),
        (WATER, "bulk_modulus_mpa", -1.0),
        (HOSE, "bore_radius_mm", 8.0),
        (HOSE, "length_mm", float("inf")),
        (HOSE, "poisson_ratio", 0.6),
        (HOSE, "minor_loss", -1.0),
        (pm.SpeedLaw.published(), "distensibility_per_kpa", 2.0),
    ],
)
def test_what_is_not_physical_is_a_value_error(of: Any, field: str, value: float) -> None:
    with pytest.raises(ValueError, match="allowed"):
        dataclasses.replace(of, **{field: value})


def test_water_is_known_from_0_to_100_degc() -> None:
    assert pm.Fluid.water(temperature_degc=20).viscosity_mpa_s == pytest.approx(1.002, rel=0.01)
    assert pm.Fluid.water(temperature_degc=100).vapour_kpa == pytest.approx(101.4, rel=2e-3)
    with pytest.raises(ValueError, match="120"):
        pm.Fluid.water(temperature_degc=120)


def test_a_revolution_holds_more_where_a_segment_is_trapped_at_more_pressure() -> None:
    law, pump = pm.SpeedLaw.published(), pm.Pump.three_roller()
    speeds = [10, 60, 150]
    volumes = law.revolution_ml(pump, speed_rpm=speeds)
    pressures = law.trapped_kpa(pump, speed_rpm=speeds)
    assert isinstance(volumes, np.ndarray)
    assert isinstance(pressures, np.ndarray)
    assert np.all(np.diff(volumes)[np.diff(pressures) > 0] > 0)
    # V_rot is a line over the pressure.
    slope = np.diff(volumes) / np.diff(pressures)
    assert slope[0] == pytest.approx(slope[1])
    with pytest.raises(ValueError, match="speed"):
        law.revolution_ml(pump)
    with pytest.raises(ValueError, match="speed"):
        law.revolution_ml(pump, speed_rpm=0)


@pytest.mark.parametrize(
    ("name", "number"),
    [("resistance_kpa_s_ml", -1), ("compliance_ml_kpa", 0), ("inertance_kpa_s2_ml", 0), ("reservoir_kpa", 0)],
)
def test_a_refused_value_of_a_line_is_told_by_its_argument(name: str, number: float) -> None:
    line = pm.Pump.three_roller().outlet
    with pytest.raises(ValueError, match=f"^{name} is {number}; allowed: "):
        line.replace(**{name: number})
    with pytest.raises(ValueError, match=f"^{name} is {number}; allowed: "):
        pm.Line(**{**line.to_dict(), name: number})
