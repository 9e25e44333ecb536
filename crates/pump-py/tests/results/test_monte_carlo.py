import math

import numpy as np
import pytest
from matplotlib.axes import Axes

import pumpmodel as pm

PUMP = pm.Pump.three_roller()


def plan(volume: str, start_angle_rad: float, half_width_rad: float) -> pm.Plan:
    return pm.Doser(PUMP).plan(
        volume, rate="5mL/s", start_angle_rad=start_angle_rad, start_half_width_rad=half_width_rad
    )


@pytest.mark.parametrize(
    ("volume", "start_rad", "half_width_rad"),
    [("25mL", 0.3, 0.0), ("1mL", 0.3, 0.02), ("0.2mL", 0.5, 0.03), ("-5mL", 0.2, 0.02), ("25mL", 0.3, 10.0)],
)
def test_the_trials_have_the_standard_uncertainty_of_the_budget(
    volume: str, start_rad: float, half_width_rad: float
) -> None:
    planned = plan(volume, start_rad, half_width_rad)
    drawn = pm.monte_carlo(planned, trials=100_000, seed=7)
    # The standard deviation of 100,000 trials is known to 0.22 %.
    assert drawn.standard_ml == pytest.approx(drawn.budget_standard_ml, rel=0.01)
    within = np.abs(drawn.volume_ml - planned.planned_ml) <= planned.expanded_uncertainty_ml
    # The budget of an angle that is not stated covers more.
    most = 0.957 if half_width_rad < 0.04 else 1.0
    assert 0.953 < within.mean() < most


def test_a_start_angle_on_the_edge_of_a_pulse_makes_volumes_on_one_side() -> None:
    # A pulse begins at angle 0: before it the flow is level, after it the flow falls.
    planned = plan("1mL", 0.0, 0.03)
    drawn = pm.monte_carlo(planned, trials=200_000, seed=7)
    turn_rad = planned.end_angle_rad - planned.start_angle_rad
    starts = np.linspace(-0.03, 0.03, 20_001)
    exact_ml = PUMP.outlet_volume_ml(starts + turn_rad) - PUMP.outlet_volume_ml(starts)
    chance_ml = drawn.standard_ml / math.sqrt(200_000)
    assert drawn.mean_ml == pytest.approx(float(exact_ml.mean()), abs=4 * chance_ml)


def test_trials_repeat_by_their_seed_alone() -> None:
    planned = plan("5mL", 0.3, 0.02)
    once, again, other = (pm.monte_carlo(planned, trials=1000, seed=seed).volume_ml for seed in (1, 1, 2))
    assert np.array_equal(once, again)
    assert not np.array_equal(once, other)
    assert not once.flags.writeable


def test_the_interval_is_the_shortest_that_covers_the_part_asked_for() -> None:
    drawn = pm.monte_carlo(plan("5mL", 0.3, 0.02), trials=20_000, seed=3)
    least_ml, most_ml = drawn.interval_ml(0.5)
    inside = (drawn.volume_ml >= least_ml) & (drawn.volume_ml <= most_ml)
    assert inside.sum() == 10_000
    # Half of a normal distribution lies within 0.6745 standard deviations.
    assert most_ml - least_ml == pytest.approx(2 * 0.6745 * drawn.standard_ml, rel=0.05)
    for coverage in (0.0, 1.0, math.nan):
        with pytest.raises(ValueError, match="coverage is"):
            drawn.interval_ml(coverage)


def test_trials_out_of_range_are_refused_by_name() -> None:
    planned = plan("5mL", 0.3, 0.0)
    for trials in (1, 0, 10_000_001):
        with pytest.raises(ValueError, match=r"trials is .*allowed: 2 to 10,000,000"):
            pm.monte_carlo(planned, trials=trials)
    with pytest.raises(TypeError, match="trials must be a whole number, not float"):
        pm.monte_carlo(planned, trials=1e3)  # type: ignore[arg-type]


def test_trials_have_a_picture_and_a_table() -> None:
    drawn = pm.monte_carlo(plan("5mL", 0.3, 0.02), trials=5000, seed=3)
    axis = drawn.plot()
    assert isinstance(axis, Axes)
    assert axis.get_xlabel() == "volume (mL)"
    assert "expanded uncertainty by the budget" in drawn._repr_html_()
    assert repr(drawn).startswith("VolumeTrials(5000 trials, mean ")
