//! A dose into a tared vessel, and its weight: the first calibration.

use pump_bench::calibration::{Earlier, Expected, Stored};
use pump_bench::report::calibration_text;
use pump_bench::units::{StatedReading, stated_reading};
use pump_bench::{Bench, DoseReport, DoseRequest, Session};

use super::asker::{Asked, Question, Usual};
use super::course::{Course, heading, quieten, tell_person};
use super::options::AnswerOptions;
use super::written::rounded;
use crate::advice;
use crate::commands::delivery::deliver;
use crate::failure::Failure;
use crate::terminal::{noted, tell};

/// Usual volume of the dose that is weighed, mL: a kitchen scale of 0.01 g then reads it to a thousandth.
const USUAL_ML: f64 = 10.0;

/// Most and fewest revolutions of that dose: it takes a minute or two, and the pulses of a revolution count little.
const REVOLUTIONS: [f64; 2] = [2.0, 40.0];

/// Doses into the vessel and asks for the weight. Returns false if nobody can say the weight now.
pub(super) fn weigh(course: &mut Course, options: &AnswerOptions) -> Asked<bool> {
    let mut given = options.weight;
    loop {
        let mut balance_g = None;
        if !course.answers.done.dosed {
            heading("A dose to be weighed");
            if course.answers.volume_ml.is_none() {
                ask_volume(course)?;
            }
            balance_g = dose(course)?;
            // A weight on the command line is that of a dose that is in the vessel.
            given = given.filter(|_| course.is_simulated());
        }
        let reading = match given.take() {
            Some(reading) => Some(reading),
            None if course.asker.is_silent() && !course.is_simulated() => return Ok(false),
            None => ask_weight(course, balance_g)?,
        };
        let Some(reading) = reading else {
            course.answers.done.dosed = false;
            course.keep()?;
            continue;
        };
        match keep(course, &reading, options.temperature) {
            Ok(()) => return Ok(true),
            Err(failure) if course.asker.is_silent() || options.weight.is_some() => {
                return Err(failure.into());
            }
            Err(failure) => tell_person(&format!("  {}", failure.message())),
        }
    }
}

fn ask_volume(course: &mut Course) -> Asked<()> {
    let bench = course.bench()?;
    let revolution_ml = bench.model().revolution_ml();
    let fits_ml = USUAL_ML.min(REVOLUTIONS[1] * revolution_ml).max(REVOLUTIONS[0] * revolution_ml);
    let same_head = course.last.as_ref().filter(|last| last.head == course.answers.head);
    let of_last = same_head.and_then(|last| {
        let answer = format!("{}mL", last.volume_ml?);
        Some(Usual { answer, of: Some(last.name.clone()) })
    });
    let question = Question {
        text: "Volume of the dose",
        option: "--volume 5mL",
        usual: of_last.or(Some(Usual::new(format!("{}mL", rounded(fits_ml))))),
        help: "the volume that you will mostly dose, or one that your scale reads to a thousandth",
    };
    let read = |answer: &str| pump_bench::units::volume_ml(answer).map_err(|error| error.to_string());
    course.settle(&question, read, |answers, ml| answers.volume_ml = Some(ml))
}

/// Doses into the vessel. Returns what a simulated balance shows, g.
fn dose(course: &mut Course) -> Asked<Option<f64>> {
    let bench = course.bench()?;
    let asked_ml = course.answers.volume_ml.unwrap_or(USUAL_ML);
    let volume_ml = exact_ml(&bench, asked_ml)?;
    if volume_ml != asked_ml {
        tell_person(&format!(
            "  Nobody knows yet where the rollers stand, so the dose is {} mL: whole pitches are exact from anywhere.",
            rounded(volume_ml)
        ));
    }
    let question = Question {
        text: "Put a vessel on the scale below the outlet and tare it; Enter doses",
        option: "--yes",
        usual: Some(Usual::new("yes")),
        help: "the dose begins when you press Enter",
    };
    course.asker.ask(&question, |answer| match answer {
        "y" | "yes" => Ok(()),
        other => Err(format!("`{other}`: press Enter, or say quit")),
    })?;
    let mut session = bench.session()?;
    let prepared = session.prepare(DoseRequest::dose(volume_ml));
    let mut prepared = noted(&mut session, prepared)?;
    quieten(&mut prepared);
    course.tell_time(prepared.motion_s());
    let delivered = deliver(&bench, &mut session, &prepared, course.asker.interrupt(), false);
    course.note_motion(&session);
    let (delivered, signal) = delivered?;
    let report = DoseReport::new(&bench, &prepared, Some(&delivered));
    tell(&report.summary(None, None))?;
    if !delivered.completed {
        return Err(Failure::stopped(signal.unwrap_or(0), true, "stopped by the user in the dose").into());
    }
    course.answers.done.dosed = true;
    course.keep()?;
    Ok(report.balance_g.filter(|_| bench.is_simulated()))
}

/// The volume whose turn is the same from wherever the rollers stand, if nobody knows that: whole pitches.
fn exact_ml(bench: &Bench, volume_ml: f64) -> Result<f64, Failure> {
    if bench.stands()?.phase().is_known(bench.model().pitch_rad()) {
        return Ok(volume_ml);
    }
    let active = bench.calibrations().active()?;
    let factor = active.and_then(|stored| stored.calibration.displacement).map_or(1.0, |found| found.factor);
    let pitch_ml = factor * bench.model().outlet_curve().pitch_ml();
    let whole_ml = (volume_ml / pitch_ml).round().max(1.0) * pitch_ml;
    let is_whole = (whole_ml / volume_ml - 1.0).abs() < 1e-9;
    Ok(if is_whole { volume_ml } else { whole_ml })
}

/// Asks for the weight. `None` for a dose that is to be made again.
fn ask_weight(course: &mut Course, balance_g: Option<f64>) -> Asked<Option<StatedReading>> {
    let question = Question {
        text: "Reading of the scale, as 4.93g (redo: dose again)",
        option: "--weight 4.93g",
        usual: balance_g.map(|grams| Usual::new(format!("{grams:.3}g"))),
        help: "the reading with all digits of the scale: the last one says how sure it is. Water of 25 °C is weighed, \
               --temperature says another. redo doses again, if a drop fell beside the vessel",
    };
    course.asker.ask(&question, |answer| match answer {
        "redo" => Ok(None),
        answer => stated_reading(answer).map(Some).map_err(|error| error.to_string()),
    })
}

/// Calibrates the pump by the weight.
fn keep(course: &mut Course, reading: &StatedReading, temperature_degc: Option<f64>) -> Result<(), Failure> {
    let bench = course.bench()?;
    let held = bench.folder().lock()?;
    let expected = Expected::of_digits(bench.file(), reading);
    let weighed = bench.weigh_last_dose(reading, temperature_degc, Earlier::Joined, &expected)?;
    let stored: Stored = bench.keep_calibration(weighed.calibration)?;
    drop(held);
    tell(&calibration_text(&bench, &stored, advice::words)?)?;
    course.answers.done.dosed = false;
    course.answers.done.weighed += 1;
    course.keep()
}

/// Accepts a dose of the course that was stopped or cut off, so that another can be made. Its volume is on record.
pub(super) fn accept_stopped(course: &mut Course) -> Asked<()> {
    let bench = course.bench()?;
    if bench.story()?.state.is_none_or(|state| state.unfinished.is_none()) {
        return Ok(());
    }
    let question = Question {
        text: "A motion of this pump was stopped before its end. Leave it as it is, and go on?",
        option: "--yes",
        usual: Some(Usual::new("yes")),
        help: "its volume stays on record; empty and tare the vessel. `dose status` says what was delivered",
    };
    if !course.asker.agrees(&question)? {
        return Err(super::asker::Stop::Left);
    }
    let mut session: Session<'_> = bench.session()?;
    let accepted = session.accept();
    noted(&mut session, accepted)?;
    course.answers.done.dosed = false;
    Ok(course.keep()?)
}
