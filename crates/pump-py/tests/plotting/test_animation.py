from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.patches import Circle
from PIL import Image

import pumpmodel as pm


def first_roller_deg(animation: Any) -> float:
    head = animation._fig.axes[0]
    (roller,) = [
        patch for patch in head.patches if isinstance(patch, Circle) and patch.get_label() == "roller 0"
    ]
    return float(np.degrees(np.arctan2(*roller.center[::-1])))


def test_an_animation_turns_the_rollers_and_moves_the_pressures(tmp_path: Path) -> None:
    pump = pm.Pump.three_roller()
    run = pump.simulate(speed_rpm=60, duration_s=0.4)
    animation: Any = pump.animate(run, frames_per_s=5)
    angles, moments = [], []
    for frame in range(3):
        animation._func(frame)
        angles.append(first_roller_deg(animation))
        dot = animation._fig.axes[1].lines[2]
        moments.append((float(dot.get_xdata()[0]), float(dot.get_ydata()[0])))
    # At 60 r/min the head turns by 72 deg in 0.2 s.
    assert angles == pytest.approx([30, 102, 174], abs=0.01)
    assert [time_s for time_s, _ in moments] == [run.time_s[row] for row in (0, 200, 400)]
    assert [kpa for _, kpa in moments] == pytest.approx(run.inlet_kpa[[0, 200, 400]])
    file = tmp_path / "head.gif"
    animation.save(file, writer="pillow", dpi=40)
    with Image.open(file) as picture:
        assert (picture.format, getattr(picture, "n_frames", 1)) == ("GIF", 3)


def test_a_plan_is_animated_until_it_has_settled() -> None:
    plan = pm.Doser(pm.Pump.three_roller()).plan("1mL", start_angle_rad=0.0)
    page = plan.animate(frames_per_s=4).to_jshtml()
    assert page.count("data:image/png") == int(np.ceil(plan.settled_s * 4)) + 1
    assert plan.settled_s < 1


def test_an_animation_that_is_no_use_is_refused() -> None:
    pump = pm.Pump.three_roller()
    run = pump.simulate(speed_rpm=60, duration_s=100, dt_s=0.1)
    with pytest.raises(ValueError, match=r"has 2,501 frames; allowed: at most 2,000"):
        pump.animate(run)
    with pytest.raises(ValueError, match="slower is 0; allowed: a finite number above 0"):
        pump.animate(run, slower=0)
    with pytest.raises(TypeError, match="a Run or a Plan can be animated, not Pump"):
        pm.animate(pump, pump)  # type: ignore[arg-type]
