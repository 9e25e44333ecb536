import math
import pickle

import numpy as np
import pytest
from drawn import line, results, runs, verification
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

import pumpmodel as pm
from pumpmodel.plotting.axes import BLUE, VERMILION
from pumpmodel.plotting.calibration import run_factors
from pumpmodel.plotting.envelope import envelope

Array = NDArray[np.float64]
DRAWN = list(results())


def curve(axis: Axes, label: str) -> tuple[Array, Array]:
    (found,) = [one for one in axis.lines if one.get_label() == label]
    return np.asarray(found.get_xdata()), np.asarray(found.get_ydata())


def axes_of(drawn: Axes | list[Axes]) -> list[Axes]:
    return drawn if isinstance(drawn, list) else [drawn]


@pytest.mark.parametrize("name", DRAWN)
def test_every_result_has_a_picture_that_names_its_axes(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plt, "show", lambda: pytest.fail("a window opens"))
    axes = axes_of(results()[name].plot())
    assert axes[-1].get_xlabel()
    assert all(axis.get_ylabel() or name in ("plan", "dose", "expected fit") for axis in axes)
    axes[0].figure.canvas.draw()


@pytest.mark.parametrize("name", [name for name in DRAWN if name != "pulsation"])
def test_every_picture_is_drawn_into_axes_that_are_given(name: str) -> None:
    figure, axis = plt.subplots()
    extra = {"panels": "pressure"} if name in ("run", "long run", "plan") else {}
    assert axes_of(results()[name].plot(ax=axis, **extra)) == [axis]
    assert plt.get_fignums() == [figure.number]


@pytest.mark.parametrize("name", DRAWN)
@pytest.mark.parametrize("style", ["default", "dark_background"])
def test_every_word_stands_out_from_what_is_behind_it(name: str, style: str) -> None:
    with plt.style.context(style):
        axes = axes_of(results()[name].plot())

    def brightness(colour: object) -> float:
        return float(np.dot((0.2126, 0.7152, 0.0722), to_rgb(colour)))  # type: ignore[arg-type]

    for axis in axes:
        # Out of the styles' context, colours of the axes hold.
        behind = brightness(axis.get_facecolor()[:3])
        for text in (*axis.texts, axis.title, axis.xaxis.label, axis.yaxis.label):
            box = text.get_bbox_patch()
            under = behind if box is None else brightness(box.get_facecolor()[:3])
            assert abs(brightness(text.get_color()) - under) > 0.15, text.get_text()


def test_a_long_run_keeps_the_extremes_of_every_column() -> None:
    run = pm.Pump.three_roller().simulate(speed_rpm=100, duration_s=60)
    assert len(run) > 20_000
    flow, pressure, _ = pm.plot(run)
    for axis, label, column in (
        (flow, "inlet", run.inlet_flow_ml_s),
        (pressure, "inlet", run.inlet_kpa),
        (pressure, "outlet", run.outlet_kpa),
    ):
        x, y = curve(axis, label)
        assert len(x) <= 20_000
        assert (y.min(), y.max()) == (column.min(), column.max())
        # Each column of pixels of a picture 700 pixels wide.
        edges = np.linspace(0, run.time_s[-1], 701)
        all_at, drawn_at = (np.searchsorted(times, edges) for times in (run.time_s, x))
        for column_of in range(700):
            whole = column[all_at[column_of] : all_at[column_of + 1]]
            kept = y[drawn_at[column_of] : drawn_at[column_of + 1]]
            # Columns of the envelope are narrower than those of the picture, and may cross their edges.
            assert kept.max() <= whole.max()
            inner = column[all_at[column_of] + 12 : all_at[column_of + 1] - 12]
            assert (kept.min() <= inner.min(), kept.max() >= inner.max()) == (True, True)


def test_one_sample_that_stands_out_of_a_million_is_drawn() -> None:
    x, y = np.arange(1e6), np.zeros(1_000_000)
    y[123_457], y[654_321] = 7, -3
    kept_x, kept_y = envelope(x, y)
    assert len(kept_x) <= 20_000
    assert (kept_x[kept_y.argmax()], kept_y.max()) == (123_457, 7)
    assert (kept_x[kept_y.argmin()], kept_y.min()) == (654_321, -3)
    assert (kept_x[0], kept_x[-1]) == (0, 999_999)
    assert np.all(np.diff(kept_x) > 0)
    assert envelope(x[:20_000], y[:20_000])[0] is not kept_x
    np.testing.assert_array_equal(envelope(x[:20_000], y[:20_000])[0], x[:20_000])


def test_steady_states_are_drawn_with_their_range() -> None:
    steady = pm.Pump.three_roller().steady_state(speed_rpm=[100, 50, 150])
    pressure, flow, ripple = steady.plot()
    rpm, mean = curve(pressure, "outlet, mean\nand range")
    assert rpm.tolist() == [50, 100, 150]
    np.testing.assert_array_equal(mean, np.asarray(steady.outlet_mean_kpa)[[1, 0, 2]])
    inlet, outlet = (np.asarray(band.get_paths()[0].vertices) for band in pressure.collections)
    assert (inlet[:, 1].min(), outlet[:, 1].max()) == (steady.inlet_min_kpa[2], steady.outlet_max_kpa[2])
    assert flow.get_ylabel() == "mean flow\n(mL/s)"
    assert curve(ripple, "peak to peak")[1] == pytest.approx(100 * np.asarray(steady.ripple_peak_to_peak))
    with pytest.raises(ValueError, match="2 axes for 3 panels"):
        steady.plot(ax=[pressure, flow])
    with pytest.raises(ValueError, match="no speeds"):
        pm.Pump.three_roller().steady_state(speed_rpm=[]).plot()


def test_an_identified_line_is_drawn_with_what_was_measured_and_what_is_left() -> None:
    for port, colour in (("inlet", BLUE), ("outlet", VERMILION)):
        found = line(port)
        fit, residual = found.plot()
        np.testing.assert_array_equal(curve(fit, "measured")[1], found.measured_kpa)
        np.testing.assert_array_equal(curve(fit, f"{port}, fitted")[1], found.fitted_kpa)
        np.testing.assert_array_equal(np.asarray(residual.lines[0].get_ydata()), found.residual_kpa)
        assert [one.get_color() for one in fit.lines][1] == colour
        assert "kPa s/mL" in fit.get_title()


def test_a_calibration_is_drawn_with_its_band_and_each_run() -> None:
    pump = pm.Pump.three_roller()
    calibration = pm.Calibration.from_runs(pump, runs())
    axis = calibration.plot(pump=pump)
    rpm, factor = curve(axis, "factor")
    np.testing.assert_array_equal(factor, calibration.displacement_factor(speed_rpm=rpm))
    (band,) = axis.collections
    corners = np.asarray(band.get_paths()[0].vertices)
    at_least = factor[0] - 2 * calibration.standard_uncertainty(speed_rpm=rpm[0])
    assert corners[corners[:, 0] == rpm[0], 1].min() == at_least
    # Water of 25 °C at 85.7 kPa has 1.0038 mL for each gram that a scale shows (ISO 8655-6).
    expected = [1.0038 * (run.mass_g or 0) / 2 / pump.volume_per_revolution_ml for run in runs()]
    factors = run_factors(calibration, pump)
    assert [factor for _, factor in factors] == pytest.approx(expected, abs=1e-4)
    points = [one for one in axis.lines if one.get_label() in ("run", "outlier")]
    assert sum(len(np.asarray(one.get_xdata())) for one in points) == len(runs())
    assert not [one for one in calibration.plot().lines if one.get_label() == "run"]


def test_a_budget_has_a_bar_for_each_source_that_contributes() -> None:
    plan = results()["plan"]
    for dose in (plan, results()["dose"]):
        axis = pm.plot_budget(dose)
        expected = sorted(
            share["standard_ml"] for share in plan.uncertainty_budget if share["standard_ml"] > 0
        )
        widths = [bar.get_width() for bar in axis.patches]  # type: ignore[attr-defined]
        assert widths == pytest.approx(expected)
        assert len(axis.get_yticklabels()) == len(expected)
        assert "(mL)" in axis.get_xlabel()


def test_a_verification_is_drawn_with_what_is_allowed() -> None:
    axis = verification().plot()
    assert curve(axis, "dose")[1].tolist() == [10.01, 9.98, 10.04, 10.02]
    (allowed,) = [band for band in axis.patches if band.get_label() == "mean allowed"]
    box = allowed.get_extents().transformed(axis.transData.inverted())
    assert (box.y0, box.y1) == (pytest.approx(9.94), pytest.approx(10.06))
    expected = "not passed: systematic 0.12 % (±0.6 allowed), random 0.25 % (0.2 allowed)"
    assert axis.get_title() == expected


def test_one_pitch_is_drawn_at_both_ports() -> None:
    pump = pm.Pump.three_roller()
    axis = pm.plot_pitch(pump)
    deg, flow = curve(axis, "outlet")
    assert (deg[0], deg[-1]) == (0, pytest.approx(120))
    np.testing.assert_array_equal(flow, pump.outlet_flow_ml_rad(np.linspace(0, pump.pitch_rad, len(deg))))
    assert curve(axis, "mean")[1][0] == pytest.approx(21.3185 / math.tau, abs=1e-4)
    assert axis.get_ylim()[0] == 0


@pytest.mark.parametrize(("volume_ml", "percent"), [(1, 81.7), (5, 26.0), (25, 4.4)])
def test_the_error_of_a_dose_by_one_constant_is_the_known_one(volume_ml: float, percent: float) -> None:
    axis = pm.plot_dose_error(pm.Pump.three_roller(), volume_ml)
    assert np.abs(curve(axis, f"{volume_ml} mL")[1]).max() == pytest.approx(percent, abs=0.05)
    for wrong in (0, math.inf):
        with pytest.raises(ValueError, match="allowed: a finite volume, not 0"):
            pm.plot_dose_error(pm.Pump.three_roller(), [1, wrong])


def test_a_spectrum_has_the_amplitudes_at_their_frequencies() -> None:
    found = pm.Pump.three_roller().harmonics(5, speed_rpm=100)
    flow, pressure = found.plot()
    # Three rollers at 100 r/min: 5 Hz and its multiples.
    x, y = (np.asarray(data) for data in pressure.lines[0].get_data())
    assert x.tolist() == pytest.approx([5, 10, 15, 20, 25])
    np.testing.assert_array_equal(y, abs(found.pressure_kpa))
    assert flow.get_ylabel() == "flow at the rollers,\namplitude (mL/s)"


def test_a_roller_volume_is_drawn_through_its_points() -> None:
    fit = pm.VolumeFit(
        [0, 10, 20, 30, 40, 50] * 2, [0, 0.23, 0.83, 1.49, 1.96, 2.1] * 2, run=["a"] * 6 + ["b"] * 6
    )
    axis = fit.plot()
    assert curve(axis, "run b")[1].tolist() == list(fit.volume_ml[6:])
    deg, volume_ml = curve(axis, "spline fit")
    assert np.interp(30, deg, volume_ml) == pytest.approx(1.49, abs=1e-3)
    assert axis.get_title() == "2.1 mL over 50°, residuals 0 µL RMS"


def test_a_function_is_drawn_as_a_curve_beside_its_fit() -> None:
    fit = results()["function"]
    axis = fit.plot()
    angle_deg, volume_ml = curve(axis, "function")
    np.testing.assert_array_equal(angle_deg, fit.angle_deg)
    np.testing.assert_array_equal(volume_ml, fit.volume_ml)
    assert {line.get_linestyle() for line in axis.lines} == {"-", "--"}
    assert {line.get_marker() for line in axis.lines} == {"None"}
    loaded = pickle.loads(pickle.dumps(fit))
    assert [line.get_label() for line in loaded.plot().lines] == ["spline fit", "function"]


def test_sensitivities_are_drawn_by_parameter_and_port() -> None:
    found = results()["sensitivity"]
    axes = found.plot()
    assert len(axes) == 5
    for row, axis in enumerate(axes):
        np.testing.assert_array_equal(axis.lines[0].get_ydata(), found.inlet_kpa_by[row])
        np.testing.assert_array_equal(axis.lines[1].get_ydata(), found.outlet_kpa_by[row])


def test_an_expected_fit_has_a_bar_for_each_parameter() -> None:
    fit = results()["expected fit"]
    outlet = pm.Pump.three_roller().outlet
    widths = [bar.get_width() for bar in fit.plot().patches][::-1]
    expected = [
        100 * fit.resistance_kpa_s_ml / outlet.resistance_kpa_s_ml,
        100 * fit.compliance_ml_kpa / outlet.compliance_ml_kpa,
        100 * fit.inertance_kpa_s2_ml / outlet.inertance_kpa_s2_ml,
    ]
    np.testing.assert_allclose(widths, expected, rtol=1e-12)
    assert pm.ExpectedFit.from_dict(fit.to_dict()) == fit


def test_a_polynomial_is_drawn_with_the_stretches_where_it_is_held() -> None:
    volume = pm.VolumePolynomial([-1.0e-4, 0.006, 0, 0], 50)
    axis = volume.plot()
    assert len(axis.patches) == len(volume.held_deg) == 1
    angle_deg, drawn_ml = curve(axis, "polynomial of\norder 3")
    np.testing.assert_array_equal(drawn_ml, volume.displaced_ml(np.radians(angle_deg)))
