//! The line is filled before the first dose.

use pump_bench::record::Purpose;
use pump_bench::{DoseReport, DoseRequest};

use super::asker::{Asked, Question, Usual, yes_or_no};
use super::course::{Course, heading, quieten};
use super::options::volume_or_0;
use super::written::rounded;
use crate::commands::delivery::deliver;
use crate::failure::Failure;
use crate::terminal::noted;
use crate::warned::Warned;

/// Revolutions that fill the hoses of most pumps.
const REVOLUTIONS: f64 = 10.0;

/// Fills the line, as often as the person wants.
pub(super) fn fill(course: &mut Course) -> Asked<()> {
    if course.answers.done.primed {
        return Ok(());
    }
    heading("The line");
    if course.answers.prime_ml.is_none() {
        ask_volume(course)?;
    }
    let mut volume_ml = course.answers.prime_ml.unwrap_or(0.0);
    while volume_ml > 0.0 {
        prime(course, volume_ml)?;
        volume_ml = ask_more(course)?;
    }
    course.answers.done.primed = true;
    Ok(course.keep()?)
}

fn ask_volume(course: &mut Course) -> Asked<()> {
    let revolution_ml = course.bench()?.model().revolution_ml();
    let usual = format!("{}mL", rounded(REVOLUTIONS * revolution_ml));
    let question = Question {
        text: "Volume that fills both hoses (0: they are full)",
        option: "--prime 5mL",
        usual: course.suggested(
            // A line that was full says nothing of this one.
            |last| last.prime_ml.filter(|ml| *ml > 0.0).map(|ml| format!("{ml}mL")),
            Some(&usual),
        ),
        help: "a hose of 3 mm bore holds 7 mL a metre; more can follow",
    };
    course.settle(&question, volume_or_0, |answers, ml| answers.prime_ml = Some(ml))
}

/// Pumps a volume into the line.
fn prime(course: &mut Course, volume_ml: f64) -> Asked<()> {
    let bench = course.bench()?;
    let mut session = bench.session()?;
    let prepared = session.prepare(DoseRequest::new(Purpose::Prime, volume_ml));
    let mut prepared = noted(&mut session, prepared)?;
    quieten(&bench, &mut prepared);
    course.tell_time(prepared.motion_s());
    let delivered =
        deliver(&bench, &mut session, &prepared, course.asker.interrupt(), false, &mut Warned::default());
    course.note_motion(&session);
    let (delivered, signal) = delivered?;
    course.tell(&DoseReport::new(&bench, &prepared, Some(&delivered)).summary(None, None))?;
    if delivered.completed {
        return Ok(());
    }
    Err(Failure::stopped(signal.unwrap_or(0), true, "stopped by the user while the line was filled").into())
}

/// Asks if the line is full. Returns the volume to pump more, mL, or 0.
fn ask_more(course: &mut Course) -> Asked<f64> {
    let question = Question {
        text: "Is the line full and without bubbles? If not, how much more, as 2mL?",
        option: "--prime 5mL",
        usual: Some(Usual::new("yes")),
        help: "yes if liquid stands up to the end of the outlet; otherwise a volume to pump more, as 2mL",
    };
    course.asker.ask(&question, |answer| match yes_or_no(answer) {
        Some(true) => Ok(0.0),
        Some(false) => Err("how much more, as 2mL?".to_owned()),
        None => volume_or_0(answer),
    })
}
