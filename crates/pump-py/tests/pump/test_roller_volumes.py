"""Roller volumes of hundreds of points, of functions and of coefficients."""

import math
import pickle
import warnings
from typing import Any

import numpy as np
import pytest

import pumpmodel as pm

PHI_DEG = 50.0


def smooth_ml(deg: Any) -> Any:
    return 1.05 * (1 - np.cos(np.pi * deg / PHI_DEG))


def published() -> tuple[list[float], float]:
    table = pm.Pump.three_roller().to_dict()["roller_volume"]
    return table["polynomial_ml_deg"], table["engagement_angle_deg"]


def test_hundreds_of_points_with_scatter_become_a_pump() -> None:
    generator = np.random.default_rng(1)
    angles = generator.permutation(np.linspace(0, PHI_DEG, 400))
    fit = pm.VolumeFit(angles, smooth_ml(angles) + generator.normal(0, 0.01, 400))
    # Each value of the fit is the mean of some 16 points.
    assert fit.total_ml == pytest.approx(2.1, abs=4 * 0.01 / 4)
    assert fit.rms_ml == pytest.approx(0.01, rel=0.1)
    assert fit.falls is None
    pump = pm.Pump.three_roller().replace(roller_volume=fit)
    assert pump.roller_volume_ml == fit.total_ml
    assert pm.Pump.from_dict(pump.to_dict()) == pump
    volumes = fit.displaced_ml(np.linspace(0, np.radians(PHI_DEG), 1000))
    assert (np.diff(volumes) >= 0).all()


def test_the_spline_near_many_points_is_that_of_least_squares_in_another_basis() -> None:
    # Even angles, ten in each of 24 pieces, put the knots at even distances. Little scatter keeps it rising.
    part = np.linspace(0, 1, 241)
    volumes = smooth_ml(PHI_DEG * part) + np.random.default_rng(2).normal(0, 2e-4, 241)
    fit = pm.VolumeFit(PHI_DEG * part, volumes)
    knots = np.arange(1, 24) / 24
    # Truncated powers without those of order 0 and 1: volume and slope are 0 at the start.
    columns = [part**2, part**3, *(np.clip(part - knot, 0, None) ** 3 for knot in knots)]
    end_slopes = np.array([2, 3, *(3 * (1 - knots) ** 2)])
    # The directions across the last slope keep it 0.
    free = np.linalg.svd(end_slopes[None])[2][1:].T
    basis = np.stack(columns, axis=-1) @ free
    best = basis @ np.linalg.lstsq(basis, volumes, rcond=None)[0]
    np.testing.assert_allclose(fit.residuals_ml, best - volumes, atol=1e-12)


@pytest.mark.parametrize(
    "function",
    [smooth_ml, lambda deg: 1.05 * (1 - math.cos(math.pi * deg / PHI_DEG)), lambda deg: list(smooth_ml(deg))],
)
def test_a_function_of_an_array_or_of_a_number_becomes_a_roller_volume(function: Any) -> None:
    fit = pm.VolumeFit.from_function(function, PHI_DEG)
    assert len(fit.angle_deg) == 241
    angles = np.linspace(0, PHI_DEG, 3001)
    # The largest deviation at the samples is that of the whole curve, and is what a cubic spline leaves.
    off = abs(fit.displaced_ml(np.radians(angles)) - smooth_ml(angles)).max()
    assert off <= 1.05 * abs(fit.residuals_ml).max() < 2e-6
    assert pm.Pump.three_roller().replace(roller_volume=fit).roller_volume_ml == fit.total_ml
    assert fit == pm.VolumeFit.from_dict(fit.to_dict())


@pytest.mark.parametrize(
    ("function", "engagement_deg", "match"),
    [
        (lambda deg: deg + 0.25, 50, r"function is 0.25 mL at 0 deg; allowed: 0"),
        (
            lambda deg: np.sin(np.pi * deg / 50),
            50,
            r"function falls from 1 mL at 25 deg to 0.99\d+ mL at 25.2\d+ deg",
        ),
        (lambda deg: 0 * deg, 50, "function is 0 mL at 50 deg; allowed: more than 0"),
        (
            lambda deg: np.where(deg < 40, deg, np.nan),
            50,
            "function is nan at 40 deg; allowed: a volume in mL",
        ),
        (
            lambda deg: 2.1,
            50,
            r"shape \(\) for 241 angles; allowed: \(241,\); return an array, as np.full_like",
        ),
        (smooth_ml, 0, "engagement_deg is 0; allowed: more than 0 and less than 360"),
        (smooth_ml, math.nan, "engagement_deg is nan; allowed"),
        (smooth_ml, 360, "engagement_deg is 360; allowed"),
        (smooth_ml, [50, 60], r"engagement_deg has the shape \(2,\); allowed: one number"),
    ],
)
def test_a_function_that_is_no_roller_volume_is_a_value_error(
    function: Any, engagement_deg: Any, match: str
) -> None:
    with pytest.raises(ValueError, match=match):
        pm.VolumeFit.from_function(function, engagement_deg)


def test_arguments_beside_the_function_are_refused_by_name() -> None:
    with pytest.raises(TypeError, match="function must be callable, not float"):
        pm.VolumeFit.from_function(2.1, 50)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="samples must be a whole number, not float"):
        pm.VolumeFit.from_function(smooth_ml, 50, samples=100.0)  # type: ignore[arg-type]
    for samples in (25, 10_001):
        with pytest.raises(ValueError, match=f"samples is {samples}; allowed: 26 to 10000"):
            pm.VolumeFit.from_function(smooth_ml, 50, samples=samples)
    assert len(pm.VolumeFit.from_function(smooth_ml, 50, samples=26).angle_deg) == 26

    def broken(_deg: Any) -> Any:
        raise ZeroDivisionError("by hand")

    with pytest.raises(ZeroDivisionError, match="by hand"):
        pm.VolumeFit.from_function(broken, 50)


def test_the_published_coefficients_are_the_published_pump() -> None:
    coefficients, engagement_deg = published()
    volume = pm.VolumePolynomial(coefficients, engagement_deg)
    pump = pm.Pump.three_roller()
    assert volume.total_ml == pytest.approx(pump.roller_volume_ml, abs=1e-12)
    assert pump.replace(roller_volume=volume) == pump
    # Below the polynomial's minimum the volume is held.
    [(first_deg, last_deg)] = volume.held_deg
    assert first_deg == 0
    assert last_deg == pytest.approx(0.567, abs=1e-3)
    angles = np.radians([-1.0, 0.0, 30.0, engagement_deg, 90.0])
    volumes = volume.displaced_ml(angles)
    assert isinstance(volumes, np.ndarray)
    np.testing.assert_allclose(volumes[[0, 1, 3, 4]], [0, 0, volume.total_ml, volume.total_ml], atol=1e-12)
    least = np.polyval(coefficients, last_deg)
    assert volumes[2] == pytest.approx(np.polyval(coefficients, 30) - least, abs=1e-12)
    for copied in (pickle.loads(pickle.dumps(volume)), pm.VolumePolynomial.from_dict(volume.to_dict())):
        assert copied == volume


def test_coefficients_of_a_lower_order_are_those_of_numpy_reversed() -> None:
    volume = pm.VolumePolynomial([-3.2e-5, 0.0024, 0, 0], 50)
    assert volume.total_ml == pytest.approx(2, abs=1e-12)
    polynomial = np.polynomial.Polynomial([0, 0, 0.0024, -3.2e-5])
    assert pm.VolumePolynomial(polynomial.convert().coef[::-1], 50) == volume
    file = pm.Pump.three_roller().replace(roller_volume=volume).to_dict()
    assert file["roller_volume"]["polynomial_ml_deg"] == [0, 0, -3.2e-5, 0.0024, 0, 0]


@pytest.mark.parametrize(
    ("coefficients", "engagement_deg", "match"),
    [
        ([], 50, r"coefficients_ml_deg has the shape \(0,\); allowed: 1 to 6 numbers, highest order first"),
        ([1.0] * 7, 50, r"coefficients_ml_deg has the shape \(7,\)"),
        (2.1, 50, r"coefficients_ml_deg has the shape \(\)"),
        ([1, math.inf], 50, "coefficients_ml_deg is .*; allowed: finite numbers"),
        ([1, 0], 0, "engagement_deg is 0; allowed"),
        ([1, 0], math.nan, "engagement_deg is nan; allowed"),
        ([-1, 0], 50, "rise"),
    ],
)
def test_coefficients_of_no_roller_volume_are_value_errors(
    coefficients: Any, engagement_deg: float, match: str
) -> None:
    with pytest.raises(ValueError, match=match):
        pm.VolumePolynomial(coefficients, engagement_deg)


def jumping_ml(deg: Any) -> Any:
    return smooth_ml(deg) + np.where(deg > 24.9, 0.3, 0.0)


def with_outlier_ml(deg: Any) -> Any:
    return smooth_ml(deg) + np.where(abs(deg - 25) < 0.1, 0.01, 0.0)


@pytest.mark.parametrize(
    ("function", "match"),
    [
        (jumping_ml, r"function jumps from 1.0\d+ mL at 24.7\d+ deg to 1.3\d+ mL at 25 deg; the fit smooths"),
        (
            lambda deg: np.where(deg > 0, 1.0 + deg / 50, 0.0),
            r"function jumps from 0 mL at 0 deg to 1.00\d+ mL at 0.2\d+ deg",
        ),
        (with_outlier_ml, r"function has an outlier, 1.06 mL at 25 deg between 1.03\d+ and 1.06\d+ mL"),
        (
            lambda deg: smooth_ml(np.minimum(1.25 * deg, PHI_DEG)),
            r"function is constant, 2.1 mL, from 40 deg on; engagement_deg is 50",
        ),
        (
            lambda deg: smooth_ml(np.maximum(1.25 * (deg - 10), 0)),
            r"function is constant, 0 mL, up to 10 deg; a roller displaces volume from its first",
        ),
    ],
)
def test_a_doubtful_function_is_warned_of_by_name(function: Any, match: str) -> None:
    with pytest.warns(UserWarning, match=match) as told:
        fit = pm.VolumeFit.from_function(function, PHI_DEG)
    assert fit.total_ml > 1
    assert {warning.filename for warning in told} == {__file__}


@pytest.mark.parametrize(
    "function",
    [
        smooth_ml,
        lambda deg: deg / 25,
        lambda deg: 2 / (1 + np.exp(-(deg - 25) / 2)) - 2 / (1 + np.exp(12.5)),
        lambda deg: np.sqrt(deg),
        lambda deg: np.interp(deg, [0, 20, 22, 50], [0, 0.1, 1.9, 2]),
    ],
)
def test_a_steep_function_is_not_doubtful(function: Any) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pm.VolumeFit.from_function(function, PHI_DEG)


def test_a_fit_of_many_points_has_a_short_name() -> None:
    fit = pm.VolumeFit.from_function(smooth_ml, PHI_DEG, samples=5000)
    assert repr(fit) == "VolumeFit(method='spline', 5000 points, total_ml=2.1, engagement_deg=50)"
