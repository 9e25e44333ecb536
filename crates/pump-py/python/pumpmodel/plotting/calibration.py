"""A calibration over the speed, with its band."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pumpmodel._pumpmodel import Calibration, Pump
from pumpmodel.plotting.axes import GREEN, axes_for, finish, ink
from pumpmodel.weighed import WeighedRun

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray


def plot_calibration(calibration: Calibration, *, pump: Pump | None = None, ax: Axes | None = None) -> Axes:
    """Draw the displacement factor of a calibration over the speed, with the band that covers 95 %.

    Parameters
    ----------
    calibration : Calibration
        Calibration to draw.
    pump : Pump, optional
        Pump of the calibration. With it the weighed runs are drawn as points; a fitted speed law needs it.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes over the speed. Ticks at the bottom mark the speeds of the runs.

    Raises
    ------
    ValueError
        If a speed law was fitted and no pump is given, or the calibration has no runs.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    speeds = np.asarray(calibration.speeds_rpm)
    if not speeds.size:
        message = "the calibration has no weighed runs; its factor is 1 at every speed"
        raise ValueError(message)
    rpm = np.linspace(*_range(speeds), 200)
    factor = np.asarray(calibration.displacement_factor(speed_rpm=rpm, pump=pump))
    standard = np.asarray(calibration.standard_uncertainty(speed_rpm=rpm, pump=pump))
    (axis,) = axes_for(["calibration"], ax)
    axis.fill_between(
        rpm, factor - 2 * standard, factor + 2 * standard, color=GREEN, alpha=0.25, linewidth=0, label="95 %"
    )
    axis.plot(rpm, factor, color=GREEN, linewidth=1.2, label="factor")
    if pump is not None:
        _draw_runs(axis, calibration, pump)
    axis.plot(
        speeds,
        np.zeros_like(speeds),
        "|",
        color=ink(axis, 0.6),
        transform=axis.get_xaxis_transform(),
        markersize=12,
        clip_on=False,
        label="speed of runs",
    )
    axis.set_xlabel("speed (r/min)")
    axis.set_ylabel("measured over model volume")
    axis.ticklabel_format(axis="y", useOffset=False)
    count = len(calibration.to_dict()["runs"])
    # Without a bench a calibration has no number.
    number = f" {calibration.version}" if calibration.version else ""
    axis.set_title(f"calibration{number} of {calibration.date[:10]}, {count} runs", fontsize="medium")
    finish(axis)
    return axis


def _range(speeds: NDArray[np.float64]) -> tuple[float, float]:
    """Return the speeds from which and to which a calibration is drawn: a little beyond its runs."""
    least, most = float(speeds.min()), float(speeds.max())
    aside = 0.05 * (most - least) if most > least else 0.2 * most
    return least - min(aside, 0.5 * least), most + aside


def run_factors(calibration: Calibration, pump: Pump) -> list[tuple[float, float]]:
    """Return speed (r/min) and measured over model volume of each weighed run."""
    factors = []
    for run in calibration.to_dict()["runs"]:
        weighed = WeighedRun(
            speed_rpm=run["speed_rpm"],
            turned_deg=run["turned_deg"],
            start_angle_deg=run["start_angle_deg"],
            temperature_degc=run["temperature_degc"],
            **run["reading"],
        )
        alone = Calibration.from_runs(pump, [weighed], fit="factor")
        factors.append((weighed.speed_rpm, alone.displacement_factor(speed_rpm=weighed.speed_rpm)))
    return factors


def _draw_runs(axis: Axes, calibration: Calibration, pump: Pump) -> None:
    # Outliers are numbered from 1.
    outliers = set(calibration.outliers)
    factors = run_factors(calibration, pump)
    for label, marker, chosen in (("run", "o", False), ("outlier", "x", True)):
        points = [point for number, point in enumerate(factors, 1) if (number in outliers) == chosen]
        if points:
            axis.plot(*zip(*points, strict=True), marker, color=ink(axis, 0.55), markersize=4, label=label)
