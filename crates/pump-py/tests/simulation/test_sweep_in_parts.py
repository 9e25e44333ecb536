import warnings
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import pumpmodel as pm
from pumpmodel.sweeps import RESULTS

SPEEDS = np.linspace(20, 170, 50)


def heads() -> Iterator[pm.Pump]:
    three = pm.Pump.three_roller()
    return (three.replace(rollers=count) for count in (2, 3, 4, 5, 8))


@pytest.mark.parametrize(("points", "rows"), [(1, [1] * 5), (149, [2, 2, 1]), (10**9, [5])])
def test_parts_have_whole_rows_and_the_numbers_of_one_sweep(points: int, rows: list[int]) -> None:
    whole = pm.sweep(heads(), speed_rpm=SPEEDS)
    with ThreadPoolExecutor(2) as executor:
        for by in (None, executor):
            parts = list(pm.sweep_in_parts(heads(), speed_rpm=SPEEDS, points=points, executor=by))
            assert [part.shape for part in parts] == [(count, 50) for count in rows]
            for name in ("speed_rad_s", *RESULTS):
                rows_of_all = np.vstack([np.atleast_2d(getattr(part, name)) for part in parts])
                expected = np.atleast_2d(getattr(whole, name))
                np.testing.assert_array_equal(rows_of_all[: len(expected)], expected)


def test_pumps_are_taken_as_they_are_needed() -> None:
    taken = 0

    def endless() -> Iterator[pm.Pump]:
        nonlocal taken
        while True:
            taken += 1
            yield pm.Pump.three_roller()

    parts = pm.sweep_in_parts(endless(), speed_rpm=SPEEDS, points=100)
    assert taken == 0
    next(parts)
    next(parts)
    assert taken == 4
    assert list(pm.sweep_in_parts([], speed_rpm=SPEEDS)) == []


def test_refusals_come_before_the_first_part_or_name_the_pump() -> None:
    three = pm.Pump.three_roller()
    for points, error, message in (
        (0, ValueError, "points is 0; allowed: 1 or more"),
        (2.5, TypeError, "points must be an integer, not float"),
        (True, TypeError, "points must be an integer, not bool"),
    ):
        with pytest.raises(error, match=message):
            pm.sweep_in_parts(three, speed_rpm=SPEEDS, points=points)  # type: ignore[arg-type]
    assert [part.shape for part in pm.sweep_in_parts(three, speed_rpm=SPEEDS, points=10**400)] == [(1, 50)]
    with pytest.raises(ValueError, match="give exactly one of speed_rpm and speed_rad_s"):
        pm.sweep_in_parts(three)
    parts = pm.sweep_in_parts([three, three, 3], speed_rpm=SPEEDS, points=1)  # type: ignore[list-item]
    assert [next(parts).shape, next(parts).shape] == [(1, 50), (1, 50)]
    with pytest.raises(TypeError, match=r"pumps\[2\] must be a Pump, not int"):
        next(parts)


def test_each_part_warns_of_its_lowest_pressure() -> None:
    three = pm.Pump.three_roller()
    long = three.replace(inlet=three.inlet.replace(resistance_kpa_s_ml=3.0))
    parts = pm.sweep_in_parts([three, long], speed_rpm=[170], points=1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        next(parts)
    with pytest.warns(UserWarning, match=r"inlet of pumps\[1\] at 170 r/min"):
        next(parts)
