import math

import numpy as np
import pytest

import pumpmodel as pm


def reversing_head() -> pm.Pump:
    """Return a head with a narrow bore and many rollers, which takes back at each roller's exit."""
    return pm.Pump.from_drawing(
        "narrow",
        rollers=6,
        bore_radius_mm=1.6,
        tube_outer_radius_mm=3.2,
        backplate_radius_mm=40,
        contact_angle_deg=30,
        roller_radius_mm=8,
        roller_offset_mm=29.8,
        hose_length_mm=300,
    )


def test_the_angle_is_the_inverse_of_the_volume_both_ways() -> None:
    pump = pm.Pump.three_roller()
    volumes = np.linspace(-60, 60, 241)
    for start_rad in (0.0, 0.4, 1.2, -7.7, 1e5):
        ends_rad = pump.angle_for_volume(volumes, start_rad)
        delivered_ml = pump.outlet_volume_ml(ends_rad) - pump.outlet_volume_ml(start_rad)
        np.testing.assert_allclose(delivered_ml, volumes, atol=1e-9 * max(1.0, abs(start_rad) / 100))
        assert np.all(np.diff(ends_rad) > 0)
    assert pump.angle_for_volume(0.0, 0.3) == 0.3


def test_shapes_broadcast_and_a_number_stays_a_number() -> None:
    pump = pm.Pump.three_roller()
    assert isinstance(pump.angle_for_volume(1), float)
    table = pump.angle_for_volume(np.array([[1.0], [2.0]]), np.array([0.0, 0.5, 1.0]))
    assert isinstance(table, np.ndarray)
    assert table.shape == (2, 3)
    for row, volume_ml in enumerate((1.0, 2.0)):
        for column, start_rad in enumerate((0.0, 0.5, 1.0)):
            assert table[row, column] == pump.angle_for_volume(volume_ml, start_rad)
    assert pump.angle_for_volume(1.0, [0.0, 0.5]).shape == (2,)
    assert pump.angle_for_volume([], 0.5).shape == (0,)


def test_where_the_flow_reverses_the_first_angle_on_the_way_is_found() -> None:
    pump = reversing_head()
    assert np.min(pump.outlet_flow_ml_rad(np.linspace(0, pump.pitch_rad, 2000))) < 0
    turn = np.linspace(0, 3 * math.tau, 400_001)
    for start_rad in (0.0, 0.2, 0.9):
        way_ml = pump.outlet_volume_ml(start_rad + turn) - pump.outlet_volume_ml(start_rad)
        back_ml = pump.outlet_volume_ml(start_rad - turn) - pump.outlet_volume_ml(start_rad)
        for volume_ml in np.linspace(0.02, 0.9 * way_ml[-1], 17):
            first = turn[np.argmax(way_ml >= volume_ml)]
            assert pump.angle_for_volume(volume_ml, start_rad) == pytest.approx(start_rad + first, abs=1e-4)
            first = turn[np.argmax(back_ml <= -volume_ml)]
            assert pump.angle_for_volume(-volume_ml, start_rad) == pytest.approx(start_rad - first, abs=1e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((math.nan,), "volume_ml is NaN; allowed: a finite number, up to 1e9"),
        ((1e10,), "volume_ml is 10000000000; allowed"),
        ((1.0, math.inf), "start_angle_rad is inf; allowed"),
        (([1.0, 2.0], [0.0, 1.0, 2.0]), r"volume_ml \[2\], start_angle_rad \[3\]; allowed"),
    ],
)
def test_a_volume_or_angle_beyond_its_range_is_refused(arguments: tuple[object, ...], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pm.Pump.three_roller().angle_for_volume(*arguments)  # type: ignore[call-overload]
