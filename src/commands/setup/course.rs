//! The course of a first run: its answers on record, and the pump that they make.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use pump_bench::catalogue::unusual;
use pump_bench::config::Config;
use pump_bench::drives::{BoardOnRecord, FoundBoard, Opening};
use pump_bench::notice::{Notice, Remedy};
use pump_bench::pump_file::{Axis, DriverName, PumpFile};
use pump_bench::report::Explain;
use pump_bench::setup::{Answers, Done, HeadAnswer, Neighbour, SetupError, SetupFolder, Topic};
use pump_bench::{Bench, Prepared, Session, built_in};

use super::asker::{Asked, Asker, Question, Usual};
use super::runnable::Runnable;
use crate::advice;
use crate::failure::Failure;
use crate::interrupt;
use crate::terminal::{say, say_wrapped, tell, warn};

/// Longest motion of a setup, s.
const LONGEST_S: f64 = 3600.0;

/// A first run.
pub(super) struct Course {
    pub(super) asker: Asker,
    pub(super) answers: Answers,
    pub(super) folder: SetupFolder,
    state_dir: PathBuf,
    /// Answers of the pump that is named, or else of the one whose first run came to its end last and whose file still
    /// says the same. Answers are suggested from them.
    pub(super) last: Option<Answers>,
    /// Answers before a part of them was asked anew. They stay on record until each new one is there.
    pub(super) corrected: Option<Answers>,
    /// Answered questions that the correction of a part does not ask anew. `None` outside such a correction.
    pub(super) kept: Option<BTreeSet<Topic>>,
    /// Answers before each step back, the oldest first. They are suggested.
    withdrawn: Vec<Answers>,
    /// Topic of the question that is asked. `None` where the answers are complete.
    pub(super) at: Option<Topic>,
    /// True if the summary is to be shown though nothing has changed.
    pub(super) reviews: bool,
    /// Other pumps of the configuration that boards turn.
    neighbours: Vec<Neighbour>,
    /// Board that answered at the port, once it was asked.
    pub(super) board: Option<FoundBoard>,
    /// True if the answers name another place than the pump file, so that the board there is to be asked.
    pub(super) is_elsewhere: bool,
    /// True if the person has said that the board at the port turns the pump from now on, whatever is on record.
    pub(super) accepts_board: bool,
    /// Port at which no board answered. A script is told so once.
    pub(super) silent_port: Option<PathBuf>,
    /// True once each answer is there and the pump file is that of the answers.
    pub(super) is_complete: bool,
    /// True if the motor has turned in this call.
    pub(super) has_moved: bool,
    /// Warnings that were said already.
    warned: Vec<String>,
    /// Words that complete the commands which are told.
    pub(super) runnable: Runnable,
}

impl Course {
    /// The course of these answers. `like` names the pump from which answers are suggested.
    pub(super) fn new(
        asker: Asker,
        answers: Answers,
        folder: SetupFolder,
        (state_dir, config): (PathBuf, &Config),
        like: Option<Answers>,
    ) -> Self {
        // Answers that somebody has changed in the file since are those of no pump.
        let is_known = |other: &Answers| other.is_finished() && folder.is_of_answers(other);
        let last = like
            .or_else(|| folder.all().into_iter().find(|other| other.name != answers.name && is_known(other)));
        let neighbours = Neighbour::all_but(config, &answers.name);
        Self {
            asker,
            answers,
            folder,
            state_dir,
            last,
            corrected: None,
            kept: None,
            withdrawn: Vec::new(),
            at: None,
            reviews: false,
            neighbours,
            board: None,
            is_elsewhere: false,
            accepts_board: false,
            silent_port: None,
            is_complete: false,
            has_moved: false,
            warned: Vec::new(),
            runnable: Runnable::default(),
        }
    }

    /// Puts the answers on record.
    pub(super) fn keep(&mut self) -> Result<(), Failure> {
        Ok(self.folder.keep(&mut self.answers)?)
    }

    /// Takes new answers: they are on record, and what was done with others counts no more. Those of a correction wait
    /// until it is complete.
    pub(super) fn take(&mut self, answers: Answers) -> Result<(), Failure> {
        let before = std::mem::replace(&mut self.answers, answers);
        if self.corrected.is_some() {
            return Ok(());
        }
        self.answers.done = still_done(&before, &self.answers);
        if self.answers == before { Ok(()) } else { self.keep() }
    }

    /// True if a script has failed before its answers were complete, and so changed nothing but the answers of a pump
    /// that is set up: those `before` hold on.
    pub(super) fn is_to_return_to(&self, before: &Answers) -> bool {
        self.asker.is_silent()
            && !self.is_complete
            && before.done.written.is_some()
            && self.answers != *before
    }

    /// Forgets a part of the answers, which is asked anew: the former ones are suggested.
    pub(super) fn correct(&mut self, part: &[Topic]) {
        self.corrected = Some(self.answers.clone());
        part.iter().for_each(|topic| topic.forget(&mut self.answers));
        self.kept = Some(self.answers.asked.clone());
    }

    /// Leaves a correction: the answers of before are shown again.
    pub(super) fn leave_correction(&mut self) {
        if let Some(before) = self.corrected.take() {
            self.answers = before;
        }
        self.kept = None;
        self.board = None;
        self.reviews = true;
    }

    /// Forgets the answer to a question, which is asked anew and suggests it.
    pub(super) fn withdraw(&mut self, topic: Topic) -> Result<(), Failure> {
        self.withdrawn.push(self.answers.clone());
        let mut answers = self.answers.clone();
        topic.forget(&mut answers);
        if matches!(topic, Topic::Driver | Topic::Port) {
            self.board = None;
        }
        self.take(answers)
    }

    /// Takes the answers of a correction that is complete.
    pub(super) fn end_correction(&mut self) -> Result<(), Failure> {
        self.withdrawn.clear();
        self.kept = None;
        let Some(before) = self.corrected.take() else { return Ok(()) };
        let corrected = std::mem::replace(&mut self.answers, before);
        self.take(corrected)
    }

    /// Asks a question until its answer contradicts no other, and keeps it.
    pub(super) fn settle<T>(
        &mut self,
        topic: Topic,
        question: &Question<'_>,
        mut read: impl FnMut(&str) -> Result<T, String>,
        mut set: impl FnMut(&mut Answers, T),
    ) -> Asked<()> {
        self.at = Some(topic);
        let before = self.answers.clone();
        let (runnable, is_asked) = (self.runnable.clone(), !self.asker.is_silent());
        let answers = self.asker.ask(question, |answer| {
            let mut answers = before.clone();
            set(&mut answers, read(answer)?);
            answers.check().map_err(|error| match is_asked {
                true => runnable.complete(&error.told(Runnable::at_question)),
                false => advice::told(&error),
            })?;
            Ok(answers)
        })?;
        Ok(self.take_answered(topic, answers)?)
    }

    /// Takes new answers, of which a person has given that to a question of this topic.
    pub(super) fn take_answered(&mut self, topic: Topic, mut answers: Answers) -> Result<(), Failure> {
        if !self.asker.is_silent() {
            answers.asked.insert(topic);
        }
        self.take(answers)
    }

    /// The answers that are asked anew, the newest first: those that were taken back, and those that are corrected.
    pub(super) fn earlier(&self) -> impl Iterator<Item = &Answers> {
        self.withdrawn.iter().rev().chain(&self.corrected)
    }

    /// The answer that is asked anew.
    pub(super) fn former(&self, of: impl Fn(&Answers) -> Option<String>) -> Option<Usual> {
        self.earlier().find_map(of).map(Usual::new)
    }

    /// The answer that is asked anew or that of the last pump as a suggestion, or else the usual one.
    pub(super) fn suggested(
        &self,
        of: impl Fn(&Answers) -> Option<String>,
        usual: Option<&str>,
    ) -> Option<Usual> {
        let of_last = |last: &Answers| Some(Usual { answer: of(last)?, of: Some(last.name.clone()) });
        let last = || self.last.as_ref().and_then(of_last);
        self.former(&of).or_else(last).or_else(|| usual.map(Usual::new))
    }

    /// The answer of before or of the last pump as a suggestion, if that has the same head, or else the usual one.
    pub(super) fn suggested_of_head(
        &self,
        of: impl Fn(&Answers) -> Option<String>,
        usual: Option<&str>,
    ) -> Option<Usual> {
        let before = self.earlier().next().or(self.last.as_ref());
        let is_other = before.is_some_and(|before| before.head != self.answers.head);
        if is_other { usual.map(Usual::new) } else { self.suggested(of, usual) }
    }

    /// The other pumps of the configuration at the board of a port.
    pub(super) fn others_at(&self, port: &Path) -> Vec<Neighbour> {
        self.neighbours.iter().filter(|other| other.is_at(port)).cloned().collect()
    }

    /// The other pumps of the board at a port that only their records know, as one that another pump file names. A
    /// built-in pump, with which the motor was tried, keeps no axis.
    pub(super) fn recorded_at(&self, board: Option<&FoundBoard>, port: &Path) -> Vec<(String, Axis)> {
        let Some(board) = board else { return Vec::new() };
        let opening = Opening::of_pump(&self.answers.name, board.driver(), &self.state_dir);
        let mut recorded = board.pumps_on_record(port, &opening);
        recorded.retain(|(pump, _)| {
            built_in(pump).is_none() && self.neighbours.iter().all(|other| other.name != *pump)
        });
        recorded
    }

    /// The board on record, of a pump that a board turns.
    pub(super) fn board_on_record(&self) -> Option<BoardOnRecord> {
        let driver = self.answers.driver.filter(|driver| *driver != DriverName::Sim)?;
        BoardOnRecord::of(&Opening::of_pump(&self.answers.name, driver, &self.state_dir))
    }

    /// Puts the board that answered on record, so that another one at its port is refused from now on. A pump whose
    /// journal was begun keeps its board. A pump that had the axis by its record makes place, and is named.
    pub(super) fn expect_board(&self) -> Result<(), Failure> {
        let Answers { port: Some(port), axis: Some(axis), .. } = &self.answers else { return Ok(()) };
        let Some(board) = self.board.as_ref().filter(|_| !self.is_simulated()) else { return Ok(()) };
        let bench = self.bench()?;
        if bench.story()?.state.is_some() {
            if let Some(recorded) = board.other_on_record(bench.opening()) {
                let text = format!(
                    "the record of `{}` is of board {recorded:016x}, and another one is at {}: its motor does not move \
                     there before `dose home --unknown --accept-settings` takes it, and the rollers' angle is unknown \
                     then",
                    self.answers.name,
                    port.display()
                );
                warn(&[self.runnable.complete(&text)]);
            }
            return Ok(());
        }
        for pump in board.expect(port, *axis, bench.opening()).map_err(Failure::of)? {
            let name = &self.answers.name;
            let trial = built_in(&pump).map_or("", |_| ", since a built-in pump is a trial");
            warn(&[format!(
                "the axis {axis} turned the pump `{pump}` by the record: `{name}` takes its place{trial}"
            )]);
        }
        Ok(())
    }

    /// True if the motor of these answers is at another place than by the answers before or by the pump file, or if
    /// there is no pump file yet.
    pub(super) fn moves_to(&self, answers: &Answers) -> bool {
        let at =
            |answers: &Answers| (answers.driver, answers.port.clone(), answers.axis, answers.socket.clone());
        if answers.done.written.is_none() || at(answers) != at(&self.answers) {
            return true;
        }
        let file = PumpFile::read(&self.folder.pump_file(&answers.name)).ok();
        file.and_then(|file| file.drive).is_none_or(|drive| {
            (Some(drive.driver), drive.port) != (answers.driver, answers.port.clone())
                || answers.axis.is_some_and(|axis| axis != drive.axis)
        })
    }

    /// Refuses an axis or a socket that was said in this call and turns another pump.
    pub(super) fn check_axis(&self, answers: &Answers) -> Result<(), Failure> {
        let at = |answers: &Answers| (answers.port.clone(), answers.axis, answers.socket.clone());
        let is_new = answers.done.written.is_none() || at(answers) != at(&self.answers);
        if !is_new {
            return Ok(());
        }
        answers.check_axis(&self.neighbours)?;
        Ok(answers.check_socket(&self.neighbours)?)
    }

    /// The refusal of a socket on record that turns another pump.
    pub(super) fn socket_of_another(&self) -> Option<SetupError> {
        self.answers.check_socket(&self.neighbours).err()
    }

    /// The refusal of an axis on record that turns another pump.
    pub(super) fn axis_of_another(&self) -> Option<SetupError> {
        self.answers.check_axis(&self.neighbours).err()
    }

    /// True if no motor moves.
    pub(super) fn is_simulated(&self) -> bool {
        self.answers.driver.is_none_or(|driver| driver == DriverName::Sim)
    }

    /// The pump file and its text.
    pub(super) fn pump_file(&self) -> Result<(PumpFile, String), Failure> {
        Ok(self.answers.pump_file(advice::words)?)
    }

    /// The bench of the pump file that was written.
    pub(super) fn bench(&self) -> Result<Bench, Failure> {
        let mut file = PumpFile::read(&self.folder.pump_file(&self.answers.name)).map_err(Failure::of)?;
        // The course watches which way the motor turns.
        file.motor.direction_confirmed = None;
        self.bench_of(file)
    }

    /// The bench of a pump file.
    pub(super) fn bench_of(&self, file: PumpFile) -> Result<Bench, Failure> {
        // The settings follow from the motor's steps, which are right once a turn was seen.
        let is_open = !self.answers.done.turned;
        let configures = is_open && !self.is_simulated() && self.answers.configure == Some(true);
        let bench = Bench::new(file, None, &self.state_dir)?;
        let bench =
            bench.configuring(configures).accepting_settings(self.accepts_board).watching_the_turn(true);
        Ok(bench.stopping_on(interrupt::stop_request()))
    }

    /// The folder of all records.
    pub(super) fn state_dir(&self) -> &Path {
        &self.state_dir
    }

    /// Says the notes of a session that were not said yet.
    pub(super) fn warn(&mut self, notes: &[Notice]) {
        for note in notes {
            let text = note.text().to_owned();
            if !self.warned.contains(&text) {
                warn(&[self.runnable.complete(&note.clone().worded(self.runnable.words()))]);
                self.warned.push(text);
            }
        }
    }

    /// The largest volume that the setup moves at once, mL: that of an hour at the usual rate. A larger one is a slip.
    pub(super) fn most_ml(&self) -> Result<f64, Failure> {
        Ok(LONGEST_S * self.pump_file()?.0.pump.default_rate_ml_s)
    }

    /// Says how long a motion lasts, before it begins.
    pub(super) fn tell_time(&self, motion_s: f64) {
        let takes = if self.is_simulated() { "A real pump would take" } else { "It takes" };
        tell_person(&format!("  {takes} {motion_s:.0} s."));
    }

    /// Tells a result, with commands that run as they are printed.
    pub(super) fn tell(&self, text: &str) -> Result<(), Failure> {
        tell(&self.runnable.complete(text))
    }

    /// Notes that a session may have turned the motor.
    pub(super) fn note_motion(&mut self, session: &Session<'_>) {
        self.has_moved |= session.has_moved();
    }
}

/// The steps that are still done after answers were changed.
fn still_done(before: &Answers, after: &Answers) -> Done {
    let done = after.done;
    let is_head = (&before.head, before.rollers) == (&after.head, after.rollers);
    let is_motor = (before.steps_per_rev, before.full_steps, before.microsteps, before.gear)
        == (after.steps_per_rev, after.full_steps, after.microsteps, after.gear);
    let is_drive = (before.driver, &before.port, before.axis) == (after.driver, &after.port, after.axis);
    let turned = done.turned && is_motor && is_drive;
    let directed = done.directed && is_drive && before.invert == after.invert;
    let mut still = done;
    (still.turned, still.directed) = (turned, directed);
    still.prime_left_ml = done.prime_left_ml.filter(|_| is_drive);
    // A dose that went the other way is in no vessel.
    let is_way = before.invert == after.invert;
    still.primed = done.primed && is_drive;
    still.dosed = done.dosed && is_head && is_motor && is_drive && is_way;
    still
}

/// Leaves the warnings out that the course is there to answer, that nobody knows the angle or has weighed the pump, and
/// those that the summary of the answers has said.
pub(super) fn quieten(bench: &Bench, prepared: &mut Prepared) {
    const ANSWERED: [Remedy; 6] = [
        Remedy::TurnAndSayAngle,
        Remedy::FindAngle,
        Remedy::FindOrSayAngle,
        Remedy::Weigh,
        Remedy::WeighToBeSurer,
        Remedy::CalibrateRuns,
    ];
    let said = unusual(bench.file());
    prepared.warnings.retain(|warning| {
        let is_of_angle = warning.text().starts_with("the rollers' angle is unknown");
        !is_of_angle
            && !said.contains(warning)
            && !warning.remedies().iter().any(|remedy| ANSWERED.contains(remedy))
    });
}

/// Refuses a volume beyond the largest one that the setup moves at once.
pub(super) fn within(volume_ml: f64, most_ml: f64) -> Result<f64, String> {
    if volume_ml <= most_ml {
        return Ok(volume_ml);
    }
    Err(format!(
        "{volume_ml} mL take longer than an hour at the usual rate; allowed here: {} mL at most",
        rounded(most_ml)
    ))
}

/// A heading of a part of the course.
pub(super) fn heading(text: &str) {
    say(&format!("\n{text}\n"));
}

/// A line to the person.
pub(super) fn tell_person(text: &str) {
    say_wrapped(&format!("{text}\n"));
}

/// The head in words.
pub(super) fn head_in_words(head: &HeadAnswer) -> String {
    match head {
        HeadAnswer::Catalogue(name) => name.clone(),
        HeadAnswer::Volume { ml_per_rev } => format!("{ml_per_rev} mL per revolution"),
        HeadAnswer::Drawing { bore_mm, outer_mm, backplate_mm, roller_mm, offset_mm, contact_deg } => {
            format!(
                "a drawing: tube {bore_mm} x {outer_mm} mm, backplate {backplate_mm} mm, roller {roller_mm} mm, offset \
             {offset_mm} mm, contact {contact_deg} deg"
            )
        }
        HeadAnswer::File(path) => format!("as in {}", path.display()),
    }
}

/// A number with four digits at most.
pub(super) fn rounded(value: f64) -> String {
    rounded_to(value, 4)
}

/// A number with so many digits at most.
pub(super) fn rounded_to(value: f64, digits: usize) -> String {
    let rounded = format!("{value:.*e}", digits.saturating_sub(1)).parse::<f64>().unwrap_or(value);
    format!("{rounded}")
}
