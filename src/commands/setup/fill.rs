//! The line is filled before the first dose.

use pump_bench::record::Purpose;
use pump_bench::setup::Topic;
use pump_bench::{DoseReport, DoseRequest};

use super::asker::{Asked, Question, Stop, Usual, yes_or_no};
use super::course::{Course, heading, quieten, rounded, within};
use super::options::volume_or_0;
use crate::commands::delivery::deliver;
use crate::failure::Failure;
use crate::terminal::noted;
use crate::warned::Warned;

/// Revolutions that fill the hoses of most pumps.
const REVOLUTIONS: f64 = 10.0;

/// Time from which on the filling of a line is asked for once more, s.
const LONG_S: f64 = 120.0;

/// Fills the line, as often as the person wants. `is_typed` is true if this call has named the volume: that of an
/// earlier one has moved the pump already, or was never agreed to.
pub(super) fn fill(course: &mut Course, is_typed: bool) -> Asked<()> {
    if course.answers.done.primed {
        return Ok(());
    }
    heading("The line");
    let most_ml = course.most_ml()?;
    let mut named_ml = course.answers.prime_ml.filter(|_| is_typed);
    let mut asks_volume = false;
    loop {
        let volume_ml = match (named_ml.take(), course.answers.done.prime_left_ml) {
            (Some(named_ml), _) => {
                let refused =
                    |why| Failure::refused(format!("{why}; say --prime 5mL")).value(format!("{named_ml} mL"));
                within(named_ml, most_ml).map_err(refused)?
            }
            (None, Some(0.0)) if !asks_volume => match ask_more(course, most_ml) {
                // Pumped liquid stays in the line: the previous question suggests no more of it.
                Err(Stop::Back) => {
                    asks_volume = true;
                    continue;
                }
                more_ml => more_ml?,
            },
            (None, _) => ask_volume(course, most_ml)?,
        };
        if volume_ml == 0.0 {
            course.answers.done.primed = true;
            return Ok(course.keep()?);
        }
        match prime(course, volume_ml) {
            Err(Stop::Back) => {}
            primed => {
                primed?;
                asks_volume = false;
            }
        }
    }
}

/// Asks once more if the line is full.
pub(super) fn reopen(course: &mut Course) -> Result<(), Failure> {
    course.answers.done.primed = false;
    course.keep()
}

/// Asks for the volume, mL. What an earlier filling has left is suggested.
fn ask_volume(course: &mut Course, most_ml: f64) -> Asked<f64> {
    let in_words = |ml: f64| format!("{}mL", rounded(ml));
    let usual = in_words(REVOLUTIONS * course.bench()?.model().revolution_ml());
    let left_ml = course.answers.done.prime_left_ml;
    let before_ml = left_ml.or(course.answers.prime_ml).filter(|ml| *ml <= most_ml);
    let question = Question {
        text: "Volume that fills both hoses (0: they are full)",
        option: "--prime 5mL",
        usual: before_ml.map(|ml| Usual::new(in_words(ml))).or_else(|| {
            course.suggested(
                // A line that was full says nothing of this one.
                |last| last.prime_ml.filter(|ml| *ml > 0.0 && *ml <= most_ml).map(|ml| format!("{ml}mL")),
                Some(&usual),
            )
        }),
        help: "a hose of 3 mm bore holds 7 mL a metre; more can follow",
    };
    let mut asked_ml = 0.0;
    let read = |answer: &str| within(volume_or_0(answer)?, most_ml);
    course.settle(Topic::Prime, &question, read, |answers, ml| {
        asked_ml = ml;
        answers.prime_ml = if left_ml.is_some() { answers.prime_ml } else { Some(ml) };
    })?;
    Ok(asked_ml)
}

/// Pumps a volume into the line. Notes what is left of it if the pump is stopped.
fn prime(course: &mut Course, volume_ml: f64) -> Asked<()> {
    let bench = course.bench()?;
    let request = DoseRequest::new(Purpose::Prime, volume_ml);
    let motion_s = bench.prepare(request)?.motion_s();
    course.tell_time(motion_s);
    if motion_s > LONG_S {
        allow(course)?;
    }
    let mut session = bench.session()?;
    let prepared = session.prepare(request);
    let mut prepared = noted(&mut session, prepared)?;
    quieten(&bench, &mut prepared);
    let delivered =
        deliver(&bench, &mut session, &prepared, course.asker.interrupt(), false, &mut Warned::default());
    course.note_motion(&session);
    let (delivered, signal) = delivered?;
    course.tell(&DoseReport::new(&bench, &prepared, Some(&delivered)).summary(None, None))?;
    let left_ml = if delivered.completed { 0.0 } else { (volume_ml - delivered.volume_ml).max(0.0) };
    course.answers.done.prime_left_ml = Some(left_ml);
    course.keep()?;
    if delivered.completed {
        return Ok(());
    }
    Err(Failure::stopped(signal.unwrap_or(0), true, "stopped by the user while the line was filled").into())
}

/// Asks if a filling may begin that takes long.
fn allow(course: &mut Course) -> Asked<()> {
    let question = Question {
        text: "That is long for a line. Begin? (yes, no)",
        option: "--yes",
        usual: Some(Usual::new("yes")),
        help: "no leaves; the next run asks for the volume again",
    };
    if course.asker.agrees(&question)? { Ok(()) } else { Err(Stop::Left) }
}

/// Asks if the line is full. Returns the volume to pump more, mL, or 0.
fn ask_more(course: &mut Course, most_ml: f64) -> Asked<f64> {
    let question = Question {
        text: "Is the line full and without bubbles? If not, how much more, as 2mL?",
        option: "--prime 5mL",
        usual: Some(Usual::new("yes")),
        help: "yes if liquid stands up to the end of the outlet; otherwise a volume to pump more, as 2mL",
    };
    course.asker.ask(&question, |answer| match yes_or_no(answer) {
        Some(true) => Ok(0.0),
        Some(false) => Err("how much more, as 2mL?".to_owned()),
        None => within(volume_or_0(answer)?, most_ml),
    })
}
