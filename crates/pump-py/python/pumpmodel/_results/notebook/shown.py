"""Each result as notebooks show it."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from pumpmodel._pumpmodel import Calibration, Plan, Pump, Run, SteadyState
from pumpmodel._results.notebook.html import table
from pumpmodel._results.notebook.svg import BLUE, GREEN, VERMILION, Bar, Curve, bars, curves
from pumpmodel._results.words import between, give_or_take, number, parameter

if TYPE_CHECKING:
    from pumpmodel._results.harmonics import Harmonics
    from pumpmodel.dose import Dose, Verification
    from pumpmodel.identification.identified import Identified
    from pumpmodel.identification.joint import JointlyIdentified
    from pumpmodel.sweeps import Sweep
    from pumpmodel.volume_fit import VolumeFit
    from pumpmodel.weighed import PhaseFit

# A plan is sampled at its picture's columns; its table has the exact extremes.
_SAMPLES = 20_000
# Curves that a small picture can hold.
_CURVES = 6


def _pressures(x_label: str, x: Any, columns: Any) -> str:
    ports = (("inlet", BLUE), ("outlet", VERMILION))
    drawn = [Curve(port, colour, x, getattr(columns, f"{port}_kpa")) for port, colour in ports]
    return curves(x_label, "pressure (kPa)", drawn)


def pump_html(pump: Pump) -> str:
    """Return what a notebook shows of a pump."""
    angle_rad = np.linspace(0, pump.pitch_rad, 400)
    drawn = [
        Curve("inlet", BLUE, np.degrees(angle_rad), pump.inlet_flow_ml_rad(angle_rad)),
        Curve("outlet", VERMILION, np.degrees(angle_rad), pump.outlet_flow_ml_rad(angle_rad)),
    ]
    rows = [
        ("rollers", str(pump.rollers)),
        ("volume per revolution", number(pump.volume_per_revolution_ml, "mL")),
        ("roller volume", number(pump.roller_volume_ml, "mL")),
        ("motor steps per revolution", number(pump.steps_per_rev, digits=8)),
    ]
    picture = curves("angle of the rollers (deg)", "flow (mL/rad)", drawn)
    return table(f"{pump.id}: {pump.name}", rows, picture, pump.warnings)


def run_html(run: Run) -> str:
    """Return what a notebook shows of a run."""
    if not len(run):
        return table("Run of 0 samples", [])
    rows = [
        ("time", between(run.time_s[0], run.time_s[-1], "s")),
        ("inlet", between(run.inlet_kpa.min(), run.inlet_kpa.max(), "kPa absolute")),
        ("outlet", between(run.outlet_kpa.min(), run.outlet_kpa.max(), "kPa absolute")),
        ("delivered", number(run.delivered_ml[-1], "mL")),
    ]
    return table(f"Run of {len(run):,} samples", rows, _pressures("time (s)", run.time_s, run))


def plan_html(plan: Plan) -> str:
    """Return what a notebook shows of a plan."""
    rows = [
        ("planned", f"{give_or_take(plan.planned_ml, plan.expanded_uncertainty_ml)} mL (k = 2)"),
        ("steps", f"{plan.steps:,}" + (f", then {plan.retract_steps:,}" if plan.retract_steps else "")),
        ("cruise", f"{plan.cruise_flow_ml_s:.4g} mL/s at {plan.cruise_speed_rpm:.4g} r/min"),
        ("motion, settling", f"{number(plan.motion_s, 's')}, {number(plan.settle_s, 's')}"),
        ("inlet", between(plan.inlet_min_kpa, plan.inlet_max_kpa, "kPa absolute")),
        ("outlet", between(plan.outlet_min_kpa, plan.outlet_max_kpa, "kPa absolute")),
        ("limited by", plan.limited_by.replace("_", " ")),
    ]
    trace = plan.trace(dt_s=max(1e-3, plan.settled_s / _SAMPLES))
    drawn = [
        Curve("outlet", VERMILION, trace.time_s, trace.outlet_flow_ml_s),
        Curve("inlet", BLUE, trace.time_s, trace.inlet_flow_ml_s),
    ]
    picture = curves("time (s)", "flow (mL/s)", drawn[::-1])
    return table(f"Plan of {plan.requested_ml:.6g} mL on {plan.pump.id}", rows, picture, plan.warnings)


def steady_html(steady: SteadyState[Any]) -> str:
    """Return what a notebook shows of a steady state, or of many."""
    columns = {name: np.ravel(values) for name, values in steady.to_dict().items()}
    speeds = columns["speed_rpm"]
    if not speeds.size:
        return table("Steady states at 0 speeds", [])
    rows = [
        ("inlet", between(columns["inlet_min_kpa"].min(), columns["inlet_max_kpa"].max(), "kPa absolute")),
        ("outlet", between(columns["outlet_min_kpa"].min(), columns["outlet_max_kpa"].max(), "kPa absolute")),
    ]
    if speeds.size == 1:
        rows += [
            ("mean flow", number(columns["mean_flow_ml_s"][0], "mL/s")),
            ("ripple, peak to peak", number(100 * columns["ripple_peak_to_peak"][0], "%", 3)),
            ("ripple, root mean square", number(100 * columns["ripple_rms"][0], "%", 3)),
        ]
        drawn_bars = [
            Bar(f"{port}, {word}", float(kpa), number(float(kpa), "kPa"))
            for port in ("inlet", "outlet")
            for word, edge in (("smallest", "min"), ("mean", "mean"), ("largest", "max"))
            for kpa in columns[f"{port}_{edge}_kpa"]
        ]
        picture = bars("pressures, absolute", drawn_bars)
        return table(f"Steady state at {speeds[0]:.5g} r/min", rows, picture)
    rows.append(
        ("mean flow", between(columns["mean_flow_ml_s"].min(), columns["mean_flow_ml_s"].max(), "mL/s"))
    )
    order = np.argsort(speeds)
    # Curves of one port have its name once.
    drawn = [
        Curve(port if edge == "max" else "", colour, speeds[order], columns[f"{port}_{edge}_kpa"][order])
        for port, colour in (("inlet", BLUE), ("outlet", VERMILION))
        for edge in ("min", "max")
    ]
    title = f"Steady states at {speeds.size:,} speeds"
    return table(title, rows, curves("speed (r/min)", "pressure, range (kPa)", drawn))


def sweep_html(sweep: "Sweep") -> str:
    """Return what a notebook shows of a sweep."""
    title = "Sweep of {:,} pumps at {:,} speeds".format(*sweep.shape)
    if not sweep.outlet_max_kpa.size:
        return table(title, [])
    rows = [
        ("speed", between(sweep.speed_rpm.min(), sweep.speed_rpm.max(), "r/min")),
        (
            "smallest at the inlet",
            between(sweep.inlet_min_kpa.min(), sweep.inlet_min_kpa.max(), "kPa absolute"),
        ),
        (
            "largest at the outlet",
            between(sweep.outlet_max_kpa.min(), sweep.outlet_max_kpa.max(), "kPa absolute"),
        ),
    ]
    order = np.argsort(sweep.speed_rpm)
    drawn = [
        Curve("", VERMILION, sweep.speed_rpm[order], values[order])
        for values in sweep.outlet_max_kpa[:_CURVES]
    ]
    shown = "" if len(sweep.pumps) <= _CURVES else f", the first {_CURVES} pumps"
    picture = curves("speed (r/min)", f"largest outlet pressure (kPa){shown}", drawn)
    return table(title, rows, picture)


def calibration_html(calibration: Calibration) -> str:
    """Return what a notebook shows of a calibration."""
    data = calibration.to_dict()
    rows = [
        ("made", calibration.date),
        ("fluid", f"{calibration.fluid}, {calibration.temperature_degc:.4g} °C"),
        ("runs", str(len(data["runs"]))),
    ]
    speeds = calibration.speeds_rpm
    picture = ""
    try:
        middle = float(np.mean(speeds)) if speeds else math.nan
        factor = calibration.displacement_factor(speed_rpm=middle) if speeds else None
        if speeds and factor is not None:
            standard = calibration.standard_uncertainty(speed_rpm=middle)
            rows.append((f"factor at {middle:.4g} r/min", f"{give_or_take(factor, 2 * standard)} (k = 2)"))
        if speeds:
            # A single speed has its factor on either side too.
            wide = 1.0 if len(speeds) > 1 else 1.2
            rpm = np.linspace(min(speeds) / wide, max(speeds) * wide, 60)
            mean = np.asarray(calibration.displacement_factor(speed_rpm=rpm))
            twice = 2 * np.asarray(calibration.standard_uncertainty(speed_rpm=rpm))
            drawn = [
                Curve("", BLUE, rpm, mean - twice),
                Curve("95 %", BLUE, rpm, mean + twice),
                Curve("factor", GREEN, rpm, mean),
            ]
            picture = curves("speed (r/min)", "measured / model", drawn)
    except ValueError:
        rows.append(("factor", "by a speed law, which needs the pump"))
    return table(f"Calibration {calibration.version}", rows, picture)


def identified_html(found: "Identified") -> str:
    """Return what a notebook shows of an identified line."""
    rows = [parameter(name, estimate) for name, estimate in found.parameters.items()]
    rows.append(("RMSE", number(found.rmse_kpa, "kPa", 3)))
    label, x = {
        "line": ("time (s)", found._varied),
        "resistance": ("flow (mL/s)", found._varied),
        "compliance": ("injected volume (mL)", found._varied),
    }[found.kind]
    colour = BLUE if found.port == "inlet" else VERMILION
    drawn = [
        Curve("measured", "#888888", x, found.measured_kpa, dots=len(x) <= 100),
        Curve("fitted", colour, x, found.fitted_kpa),
    ]
    picture = curves(label, "pressure drop (kPa)" if found.kind == "resistance" else "pressure (kPa)", drawn)
    return table(f"Identified {found.kind} at the {found.port} (± k = 2)", rows, picture, found.warnings)


def jointly_html(found: "JointlyIdentified") -> str:
    """Return what a notebook shows of a line that was identified from several recordings."""
    rows = [parameter(name, estimate) for name, estimate in found.parameters.items()]
    rows.append(("RMSE", number(found.rmse_kpa, "kPa", 3)))
    rows.append(("log likelihood", number(found.log_likelihood, digits=6)))
    colour = BLUE if found.port == "inlet" else VERMILION
    picture = "".join(
        curves(
            "time (s)",
            "pressure (kPa)",
            [
                Curve("measured", "#888888", fit.time_s, fit.measured_kpa, dots=len(fit.time_s) <= 100),
                Curve("fitted", colour, fit.time_s, fit.fitted_kpa),
            ],
        )
        for fit in found.recordings[:_CURVES]
    )
    title = f"Identified line at the {found.port}, {len(found.recordings)} recordings (± k = 2)"
    return table(title, rows, picture, found.warnings)


def volume_html(fit: "VolumeFit") -> str:
    """Return what a notebook shows of a fitted roller volume."""
    rows = [
        ("roller volume", number(fit.total_ml, "mL")),
        ("engagement angle", number(fit.engagement_deg, "deg")),
        ("points", f"{len(fit.angle_deg):,}"),
        ("residuals, root mean square", number(1000 * fit.rms_ml, "µL", 2)),
    ]
    measured = np.asarray(fit.angle_deg)
    angle_deg = np.linspace(0, fit.engagement_deg, 90)
    shown = slice(None, None, max(1, len(measured) // 100))
    drawn = [
        Curve("fit", GREEN, angle_deg, fit.displaced_ml(np.radians(angle_deg))),
        Curve("measured", "#888888", (measured - measured.min())[shown], fit.volume_ml[shown], dots=True),
    ]
    picture = curves("angle (deg)", "displaced volume (mL)", drawn)
    return table(f"Roller volume, {fit.method}", rows, picture)


def dose_html(dose: "Dose") -> str:
    """Return what a notebook shows of a dose of a bench."""
    rows = [
        ("delivered", "planned only" if dose.delivered_ml is None else number(dose.delivered_ml, "mL", 6)),
        ("expanded uncertainty", f"{number(dose.expanded_uncertainty_ml, 'mL', 2)} (k = 2)"),
        ("steps", f"{dose.steps:,}"),
        ("flow", number(dose.mean_flow_ml_s, "mL/s")),
        ("motor", "simulated" if dose.simulated else dose.driver),
        ("completed", "yes" if dose.completed else "no"),
    ]
    shares = sorted(dose.uncertainty_budget, key=lambda share: -share.standard_ml)
    drawn = [
        Bar(share.source.replace("_", " "), share.standard_ml, number(1000 * share.standard_ml, "µL", 2))
        for share in shares
        if share.standard_ml > 0
    ]
    picture = bars("standard uncertainty by source", drawn)
    return table(f"{dose._title(f'{dose.requested_ml:.6g}')} on {dose.pump}", rows, picture, dose.warnings)


def verification_html(found: "Verification") -> str:
    """Return what a notebook shows of a verification."""
    rows = [
        ("mean", number(found.mean_ml, "mL", 5)),
        (
            "systematic error",
            f"{number(found.systematic_percent, '%', 2)} (±{found.tolerance.systematic_percent:g} % allowed)",
        ),
        (
            "random error",
            f"{number(found.random_percent, '%', 2)} ({found.tolerance.random_percent:g} % allowed)",
        ),
        ("verdict", "passed" if found.passed else "not passed"),
    ]
    count = len(found.volumes_ml)
    doses = np.arange(1, count + 1)
    shown = slice(None, None, max(1, count // 100))
    drawn = [
        Curve("nominal", "#888888", [1, max(count, 2)], [found.nominal_ml] * 2),
        Curve("dose", VERMILION, doses[shown], found.volumes_ml[shown], dots=True),
    ]
    picture = curves("dose", "volume (mL)", drawn)
    return table(f"Verification of {found.nominal_ml:.6g} mL, {count} doses", rows, picture)


def phase_html(fit: "PhaseFit") -> str:
    """Return what a notebook shows of a fit to short doses."""
    rows = [
        (name, f"{give_or_take(value, 2 * standard)} {unit} (k = 2)")
        for name, value, standard, unit in (
            ("roller volume", fit.roller_volume_ml, fit.roller_volume_standard_ml, "mL"),
            (
                "engagement angle",
                math.degrees(fit.engagement_rad),
                math.degrees(fit.engagement_standard_rad),
                "deg",
            ),
            ("zero", math.degrees(fit.zero_rad), math.degrees(fit.zero_standard_rad), "deg"),
        )
    ]
    return table("Fit to short doses", rows)


def harmonics_html(found: "Harmonics") -> str:
    """Return what a notebook shows of a pulsation."""
    hertz = np.asarray(found.rad_s) / math.tau
    rows = [
        ("mean flow", number(found.mean_flow_ml_s, "mL/s")),
        ("mean pressure", number(found.mean_kpa, "kPa absolute")),
        ("harmonics", str(len(hertz))),
    ]
    shown = slice(0, 12)
    amplitudes = np.abs(found.pressure_kpa)[shown]
    drawn = [
        Bar(f"{frequency:.4g} Hz", float(amplitude), number(float(amplitude), "kPa", 3))
        for frequency, amplitude in zip(hertz[shown], amplitudes, strict=True)
    ]
    return table("Pulsation", rows, bars("amplitude of the pressure", drawn))
