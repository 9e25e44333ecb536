//! A revolution that is wrong where the board sets the microsteps itself: they are right, so the motor or its gear has
//! another number, or the motor stalls.

use pump_bench::notice::with_sources;
use pump_bench::pump_file::PumpFile;
use pump_bench::setup::Topic;
use pump_bench::units::{FULL_STEPS_PER_REV, count};

use super::super::asker::{Asked, Question};
use super::super::board;
use super::super::course::{Course, rounded, tell_person};
use super::super::written::rewrite;
use crate::failure::Failure;

/// Full steps of usual motors: 1.8 and 0.9 deg.
const USUAL: [u32; 2] = [200, 400];

/// Part by which the full steps of a usual motor may depart from a turn that was read by eye.
const NEAR: f64 = 0.12;

/// Cause of a wrong revolution, as a person says it.
enum Cause {
    FullSteps(u32),
    Gear(f64),
    Stalls,
}

/// Motor whose microsteps the board sets.
#[derive(Clone, Copy)]
struct KnownMotor {
    full_steps: u32,
    microsteps: u32,
    gear: f64,
}

impl KnownMotor {
    /// The motor of a pump file, if the board sets its microsteps.
    fn of(file: &PumpFile) -> Option<Self> {
        file.drive.as_ref()?.klipper.as_ref()?.tmc.as_ref()?;
        let motor = &file.motor;
        let full_steps = motor.full_steps_per_rev.max(1);
        Some(Self { full_steps, microsteps: motor.steps_per_rev / full_steps, gear: motor.gear })
    }

    /// The causes of a revolution that made so many turns, in words.
    fn causes(self, turned: f64) -> String {
        let full_steps = f64::from(self.full_steps) / turned;
        let near = |usual: &u32| (f64::from(*usual) / full_steps - 1.0).abs() <= NEAR;
        let usual = USUAL.into_iter().find(near).map_or(String::new(), |usual| {
            format!(
                "a motor of {usual} full steps ({} deg) in place of {}, ",
                360.0 / f64::from(usual),
                self.full_steps
            )
        });
        let gear = rounded(self.gear / turned);
        format!(
            "{usual}a gear of {gear} in place of {}, or a motor that stalls for want of current",
            self.gear
        )
    }
}

/// True if the board sets the microsteps of the motor itself.
pub(super) fn are_set(course: &Course) -> Result<bool, Failure> {
    Ok(KnownMotor::of(&course.pump_file()?.0).is_some())
}

/// Asks for the cause of a revolution that made so many turns, and takes it. A second wrong revolution ends the setup.
pub(super) fn correct(course: &mut Course, turned: f64, is_second: bool) -> Asked<()> {
    let Some(motor) = KnownMotor::of(&course.pump_file()?.0) else { return Ok(()) };
    let KnownMotor { full_steps, microsteps, gear } = motor;
    let made = format!(
        "{} turns in place of 1, with {full_steps} full steps, {microsteps} microsteps and a gear of {gear}",
        rounded(turned)
    );
    let causes = motor.causes(turned);
    if is_second {
        let refused = Failure::refused(format!(
            "the second revolution was wrong too: {made}. The board sets the microsteps itself, so the cause is \
             {causes}. Look at the motor's label, its plug and supply, and at the coupling of the head; `dose setup \
             --full-steps 400`, `dose setup --gear 2` or `dose setup --current 0.8A` then says what it is"
        ));
        return Err(refused.value(format!("{} turns", rounded(turned))).allowed("1 turn").into());
    }
    tell_person(&format!(
        "  It made {made}. The board sets the microsteps in the stepper driver itself, so they are right, and the \
         cause is {causes}."
    ));
    match ask(course, motor)? {
        Cause::Stalls => {
            if !course.answers.sets_stepper_driver() {
                tell_person("  The file that you began with has the motor's current: change run_a there.");
                return Ok(());
            }
            let mut answers = course.answers.clone();
            Topic::Current.forget(&mut answers);
            Topic::HoldCurrent.forget(&mut answers);
            course.take(answers)?;
            board::ask(course)?;
        }
        cause => {
            let mut answers = course.answers.clone();
            (answers.full_steps, answers.microsteps) = (Some(full_steps), Some(microsteps));
            (answers.steps_per_rev, answers.gear) = (None, Some(gear));
            match cause {
                Cause::FullSteps(steps) => answers.full_steps = Some(steps),
                Cause::Gear(gear) => answers.gear = Some(gear),
                Cause::Stalls => {}
            }
            course.take(answers)?;
        }
    }
    rewrite(course)
}

fn ask(course: &mut Course, motor: KnownMotor) -> Asked<Cause> {
    let question = Question {
        text: "Cause: the full steps of the motor, as 400, its gear, as gear 2, or stalls",
        option: "--full-steps 400, --gear 2 or --current 0.8A",
        usual: None,
        help: "360 over the angle on the motor's label are its full steps: 1.8 deg is 200, 0.9 deg is 400. A gearbox \
               1:5 is gear 5. A motor that hums or stands still at times stalls: its current is asked for anew. Each \
               answer makes one more revolution, and another wrong one ends the setup",
    };
    let before = course.answers.clone();
    course.asker.ask(&question, |answer| {
        let cause = cause(answer, motor)?;
        let mut answers = before.clone();
        match cause {
            Cause::FullSteps(steps) => {
                (answers.full_steps, answers.microsteps) = (Some(steps), Some(motor.microsteps));
                answers.steps_per_rev = None;
            }
            Cause::Gear(gear) => answers.gear = Some(gear),
            Cause::Stalls => {}
        }
        answers.check().map_err(|error| with_sources(&error))?;
        Ok(cause)
    })
}

fn cause(answer: &str, motor: KnownMotor) -> Result<Cause, String> {
    if answer == "stalls" {
        return Ok(Cause::Stalls);
    }
    if let Some(gear) = answer.strip_prefix("gear") {
        return match gear.trim().parse::<f64>() {
            Ok(gear) if gear == motor.gear => Err(format!("the gear is {gear} already")),
            Ok(gear) if gear > 0.0 && gear.is_finite() => Ok(Cause::Gear(gear)),
            _ => Err(format!("`{answer}` is no gear; write a number, as gear 5")),
        };
    }
    let steps = count("number of full steps per revolution", FULL_STEPS_PER_REV)(answer);
    match steps.map_err(|error| format!("{error}; or write gear 2, or stalls"))? {
        steps if steps == motor.full_steps => Err(format!("the motor has {steps} full steps already")),
        steps => Ok(Cause::FullSteps(steps)),
    }
}
