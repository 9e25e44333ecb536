//! Calibrations in words and as JSON.

use std::fmt::Write;

use pump_bench::Bench;
use pump_bench::calibration::{AgainstSpeed, CalibrationError, Displacement, Stored};
use serde_json::json;

/// One line of JSON.
pub(super) fn json(stored: &Stored) -> String {
    format!("{}\n", json!(stored))
}

pub(super) fn list_json(all: &[Stored], active: Option<u32>) -> String {
    format!("{}\n", json!({ "schema": "calibrations/1", "active": active, "calibrations": all }))
}

/// Speeds in words.
fn speeds(displacement: &Displacement) -> String {
    let speeds: Vec<String> = displacement.speeds_rpm.iter().map(|rpm| short(*rpm)).collect();
    format!("{} r/min", speeds.join(", "))
}

/// A number with four decimals at most.
pub(super) fn short(value: f64) -> String {
    format!("{value:.4}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// What was found, and what becomes of it.
pub(super) fn text(bench: &Bench, stored: &Stored) -> Result<String, CalibrationError> {
    let (version, calibration, file) = (stored.version, &stored.calibration, bench.file());
    let Some(found) = &calibration.displacement else { return Ok(String::new()) };
    let base = bench.model();
    let mut text = format!(
        "calibration {version} of {} ({}): {} runs at {}, {} at {} °C\n",
        file.pump.id,
        bench.driver().as_str(),
        calibration.runs.len(),
        speeds(found),
        calibration.fluid,
        calibration.temperature_degc,
    );
    // Writing to a String cannot fail.
    for rpm in &found.speeds_rpm {
        let (factor, standard) = (found.factor_at(base, *rpm)?, found.standard_at(base, *rpm)?);
        let _ = writeln!(
            text,
            "  at {:>7} r/min  model volume times {factor:.4} ± {:.4} (k = 2), {:.3} mL per revolution",
            short(*rpm),
            2.0 * standard,
            factor * calibration.revolution_ml
        );
    }
    if let Some(law) = &found.speed_law {
        let _ = writeln!(
            text,
            "  speed law  s {:.5} ± {:.5}, D {:.3e} ± {:.1e} /kPa (k = 2)",
            law.scale,
            2.0 * law.scale_standard,
            law.distensibility_per_kpa,
            2.0 * law.distensibility_standard_per_kpa
        );
    }
    if let Some(scatter) = found.scatter.standard() {
        let expected = file.uncertainty.repeatability_percent;
        let percent = 100.0 * scatter;
        let _ = write!(text, "  runs scatter by {percent:.3} % (the pump file says {expected} %)");
        let _ = match found.speeds_rpm.len() {
            0..3 => writeln!(text),
            _ => {
                let of = if found.speed_law.is_some() { "speed law" } else { "line" };
                writeln!(text, ", speeds depart from the {of} by {:.3} %", 100.0 * found.lack_of_fit)
            }
        };
    }
    for run in &found.outliers {
        let _ =
            writeln!(text, "  warning: run {run} lies far from the others; it is in the fit: weigh it again");
    }
    if found.scatter.standard().is_some_and(|scatter| found.lack_of_fit > 2.0 * scatter) {
        text.push_str("  warning: the speeds depart from the fit by far more than the runs scatter; it is not their shape\n");
    }
    let limit_rpm = file.motor.max_speed_rpm;
    if found.range_rpm().1 > 1.01 * limit_rpm {
        let _ = writeln!(
            text,
            "  warning: {} r/min is beyond the motor's {} r/min; were these runs made with this pump?",
            short(found.range_rpm().1),
            short(limit_rpm)
        );
    }
    match found.speeds_rpm.len() {
        0 | 1 => {
            text.push_str("  warning: one speed; doses at others are less sure, calibrate at three or more\n")
        }
        2 => text
            .push_str("  warning: two speeds do not show whether a line fits; calibrate at three or more\n"),
        _ => {}
    }
    let flows = AgainstSpeed::of(Some(found), None, base).map(|against| against.flows_ml_s(false));
    if let Some((least_ml_s, most_ml_s)) = flows.transpose()?.flatten() {
        let _ = writeln!(
            text,
            "doses from {least_ml_s:.3} to {most_ml_s:.3} mL/s use it from now on; `dose calibrate use none` goes back to the model",
        );
    } else {
        text.push_str("doses use it from now on; `dose calibrate use none` goes back to the model\n");
    }
    Ok(text)
}

/// Every calibration, a line each; the one in use is marked.
pub(super) fn list(bench: &Bench, all: &[Stored], active: Option<u32>) -> String {
    if all.is_empty() {
        let (pump, driver) = (&bench.file().pump.id, bench.driver().as_str());
        return format!(
            "{pump} ({driver}) is not calibrated; `dose calibrate run` weighs what it delivers\n"
        );
    }
    let mut text = String::new();
    for Stored { version, calibration } in all {
        let mark = if active == Some(*version) { '*' } else { ' ' };
        let what = calibration.displacement.as_ref().map_or("zero only".to_owned(), |found| {
            let factor = match &found.speed_law {
                None => format!("times {:.4}", found.factor),
                Some(law) => format!("s {:.4}, D {:.2e} /kPa", law.scale, law.distensibility_per_kpa),
            };
            format!("{} runs at {}, {factor}", calibration.runs.len(), speeds(found))
        });
        let _ = write!(text, "{mark} {version:>3}  {}  {what}", calibration.date);
        if calibration.zero_deg != 0.0 {
            let _ = write!(text, ", zero at {:.2}°", calibration.zero_deg);
        }
        for (name, said) in [("tube", &calibration.tube), ("note", &calibration.note)] {
            if let Some(said) = said {
                let _ = write!(text, ", {name} {said}");
            }
        }
        text.push('\n');
    }
    if active.is_none() {
        text.push_str("none is in use; `dose calibrate use <N>` uses one\n");
    }
    text
}
