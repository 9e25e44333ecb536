"""The next experiment, against the uncertainties of fits that were made."""

import math
from typing import Any, Literal

import numpy as np
import pytest

import pumpmodel as pm

NOISE_KPA = 0.3


def record(pump: pm.Pump, experiment: pm.Experiment, seed: int) -> pm.Identified:
    run = pump.simulate(
        speed_rpm=experiment.speed_rpm, duration_s=experiment.duration_s, dt_s=experiment.dt_s
    )
    noise = np.random.default_rng(seed).normal(0, NOISE_KPA, len(run))
    return pm.identify_line(
        pump,
        time_s=run.time_s,
        pressure_kpa=run.outlet_kpa + noise,
        speed_rpm=experiment.speed_rpm,
        begin="step",
        start_angle_rad=0.0,
    )


def standards(fit: pm.ExpectedFit) -> dict[str, float]:
    return {
        name: getattr(fit, name)
        for name in ("resistance_kpa_s_ml", "compliance_ml_kpa", "inertance_kpa_s2_ml")
    }


@pytest.mark.parametrize("speed_rpm", [40, 110])
def test_a_fit_has_the_uncertainties_that_were_expected(speed_rpm: float) -> None:
    pump = pm.Pump.three_roller()
    experiment = pm.Experiment(speed_rpm=speed_rpm, duration_s=1.5)
    (expected,) = pm.next_experiment(pump, [experiment], standard_kpa=NOISE_KPA)
    found = [record(pump, experiment, seed) for seed in range(4)]
    for name, standard in standards(expected).items():
        stated = np.mean([fit.parameters[name].standard for fit in found])
        assert stated == pytest.approx(standard, rel=0.15), name


def test_the_most_informative_experiment_comes_first() -> None:
    pump = pm.Pump.three_roller()
    candidates = [
        pm.Experiment(speed_rpm=speed, duration_s=duration)
        for speed in (15, 60, 140)
        for duration in (0.3, 2.0)
    ]
    fits = pm.next_experiment(pump, candidates, standard_kpa=NOISE_KPA)
    gains = [fit.gain_nats for fit in fits]
    assert gains == sorted(gains, reverse=True)
    assert {fit.experiment for fit in fits} == set(candidates)
    assert fits[0].experiment.duration_s == 2.0
    # A longer record tells more, at each speed.
    for speed in (15, 60, 140):
        by_duration = {fit.experiment.duration_s: fit for fit in fits if fit.experiment.speed_rpm == speed}
        assert by_duration[2.0].gain_nats > by_duration[0.3].gain_nats


def test_what_is_known_already_is_told_only_once_more() -> None:
    pump = pm.Pump.three_roller()
    experiment = pm.Experiment(speed_rpm=100, duration_s=1)
    known = record(pump, experiment, 7)
    (again,) = pm.next_experiment(pump, [experiment], standard_kpa=NOISE_KPA, known=known)
    # Twice the information on three parameters: 3/2 ln 2, and uncertainties smaller by the root of 2.
    assert again.gain_nats == pytest.approx(1.5 * math.log(2), rel=0.1)
    for name, standard in standards(again).items():
        assert standard == pytest.approx(known.parameters[name].standard / math.sqrt(2), rel=0.15)


def test_what_has_to_be_found_beside_the_line_costs_information() -> None:
    pump = pm.Pump.three_roller()
    experiment = pm.Experiment(speed_rpm=100, duration_s=1, port="inlet", initial="steady")
    sets: list[list[Literal["start_angle", "reservoir"]]] = [[], ["reservoir"], ["reservoir", "start_angle"]]
    gains = [
        pm.next_experiment(pump, [experiment], standard_kpa=NOISE_KPA, unknown=unknown)[0].gain_nats
        for unknown in sets
    ]
    assert gains[0] > gains[1] > gains[2]


def test_wrong_arguments_are_refused_by_name() -> None:
    pump = pm.Pump.three_roller()
    outlet, inlet = (pm.Experiment(speed_rpm=60, duration_s=1, port=port) for port in ("outlet", "inlet"))
    with pytest.raises(ValueError, match="standard_kpa is 0"):
        pm.next_experiment(pump, [outlet], standard_kpa=0)
    with pytest.raises(ValueError, match="candidates are of 2 ports"):
        pm.next_experiment(pump, [outlet, inlet], standard_kpa=1)
    with pytest.raises(ValueError, match="candidates is empty; allowed: one Experiment at least"):
        pm.next_experiment(pump, [], standard_kpa=1)
    with pytest.raises(ValueError, match="'speed'"):
        pm.next_experiment(pump, [outlet], standard_kpa=1, unknown=["speed"])  # type: ignore[list-item]
    known = record(pump, outlet, 1)
    with pytest.raises(ValueError, match="known is of the outlet"):
        pm.next_experiment(pump, [inlet], standard_kpa=1, known=known)


def test_an_experiment_that_cannot_be_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="port is 'in'; allowed: 'inlet', 'outlet'"):
        pm.Experiment(100, 1, port="in")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="initial is 'moving'; allowed: 'rest', 'steady'"):
        pm.Experiment(100, 1, initial="moving")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="speed_rpm must be a number in r/min, not str"):
        pm.Experiment("100", 1)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="duration_s is inf; allowed: a finite number"):
        pm.Experiment(np.float32(100), float("inf"))
    experiment = pm.Experiment(np.float32(100), 1)
    with pytest.raises(TypeError, match="standard_kpa must be a number in kPa, not str"):
        pm.next_experiment(pm.Pump.three_roller(), [experiment], standard_kpa="0.3")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="standard_kpa is 1e-300; allowed: 1e-9 to 1e9"):
        pm.next_experiment(pm.Pump.three_roller(), [experiment], standard_kpa=1e-300)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"duration_s": -1}, "duration_s is -1; allowed: a positive number in s"),
        ({"dt_s": 0}, "dt_s is 0; allowed: a positive number in s"),
        ({"dt_s": 2}, "dt_s is 2; allowed: more than 0, duration_s at most"),
        ({"speed_rpm": 0}, "speed_rpm is 0; allowed: a finite speed other than 0"),
    ],
)
def test_an_experiment_that_cannot_be_made_is_refused_at_once(keywords: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        pm.Experiment(**{"speed_rpm": 60, "duration_s": 1, **keywords})
