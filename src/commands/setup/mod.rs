//! `dose setup`: a guided first run of a pump, from its head to a dose that was weighed.

mod asker;
mod back;
mod board;
mod course;
mod fill;
mod head;
mod motor;
mod options;
mod outlook;
mod place;
mod runnable;
mod turn;
mod weigh;
mod written;

use std::fs;
use std::path::Path;

use clap::Args;
use pump_bench::balance::Balance;
use pump_bench::config::Config;
use pump_bench::pump_file::DriverName;
use pump_bench::setup::{Answers, SetupError, SetupFolder};

use self::asker::{Asked, Asker, Question, Stop, Usual};
use self::course::{Course, heading, tell_person};
use self::options::AnswerOptions;
use self::runnable::Runnable;
use crate::failure::Failure;
use crate::options::balance::BalanceOptions;
use crate::options::pump::{ConfigOption, RecordOption};
use crate::terminal::say;
use crate::told_commands::shell_word;

/// Answers that a call gives to the steps that move the pump. Each is taken once.
struct Given {
    balance: Option<Box<dyn Balance>>,
    /// How far the head turned, in turns.
    turned: Option<f64>,
    /// True if the volume that fills the line was typed.
    primes: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SetupArgs {
    /// Name of the pump, as acid; it stands for the pump in --pump NAME
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Go on with the first run that was left last
    #[arg(long = "continue", conflicts_with = "anew")]
    goes_on: bool,
    /// Take the answers of another pump that was set up, but its axis
    #[arg(long, value_name = "NAME")]
    like: Option<String>,
    /// Ask every question anew
    #[arg(long)]
    anew: bool,
    /// Ask nothing: take the suggested answers, and let the motor move
    #[arg(long)]
    yes: bool,
    /// Dose once more: one more dose to weigh, or another in place of one that nobody has weighed
    #[arg(long, conflicts_with = "no_motion")]
    again: bool,
    /// Write the pump file, and move nothing
    #[arg(long)]
    no_motion: bool,
    #[command(flatten)]
    answers: AnswerOptions,
    #[command(flatten)]
    balance: BalanceOptions,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: RecordOption,
}

impl SetupArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let config = self.config.config()?;
        let path = self.config.path().ok_or(SetupError::NoPlace)?;
        let state_dir = self.record.folder(&config)?;
        let folder = SetupFolder::of(&path).recording_in(&state_dir);
        let mut asker = Asker::new(self.yes)?;
        let answers = match self.begin(&mut asker, &folder, &config) {
            Ok(answers) => answers,
            Err(Stop::Left | Stop::Back) => return Ok(()),
            Err(Stop::Failed(failure)) => return Err(failure),
        };
        let like = self.liked(&folder)?;
        let mut course = Course::new(asker, answers, folder, (state_dir, &config), like);
        let name = course.answers.name.clone();
        course.runnable = self.runnable(&name);
        let before = course.folder.read(&name).map_err(Failure::from)?;
        let ended = self.follow(&mut course, &config);
        match ended {
            Ok(()) => Ok(()),
            Err(Stop::Left | Stop::Back) => {
                let which = if course.corrected.is_some() {
                    "The answers before the correction"
                } else {
                    "The answers"
                };
                let text = format!("{which} are on record; `dose setup {name}` goes on.\n");
                say(&course.runnable.complete(&text));
                Ok(())
            }
            Err(Stop::Failed(failure)) => {
                let failure = if course.has_moved { failure.after_motion() } else { failure };
                if let Some(before) = before.filter(|before| course.is_to_return_to(before)) {
                    course.answers = before;
                    course.keep()?;
                    let one = match self.anew {
                        true => {
                            "; --anew forgets every answer, and an option without it changes its answer alone"
                        }
                        false => "",
                    };
                    let failure = failure.with(&format!("; the answers on record are as before{one}"));
                    let message = course.runnable.complete(failure.message());
                    return Err(failure.saying(message));
                }
                let is_kept = course.folder.read(&name).is_ok_and(|kept| kept.is_some());
                // A board that has changed its port, or an axis that it lacks, would fail the same way for ever.
                let elsewhere = match &course.answers.port {
                    Some(_) if failure.is_of_drive() => {
                        " there, and `--port <PORT>`, `--axis <AXIS>` or `--socket <SOCKET>` with it elsewhere"
                    }
                    _ => "",
                };
                let failure = if is_kept {
                    failure.with(&format!("; `dose setup {name}` goes on{elsewhere}"))
                } else {
                    failure
                };
                let message = course.runnable.complete(failure.message());
                Err(failure.saying(message))
            }
        }
    }

    /// The words that complete the commands of this run.
    fn runnable(&self, name: &str) -> Runnable {
        let words = |options: Vec<(&str, String)>| {
            let words = options.iter().map(|(option, value)| format!("{option} {}", shell_word(value)));
            words.collect::<Vec<_>>().join(" ")
        };
        Runnable { scale: words(self.balance.typed()), pump: name.to_owned() }
    }

    /// The answers of the pump that `--like` names.
    fn liked(&self, folder: &SetupFolder) -> Result<Option<Answers>, Failure> {
        let Some(like) = &self.like else { return Ok(None) };
        let refused =
            || Failure::refused(format!("no pump `{like}` was set up, so there are no answers of it"));
        folder.read(like)?.ok_or_else(refused).map(Some)
    }

    /// The answers on record, or those of a new pump.
    fn begin(&self, asker: &mut Asker, folder: &SetupFolder, config: &Config) -> Asked<Answers> {
        let name = match &self.name {
            Some(name) => name.clone(),
            None if self.goes_on => {
                let unfinished = folder.all().into_iter().find(|answers| answers.done.weighed == 0);
                let refused = || Failure::refused("no first run was left: there is nothing to go on with");
                unfinished.ok_or_else(refused)?.name
            }
            None => ask_name(asker, config)?,
        };
        let kept = folder.read(&name)?;
        Ok(match kept {
            None if self.goes_on => {
                let refused = format!("no first run of `{name}` was left; leave --continue out");
                return Err(Failure::refused(refused).into());
            }
            None => Answers::of(name),
            Some(before) if self.anew => {
                let mut answers = Answers::of(name);
                answers.done.written = before.done.written;
                answers
            }
            Some(before) => before,
        })
    }

    /// Follows the course from where it was left to its end.
    fn follow(&self, course: &mut Course, config: &Config) -> Asked<()> {
        let is_new = course.answers.unix_s == 0;
        course.answers.check_name(config)?;
        let record = course.state_dir().join(&course.answers.name);
        if course.answers.done.written.is_none() && record.exists() && is_new {
            let name = course.answers.name.clone();
            return Err(Failure::from(SetupError::Taken { name, path: record }).into());
        }
        if course.folder.pump_file(&course.answers.name).exists() {
            // Before any answer changes: the board of the pump file of now may tell its steps.
            weigh::accept_stopped(course)?;
        }
        let mut answers = course.answers.clone();
        self.refuse_like(&answers)?;
        self.refuse_weight_of_dose_to_come()?;
        self.answers.write_to(&mut answers)?;
        if let Some(last) = course.last.as_ref().filter(|_| self.like.is_some()) {
            answers.take_missing(last);
        }
        answers.check()?;
        course.check_axis(&answers)?;
        self.refuse_weight_before_dose(&answers)?;
        self.refuse_volume_of_made_dose(course)?;
        let balance = self.balance.open(answers.port.as_deref())?;
        let mut given = Given { balance, turned: self.answers.turned, primes: self.answers.prime.is_some() };
        if let Some(balance) = &mut given.balance {
            // A balance that is silent or says no mass is found before anything moves.
            weigh::still(balance.as_mut(), &self.balance)?;
        }
        course.is_elsewhere = course.moves_to(&answers);
        course.take(answers)?;
        introduce(course, is_new, self.like.is_some());
        loop {
            match self.follow_on(course, &mut given) {
                Err(Stop::Back) => back::to_answers(course)?,
                ended => return ended,
            }
        }
    }

    /// Follows the course from its answers to its end, or to a question that goes back to the answers.
    fn follow_on(&self, course: &mut Course, given: &mut Given) -> Asked<()> {
        if std::mem::take(&mut course.is_elsewhere) {
            board::meet_said(course, self.no_motion)?;
        }
        written::write(course)?;
        course.is_complete = true;
        course.expect_board()?;
        if self.no_motion {
            say("Nothing was moved: this pump was not tried yet.\n");
            weigh::tell_calibration_of_another_head(course)?;
            course.answers.done.file_alone = true;
            return Ok(course.keep()?);
        }
        weigh::leave_calibration_of_another_head(course)?;
        weigh::accept_stopped(course)?;
        if course.answers.done.weighed > 0 {
            // A pump that was moved to another place turns in another way.
            turn::watch(course, &mut given.turned)?;
            if !self.weighs_more(course)? {
                return outlook::tell_outlook(course);
            }
        }
        if self.again {
            weigh::leave_dose(course)?;
        }
        loop {
            turn::watch(course, &mut given.turned)?;
            match fill::fill(course, std::mem::take(&mut given.primes)) {
                Err(Stop::Back) if course.is_simulated() => return Err(Stop::Back),
                Err(Stop::Back) => {
                    turn::forget_direction(course)?;
                    continue;
                }
                filled => filled?,
            }
            match weigh::weigh(course, &self.answers, &self.balance, &mut given.balance) {
                Err(Stop::Back) => fill::reopen(course)?,
                Err(stop) => return Err(stop),
                Ok(true) => return outlook::tell_outlook(course),
                Ok(false) => {
                    let name = &course.answers.name;
                    let text = format!("Weigh the dose, then run `dose setup {name} --weight 4.93g`.\n");
                    say(&course.runnable.complete(&text));
                    return Ok(());
                }
            }
        }
    }

    /// Refuses to take another pump's answers for one that has answers to everything.
    fn refuse_like(&self, answers: &Answers) -> Result<(), Failure> {
        if self.like.is_none() || !answers.is_finished() {
            return Ok(());
        }
        Err(Failure::refused(format!(
            "`{}` is set up, so --like has no answer to add; --anew beside it takes the other pump's answers in place \
             of its own",
            answers.name
        )))
    }

    /// Refuses a weight beside another dose: it may be that of the one in the vessel, which --again leaves.
    fn refuse_weight_of_dose_to_come(&self) -> Result<(), Failure> {
        if !self.again || self.answers.weight.is_none() {
            return Ok(());
        }
        let refused = Failure::refused(
            "--weight is that of the dose in the vessel, and --again leaves that dose and makes another one; say \
             --weight alone to keep it, or --again alone and the weight after the dose",
        );
        Err(refused.value("--again beside --weight").allowed("one of them"))
    }

    /// Refuses the weight of a dose that a real pump has not made yet. On a simulated one it is a made-up reading.
    fn refuse_weight_before_dose(&self, answers: &Answers) -> Result<(), Failure> {
        let is_made = answers.done.dosed || answers.done.weighed > 0;
        let is_simulated = answers.driver.is_none_or(|driver| driver == DriverName::Sim);
        if self.answers.weight.is_none() || is_made || is_simulated {
            return Ok(());
        }
        let refused = Failure::refused(
            "--weight is that of a dose in the vessel, and none was made yet; leave it out, and say it after the dose",
        );
        Err(refused.value("no dose").allowed("--weight after the dose"))
    }

    /// Refuses the volume of a dose that was made already and waits for its weight.
    fn refuse_volume_of_made_dose(&self, course: &Course) -> Result<(), Failure> {
        let before = &course.answers;
        let other = self.answers.volume.filter(|ml| before.volume_ml != Some(*ml));
        let Some(volume_ml) = other.filter(|_| before.done.dosed && !self.again) else { return Ok(()) };
        if !weigh::is_last(course)? {
            return Ok(());
        }
        let refused = Failure::refused(
            "the dose was made and waits for its weight, so that --volume changes nothing; leave it out and say \
             --weight, or add --again for a dose of this volume",
        );
        Err(refused.value(format!("{volume_ml} mL")).allowed("--weight, or --again"))
    }

    /// Asks if one more dose is to be weighed, of a pump that is set up.
    fn weighs_more(&self, course: &mut Course) -> Asked<bool> {
        let is_weight_there = self.answers.weight.is_some() || self.balance.is_given();
        if self.again || course.answers.done.dosed || is_weight_there {
            return Ok(true);
        }
        if course.asker.is_silent() {
            return Ok(false);
        }
        let question = Question {
            text: "This pump is set up. Weigh one more dose?",
            option: "--again for one more, or --yes for none",
            usual: Some(Usual::new("yes")),
            help: "a second dose shows how much doses scatter, and makes them surer",
        };
        course.asker.agrees(&question)
    }
}

fn ask_name(asker: &mut Asker, config: &Config) -> Asked<String> {
    let question = Question {
        text: "Name of the pump, as acid",
        option: "a name, as in `dose setup acid`",
        usual: None,
        help: "a short word for what it doses; `dose 5mL --pump NAME` then doses with it. Letters a-z, digits, - and _",
    };
    loop {
        let named = asker.ask(&question, |name| {
            Answers::of(name).check_name(config).map_err(|error| error.to_string())?;
            Ok(name.to_owned())
        });
        match named {
            Err(Stop::Back) => tell_person("  no question was asked before this one"),
            named => return named,
        }
    }
}

/// True if the pump file says what the pins of its stepper driver need.
fn states_pins(pump_file: &Path) -> bool {
    let text = fs::read_to_string(pump_file).unwrap_or_default();
    text.lines().any(|line| line.trim_start().starts_with("[drive.pins]"))
}

/// Says what the course does, and what is on record.
fn introduce(course: &Course, is_new: bool, is_like: bool) {
    let name = &course.answers.name;
    if let Some(last) = course.last.as_ref().filter(|_| is_like) {
        tell_person(&format!(
            "`{name}` takes the answers of `{}`, all but its axis and its direction.",
            last.name
        ));
        if last.done.written.is_some() && !course.folder.is_of_answers(last) {
            tell_person(&format!(
                "Its pump file says something else by now, or is gone; that is not among the answers: {}",
                course.folder.pump_file(&last.name).display()
            ));
        }
        if states_pins(&course.folder.pump_file(&last.name)) {
            tell_person(&format!(
                "Its pump file has [drive.pins], which are not among the answers: write them into that of `{name}` too \
                 if its stepper driver is of the same kind, before its motor turns (--no-motion writes the file alone)."
            ));
        }
    }
    if course.asker.is_silent() {
        return;
    }
    // Answers that are piped in were written before: nobody can go back or ask.
    let is_person = course.asker.asks_person();
    if is_new {
        let keys = match is_person {
            true => {
                "Enter takes the answer in brackets, ? explains the question, back returns to the one before, quit \
                 leaves; "
            }
            false => "",
        };
        tell_person(&format!(
            "Setting up `{name}`: some questions, one revolution, and one dose that you weigh. It takes about ten \
             minutes. {keys}`dose setup {name}` goes on later."
        ));
    } else {
        let keys = match is_person {
            true => " ? explains, back returns to the previous question, quit leaves.",
            false => "",
        };
        heading(&format!("Going on with `{name}`; the answers so far are on record.{keys}"));
    }
    if let Some(last) = course.last.as_ref().filter(|_| !is_like) {
        tell_person(&format!(
            "Suggested answers are those of `{}`, the pump that was set up last.",
            last.name
        ));
    }
}
