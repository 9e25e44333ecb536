//! A dose into a tared vessel, and its weight: the first calibration.

use pump_bench::balance::{Balance, BalanceReading};
use pump_bench::calibration::{Earlier, Expected, Stored};
use pump_bench::report::{Explain, calibration_text};
use pump_bench::setup::Topic;
use pump_bench::units::{Amount, StatedReading, stated_reading};
use pump_bench::{Bench, DoseReport, DoseRequest, Session};

use super::asker::{Asked, Question, Stop, Usual};
use super::course::{Course, heading, quieten, rounded, tell_person, within};
use super::options::AnswerOptions;
use crate::commands::delivery::deliver;
use crate::failure::Failure;
use crate::options::balance::{BalanceOptions, read_still};
use crate::terminal::noted;
use crate::warned::Warned;

/// Usual volume of the dose that is weighed, mL: a kitchen scale of 0.01 g then reads it to a thousandth.
const USUAL_ML: f64 = 10.0;

/// Words for a dose of the course that nobody can weigh any more.
const LATER_DOSE: &str = "the pump has moved since setup's dose, so nobody can weigh that one any more; empty and tare \
                          the vessel for another";

/// Words for a dose that was made while nobody read the balance.
const UNKNOWN_BEFORE: &str = "the balance was not read before this dose, so it may show the vessel too; the dose is on \
                              record: --weight says what it weighs, and --again makes another";

/// Reading of the balance before the dose, if there is a balance.
type ReadBefore<'a> = dyn FnMut() -> Result<Option<BalanceReading>, Failure> + 'a;

/// Most and fewest revolutions of that dose: it takes a minute or two, and the pulses of a revolution count little.
const REVOLUTIONS: [f64; 2] = [2.0, 40.0];

/// Doses into the vessel and takes the weight: that of the command line, that of the balance, or a person's. Returns
/// false if nobody can say the weight now.
pub(super) fn weigh(
    course: &mut Course,
    options: &AnswerOptions,
    named: &BalanceOptions,
    balance: &mut Option<Box<dyn Balance>>,
) -> Asked<bool> {
    let mut given = options.weight;
    if let Some(reading) = given.filter(|_| !course.answers.done.dosed && course.answers.done.weighed > 0) {
        refuse_later_dose(course)?;
        tell_person("The weight takes the place of the earlier reading of the dose that was made last.");
        keep(course, &reading, options.temperature, false)?;
        return Ok(true);
    }
    loop {
        let mut shown_g = None;
        if course.answers.done.dosed && !is_last(course)? {
            leave_dose(course)?;
            if given.is_some() {
                return Err(Failure::refused(LATER_DOSE).into());
            }
            tell_person(LATER_DOSE);
        }
        if !course.answers.done.dosed {
            settle_volume(course)?;
            let dosed = dose(course, &mut || {
                balance.as_mut().map(|balance| still(balance.as_mut(), named)).transpose()
            });
            shown_g = match dosed {
                Err(Stop::Back) => {
                    course.withdraw(Topic::Volume)?;
                    continue;
                }
                dosed => dosed?,
            };
        }
        let reading = match (given.take(), balance.as_mut()) {
            (Some(reading), _) => Some(reading),
            (None, Some(balance)) => {
                let before_g =
                    course.answers.done.before_g.ok_or_else(|| Failure::refused(UNKNOWN_BEFORE))?;
                let after = still(balance.as_mut(), named)?;
                Some(more_on(course, after, before_g)?)
            }
            (None, None) if course.asker.is_silent() && !course.is_simulated() => return Ok(false),
            (None, None) => ask_weight(course, shown_g)?,
        };
        let Some(reading) = reading else {
            leave_dose(course)?;
            continue;
        };
        match keep(course, &reading, options.temperature, true) {
            Ok(()) => return Ok(true),
            Err(failure) if course.asker.is_silent() || options.weight.is_some() || balance.is_some() => {
                return Err(failure.into());
            }
            Err(failure) => tell_person(&format!("  {}", failure.message())),
        }
    }
}

/// Announces the dose, and asks its volume unless it is known.
fn settle_volume(course: &mut Course) -> Asked<()> {
    heading("Weigh a dose");
    let fluid = course.bench()?.file().fluid.clone();
    tell_person(&format!(
        "The weight is taken as that of {} at {} °C; `dose` names another fluid by --fluid, or by [fluid] in \
         the pump file.",
        fluid.name, fluid.temperature_degc
    ));
    let most_ml = course.most_ml()?;
    let too_much = course.answers.volume_ml.and_then(|ml| within(ml, most_ml).err());
    if let Some(why) = too_much.as_ref().filter(|_| course.asker.is_silent()) {
        return Err(Failure::refused(format!("{why}; say --volume 5mL")).into());
    }
    if course.answers.volume_ml.is_none() || too_much.is_some() {
        ask_volume(course, most_ml)?;
    }
    Ok(())
}

/// True if the pump's last motion is the dose of the course, so that a scale can weigh it. Answers of an early version
/// do not tell the dose.
pub(super) fn is_last(course: &Course) -> Result<bool, Failure> {
    let bench = course.bench()?;
    let last = bench.last_number()?;
    let can_be_weighed = bench.story()?.state.is_some_and(|state| state.last.is_some());
    Ok(can_be_weighed && course.answers.done.dose.is_none_or(|number| number == last))
}

/// Refuses the weight of a dose that was made after the one that this course has weighed.
fn refuse_later_dose(course: &Course) -> Result<(), Failure> {
    if is_last(course)? {
        return Ok(());
    }
    let pump = &course.answers.name;
    Err(Failure::refused(format!(
        "the pump has dosed since setup weighed a dose of it, so this weight is not that of setup's dose; nothing is \
         kept; `dose calibrate last <READING> --pump {pump}` takes it for the last dose, and `dose setup {pump}` \
         doses anew and asks"
    )))
}

fn ask_volume(course: &mut Course, most_ml: f64) -> Asked<()> {
    let bench = course.bench()?;
    let revolution_ml = bench.model().revolution_ml();
    let fits_ml = USUAL_ML.min(REVOLUTIONS[1] * revolution_ml).max(REVOLUTIONS[0] * revolution_ml);
    let own = format!("{}mL", rounded(fits_ml));
    let question = Question {
        text: "Volume of the dose",
        option: "--volume 5mL",
        usual: course.suggested_of_head(
            |last| last.volume_ml.filter(|ml| *ml <= most_ml).map(|ml| format!("{ml}mL")),
            Some(&own),
        ),
        help: "the volume that you will mostly dose, or one that your scale reads to a thousandth",
    };
    let read = |answer: &str| {
        let volume_ml = pump_bench::units::volume_ml(answer).map_err(|error| error.to_string())?;
        within(volume_ml, most_ml)
    };
    course.settle(Topic::Volume, &question, read, |answers, ml| answers.volume_ml = Some(ml))
}

/// Reads a balance that stands still.
pub(super) fn still(balance: &mut dyn Balance, named: &BalanceOptions) -> Result<BalanceReading, Failure> {
    read_still(balance, named.longest_wait())
}

/// The mass that a balance shows more than before the dose.
fn more_on(course: &Course, after: BalanceReading, before_g: f64) -> Result<StatedReading, Failure> {
    let mass_g = after.mass_g - before_g;
    // The digits that the balance shows say how sure the mass is.
    let shown = BalanceReading { mass_g, ..after }.shown();
    tell_person(&format!("  {shown} more on the balance"));
    if mass_g > 0.0 {
        return Ok(StatedReading { amount: Amount::Mass(mass_g), resolution: Amount::Mass(after.step_g) });
    }
    if course.is_simulated() {
        return Err(Failure::refused(format!(
            "the balance rose by {shown} where a simulated motor made the steps of {} mL: no motor moved; without a \
             balance setup asks for a made-up reading",
            course.answers.volume_ml.unwrap_or(USUAL_ML)
        )));
    }
    Err(Failure::refused(format!(
        "the balance shows {shown} of the dose; is the vessel on it, and the line filled? The dose is on record, and \
         `--weight` says what it weighs"
    )))
}

/// Doses into the vessel. Returns what a simulated balance shows, g. The reading of a real one before the dose is on
/// record with the dose.
fn dose(course: &mut Course, before: &mut ReadBefore<'_>) -> Asked<Option<f64>> {
    let bench = course.bench()?;
    let asked_ml = course.answers.volume_ml.unwrap_or(USUAL_ML);
    let volume_ml = exact_ml(&bench, asked_ml)?;
    if volume_ml != asked_ml {
        tell_person(&format!(
            "  Nobody knows yet where the rollers stand, so the dose is {} mL: whole pitches are exact from anywhere.",
            rounded(volume_ml)
        ));
    }
    course.tell_time(bench.prepare(DoseRequest::dose(volume_ml))?.motion_s());
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
    let before = before()?;
    let mut session = bench.session()?;
    let prepared = session.prepare(DoseRequest::dose(volume_ml));
    let mut prepared = noted(&mut session, prepared)?;
    quieten(&bench, &mut prepared);
    let delivered =
        deliver(&bench, &mut session, &prepared, course.asker.interrupt(), false, &mut Warned::default());
    course.note_motion(&session);
    let (delivered, signal) = delivered?;
    let report = DoseReport::new(&bench, &prepared, Some(&delivered));
    course.tell(&report.summary(None, None))?;
    if !delivered.completed {
        return Err(Failure::stopped(signal.unwrap_or(0), true, "stopped by the user in the dose").into());
    }
    drop(session);
    (course.answers.done.dosed, course.answers.done.dose) = (true, Some(bench.last_number()?));
    course.answers.done.before_g = before.map(|before| before.mass_g);
    course.keep()?;
    Ok(report.balance_g.filter(|_| bench.is_simulated()))
}

/// The volume whose turn is the same from wherever the rollers stand, if nobody knows that: whole pitches. A dose that
/// is made again turns by as many pitches, whatever the first weighing has shown.
fn exact_ml(bench: &Bench, volume_ml: f64) -> Result<f64, Failure> {
    if bench.stands()?.phase().is_known(bench.model().pitch_rad()) {
        return Ok(volume_ml);
    }
    let active = bench.calibrations().active()?;
    let factor = active.and_then(|stored| stored.calibration.displacement).map_or(1.0, |found| found.factor);
    let pitch_ml = bench.model().outlet_curve().pitch_ml();
    let whole_ml = (volume_ml / pitch_ml).round().max(1.0) * factor * pitch_ml;
    let is_whole = (whole_ml / volume_ml - 1.0).abs() < 1e-9;
    Ok(if is_whole { volume_ml } else { whole_ml })
}

/// Asks for the weight. `None` for a dose that is to be made again.
fn ask_weight(course: &mut Course, balance_g: Option<f64>) -> Asked<Option<StatedReading>> {
    let question = Question {
        text: "Reading of the scale, as 4.93g, or of a cylinder, as 4.9mL (redo: dose again)",
        option: "--weight 4.93g, or --again to dose again",
        usual: balance_g.map(|grams| Usual::new(format!("{grams:.3}g"))),
        help: "the reading with all digits of the scale: the last one says how sure it is. Water of 25 °C is weighed, \
               --temperature says another. redo doses again, if a drop fell beside the vessel",
    };
    loop {
        let asked = course.asker.ask(&question, |answer| match answer {
            "redo" => Ok(None),
            bare if bare.parse::<f64>().is_ok() => {
                Err(format!("`{bare}` has no unit; write {bare}g if the scale shows g"))
            }
            answer => stated_reading(answer).map(Some).map_err(|error| error.to_string()),
        });
        match asked {
            Err(Stop::Back) => tell_person(
                "  the dose is in the vessel, and no way leads back over it; redo leaves it and doses again",
            ),
            asked => return asked,
        }
    }
}

/// Calibrates the pump by the weight. `is_new` is false for a dose that was weighed before.
fn keep(
    course: &mut Course,
    reading: &StatedReading,
    temperature_degc: Option<f64>,
    is_new: bool,
) -> Result<(), Failure> {
    let bench = course.bench()?;
    let held = bench.folder().lock()?;
    let file = bench.file_of_last_dose(None, temperature_degc)?;
    let expected = Expected::of_digits(&file, reading);
    let weighed = bench.weigh_last_dose(&file, reading, Earlier::Joined, &expected)?;
    let pump = &course.answers.name;
    let meant = format!("; if it is right, `dose calibrate last --anyway --pump {pump}` takes it");
    weighed.check_likely().map_err(|error| Failure::of(error).with(&meant))?;
    let stored: Stored = bench.keep_weighing(weighed.calibration)?;
    drop(held);
    course.tell(&calibration_text(&bench, &stored, None, true, course.runnable.words())?)?;
    course.answers.done.dosed = false;
    course.answers.done.weighed += u32::from(is_new);
    course.keep()
}

/// Has another dose made in place of one that nobody has weighed.
pub(super) fn leave_dose(course: &mut Course) -> Result<(), Failure> {
    course.answers.done.dosed = false;
    course.keep()
}

/// Has a person accept a dose that was stopped or cut off, so that another can be made. Its volume is on record. A
/// script is refused: the rest of the dose would be lost without a word.
pub(super) fn accept_stopped(course: &mut Course) -> Asked<()> {
    let bench = course.bench()?;
    let Err(unfinished) = bench.refuse_unfinished(bench.story()?.state) else { return Ok(()) };
    // A dose that another process makes is in motion.
    drop(bench.session()?);
    if course.asker.is_silent() {
        return Err(Failure::from(unfinished).into());
    }
    let told = course.runnable.complete(&unfinished.told(course.runnable.words()));
    tell_person(&format!("  {told}"));
    let question = Question {
        text: "Is the rest to be left, and setup to go on? (yes, quit)",
        option: "`dose accept` first",
        usual: None,
        help: "yes leaves the rest: what was delivered stays on record; empty and tare the vessel; quit leaves setup, \
               and the rest can be made",
    };
    if !course.asker.agrees(&question)? {
        return Err(Stop::Left);
    }
    let mut session: Session<'_> = bench.session()?;
    let accepted = session.accept_counted();
    noted(&mut session, accepted)?;
    if std::mem::take(&mut course.answers.done.dosed) {
        course.keep()?;
    }
    Ok(())
}

/// Says that doses are refused while they would use a calibration of another head.
pub(super) fn tell_calibration_of_another_head(course: &Course) -> Result<(), Failure> {
    let bench = course.bench()?;
    if let Some(stored) = bench.calibrations().active()?.filter(|stored| !stored.is_of(bench.model())) {
        let (version, pump) = (stored.version, &course.answers.name);
        tell_person(&format!(
            "Calibration {version} was made with another head, and doses are refused with it: `dose setup {pump}` \
             weighs the pump anew, `dose calibrate use none --pump {pump}` doses by the file."
        ));
    }
    Ok(())
}

/// Has doses use no calibration that was made with another head: its factor is that of another volume. The pump is to
/// be weighed again.
pub(super) fn leave_calibration_of_another_head(course: &mut Course) -> Asked<()> {
    let bench = course.bench()?;
    let Some(stored) = bench.calibrations().active()?.filter(|stored| !stored.is_of(bench.model())) else {
        return Ok(());
    };
    accept_stopped(course)?;
    let held = bench.folder().lock()?;
    bench.use_calibration(None)?;
    drop(held);
    tell_person(&format!(
        "Calibration {} was made with another head. Doses use it no more, and the pump is weighed again.",
        stored.version
    ));
    (course.answers.done.weighed, course.answers.done.dosed) = (0, false);
    Ok(course.keep()?)
}
