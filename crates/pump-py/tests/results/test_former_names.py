import math
import pickle
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pumpmodel as pm
from pumpmodel._results.renamed import COLUMNS

PUMP = pm.Pump.three_roller()
RUN = PUMP.simulate(speed_rpm=100, duration_s=0.1)
FIT = pm.VolumeFit([0, 12, 24, 36, 48], [0, 0.1, 0.8, 1.7, 2.1])
ANGLES = np.linspace(-1, 3, 20)

METHODS: list[tuple[object, str, str, dict[str, Any]]] = [
    (PUMP, "average_flow", "average_flow_ml_s", {"speed_rpm": 100}),
    (PUMP, "average_flow", "average_flow_ml_s", {"speed_rad_s": [1.0, -2.0]}),
    (PUMP, "speed_for_flow", "speed_for_flow_rpm", {"flow_ml_s": 10}),
    (PUMP, "outlet_volume", "outlet_volume_ml", {"angle_rad": ANGLES}),
    (PUMP, "outlet_flow_per_rad", "outlet_flow_ml_rad", {"angle_rad": ANGLES}),
    (PUMP, "inlet_volume", "inlet_volume_ml", {"angle_rad": 1.0}),
    (PUMP, "inlet_flow_per_rad", "inlet_flow_ml_rad", {"angle_rad": ANGLES}),
    (FIT, "volume", "displaced_ml", {"angle_rad": 0.5}),
]


def warned(former: str, now: str, call: Callable[[], Any]) -> Any:
    """Return what the call returns, after a check of its one warning and of the line that it names."""
    with warnings.catch_warnings(record=True) as messages:
        warnings.simplefilter("always")
        result = call()
    assert [str(message.message) for message in messages] == [f"{former} is deprecated; use {now}"]
    assert messages[0].category is DeprecationWarning
    assert messages[0].filename == __file__
    return result


@pytest.mark.parametrize(("of", "former", "now", "arguments"), METHODS)
def test_a_former_method_warns_and_returns_the_same_numbers(
    of: object, former: str, now: str, arguments: dict[str, Any]
) -> None:
    name = type(of).__name__
    old = warned(f"{name}.{former}", f"{name}.{now}", lambda: getattr(of, former)(**arguments))
    np.testing.assert_array_equal(old, getattr(of, now)(**arguments))


@pytest.mark.parametrize(("former", "now"), COLUMNS.items())
def test_a_column_of_a_run_is_read_by_its_former_name(former: str, now: str) -> None:
    assert warned(f"Run.{former}", f"Run.{now}", lambda: getattr(RUN, former)) is getattr(RUN, now)
    data = RUN.to_dict()
    assert former not in data
    for read in (lambda: data[former], lambda: data.get(former)):
        assert warned(f"the column {former}", now, read) is getattr(RUN, now)
    assert data.get("colour") is None
    with pytest.raises(KeyError, match="colour"):
        data["colour"]


@pytest.mark.parametrize(("former", "now"), COLUMNS.items())
def test_a_column_of_a_table_is_read_by_its_former_name(former: str, now: str) -> None:
    pytest.importorskip("pandas")
    table = RUN.to_dataframe()
    assert former not in table.columns
    later = table[table["time_s"] > 0.05]
    for frame in (table, later, table.copy(), table.set_index("time_s")):
        for read in (lambda frame=frame: frame[former], lambda frame=frame: getattr(frame, former)):
            np.testing.assert_array_equal(warned(f"the column {former}", now, read), frame[now])
    both = warned(f"the column {former}", now, lambda: table[["time_s", former]])
    assert list(both.columns) == ["time_s", now]
    own = table.rename(columns={now: former})
    np.testing.assert_array_equal(own[former], table[now])


@pytest.mark.parametrize(("former", "now"), COLUMNS.items())
def test_a_variable_of_a_dataset_is_read_by_its_former_name(former: str, now: str) -> None:
    pytest.importorskip("xarray")
    data = RUN.to_xarray()
    assert former not in data
    for dataset in (data, data.isel(time_s=slice(5)), data.sel(time_s=slice(0.05, None))):
        for read in (lambda of=dataset: of[former], lambda of=dataset: getattr(of, former)):
            np.testing.assert_array_equal(warned(f"the column {former}", now, read), dataset[now])


def test_pickled_tables_need_no_pumpmodel_to_be_read() -> None:
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    table, data = RUN.to_dataframe(), RUN.to_xarray()
    for one, plain in ((table, pandas.DataFrame), (data, xarray.Dataset), (RUN.to_dict(), dict)):
        pickled = pickle.dumps(one)
        assert b"pumpmodel" not in pickled
        assert type(pickle.loads(pickled)) is plain
    pandas.testing.assert_frame_equal(pickle.loads(pickle.dumps(table)), pandas.DataFrame(table))
    assert pickle.loads(pickle.dumps(table)).attrs == table.attrs
    assert pickle.loads(pickle.dumps(data)).equals(data)


def test_a_run_is_made_of_the_columns_of_a_trace() -> None:
    now = dict(RUN.to_dict())
    former = {name: name for name in now} | {name: former for former, name in COLUMNS.items()}
    assert pm.Run.from_dict({former[name]: column for name, column in now.items()}) == RUN
    with pytest.raises(ValueError, match="inlet_kpa and p_in_kpa are one column"):
        pm.Run.from_dict({**now, "p_in_kpa": now["inlet_kpa"]})


def test_what_was_varied_has_the_name_of_its_quantity() -> None:
    line = pm.identify_line(PUMP, time_s=RUN.time_s, pressure_kpa=RUN.outlet_kpa, speed_rpm=100, begin="step")
    resistance = pm.identify_resistance([10, 20, 40, 60], drop_kpa=[1.11, 2.21, 4.44, 6.64])
    compliance = pm.identify_compliance([0, 0.1, 0.2, 0.3, 0.4], [88.6, 91.4, 94.2, 96.9, 99.7])
    np.testing.assert_array_equal(resistance.flow_ml_s, [10, 20, 40, 60])
    np.testing.assert_array_equal(compliance.volume_ml, [0, 0.1, 0.2, 0.3, 0.4])
    for found, name in ((line, "time_s"), (resistance, "flow_ml_s"), (compliance, "volume_ml")):
        old = warned("Identified.x", f"Identified.{name}", partial(getattr, found, "x"))
        assert old is getattr(found, name)
        for other in {"time_s", "flow_ml_s", "volume_ml"} - {name}:
            with pytest.raises(AttributeError, match=f"has no {other}; it has {name}"):
                getattr(found, other)


def test_a_turn_by_the_former_name_turns_as_far(tmp_path: Path) -> None:
    with pm.Bench.open("three-roller", state_dir=tmp_path) as bench:
        turned_rad = warned("Bench.jog", "Bench.jog_rad", lambda: bench.jog(0.2))
        assert turned_rad == pytest.approx(0.2, abs=math.tau / 12_800)
        assert bench.jog_rad(0.2) == turned_rad


def test_falls_of_a_volume_have_names_with_units() -> None:
    fit = pm.VolumeFit([0, 10, 20, 30, 40, 50], [0, 0.5, 0.4, 1.2, 1.9, 2.1], run=["a"] * 6)
    assert fit.falls is not None
    (fall,), (within,) = fit.falls, fit.run_falls
    assert fall == (fall.from_deg, fall.to_deg, fall.fall_ml)
    assert (fall.from_deg, fall.to_deg) == (10, 20)
    assert fall.fall_ml == pytest.approx(0.1)
    assert (within.run, *within[1:]) == ("a", *fall)
