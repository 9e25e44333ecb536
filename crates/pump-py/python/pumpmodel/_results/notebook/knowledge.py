"""Knowledge of a line or a volume as notebooks show it: derivatives, expectations, trials."""

from typing import TYPE_CHECKING

import numpy as np

from pumpmodel._results.notebook.html import table
from pumpmodel._results.notebook.svg import BLUE, GREEN, VERMILION, Bar, Curve, bars, curves
from pumpmodel._results.words import between, number

if TYPE_CHECKING:
    from pumpmodel._results.sensitivity import Sensitivity
    from pumpmodel.identification.experiment import ExpectedFit
    from pumpmodel.monte_carlo import VolumeTrials
    from pumpmodel.volume_fit import VolumePolynomial

_LINE = ("R", "C", "L")
# Columns of a small histogram.
_BINS = 40


def sensitivity_html(found: "Sensitivity") -> str:
    """Return what a notebook shows of the derivatives of a run."""
    if not len(found.time_s):
        return table("Sensitivity of a run of 0 samples", [])
    rows = []
    for parameter, inlet, outlet in zip(
        found.parameters, found.inlet_kpa_by, found.outlet_kpa_by, strict=True
    ):
        most = f"{number(abs(inlet).max())} at the inlet, {number(abs(outlet).max())} at the outlet"
        rows.append((f"kPa by {parameter}, largest", most))
    # By the compliance: the row that every record has something to tell of.
    drawn = [
        Curve(port, colour, found.time_s, by[1])
        for port, colour, by in (
            ("inlet", BLUE, found.inlet_kpa_by),
            ("outlet", VERMILION, found.outlet_kpa_by),
        )
    ]
    picture = curves("time (s)", "by C (kPa/(mL/kPa))", drawn)
    return table(f"Sensitivity of a run of {len(found.time_s):,} samples", rows, picture)


def expected_html(fit: "ExpectedFit") -> str:
    """Return what a notebook shows of the fit that an experiment would give."""
    made = fit.experiment
    rows = [
        ("speed", f"{made.speed_rpm:g} r/min for {made.duration_s:g} s, at the {made.port}"),
        ("information gained", number(fit.gain_nats, "nats")),
        ("R", f"± {number(fit.resistance_kpa_s_ml, 'kPa s/mL', 2)} (k = 1)"),
        ("C", f"± {number(fit.compliance_ml_kpa, 'mL/kPa', 2)} (k = 1)"),
        ("L", f"± {number(fit.inertance_kpa_s2_ml, 'kPa s²/mL', 2)} (k = 1)"),
    ]
    drawn = [
        Bar(name, percent, number(percent, "%", 2))
        for name, percent in zip(_LINE, fit.relative_percent, strict=True)
    ]
    return table("Expected fit", rows, bars("standard uncertainty of the value", drawn))


def trials_html(drawn: "VolumeTrials") -> str:
    """Return what a notebook shows of the trials of a dose."""
    least_ml, most_ml = drawn.interval_ml()
    rows = [
        ("mean", number(drawn.mean_ml, "mL", 5)),
        ("standard deviation", number(drawn.standard_ml, "mL", 2)),
        ("95.45 % of the trials", f"{least_ml:.5g} to {most_ml:.5g} mL"),
        ("expanded uncertainty by the budget", number(drawn.budget_expanded_ml, "mL", 2)),
    ]
    counts, edges = np.histogram(drawn.volume_ml, bins=_BINS)
    steps = Curve("", GREEN, np.repeat(edges, 2)[1:-1], np.repeat(counts, 2))
    picture = curves("volume (mL)", "trials", [steps])
    return table(f"{len(drawn.volume_ml)} trials of a dose", rows, picture)


def polynomial_html(volume: "VolumePolynomial") -> str:
    """Return what a notebook shows of a roller volume by a polynomial."""
    order = len(volume.coefficients_ml_deg) - 1
    rows = [
        ("roller volume", number(volume.total_ml, "mL")),
        ("engagement angle", number(volume.engagement_deg, "deg")),
    ]
    rows += [("held, where it falls", between(*held, "deg")) for held in volume.held_deg]
    angle_deg = np.linspace(0, volume.engagement_deg, 90)
    curve = Curve("", GREEN, angle_deg, volume.displaced_ml(np.radians(angle_deg)))
    picture = curves("angle (deg)", "displaced volume (mL)", [curve])
    return table(f"Roller volume, polynomial of order {order}", rows, picture)
