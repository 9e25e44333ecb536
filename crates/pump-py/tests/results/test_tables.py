import sys
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import pumpmodel as pm

PUMP = pm.Pump.three_roller()
RUN = PUMP.simulate(speed_rpm=100, duration_s=0.1)
PLAN = pm.Doser(PUMP).plan("-1mL")
STEADY = PUMP.steady_state(speed_rpm=[[10, 20, 30], [40, 50, 60]])


def test_a_table_has_the_columns_and_their_units() -> None:
    pytest.importorskip("pandas")
    table = RUN.to_dataframe()
    assert list(table.columns) == list(RUN.to_dict())
    assert table.attrs["units"]["outlet_flow_ml_s"] == "mL/s"
    np.testing.assert_array_equal(table["outlet_kpa"].to_numpy(), RUN.outlet_kpa)
    steps = PLAN.to_dataframe()
    assert list(steps.columns) == ["step", "time_s", "direction", "angle_rad"]
    assert len(steps) == abs(PLAN.steps)
    assert set(steps["direction"]) == {-1}
    assert steps["angle_rad"].iloc[-1] == pytest.approx(PLAN.end_angle_rad)
    rows = STEADY.to_dataframe()
    assert rows["speed_rpm"].tolist() == pytest.approx([10, 20, 30, 40, 50, 60])
    assert rows["mean_flow_ml_s"].iloc[5] == STEADY.mean_flow_ml_s[1, 2]
    assert len(PUMP.steady_state(speed_rpm=10).to_dataframe()) == 1


def test_a_dataset_has_dimensions_and_attributes() -> None:
    pytest.importorskip("xarray")
    data = RUN.to_xarray()
    assert data["inlet_kpa"].dims == ("time_s",)
    assert data["inlet_kpa"].attrs == {"units": "kPa", "long_name": "pressure at the inlet, absolute"}
    assert data["time_s"].attrs["units"] == "s"
    np.testing.assert_array_equal(data["delivered_ml"], RUN.delivered_ml)
    assert PLAN.to_xarray()["angle_rad"].sizes == {"time_s": abs(PLAN.steps)}
    grid = STEADY.to_xarray()
    assert grid["outlet_max_kpa"].shape == (2, 3)
    line = PUMP.steady_state(speed_rpm=[10, 20]).to_xarray()
    assert line["outlet_max_kpa"].dims == ("speed_rpm",)
    assert PUMP.steady_state(speed_rpm=10).to_xarray()["speed_rpm"].shape == ()


@pytest.mark.parametrize(("module", "extra"), [("pandas", "dataframe"), ("xarray", "xarray")])
def test_without_them_the_extra_is_named(module: str, extra: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    for result in (RUN, PLAN, STEADY):
        convert = result.to_dataframe if module == "pandas" else result.to_xarray
        with pytest.raises(ImportError, match=rf'pip install "\./crates/pump-py\[{extra}\]"'):
            convert()


def replaced(name: str, place: int, number: float) -> NDArray[np.float64]:
    """Return a column of the run with another number at a place."""
    column: NDArray[np.float64] = RUN.to_dict()[name].copy()
    column[place] = number
    return column


def test_a_run_returns_from_its_dict_and_shares_its_arrays() -> None:
    data = RUN.to_dict()
    assert data["inlet_kpa"] is RUN.inlet_kpa
    assert pm.Run.from_dict(data) == RUN
    wrong: list[tuple[dict[str, Any], str]] = [
        ({**data, "colour": [1]}, "colour is not a column"),
        ({name: data[name] for name in list(data)[1:]}, "time_s is missing"),
        ({**data, "time_s": [0.0]}, "angle_rad has 101 numbers, but time_s has 1; allowed: columns of equal"),
        (
            {**data, "outlet_kpa": replaced("outlet_kpa", 7, np.nan)},
            r"outlet_kpa\[7\] is NaN; allowed: a finite",
        ),
        (
            {**data, "angle_rad": replaced("angle_rad", 0, -np.inf)},
            r"angle_rad\[0\] is -inf; allowed: a finite",
        ),
        ({**data, "time_s": replaced("time_s", 3, 0.0015)}, r"time_s\[3\] is 0.0015; allowed: more than the"),
        (
            {**data, "time_s": replaced("time_s", 3, 0.002)},
            r"time_s\[3\] is 0.002; allowed: more than the time",
        ),
    ]
    for changed, message in wrong:
        with pytest.raises(ValueError, match=message):
            pm.Run.from_dict(changed)


def test_a_run_returns_from_a_table_and_any_mapping(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    assert pm.Run.from_dict(RUN.to_dataframe()) == RUN
    assert pm.Run.from_dict(MappingProxyType(RUN.to_dict())) == RUN
    RUN.to_dataframe().to_csv(tmp_path / "run.csv", index=False)
    again = pm.Run.from_dict(pandas.read_csv(tmp_path / "run.csv"))
    np.testing.assert_allclose(again.outlet_kpa, RUN.outlet_kpa, rtol=1e-12)
    RUN.to_dataframe().to_csv(tmp_path / "run.csv")
    with pytest.raises(ValueError, match=r"Unnamed: 0 is not a column of a run; .* leave it out"):
        pm.Run.from_dict(pandas.read_csv(tmp_path / "run.csv"))
    wrong: Any = [1.0]
    with pytest.raises(TypeError, match=r"data must have columns by name, not be a list; allowed: a dict"):
        pm.Run.from_dict(wrong)


def test_lines_and_limits_are_replaced_and_return_from_their_dicts() -> None:
    line = PUMP.outlet
    assert pm.Line(**line.to_dict()) == line
    assert line.replace(reservoir_kpa=100).reservoir_kpa == 100
    assert line.replace() == line
    with pytest.raises(ValueError, match="allowed"):
        line.replace(compliance_ml_kpa=0)
    limits = pm.Limits(max_outlet_kpa=150)
    assert pm.Limits(**limits.to_dict()) == limits
