//! Warnings of what the calibration in use has not weighed: the pump, its fluid, and its motor's steps.

use pump_ctl::plan::Prediction;
use pump_ctl::step::Direction;
use pump_model::Port;

use crate::calibration::{Applied, Made, head_in_words};
use crate::catalogue::{SUCKS, beyond_known_kpa, built_in, doubtful, suction_warning};
use crate::notice::{Notice, Remedy};
use crate::numbers::significant;
use crate::pump_file::PumpFile;

/// Fluid of published flows, and of the measurements of McIntyre et al.: its name and temperature in °C.
const WATER: (&str, f64) = ("water", 25.0);

/// Part by which two numbers of steps may differ as a gear is rounded.
const SAME_STEPS: f64 = 1e-6;

/// Warns of a pump that may deliver something else than its model says, and of a fluid that flows through a fixed
/// resistance.
pub(in crate::dosing) fn of_pump(
    file: &PumpFile,
    applied: Option<&Applied>,
    prediction: &Prediction,
    direction: Direction,
) -> impl Iterator<Item = Notice> {
    let is_weighed = applied.is_some_and(|applied| applied.sureness().is_some());
    let of_file: Vec<_> = doubtful(file, is_weighed).collect();
    let of_dose = deep_suction(file, prediction, direction, is_weighed);
    let is_told = of_dose.is_some() && of_file.iter().any(|notice| notice.text().starts_with(SUCKS));
    of_file
        .into_iter()
        .filter(move |notice| !is_told || !notice.text().starts_with(SUCKS))
        .chain(of_dose)
        .chain(file.resistance_warning())
}

/// Warns of a dose that sucks with more than its tube is known to stand, where nobody knows when the tube collapses: no
/// limit holds there. A pump that was weighed may suck from the height of its supply.
fn deep_suction(
    file: &PumpFile,
    prediction: &Prediction,
    direction: Direction,
    is_weighed: bool,
) -> Option<Notice> {
    let (port, sucking) = match direction {
        Direction::Forward => (Port::Inlet, prediction.inlet),
        Direction::Reverse => (Port::Outlet, prediction.outlet),
    };
    let by_height = beyond_known_kpa(file, file.ambient.pressure_kpa - file.reservoir_kpa(port)).is_some();
    let is_open = file.has_lines() && file.tube.collapse_below_ambient_kpa().is_none();
    let below_kpa = file.ambient.pressure_kpa - sucking.min_kpa;
    let text = suction_warning(file, below_kpa).filter(|_| is_open && !(is_weighed && by_height))?;
    Some(Notice::from(text))
}

/// Warns of a dose that differs from the weighed ones in its fluid or in the motor's steps.
pub(in crate::dosing) fn of_calibration(
    file: &PumpFile,
    applied: Option<&Applied>,
) -> impl Iterator<Item = Notice> {
    let notices = [unweighed_fluid(file, applied), other_steps(file, applied), other_head(file, applied)];
    notices.into_iter().flatten()
}

/// Warns of a calibration that was weighed while the file stated another number of steps. A driver that was not set to
/// the new number turns the head by another part of a revolution.
fn other_steps(file: &PumpFile, applied: Option<&Applied>) -> Option<Notice> {
    let weighed = applied.filter(|applied| applied.sureness().is_some())?;
    let Made { version, steps_per_rev, .. } = weighed.calibration.as_ref()?;
    let (then, now) = ((*steps_per_rev)?, file.motor.steps_at_pump_head());
    if (now / then - 1.0).abs() < SAME_STEPS {
        return None;
    }
    let times = significant(now / then, 3);
    let text = format!(
        "calibration {version} was weighed while the pump file stated {then} steps per revolution of the head, and now \
         it states {now}; unless the stepper driver was changed as well, doses are {times} times as large"
    );
    Some(Notice::from(text).with_remedy(Remedy::Weigh))
}

/// Warns of a calibration that was weighed with other rollers or another tube than the file states now, at the same
/// volume per revolution.
fn other_head(file: &PumpFile, applied: Option<&Applied>) -> Option<Notice> {
    let weighed = applied.filter(|applied| applied.sureness().is_some())?;
    let Made { version, head, .. } = weighed.calibration.as_ref()?;
    let (then, now) = (head.as_ref()?, head_in_words(file));
    let text = format!(
        "calibration {version} was weighed with {then}, and the pump file states {now} now; the dose's \u{b1} holds \
         for the head that was weighed"
    );
    (*then != now).then(|| Notice::from(text).with_remedy(Remedy::Weigh))
}

/// Warns of a pump that nobody has weighed, unless its displacement was calibrated.
///
/// The pump file says so: its roller volume is estimated from the drawing, it states the uncertainty over the speeds
/// that such pumps have, or it has the built-in pump's uncertainty under another name.
pub(in crate::dosing) fn unweighed_pump(file: &PumpFile, applied: Option<&Applied>) -> Option<Notice> {
    if applied.is_some_and(|applied| applied.sureness().is_some()) {
        return None;
    }
    let fact = if file.head.is_some() {
        "only the volume per revolution is known, and nobody has weighed what this pump delivers"
    } else if file.is_estimated() {
        "the roller volume is estimated from the drawing, and nobody has weighed what this pump delivers"
    } else if let Some(notice) = replaced_uncertainty(file) {
        return Some(notice);
    } else if file.uncertainty.speed_percent.is_some() {
        "nobody has weighed what this pump delivers"
    } else {
        return copied_uncertainty(file);
    };
    Some(weigh_first(fact))
}

/// Warns of a pump file that states the built-in pump's uncertainty for another head, so that another one counts.
fn replaced_uncertainty(file: &PumpFile) -> Option<Notice> {
    let own = &file.uncertainty;
    let (model, speed) = (own.model_percent, own.speed_percent.filter(|_| own.replaces_papers)?);
    Some(weigh_first(&format!(
        "the pump file states 2.4 %, which the makers of the built-in pump measured of theirs, and its head is \
         another; {model} % of the volume and {speed} % at a speed count in place of it, as of a pump that nobody \
         weighed"
    )))
}

/// Warns of a pump file that states the built-in pump's uncertainty under another name, or for another head.
pub(crate) fn copied_uncertainty(file: &PumpFile) -> Option<Notice> {
    if let Some(notice) = replaced_uncertainty(file) {
        return Some(notice);
    }
    let stated = &file.uncertainty;
    let paper = built_in("three-roller").filter(|_| built_in(&file.pump.id).is_none())?;
    let is_copy = stated.speed_percent.is_none() && stated.model_percent == paper.uncertainty.model_percent;
    is_copy.then(|| {
        weigh_first(
            "the pump file states 2.4 %, which the makers of the built-in pump measured of theirs, not of this one",
        )
    })
}

fn weigh_first(fact: &str) -> Notice {
    let text = format!("{fact}: pumps of one kind differ by 10 to 25 %");
    Notice::from(text).with_remedy(Remedy::Weigh)
}

/// Warns of a fluid much thicker or thinner than that of the calibration in use, or than the water of a head's
/// published or modelled volume.
fn unweighed_fluid(file: &PumpFile, applied: Option<&Applied>) -> Option<Notice> {
    let weighed = applied.filter(|applied| applied.sureness().is_some());
    let text = match weighed.and_then(|applied| applied.calibration.as_ref()) {
        Some(Made { version, fluid, temperature_degc, .. }) => {
            let known = format!("calibration {version} was weighed with");
            file.fluid.fills_unlike(fluid, *temperature_degc, &known)?
        }
        // Nothing can be said of a fluid whose viscosity nobody states.
        None if file.fluid.fluid().is_err() => return None,
        None => {
            file.fluid.fills_unlike(WATER.0, WATER.1, "published volumes of a revolution are those of")?
        }
    };
    Some(Notice::from(format!("{text}; the dose's \u{b1} does not contain that")).with_remedy(Remedy::Weigh))
}
