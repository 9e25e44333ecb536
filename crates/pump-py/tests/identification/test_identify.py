import copy
import json
import os
import pickle
import signal
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import pumpmodel as pm

EXAMPLES = Path(__file__).parents[4] / "examples" / "identification"


def columns(name: str) -> list[np.ndarray[Any, np.dtype[np.float64]]]:
    rows = [line for line in (EXAMPLES / name).read_text().splitlines() if line and not line.startswith("#")]
    return list(np.array([[float(cell) for cell in row.split(",")] for row in rows[1:]]).T)


def start(**changed: Any) -> pm.Identified:
    time_s, pressure_kpa = columns("start.csv")
    arguments: dict[str, Any] = {
        "pump": pm.Pump.three_roller(),
        "time_s": time_s,
        "pressure_kpa": pressure_kpa,
        "speed_rpm": 100,
    }
    return pm.identify_line(**{**arguments, **changed})


def test_the_examples_give_the_line_that_they_were_made_with() -> None:
    flow_ml_s, drop_kpa = columns("resistance.csv")
    volume_ml, pressure_kpa = columns("compliance.csv")
    pump = pm.Pump.three_roller()
    found = [
        (pm.identify_resistance(flow_ml_s, drop_kpa=drop_kpa), "resistance_kpa_s_ml", 0.15),
        (pm.identify_compliance(volume_ml, pressure_kpa, total_ml=26), "compliance_ml_kpa", 0.03),
        (start(), "inertance_kpa_s2_ml", 0.0055),
    ]
    for fit, name, truth in found:
        estimate = fit.parameters[name]
        assert abs(estimate.value - truth) < 2 * estimate.standard < 0.02 * truth
        assert not estimate.held
        assert fit.warnings == ()
        assert getattr(fit.line, name) == estimate.value
        assert fit.line.reservoir_kpa == pump.outlet.reservoir_kpa
        assert pump.replace(outlet=fit.line).outlet == fit.line
    assert found[1][0].parameters["bulk_modulus_kpa"].value == pytest.approx(26 / 0.03, rel=0.01)


def test_absolute_pressures_are_drops_along_the_flow() -> None:
    flow_ml_s, drop_kpa = columns("resistance.csv")
    by_drop = pm.identify_resistance(flow_ml_s, drop_kpa=drop_kpa)
    for port, sign in (("outlet", 1), ("inlet", -1)):
        at_pump = pm.identify_resistance(flow_ml_s, 88.637 + sign * drop_kpa, port=port)  # type: ignore[arg-type]
        assert at_pump.port == port
        assert at_pump.line.resistance_kpa_s_ml == pytest.approx(by_drop.line.resistance_kpa_s_ml, rel=1e-12)


def test_metrics_are_those_of_the_arrays() -> None:
    found = start()
    assert (
        pm.rmse(found.fitted_kpa, found.measured_kpa),
        pm.nrmse(found.fitted_kpa, found.measured_kpa),
    ) == (
        found.rmse_kpa,
        found.nrmse,
    )
    assert pm.pearson(found.fitted_kpa, found.measured_kpa) == found.pearson
    assert found.rmse_kpa == pytest.approx(np.sqrt(np.mean(found.residual_kpa**2)), rel=1e-12)
    assert found.pearson == pytest.approx(np.corrcoef(found.fitted_kpa, found.measured_kpa)[0, 1], rel=1e-12)
    for metric, arguments, message in (
        (pm.rmse, ([], []), "model and measured are empty"),
        (pm.nrmse, ([1, 1], [1, -1]), "its mean is 0"),
        (pm.pearson, ([1, 2], [3, 3]), "does not change"),
        (pm.rmse, ([1, 2], [1]), r"model has shape \[2\] and measured has shape \[1\]"),
        (pm.rmse, ([np.nan], [1]), "model is NaN"),
    ):
        with pytest.raises(ValueError, match=message):
            metric(*arguments)


def test_a_fit_is_a_value() -> None:
    found = start()
    for same in (start(), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert same == found
        assert hash(same) == hash(found)
        assert not same.time_s.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            same.fitted_kpa[0] = 0
    assert found != start(start_angle_rad=0.3)
    assert found != "fit"
    with pytest.raises(AttributeError):
        found.line = pm.Pump.three_roller().outlet  # type: ignore[misc]
    assert json.loads(json.dumps(found.to_dict()))["parameters"]["resistance_kpa_s_ml"]["value"] == (
        found.line.resistance_kpa_s_ml
    )
    assert repr(found).startswith("Identified(line, outlet: resistance_kpa_s_ml=0.149763 ± 0.00091, ")
    assert "± is k = 2" in str(found)


def test_what_is_held_and_what_is_sought_too() -> None:
    pump = pm.Pump.three_roller()
    near = pump.replace(outlet=pump.outlet.replace(resistance_kpa_s_ml=0.15, compliance_ml_kpa=0.03))
    only = start(pump=near, fit=["L"], start_angle_rad=np.radians(17))
    assert only.line.compliance_ml_kpa == 0.03
    assert [name for name, estimate in only.parameters.items() if not estimate.held] == [
        "inertance_kpa_s2_ml"
    ]
    more = start(fit=("R", "C", "L", "reservoir", "start"), start_angle_rad=np.radians(17))
    assert abs(more.line.reservoir_kpa - 88.637) < 2 * more.parameters["reservoir_kpa"].standard
    assert abs(more.parameters["start_s"].value) < 1e-3


def test_a_fit_to_the_wrong_model_is_warned_of_or_refused() -> None:
    told = " ".join(start(speed_rpm=90).warnings)
    assert "the model misses something" in told
    assert "Pearson 0.63" in told
    with pytest.raises(ValueError, match="a constant pressure explains 0"):
        start(pressure_kpa=np.full(301, 150.0))
    with pytest.raises(ValueError, match="the drop is as large at every flow"):
        pm.identify_resistance([5, 6, 7, 8], drop_kpa=[9, 9, 9, 9])


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"speed_rad_s": 1}, "speed_rpm and speed_rad_s are both given"),
        ({"speed_rpm": None}, "no speed is given"),
        ({"pressure_kpa": [1, 2]}, r"pressure_kpa has shape \[2\]; allowed: \(301,\)"),
        ({"time_s": 1.0}, r"time_s has shape \[\]"),
        ({"port": "middle"}, "port is 'middle'; allowed: 'inlet', 'outlet'"),
        ({"begin": "late"}, "begin is 'late'"),
        ({"begin": "steady", "start_s": 0.1}, "start_s is given, but a steady record"),
        ({"fit": ["R", "K"]}, "a name in fit is 'K'"),
        ({"fit": [], "start_angle_rad": 0}, "fit is empty"),
        ({"start_angle_rad": np.inf}, "start_angle_rad is inf"),
        ({"time_s": np.zeros(301)}, r"time_s\[1\] is 0"),
        ({"pressure_kpa": np.full(301, np.nan)}, r"pressure_kpa\[0\] is NaN"),
    ],
)
def test_what_is_not_allowed_is_named(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        start(**changed)


def test_types_that_are_none_are_refused() -> None:
    with pytest.raises(TypeError, match="fit is a text"):
        start(fit="RCL")
    with pytest.raises(TypeError, match="must be a number or an array of numbers"):
        start(pressure_kpa=["88.6"] * 301)
    with pytest.raises(ValueError, match="exactly one of pressure_kpa and drop_kpa"):
        pm.identify_resistance([1, 2, 3])
    with pytest.raises(ValueError, match="total_ml is -1"):
        pm.identify_compliance([0, 1, 2], [88, 90, 92], total_ml=-1)


def test_other_threads_run_during_a_fit() -> None:
    time_s = 2e-4 * np.arange(20_000)
    pump = pm.Pump.three_roller()
    run = pump.simulate(speed_rpm=100, duration_s=time_s[-1], dt_s=2e-4)
    noisy = run.outlet_kpa + np.random.default_rng(1).normal(0, 0.3, len(run.outlet_kpa))
    running = threading.Event()
    fitted = threading.Event()

    def fit() -> None:
        running.set()
        pm.identify_line(pump, time_s=run.time_s, pressure_kpa=noisy, speed_rpm=100, begin="step")
        fitted.set()

    thread = threading.Thread(target=fit)
    thread.start()
    running.wait()
    turns = 0
    while not fitted.is_set():
        turns += 1
    thread.join()
    # Held, the lock would come back once.
    assert turns > 1000


def test_ctrl_c_ends_a_search_within_a_fifth_of_a_second(interruptible: None) -> None:
    pump = pm.Pump.three_roller()
    run = pump.simulate(speed_rpm=100, duration_s=100, dt_s=1e-3)
    rng = np.random.default_rng(3)
    records: list[tuple[NDArray[np.float64], NDArray[np.float64], tuple[pm.choices.LineParameter, ...]]] = [
        (run.time_s, run.outlet_kpa + rng.normal(0, 30, len(run.time_s)), ("R", "C", "L", "start")),
        # A sample a day: the rotor passes millions of edges from one to the next.
        (np.linspace(0, 11 * 86_400, 12), rng.normal(100, 3, 12), ("R", "C", "L")),
    ]
    for time_s, pressure_kpa, fit in records:
        pressed: list[float] = []

        def press(pressed: list[float] = pressed) -> None:
            pressed.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)

        # The first search takes 0.3 s.
        timer = threading.Timer(0.05, press)
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            pm.identify_line(pump, time_s=time_s, pressure_kpa=pressure_kpa, speed_rpm=100, fit=fit)
        answered_s = time.perf_counter() - pressed[0]
        timer.join()
        # A fifth of a second on an idle machine; a busy one may take longer.
        assert answered_s < 0.5


def test_a_reading_that_is_no_number_is_named_by_its_place() -> None:
    for name in ("pressure_kpa", "drop_kpa", "standard_kpa"):
        readings = {"drop_kpa": [1.0, 2.0, 3.0, 4.0], name: [1.0, 2.0, 3.0, np.nan]}
        if name == "pressure_kpa":
            del readings["drop_kpa"]
        with pytest.raises(ValueError, match=rf"^{name}\[3\] is NaN; allowed: a finite number$"):
            pm.identify_resistance([10, 20, 30, 40], **readings)  # type: ignore[arg-type]


def test_a_simulations_own_output_is_found_without_an_uncertainty() -> None:
    pump = pm.Pump.three_roller()
    run = pump.simulate(speed_rpm=100, duration_s=3, dt_s=2e-3)
    found = pm.identify_line(
        pump, time_s=run.time_s, pressure_kpa=run.outlet_kpa, speed_rpm=100, begin="step"
    )
    sought = [estimate for estimate in found.parameters.values() if not estimate.held]
    assert [estimate.standard for estimate in sought] == [0.0] * 4
    assert "± 0" in repr(found)
    assert "<table" in found._repr_html_()
