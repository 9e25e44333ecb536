//! Calibrations of the displacement in words and as JSON.

mod next_weighing;
mod surer_before;

use std::fmt::Write;

use pump_model::Pump;
use serde_json::json;

use self::next_weighing::NextWeighing;
use self::surer_before::surer_before;
use super::status::UnfinishedCalibration;
use crate::bench::Bench;
use crate::calibration::{
    AgainstSpeed, Calibration, CalibrationError, Displacement, Stored, default_rate_uncovered,
};
use crate::displacement::SpeedDependentPump;
use crate::notice::{Remedy, Wording};
use crate::numbers::{short, two_digits};
use crate::pump_file::PumpFile;

/// One line of JSON of a calibration that was stored, with the warnings of its fit. `before` is the calibration that
/// was in use until then.
///
/// # Errors
///
/// A displacement that cannot be had of this pump.
pub fn calibration_json(
    bench: &Bench,
    stored: &Stored,
    before: Option<&Stored>,
) -> Result<String, CalibrationError> {
    let mut warnings = match &stored.calibration.displacement {
        Some(found) => warnings(bench.file(), bench.model(), found)?,
        None => Vec::new(),
    };
    warnings.extend(surer_before(bench, stored, before)?);
    let mut report = json!(stored);
    report["used"] = json!(bench.would_use(&stored.calibration).unwrap_or(true));
    report["warnings"] = json!(warnings);
    if let Some(next) = NextWeighing::of(bench.model(), stored, in_use(bench).as_ref())? {
        report["next_weighing"] = json!(next);
    }
    Ok(format!("{report}\n"))
}

/// One line of JSON of every calibration (`calibrations/1`); `active` is the one in use.
pub fn calibrations_json(all: &[Stored], active: Option<u32>) -> String {
    format!("{}\n", json!({ "schema": "calibrations/1", "active": active, "calibrations": all }))
}

/// Says what a calibration found, and which doses use it from now on, or would if it were kept. `before` is the
/// calibration that was in use until then.
///
/// # Errors
///
/// A displacement that cannot be had of this pump.
pub fn calibration_text(
    bench: &Bench,
    stored: &Stored,
    before: Option<&Stored>,
    is_kept: bool,
    words: Wording,
) -> Result<String, CalibrationError> {
    let Some(found) = &stored.calibration.displacement else { return Ok(String::new()) };
    let (file, base) = (bench.file(), bench.model());
    let mut text = heading(bench, stored, found);
    text += &factors(base, stored, found)?;
    let next = NextWeighing::of(base, stored, in_use(bench).as_ref())?;
    text += &next.map_or(String::new(), |next| next.text(found, words));
    text += &scatter(file, found).unwrap_or_default();
    for warning in warnings(file, base, found)? {
        text += &format!("  warning: {warning}\n");
    }
    if let Some(warning) = surer_before(bench, stored, before)? {
        text += &format!("  warning: {warning}; {}\n", words(Remedy::UseCalibration));
    }
    text += &match bench.would_use(&stored.calibration) {
        Ok(false) => waits(bench, stored, found, words)?,
        _ => range(base, found, is_kept, words)?,
    };
    Ok(text)
}

/// The calibration by which the next dose is planned: none while this one waits, or where none can be read.
fn in_use(bench: &Bench) -> Option<Calibration> {
    bench.calibrations().active().ok().flatten().map(|stored| stored.calibration)
}

/// Lists every calibration, a line each; the one in use is marked. A guided calibration that is unfinished comes last.
pub fn calibrations_text(bench: &Bench, all: &[Stored], active: Option<u32>, words: Wording) -> String {
    let unfinished = UnfinishedCalibration::of(bench).map_or(String::new(), |found| found.text(words) + "\n");
    finished_text(bench, all, active, words) + &unfinished
}

fn finished_text(bench: &Bench, all: &[Stored], active: Option<u32>, words: Wording) -> String {
    if all.is_empty() {
        let (pump, driver) = (&bench.file().pump.id, bench.drive_id());
        return format!("{pump} ({driver}) is not calibrated; {}\n", words(Remedy::Weigh));
    }
    let mut text: String = all.iter().map(|stored| listed(stored, active)).collect();
    if active.is_none() {
        text += &format!("none is in use; {}\n", words(Remedy::UseCalibration));
    }
    text
}

fn listed(stored: &Stored, active: Option<u32>) -> String {
    let Stored { version, calibration } = stored;
    let mark = if active == Some(*version) { '*' } else { ' ' };
    let none = if calibration.pulse.is_some() { "pulse only" } else { "zero only" };
    let what = calibration.displacement.as_ref().map_or(none.to_owned(), |found| {
        let factor = match &found.law {
            None => format!("times {:.4}", found.factor),
            Some(law) => law.to_string(),
        };
        let runs = counted(calibration.runs.len());
        format!("{runs} of {} at {}, {factor}", calibration.fluid, speeds(found))
    });
    let mut text = format!("{mark} {version:>3}  {}  {what}", calibration.date);
    // Writing to a String cannot fail.
    if calibration.zero_deg != 0.0 {
        let _ = write!(text, ", zero at {:.2}°", calibration.zero_deg);
    }
    if let Some(pulse) = &calibration.pulse {
        let (volume_ml, deg) = (pulse.roller_volume_ml, pulse.engagement_deg);
        let _ = write!(text, ", roller volume {volume_ml:.4} mL over {deg:.2}°");
    }
    for (name, said) in [("tube", &calibration.tube), ("note", &calibration.note)] {
        if let Some(said) = said {
            let _ = write!(text, ", {name} {said}");
        }
    }
    text + "\n"
}

/// A number of runs.
fn counted(runs: usize) -> String {
    if runs == 1 { "1 run".to_owned() } else { format!("{runs} runs") }
}

/// The speeds of the runs.
fn speeds(displacement: &Displacement) -> String {
    let speeds: Vec<String> = displacement.speeds_rpm.iter().map(|rpm| short(*rpm)).collect();
    format!("{} r/min", speeds.join(", "))
}

fn heading(bench: &Bench, stored: &Stored, found: &Displacement) -> String {
    let Stored { version, calibration } = stored;
    format!(
        "calibration {version} of {} ({}): {} at {}, {} at {} °C\n",
        bench.file().pump.id,
        bench.drive_id(),
        counted(calibration.runs.len()),
        speeds(found),
        calibration.fluid,
        calibration.temperature_degc,
    )
}

/// The factor on the model's volume at each speed, and the law if one was fitted.
fn factors(base: &Pump, stored: &Stored, found: &Displacement) -> Result<String, CalibrationError> {
    let mut text = String::new();
    for rpm in &found.speeds_rpm {
        let (factor, standard) = (found.factor_at(base, *rpm)?, found.whole_standard_at(base, *rpm)?);
        text += &format!(
            "  at {:>7} r/min  model volume times {factor:.4} ± {:.4} (k = 2), {:.3} mL per revolution\n",
            short(*rpm),
            2.0 * standard,
            factor * stored.calibration.revolution_ml
        );
    }
    if let Some(law) = &found.law {
        text += &format!("  speed law  {}\n", law.text_with_uncertainty());
    }
    if let Some(bend) = &found.bend {
        text += &format!(
            "  parabola   bend {:.2e} ± {:.1e} min²/r² (k = 2): an F test at 4.55 % rejects a straight line\n",
            bend.per_rpm2,
            2.0 * found.bend_standard_per_rpm2()
        );
    }
    if let Some(pulse) = &stored.calibration.pulse {
        text += &format!(
            "  pulse      the short doses again, with this volume: roller volume {:.4} ± {:.4} mL over {:.2}°\n",
            pulse.roller_volume_ml,
            2.0 * pulse.roller_volume_standard_ml,
            pulse.engagement_deg
        );
    }
    Ok(text)
}

/// The scatter of the runs, and how far the speeds depart from the fit.
fn scatter(file: &PumpFile, found: &Displacement) -> Option<String> {
    let percent = 100.0 * found.scatter.standard()?;
    let expected = file.uncertainty.repeatability_percent;
    let departure = match found.speeds_rpm.len() {
        0..3 => String::new(),
        _ => {
            let of = match (&found.law, &found.bend) {
                (Some(_), _) => "speed law",
                (None, Some(_)) => "parabola",
                (None, None) => "line",
            };
            format!(", speeds depart from the {of} by {:.3} %", 100.0 * found.lack_of_fit)
        }
    };
    Some(format!("  runs scatter by {percent:.3} % (the pump file says {expected} %){departure}\n"))
}

fn warnings(file: &PumpFile, base: &Pump, found: &Displacement) -> Result<Vec<String>, CalibrationError> {
    let mut warnings: Vec<String> = found
        .outliers
        .iter()
        .map(|run| format!("run {run} lies far from the others; it is in the fit: weigh it again"))
        .collect();
    if found.scatter.standard().is_some_and(|scatter| found.lack_of_fit > 2.0 * scatter.max(found.reading)) {
        let instead = match found.speeds_rpm.len() {
            3 if found.law.is_none() => "; a fourth speed may show a parabola",
            _ => "",
        };
        warnings.push(format!(
            "the speeds depart from the fit by far more than the runs scatter; it is not their shape{instead}"
        ));
    }
    warnings.extend(slip(found));
    let (limit_rpm, fastest_rpm) = (file.motor.max_speed_rpm, found.range_rpm().1);
    if fastest_rpm > 1.01 * limit_rpm {
        let (fastest, limit) = (short(fastest_rpm), short(limit_rpm));
        warnings.push(format!(
            "{fastest} r/min is beyond the motor's {limit} r/min; were these runs made with this pump?"
        ));
    }
    warnings.extend(match found.speeds_rpm.len() {
        0 | 1 => Some("one speed; doses at others are less sure, calibrate at three or more".to_owned()),
        2 => Some("two speeds do not show whether a line fits; calibrate at three or more".to_owned()),
        _ => None,
    });
    warnings.extend(default_rate_uncovered(file, base, found)?);
    Ok(warnings)
}

/// Scatter of a few weighed doses over the one that their prior states from which on a reading is hardly right. If the
/// prior is right, two doses scatter so by chance in one of 16,000 cases.
const SLIP: f64 = 4.0;

/// Scatter of a few weighed doses over the one that their prior states from which on it is told. If the prior is right,
/// two doses scatter so by chance in one of 22 cases.
const WIDE: f64 = 2.0;

/// Says that a few weighed doses scatter by more than was expected, or by so much that one of their readings is hardly
/// right.
fn slip(found: &Displacement) -> Option<String> {
    let (scatter, prior) = (found.scatter.standard()?, found.prior?);
    let meaning = match scatter / prior.standard {
        _ if !prior.rests_on_few() => return None,
        times if times > SLIP => {
            "one of them is hardly right, by its reading, a tare, a drop or air in the line; weigh anew before you \
             rely on it"
        }
        times if times > WIDE => "one more dose shows if a reading slipped, or if this pump scatters more",
        _ => return None,
    };
    let [scatter, expected] = [scatter, prior.standard].map(|part| two_digits(100.0 * part));
    Some(format!("the weighed doses scatter by {scatter} %, and {expected} % were expected: {meaning}"))
}

/// Says that weighed doses which show the volume less well than the model are not used, and what would use them.
fn waits(
    bench: &Bench,
    stored: &Stored,
    found: &Displacement,
    words: Wording,
) -> Result<String, CalibrationError> {
    let (file, base) = (bench.file(), bench.model());
    let of_doses = found.whole_part_at(base, found.reference_rpm)?;
    Ok(format!(
        "calibration {} waits: the mean volume by these doses, \u{b1} {} %, is less sure than the model's, \u{b1} {} % \
         (k = 2); doses keep to the model until more are weighed; {}\n",
        stored.version,
        two_digits(200.0 * of_doses),
        two_digits(200.0 * file.model_standard()),
        words(Remedy::UseCalibration),
    ))
}

/// The flows of the doses that use the calibration.
fn range(
    base: &Pump,
    found: &Displacement,
    is_kept: bool,
    words: Wording,
) -> Result<String, CalibrationError> {
    let pump = SpeedDependentPump::constant(*base);
    let flows = AgainstSpeed::of(Some(found), &pump).map(|against| against.flows_ml_s(false));
    let doses = match flows.transpose()?.flatten() {
        Some((least_ml_s, most_ml_s)) => format!("doses from {least_ml_s:.3} to {most_ml_s:.3} mL/s"),
        None => "doses".to_owned(),
    };
    if !is_kept {
        return Ok(format!("{doses} would use it if it were kept\n"));
    }
    Ok(format!("{doses} use it from now on; {}\n", words(Remedy::UseModel)))
}
