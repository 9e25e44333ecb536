import math
import sys

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from numpy.typing import NDArray

import pumpmodel as pm

Array = NDArray[np.float64]


def curve(axis: Axes, label: str) -> tuple[Array, Array]:
    (line,) = [line for line in axis.lines if line.get_label() == label]
    return np.asarray(line.get_xdata()), np.asarray(line.get_ydata())


def test_a_run_is_drawn_as_it_is() -> None:
    run = pm.Pump.three_roller().simulate(speed_rpm=100, duration_s=0.5)
    flow, pressure, delivered = pm.plot(run)
    for axis, label, column in (
        (flow, "inlet", run.inlet_flow_ml_s),
        (flow, "outlet", run.outlet_flow_ml_s),
        (pressure, "inlet", run.inlet_kpa),
        (pressure, "outlet", run.outlet_kpa),
        (delivered, "vessel", run.delivered_ml),
    ):
        x, y = curve(axis, label)
        np.testing.assert_array_equal(x, run.time_s)
        np.testing.assert_array_equal(y, column)
    labels = [axis.get_ylabel() for axis in (flow, pressure, delivered)]
    assert labels == ["flow at the rollers\n(mL/s)", "pressure\n(kPa absolute)", "delivered\n(mL)"]
    assert delivered.get_xlabel() == "time (s)"


def test_a_plan_is_drawn_with_its_end_and_what_was_asked_for() -> None:
    plan = pm.Doser(pm.Pump.three_roller()).plan("25mL", rate="10 mL/s", carry_in_ml=0.5)
    axes = pm.plot(plan)
    assert len(axes) == 4
    trace = plan.trace()
    _, rpm = curve(axes[2], "pump head")
    np.testing.assert_allclose(rpm, trace.speed_rad_s * 60 / math.tau)
    assert rpm.max() == pytest.approx(plan.cruise_speed_rpm)
    for axis in axes:
        assert list(curve(axis, "last step")[0]) == [plan.motion_s, plan.motion_s]
    assert list(curve(axes[3], "asked for")[1]) == [25.5, 25.5]
    assert axes[0].get_title() == "McIntyre et al., 3 rollers: 25.50 mL at 10 mL/s"


def test_a_plan_of_hours_is_drawn_by_its_extremes() -> None:
    plan = pm.Doser(pm.Pump.three_roller()).plan("20L")
    assert plan.motion_s > 3600
    delivered, pressure = pm.plot(plan, panels=["delivered", "pressure"])
    x, y = curve(delivered, "vessel")
    assert len(x) < 20_010
    assert y[-1] == pytest.approx(20_000, abs=0.01)
    # The solution's own extremes: a hundred thousand samples miss them by 1 kPa.
    assert curve(pressure, "outlet")[1].max() == pytest.approx(plan.outlet_max_kpa, abs=0.01)
    assert curve(pressure, "inlet")[1].min() == pytest.approx(plan.inlet_min_kpa, abs=0.01)


def test_panels_are_chosen_and_drawn_where_told() -> None:
    run = pm.Pump.three_roller().simulate(speed_rpm=100, duration_s=0.1)
    figure, (left, right) = plt.subplots(1, 2)
    assert pm.plot(run, panels="pressure", ax=left) is left
    assert pm.plot(run, panels=["speed"], ax=[right]) == [right]
    assert plt.get_fignums() == [figure.number]
    assert len(left.lines) == 2
    assert curve(right, "pump head")[1][0] == pytest.approx(100)
    with pytest.raises(ValueError, match="panels is 'pressures'; allowed: flow, pressure, speed, delivered"):
        pm.plot(run, panels="pressures")  # type: ignore[call-overload]
    with pytest.raises(ValueError, match="2 axes for 3 panels"):
        pm.plot(run, ax=[left, right])
    with pytest.raises(TypeError, match="a Run or a Plan can be plotted, not Pump"):
        pm.plot(pm.Pump.three_roller())  # type: ignore[call-overload]


def mesh(axis: Axes) -> QuadMesh:
    (found,) = [one for one in axis.collections if isinstance(one, QuadMesh)]
    return found


def test_a_map_has_a_cell_for_each_pump_and_speed() -> None:
    three = pm.Pump.three_roller()
    # Out of order on purpose: cells stand where their numbers say.
    sweep = pm.sweep([three.replace(rollers=count) for count in (4, 2, 3)], speed_rpm=[100, 50, 150, 20])
    axis = pm.plot_map(sweep, "inlet_min_kpa")
    cells = mesh(axis)
    corners = np.asarray(cells.get_coordinates(), dtype=np.float64)
    middles = (corners[1:, 1:] + corners[:-1, :-1]) / 2
    values = np.asarray(cells.get_array()).reshape(3, 4)
    assert values[1, 2] == sweep.inlet_min_kpa[2, 0]
    np.testing.assert_allclose(middles[:, 0, 1], [2, 3, 4])
    np.testing.assert_allclose(corners[0, :, 0], [5, 35, 75, 125, 175])
    for row, rollers in enumerate((2, 3, 4)):
        alone = three.replace(rollers=rollers).steady_state(speed_rpm=[20, 50, 100, 150])
        np.testing.assert_array_equal(values[row], alone.inlet_min_kpa)
    assert (axis.get_xlabel(), axis.get_ylabel()) == ("speed (r/min)", "rollers")
    assert cells.colorbar
    assert cells.colorbar.ax.get_ylabel() == "smallest inlet pressure, absolute (kPa)"


def test_a_map_of_numbers_of_ones_own_needs_their_names() -> None:
    pump = pm.Pump.three_roller()
    sweep = pm.sweep([pump, pump], speed_rpm=[50, 100])
    swing = sweep.outlet_max_kpa - sweep.outlet_min_kpa
    axis = pm.plot_map(sweep, swing, label="swing (kPa)", y=[0.3, 0.1], y_label="length (m)")
    np.testing.assert_array_equal(np.asarray(mesh(axis).get_array()).ravel(), swing[::-1].ravel())
    assert axis.get_ylabel() == "length (m)"
    assert pm.plot_map(sweep).get_ylabel() == "pump"
    assert np.shape(mesh(pm.plot_map(pm.sweep(pump, speed_rpm=50))).get_coordinates()) == (2, 2, 2)
    with pytest.raises(ValueError, match="label is missing"):
        pm.plot_map(sweep, swing)
    with pytest.raises(ValueError, match="y_label is missing"):
        pm.plot_map(sweep, y=[1, 2])
    with pytest.raises(ValueError, match=r"y has shape \(3,\); allowed: \(2,\)"):
        pm.plot_map(sweep, y=[1, 2, 3], y_label="length (m)")
    with pytest.raises(ValueError, match=r"quantity has shape \(1, 2\)"):
        pm.plot_map(sweep, swing[:1], label="swing (kPa)")
    with pytest.raises(ValueError, match="quantity is 'swing'; allowed: inlet_min_kpa, "):
        pm.plot_map(sweep, "swing")
    with pytest.raises(ValueError, match=r"the sweep has shape \(0, 1\)"):
        pm.plot_map(pm.sweep([], speed_rpm=50))


def circles(axis: Axes) -> dict[str, Array]:
    return {
        str(patch.get_label()): np.array(patch.center)
        for patch in axis.patches
        if isinstance(patch, mpl.patches.Circle)
    }


def test_a_map_of_steady_states_is_a_row() -> None:
    pump = pm.Pump.three_roller()
    steady = pump.steady_state(speed_rpm=[100, 50, 150])
    axis = pm.plot_map(steady, "outlet_max_kpa")
    row = mesh(axis)
    assert (
        np.asarray(row.get_array()).ravel().tolist() == np.asarray(steady.outlet_max_kpa)[[1, 0, 2]].tolist()
    )
    assert axis.get_xlabel() == "speed (r/min)"
    assert (axis.get_ylabel(), list(axis.get_yticks())) == ("", [])
    with pytest.raises(ValueError, match=r"speeds of shape \(\); allowed: \(n,\)"):
        pm.plot_map(pump.steady_state(speed_rpm=50))
    with pytest.raises(ValueError, match=r"of the sweep, \(3,\)"):
        pm.plot_map(steady, [1.0, 2.0], label="swing (kPa)")


def test_rollers_stand_where_the_angle_says() -> None:
    pump = pm.Pump.three_roller()
    for angle in (0.0, 0.9, -2.0, 20.0):
        drawn = circles(pm.plot_pump(pump, angle))
        for number in range(3):
            # At angle 0 the first begins to leave, where the arc of 180 + 2 beta ends: at beta on the right.
            polar = math.radians(30) + angle + number * pump.pitch_rad
            expected = 40 * np.array([math.cos(polar), math.sin(polar)])
            np.testing.assert_allclose(drawn[f"roller {number}"], expected, atol=1e-9)


def tube(axis: Axes) -> tuple[Array, Array, Array]:
    """The backplate's points, and what is left there of the tube's and of its bore's diameter."""
    lines = {name: np.array(curve(axis, name)) for name in ("backplate", "tube, inner side")}
    sides = [np.array(curve(axis, f"lumen, {side} side")) for side in ("outer", "inner")]
    thickness = np.hypot(*(lines["tube, inner side"] - lines["backplate"]))
    return lines["backplate"].T, thickness, np.hypot(*(sides[1] - sides[0]))


def test_the_tube_is_closed_under_a_roller_and_round_elsewhere() -> None:
    pump = pm.Pump.three_roller()
    plate, thickness, lumen = tube(pm.plot_pump(pump))
    assert thickness.max() == pytest.approx(14)
    assert lumen.max() == pytest.approx(10)
    # The rollers leave r_b - r_offset - r_roller, less than the two walls.
    assert thickness.min() == pytest.approx(3, abs=1e-3)
    under = np.argmin(np.hypot(*(plate - [0, -63]).T))
    assert (thickness[under], lumen[under]) == (pytest.approx(3, abs=1e-3), 0)


def test_the_squeeze_that_is_drawn_displaces_the_drawings_volume() -> None:
    plate, _, lumen = tube(pm.plot_pump(pm.Pump.three_roller()))
    step = np.hypot(*np.gradient(plate, axis=0).T) * (63 - 7) / 63
    bottom = plate[:, 1] < -25
    # A flattened bore of constant perimeter loses pi h^2/4; V_r of these dimensions is 2.2267 mL.
    volume_ml = (math.pi / 4 * (10 - lumen) ** 2 * step)[bottom].sum() / 1000
    assert volume_ml == pytest.approx(2.2267, abs=2e-3)


def test_angles_are_marked_with_their_size() -> None:
    pump = pm.Pump.three_roller()
    axis = pm.plot_pump(pump, 0.5)
    for name, size, radius in (
        ("beta", math.radians(30), 73),
        ("phi, leaving", math.radians(50.53), 49),
        ("phi, engaging", math.radians(50.53), 49),
        ("psi", math.radians(69.47), 54),
        ("pitch", math.radians(120), 12),
        ("theta", 0.5, 22),
    ):
        x, y = curve(axis, name)
        np.testing.assert_allclose(np.hypot(x, y), radius)
        turned = np.unwrap(np.arctan2(y, x))
        assert turned[-1] - turned[0] == pytest.approx(size), name
    written = {text.get_text() for text in axis.texts}
    assert {"β 30°", "φ 50.53°", "ψ 69.47°", "pitch 120°", "θ 28.65°", "inlet", "outlet"} <= written
    # By the names of the options of `dose pumps new`, and by their symbols.
    assert {
        r"tube 10 x 14 mm, $r_\mathrm{o}$ 7 mm",
        r"backplate $r_\mathrm{b}$ 63 mm",
        r"roller $r_\mathrm{roller}$ 20 mm",
        r"offset $r_\mathrm{offset}$ 40 mm",
    } <= written
    # The inlet phase leads from where a roller begins to leave to where it begins to engage.
    psi, engaging = (np.arctan2(*curve(axis, name)[::-1]) for name in ("psi", "phi, engaging"))
    assert (psi[0], psi[-1]) == (pytest.approx(math.radians(30)), pytest.approx(engaging[0]))
    _, axes = plt.subplots()
    assert pm.plot_pump(pump, ax=axes) is axes
    assert "θ" not in " ".join(text.get_text() for text in axes.texts)
    with pytest.raises(ValueError, match="angle_rad is nan"):
        pm.plot_pump(pump, math.nan)
    with pytest.raises(TypeError, match="pump must be a Pump, not str"):
        pm.plot_pump("three-roller")  # type: ignore[arg-type]


def test_without_matplotlib_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    pump = pm.Pump.three_roller()
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    message = r'matplotlib is not installed; .*: pip install "./crates/pump-py\[plot\]"'
    with pytest.raises(ImportError, match=message):
        pm.plot_pump(pump)
    with pytest.raises(ImportError, match=message):
        pm.plot(pump.simulate(speed_rpm=100, duration_s=0.1))
    with pytest.raises(ImportError, match=message):
        pm.plot_map(pm.sweep(pump, speed_rpm=[50, 100]))
