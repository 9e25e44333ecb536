import numpy as np
import pytest

import pumpmodel as pm


@pytest.fixture(scope="module")
def plan() -> pm.Plan:
    return pm.Doser(pm.Pump.three_roller()).plan("5mL", retract="0.2mL")


def test_steps_of_a_plan_include_those_of_its_retraction(plan: pm.Plan) -> None:
    assert plan.retract_steps < 0
    assert plan.retraction_ml == pytest.approx(0.2, abs=2e-3)
    made = plan.steps
    assert len(plan.step_times_s) == made - plan.retract_steps
    assert (np.diff(plan.step_times_s) > 0).all()
    assert plan.settle_s is not None
    assert plan.step_times_s[made - 1] <= plan.motion_s
    assert plan.step_times_s[made] > plan.motion_s + plan.settle_s
    assert plan.step_times_s[-1] <= plan.settled_s
    assert (plan.step_directions[:made] == 1).all()
    assert (plan.step_directions[made:] == -1).all()
    step_rad = 2 * np.pi / plan.steps_per_rev
    turned = np.diff(plan.step_angles_rad, prepend=plan.start_angle_rad)
    np.testing.assert_allclose(turned, plan.step_directions * step_rad, rtol=1e-6)


def test_the_text_of_a_plan_tells_its_retraction_and_a_start_may_be_none(plan: pm.Plan) -> None:
    assert f"then retract_steps {plan.retract_steps} until settled_s {plan.settled_s:.4f}>" in repr(plan)
    doser = pm.Doser(pm.Pump.three_roller())
    alone = doser.plan("5mL", start_angle_rad=None)
    assert "retract" not in repr(alone)
    assert alone == doser.plan("5mL")


def test_tables_of_a_plan_include_its_retraction(plan: pm.Plan) -> None:
    table = plan.to_dataframe()
    assert list(table["step"]) == list(range(1, len(plan.step_times_s) + 1))
    assert (table["direction"] == plan.step_directions).all()
    assert plan.to_xarray().sizes["time_s"] == len(table)


def test_a_trace_and_a_picture_go_on_until_the_line_has_settled_after_the_retraction(plan: pm.Plan) -> None:
    trace = plan.trace()
    assert trace.time_s[-1] == pytest.approx(plan.settled_s)
    assert trace.delivered_ml[-1] == pytest.approx(plan.planned_ml - plan.retraction_ml, abs=2e-3)
    before = pm.Doser(plan.pump).plan("5mL").trace()
    assert trace.time_s[-1] > before.time_s[-1]
    [axis] = [pm.plot(plan, panels="delivered")]
    assert "sucked back" in axis.get_legend_handles_labels()[1]
    assert axis.get_xlim()[1] == pytest.approx(plan.settled_s)


def test_a_plan_without_a_retraction_has_none_of_its_steps() -> None:
    plan = pm.Doser(pm.Pump.three_roller()).plan("-5mL")
    assert (plan.retract_steps, plan.retraction_ml) == (0, 0)
    assert len(plan.step_times_s) == -plan.steps
    assert (plan.step_directions == -1).all()
    assert plan.settle_s is not None
    assert plan.settled_s == plan.motion_s + plan.settle_s
