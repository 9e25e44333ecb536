import copy
import math
import pickle
import timeit
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
from numpy.typing import NDArray

import pumpmodel as pm
from pumpmodel.choices import Begin

Array = NDArray[np.float64]
NOISE_KPA = 0.3


def measured(seed: int = 1) -> tuple[pm.Pump, Array, Array]:
    """Return a pump, times and noisy pressures of a line with another C."""
    pump = pm.Pump.three_roller()
    real = pump.replace(outlet=pump.outlet.replace(compliance_ml_kpa=0.03))
    run = real.simulate(speed_rpm=100, duration_s=1, dt_s=2e-3)
    noise_kpa = np.random.default_rng(seed).normal(0, NOISE_KPA, len(run))
    return pump, run.time_s, run.outlet_kpa + noise_kpa


def test_the_diagonal_of_the_covariance_has_the_standard_uncertainties() -> None:
    pump, time_s, pressure_kpa = measured()
    found = pm.identify_line(
        pump,
        time_s=time_s,
        pressure_kpa=pressure_kpa,
        speed_rpm=100,
        begin="step",
        fit=("R", "C", "L", "reservoir"),
    )
    assert found.covariance_names == (
        "resistance_kpa_s_ml",
        "compliance_ml_kpa",
        "inertance_kpa_s2_ml",
        "reservoir_kpa",
        "start_angle_deg",
    )
    sought = [estimate.standard for estimate in found.parameters.values() if not estimate.held]
    assert found.covariance.shape == (5, 5)
    np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), sought, rtol=1e-9)
    np.testing.assert_allclose(found.covariance, found.covariance.T, rtol=1e-9)
    assert np.all(np.linalg.eigvalsh(found.covariance) > 0)
    with pytest.raises(ValueError, match="read-only"):
        found.covariance[0, 0] = 1
    again = pickle.loads(pickle.dumps(found))
    assert again == found
    np.testing.assert_array_equal(again.covariance, found.covariance)
    assert again.covariance_names == found.covariance_names
    assert copy.deepcopy(found) == found


def test_the_covariance_is_that_of_many_records() -> None:
    fits = []
    for seed in range(60):
        pump, time_s, pressure_kpa = measured(seed)
        found = pm.identify_line(
            pump, time_s=time_s, pressure_kpa=pressure_kpa, speed_rpm=100, begin="step", start_angle_rad=0.0
        )
        line = found.line
        fits.append([line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml])
    assert found.covariance_names == ("resistance_kpa_s_ml", "compliance_ml_kpa", "inertance_kpa_s2_ml")
    scatter = np.cov(np.array(fits).T)
    # A variance of 60 records is known to a fifth, a correlation to an eighth.
    np.testing.assert_allclose(np.diag(found.covariance) / np.diag(scatter), 1, atol=0.8)
    correlation = scatter[0, 1] / math.sqrt(scatter[0, 0] * scatter[1, 1])
    covariance = found.covariance
    ours = covariance[0, 1] / math.sqrt(covariance[0, 0] * covariance[1, 1])
    assert ours == pytest.approx(correlation, abs=0.4)


def test_rounded_times_and_gaps_cost_a_likelihood_little() -> None:
    pump = pm.Pump.three_roller()
    even = np.arange(1000) / 300
    uneven = np.sort(np.random.default_rng(1).uniform(0, even[-1], 1000))

    def best_s(times: Array) -> float:
        kpa = 90 + np.sin(31 * times)
        likelihood = pm.LineLikelihood(
            pump, time_s=times, pressure_kpa=kpa, standard_kpa=1, speed_rpm=100, begin="step"
        )
        return min(timeit.repeat(likelihood.log_likelihood, number=1, repeat=300))

    quick_s = best_s(even)
    for times in (uneven, even.round(4), even.round(6), even.astype(np.float32), np.delete(even, 500)):
        assert best_s(np.asarray(times, np.float64)) < 10 * quick_s


def test_straight_lines_have_the_textbooks_covariances() -> None:
    flow = np.array([10.0, 20, 40, 60, 75])
    drop = 0.11 * flow + 0.4 + np.array([0.01, -0.02, 0.015, 0.01, -0.012])
    found = pm.identify_resistance(flow, drop_kpa=drop, offset=True)
    _, textbook = np.polyfit(flow, drop, 1, cov=True)
    correlation = textbook[0, 1] / math.sqrt(textbook[0, 0] * textbook[1, 1])
    ours = found.covariance
    assert ours[0, 1] / math.sqrt(ours[0, 0] * ours[1, 1]) == pytest.approx(correlation, rel=1e-9)
    assert found.covariance_names == ("resistance_kpa_s_ml", "offset_kpa")
    assert ours[0, 0] / ours[1, 1] == pytest.approx(textbook[0, 0] / textbook[1, 1], rel=1e-9)
    assert pm.identify_resistance(flow, drop_kpa=drop).covariance.shape == (1, 1)

    volume = np.array([0.0, 0.1, 0.2, 0.3, 0.4])
    pressure = 88.6 + 27.7 * volume + np.array([0.02, -0.03, 0.01, 0.02, -0.02])
    closed = pm.identify_compliance(volume, pressure, total_ml=26.0)
    names = list(closed.parameters)
    assert names == ["compliance_ml_kpa", "start_kpa", "bulk_modulus_kpa"]
    np.testing.assert_allclose(
        np.sqrt(np.diag(closed.covariance)), [p.standard for p in closed.parameters.values()], rtol=1e-9
    )
    _, textbook = np.polyfit(volume, pressure, 1, cov=True)
    slope_and_start = textbook[0, 1] / math.sqrt(textbook[0, 0] * textbook[1, 1])
    ours = closed.covariance
    # C falls as the slope rises, and the bulk modulus is the slope.
    assert ours[0, 1] / math.sqrt(ours[0, 0] * ours[1, 1]) == pytest.approx(-slope_and_start, rel=1e-9)
    assert ours[1, 2] / math.sqrt(ours[1, 1] * ours[2, 2]) == pytest.approx(slope_and_start, rel=1e-9)
    assert ours[0, 2] == pytest.approx(-math.sqrt(ours[0, 0] * ours[2, 2]), rel=1e-9)


def test_the_likelihood_of_a_fit_is_that_of_its_residuals() -> None:
    pump, time_s, pressure_kpa = measured()
    found = pm.identify_line(pump, time_s=time_s, pressure_kpa=pressure_kpa, speed_rpm=100, begin="step")
    residual_kpa = found.residual_kpa
    variance = np.mean(residual_kpa**2)
    by_hand = np.sum(-0.5 * (residual_kpa**2 / variance + np.log(math.tau * variance)))
    assert found.log_likelihood == pytest.approx(by_hand, rel=1e-12)


@pytest.mark.parametrize("begin", ["step", "ramp", "steady"])
@pytest.mark.parametrize("equal", [True, False])
def test_a_likelihood_is_that_of_the_simulated_pressures(begin: pm.choices.Begin, equal: bool) -> None:
    pump, time_s, pressure_kpa = measured()
    if not equal:
        time_s = time_s + 1e-5 * np.sin(np.arange(len(time_s)))
        time_s[0] = 0
    likelihood = pm.LineLikelihood(
        pump,
        time_s=time_s,
        pressure_kpa=pressure_kpa,
        standard_kpa=NOISE_KPA,
        speed_rpm=100,
        begin=begin,
        start_angle_rad=0.2,
    )
    assert len(likelihood) == len(time_s)
    line = pump.outlet.replace(compliance_ml_kpa=0.031, inertance_kpa_s2_ml=0.005, resistance_kpa_s_ml=0.12)
    other = pump.replace(outlet=line)
    if begin == "ramp":
        ramp_s = 100 * math.tau / 60 / pump.max_acceleration_rad_s2
        run = other.simulate(
            speed_rpm=[0, 100, 100], time_s=[0, ramp_s, 2], output_time_s=time_s, start_angle_rad=0.7
        )
    else:
        run = other.simulate(
            speed_rpm=100,
            time_s=time_s,
            start_angle_rad=0.7,
            initial="steady" if begin == "steady" else "rest",
        )
    residual_kpa = pressure_kpa - run.outlet_kpa
    by_hand = np.sum(-0.5 * ((residual_kpa / 0.4) ** 2 + np.log(math.tau * 0.4**2)))
    ours = likelihood.log_likelihood(
        resistance_kpa_s_ml=0.12,
        compliance_ml_kpa=0.031,
        inertance_kpa_s2_ml=0.005,
        start_angle_rad=0.7,
        standard_kpa=0.4,
    )
    assert ours == pytest.approx(by_hand, rel=1e-9)


def test_samples_before_the_start_are_those_of_a_line_at_rest() -> None:
    pump = pm.Pump.three_roller()
    time_s = np.arange(-100, 400) * 2e-3
    run = pump.simulate(speed_rpm=100, time_s=time_s[100:] + 1e-9)
    pressure_kpa = np.concatenate([np.full(100, pump.outlet.reservoir_kpa), run.outlet_kpa])
    likelihood = pm.LineLikelihood(
        pump, time_s=time_s, pressure_kpa=pressure_kpa, standard_kpa=1, speed_rpm=100, begin="step"
    )
    best = -0.5 * len(time_s) * math.log(math.tau)
    assert likelihood.log_likelihood() == pytest.approx(best, abs=1e-9)
    later = likelihood.log_likelihood(start_s=0.0307)
    run = pump.simulate(speed_rpm=100, time_s=time_s[time_s > 0.0307] - 0.0307)
    moved_kpa = np.full(len(time_s), pump.outlet.reservoir_kpa)
    moved_kpa[time_s > 0.0307] = run.outlet_kpa
    assert later == pytest.approx(best - 0.5 * np.sum((pressure_kpa - moved_kpa) ** 2), rel=1e-9)


def test_the_fit_has_the_largest_likelihood_of_all() -> None:
    pump, time_s, pressure_kpa = measured()
    found = pm.identify_line(
        pump, time_s=time_s, pressure_kpa=pressure_kpa, speed_rpm=100, begin="step", start_angle_rad=0.0
    )
    likelihood = pm.LineLikelihood(
        pump,
        time_s=time_s,
        pressure_kpa=pressure_kpa,
        standard_kpa=found.rmse_kpa,
        speed_rpm=100,
        begin="step",
    )
    best = {name: number for name, number in found.line.to_dict().items() if name != "reservoir_kpa"}
    most = likelihood.log_likelihood(**best)
    assert most == pytest.approx(found.log_likelihood, rel=1e-9)
    for name, number in best.items():
        for factor in (0.99, 1.01):
            assert likelihood.log_likelihood(**{**best, name: factor * number}) < most
    assert likelihood.line == pump.outlet


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"standard_kpa": 0}, "standard_kpa is 0; allowed: a positive number"),
        ({"speed_rpm": 0}, "speed_rpm is 0; allowed: a finite speed other than 0"),
        ({"time_s": [0, 2, 1]}, r"^time_s\[2\] is 1; allowed: more than that of the sample before"),
        ({"pressure_kpa": [1, math.nan, 2]}, r"^pressure_kpa\[1\] is NaN; allowed: "),
        ({"pressure_kpa": [1, 2]}, "pressure_kpa has shape .2.; allowed: .3,."),
        ({"begin": "slow"}, "begin is 'slow'"),
        ({"time_s": [], "pressure_kpa": []}, "time_s is empty"),
    ],
)
def test_a_record_that_is_none_is_refused(arguments: dict[str, object], message: str) -> None:
    given: dict[str, object] = {
        "time_s": [0, 1, 2],
        "pressure_kpa": [88, 89, 88],
        "standard_kpa": 1,
        "speed_rpm": 100,
        **arguments,
    }
    with pytest.raises(ValueError, match=message):
        pm.LineLikelihood(pm.Pump.three_roller(), **given)  # type: ignore[call-overload]


def test_a_line_that_is_none_is_refused() -> None:
    likelihood = pm.LineLikelihood(
        pm.Pump.three_roller(), time_s=[0, 1], pressure_kpa=[88, 89], standard_kpa=1, speed_rpm=100
    )
    with pytest.raises(ValueError, match=r"^compliance_ml_kpa is 0; allowed: "):
        likelihood.log_likelihood(compliance_ml_kpa=0)
    with pytest.raises(ValueError, match="start_s is NaN"):
        likelihood.log_likelihood(start_s=math.nan)
    with pytest.raises(ValueError, match="standard_kpa is -1"):
        likelihood.log_likelihood(standard_kpa=-1)


@pytest.mark.parametrize("begin", ["ramp", "step", "steady"])
@pytest.mark.parametrize("times", ["equal", "uneven", "sparse"])
@pytest.mark.parametrize("speed_rpm", [100, -60])
def test_the_gradient_is_that_of_differences(begin: Begin, times: str, speed_rpm: float) -> None:
    pump, time_s, pressure_kpa = measured()
    if times == "uneven":
        time_s = time_s + np.random.default_rng(1).uniform(0, 4e-4, len(time_s))
    if times == "sparse":
        time_s, pressure_kpa = time_s**1.5 * 7, pressure_kpa
    likelihood = pm.LineLikelihood(
        pump,
        time_s=time_s + 1e-4,
        pressure_kpa=pressure_kpa,
        standard_kpa=NOISE_KPA,
        speed_rpm=speed_rpm,
        begin=begin,
        start_angle_rad=0.3,
    )
    at = {
        "resistance_kpa_s_ml": 0.12,
        "compliance_ml_kpa": 0.031,
        "inertance_kpa_s2_ml": 0.005,
        "reservoir_kpa": 89.0,
        "start_angle_rad": 0.317,
        "start_s": 0.0123,
        "standard_kpa": 0.4,
    }
    value, gradient = likelihood.value_and_gradient(**at)
    assert value == pytest.approx(likelihood.log_likelihood(**at), rel=1e-9)
    assert list(gradient) == list(at)
    for name, number in at.items():
        step = 1e-6 * number
        more, less = (likelihood.log_likelihood(**{**at, name: number + h}) for h in (step, -step))
        assert gradient[name] == pytest.approx((more - less) / (2 * step), rel=1e-4), name


def test_arrays_are_broadcast() -> None:
    pump, time_s, pressure_kpa = measured()
    likelihood = pm.LineLikelihood(
        pump, time_s=time_s, pressure_kpa=pressure_kpa, standard_kpa=NOISE_KPA, speed_rpm=100, begin="step"
    )
    compliances = np.array([0.03, 0.035, 0.04])
    angles = np.array([[0.1], [0.2]])
    values = likelihood.log_likelihood(
        compliance_ml_kpa=compliances, start_angle_rad=angles, reservoir_kpa=89
    )
    with_slopes, gradient = likelihood.value_and_gradient(
        compliance_ml_kpa=compliances, start_angle_rad=angles, reservoir_kpa=89
    )
    assert isinstance(values, np.ndarray)
    assert values.shape == (2, 3)
    for row, angle in enumerate((0.1, 0.2)):
        for column, compliance in enumerate((0.03, 0.035, 0.04)):
            one, slopes = likelihood.value_and_gradient(
                compliance_ml_kpa=compliance, start_angle_rad=angle, reservoir_kpa=89
            )
            exact = likelihood.log_likelihood(
                compliance_ml_kpa=compliance, start_angle_rad=angle, reservoir_kpa=89
            )
            assert isinstance(exact, float)
            assert values[row, column] == exact
            assert np.asarray(with_slopes)[row, column] == one
            for name, slope in slopes.items():
                assert np.asarray(gradient[name])[row, column] == slope
    with pytest.raises(
        ValueError, match=r"compliance_ml_kpa \[3\], inertance_kpa_s2_ml \[2\]; allowed: equal"
    ):
        likelihood.log_likelihood(compliance_ml_kpa=compliances, inertance_kpa_s2_ml=[0.004, 0.005])
    with pytest.raises(ValueError, match=r"^compliance_ml_kpa is -1; allowed: "):
        likelihood.log_likelihood(compliance_ml_kpa=[0.03, -1])


def test_a_likelihood_goes_to_other_processes() -> None:
    pump, time_s, pressure_kpa = measured()
    starts: list[tuple[Begin, float | None]] = [("ramp", 0.01), ("step", None), ("steady", None)]
    for begin, start_s in starts:
        likelihood = pm.LineLikelihood(
            pump,
            time_s=time_s,
            pressure_kpa=pressure_kpa,
            standard_kpa=NOISE_KPA,
            speed_rpm=-100,
            port="inlet",
            begin=begin,
            start_s=start_s,
            start_angle_rad=0.3,
        )
        again = pickle.loads(pickle.dumps(likelihood))
        assert again.log_likelihood() == likelihood.log_likelihood()
        assert again.value_and_gradient(start_angle_rad=0.4) == likelihood.value_and_gradient(
            start_angle_rad=0.4
        )
        assert (len(again), again.line) == (len(likelihood), likelihood.line)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        assert pool.submit(likelihood.log_likelihood).result() == likelihood.log_likelihood()
