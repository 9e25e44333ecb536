//! An axis of a controller that speaks grbl 1.1's protocol over a serial port: grbl, grblHAL, FluidNC.
//!
//! A dose is a sequence of jogs in machine coordinates. The board rounds each target to exactly the step that
//! it names. The board plans its own ramps, so jogs are sent ahead only as far as keeps it at speed. The
//! board makes what was sent even if this process ends. Settings are written only on request.

mod drive;

use std::time::Duration;

use pump_ctl::plan::{Motor, Plan};

use super::board::{Board, Heard};
use super::connect;
use super::error::GrblError;
use super::jogs::{Follower, Jogs, Task};
use super::line::{AxisBoard, AxisEnd, GrblBoard, Met, SILENCE, follow, lead, meet};
use super::recovery::Made;
use super::remarks::remarks;
use super::scale::Scale;
use super::settings::{self, Flavour, MOST_STEPS_S, SelfDescription, Settings};
use crate::drives::known_board::KnownBoard;
use crate::drives::wire::Wire;
use crate::drives::{BeginPlace, Disturbance, Drive, DriveError, DriveFault, Gate, Opening};
use crate::notice::Notice;
use crate::pump_file::{DriveTable, MotorTable, PumpFile};

/// Relative error of a number that is kept in single precision and told with three decimals.
const TOLD: f64 = 1e-5;

/// Opens the axis that `table` names, for the pump of `file`.
pub(crate) fn open(
    table: &DriveTable,
    file: &PumpFile,
    opening: &Opening,
) -> Result<Box<dyn Drive>, DriveError> {
    Ok(Box::new(Grbl::open(table, &file.motor, opening)?))
}

impl GrblBoard {
    /// Opens the drive of the axis that `table` names. Moves nothing.
    ///
    /// # Errors
    ///
    /// [`DriveError`] as [`Grbl::open`], and for an axis that another drive has.
    pub fn axis(
        &self,
        table: &DriveTable,
        motor: &MotorTable,
        opening: &Opening,
    ) -> Result<Grbl, DriveError> {
        Ok(Grbl::read(AxisBoard::take(self, table, opening)?, table, &motor.at_pump_head(), opening)?)
    }
}

/// One axis of a board.
#[derive(Debug)]
pub struct Grbl {
    board: AxisBoard,
    /// Number of resets that the board has told, of which this axis knows.
    resets: u32,
    /// Place of the next motion among those that begin together.
    place: Option<BeginPlace>,
    settings: Settings,
    scale: Scale,
    /// Angle of a step, in rad.
    step_rad: f64,
    /// Fewest steps per second.
    least_steps_s: f64,
    /// Most steps per second.
    most_steps_s: f64,
    /// Steps per second² of the ramps.
    steps_s2: f64,
    /// Count of the board at rest. `None` if the board has to be asked again.
    stands: Option<i64>,
    disturbed: Option<Disturbance>,
    /// True while a disturbance that was told is not on record.
    unrecorded: bool,
    /// Rests of the last motion before its end.
    rests: u32,
    /// Board that is not on record yet, with the terms on which it was opened.
    unknown_board: Option<(KnownBoard, Opening)>,
    notes: Vec<Notice>,
}

impl Grbl {
    /// Opens the port that `table` names, waits until the board rests, and reads its settings. Moves nothing.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the port is missing or in use, no grbl board answers, or its settings do not fit the
    /// pump or differ from those on record, or it is another board than the one on record.
    pub fn open(table: &DriveTable, motor: &MotorTable, opening: &Opening) -> Result<Self, DriveError> {
        KnownBoard::look_at_port(table.port.as_deref(), opening).map_err(GrblError::from)?;
        GrblBoard::open(table.port.as_deref(), table.rate_baud())?.axis(table, motor, opening)
    }

    /// Opens the board at the other end of `wire`, as [`Self::open`] does.
    #[doc(hidden)]
    pub fn over(
        wire: Box<dyn Wire>,
        table: &DriveTable,
        motor: &MotorTable,
        opening: &Opening,
    ) -> Result<Self, DriveError> {
        GrblBoard::over(wire).axis(table, motor, opening)
    }

    fn read(
        axis_board: AxisBoard,
        table: &DriveTable,
        motor: &Motor,
        opening: &Opening,
    ) -> Result<Self, GrblError> {
        let mut board = axis_board.lock()?;
        // A reset since the port was opened came after the record was written, unless an earlier drive of this pump
        // has told of it.
        let mut reset = connect::find(&mut board, table, connect::ANSWER_LIMIT)?
            | (board.resets() > axis_board.told_resets());
        connect::rest(&mut board, &mut reset)?;
        board.needs_axis()?;
        let SelfDescription { flavour, text } = settings::described(&mut board)?;
        let axis = Some(table.axis);
        let found = KnownBoard { text, axis, ..KnownBoard::at_port(table.port.as_deref(), opening) };
        let replaced = found.recognise(table.port.as_deref(), opening)?;
        let (settings, told) = settings::agreed(&mut board, flavour, table.axis, motor, opening)?;
        if settings.soft_limits() {
            return Err(GrblError::SoftLimits);
        }
        let scale = settings.scale(table)?;
        let step_rad = motor.step_rad();
        let acceleration = settings.acceleration_units_s2()?;
        let steps_s2 = acceleration * scale.steps_per_unit;
        if steps_s2 * step_rad > motor.max_acceleration_rad_s2 * (1.0 + TOLD) {
            return Err(GrblError::Steep {
                board_rad_s2: steps_s2 * step_rad,
                limit_rad_s2: motor.max_acceleration_rad_s2,
                number: settings.number(120),
                setting: acceleration,
            });
        }
        connect::rest(&mut board, &mut reset)?;
        let place = board.rests_at()?;
        // The counter of another board says nothing about the rotor.
        reset |= replaced.board.is_some();
        let told = replaced.notes().chain(told.into_iter().map(Notice::from));
        let notes = told.chain(remarks(&settings, &scale)).collect();
        let resets = board.resets();
        drop(board);
        Ok(Self {
            least_steps_s: settings.least_steps_s(&scale),
            most_steps_s: settings.most_steps_s(&scale)?,
            stands: Some(scale.count(scale.reported_mm(place))),
            disturbed: reset.then_some(Disturbance::Reset),
            unrecorded: false,
            rests: 0,
            unknown_board: opening.records_later.then(|| (found, opening.clone())),
            board: axis_board,
            resets,
            place: None,
            settings,
            scale,
            step_rad,
            steps_s2,
            notes,
        })
    }

    /// Returns the task of `plan` for the board, or refuses it before anything moves.
    fn task(&mut self, plan: &Plan) -> Result<Task, GrblError> {
        let mut board = self.board.lock()?;
        let mut reset = false;
        connect::rest(&mut board, &mut reset)?;
        let place = board.rests_at()?;
        reset |= board.resets() != self.resets;
        self.resets = board.resets();
        drop(board);
        let counted = self.scale.count(self.scale.reported_mm(place));
        let expected = self.stands.replace(counted);
        if reset {
            return Err(GrblError::Reset);
        }
        if let Some(expected) = expected.filter(|expected| *expected != counted) {
            return Err(GrblError::Count { counted, expected });
        }
        let task = Task {
            start: counted,
            direction: i64::from(plan.direction().sign()),
            steps: plan.steps().unsigned_abs(),
            steps_s: plan.profile().peak_rad_s() / self.step_rad,
            steps_s2: self.steps_s2,
            most_steps_s: self.most_steps_s,
        };
        if task.steps_s < self.least_steps_s * (1.0 - TOLD) {
            return Err(GrblError::Slow { steps_s: task.steps_s, least_s: self.least_steps_s });
        }
        if self.settings.flavour == Flavour::Grbl && task.steps_s > MOST_STEPS_S * (1.0 + TOLD) {
            return Err(GrblError::FasterThanGrbl { steps_s: task.steps_s, most_s: MOST_STEPS_S });
        }
        if task.steps_s > self.most_steps_s * (1.0 + TOLD) {
            return Err(GrblError::Fast {
                steps_s: task.steps_s,
                most_s: self.most_steps_s,
                number: self.settings.number(110),
                setting: self.settings.rate_units_min()?,
            });
        }
        task.check(&self.scale, &[])?;
        Ok(task)
    }

    /// Makes the steps of `plan` by `motion`, and stops after any error. A fault tells the bounds of the
    /// steps made. Returns `None` if the user asked to stop before the first step could be asked for.
    fn travel<T>(
        &mut self,
        plan: &Plan,
        motion: impl FnOnce(&mut Jogs<'_>) -> Result<T, GrblError>,
    ) -> Result<Option<(T, u64)>, DriveFault> {
        self.rests = 0;
        let task = match self.task(plan) {
            Ok(task) => task,
            Err(GrblError::Interrupted) => return Ok(None),
            Err(error) => return Err(self.fault(error, Made::exactly(0))),
        };
        let mut board = match self.board.lock() {
            Ok(board) => board,
            Err(_) => return Ok(None),
        };
        // From here on the gate hears the user.
        let (outcome, sent, rests) = board.undisturbed(|board| {
            let mut under_way = Jogs::new(board, &self.scale, task, &[]);
            let outcome = match motion(&mut under_way) {
                Ok(value) => Ok((value, under_way.made)),
                Err(error) => Err(under_way.recover(error)),
            };
            (outcome, under_way.sent, under_way.rests.count())
        });
        // A search that is stopped resets the board itself.
        self.resets = board.resets();
        drop(board);
        let (value, result) = match outcome {
            Ok((value, made)) => (Some(value), Ok(made)),
            Err(error) => (None, Err(error)),
        };
        let made = self.conclude(&task, AxisEnd { result, sent, rests })?;
        Ok(value.map(|value| (value, made)))
    }

    /// Makes the steps of `plan` on one line with the axes of the other places. Returns the steps made.
    fn travel_in_line(
        &mut self,
        plan: &Plan,
        mut place: BeginPlace,
        gate: &mut Gate<'_>,
    ) -> Result<u64, DriveFault> {
        self.rests = 0;
        let task = match self.task(plan) {
            Ok(task) => task,
            Err(GrblError::Interrupted) => return Ok(0),
            Err(error) => return Err(self.fault(error, Made::exactly(0))),
        };
        let own = Follower { scale: self.scale, task };
        let ended = match meet(&self.board, &mut place, own, gate) {
            Ok(Met::Stopped) => return Ok(0),
            Ok(Met::Follows(led)) => Ok(follow(&led, task.steps, gate, SILENCE)),
            Ok(Met::Leads(others)) => match self.board.lock() {
                Ok(mut board) => lead(&mut board, own, &others, gate, &mut place),
                Err(_) => return Ok(0),
            },
            Err(error) => Err(error),
        };
        match ended {
            Ok(ended) => self.conclude(&task, ended),
            Err(error) => Err(self.fault(error, Made::exactly(0))),
        }
    }

    /// Takes in the end of a motion.
    fn conclude(&mut self, task: &Task, ended: AxisEnd) -> Result<u64, DriveFault> {
        let AxisEnd { result, sent, rests } = ended;
        self.rests = rests;
        let known = match &result {
            Ok(made) => Some(*made as i64),
            Err((_, made)) => made.known(),
        };
        self.stands = known.map(|net| task.start + task.direction * net);
        if sent > 0 && !self.holds_at_rest() {
            self.disturbed.get_or_insert(Disturbance::Disabled);
        }
        result.map_err(|(error, made)| self.fault(error, made))
    }

    fn fault(&mut self, error: GrblError, made: Made) -> DriveFault {
        match error {
            GrblError::Reset => self.disturbed = Some(Disturbance::Reset),
            GrblError::Gone(_) | GrblError::Quiet { .. } => self.disturbed = Some(Disturbance::LinkLost),
            _ => {}
        }
        let Made { least, most, lost } = made;
        let (lost, count_lost) = (lost || error.loses(), matches!(error, GrblError::Reset));
        DriveFault { made_least: least, made_most: most, lost, count_lost, error: error.into() }
    }

    /// Takes in what the board says unasked for as long as `wait`, to this axis or another.
    fn overhear(&mut self, wait: Duration, deaf: bool) -> Result<(), GrblError> {
        let mut board = self.board.lock()?;
        let heard = overheard(&mut board, wait, deaf);
        let resets = board.resets();
        drop(board);
        self.note_resets(resets);
        heard
    }

    fn note_resets(&mut self, resets: u32) {
        if resets != self.resets {
            self.resets = resets;
            self.disturbed = Some(Disturbance::Reset);
            self.stands = None;
        }
    }
}

/// Takes in what a board says unasked for as long as `wait`.
fn overheard(board: &mut Board, wait: Duration, deaf: bool) -> Result<(), GrblError> {
    let before = board.be_deaf(deaf);
    let heard = board.hear_all(wait, |_: Heard| Ok(()));
    board.be_deaf(before);
    heard
}

impl Drop for Grbl {
    fn drop(&mut self) {
        if self.disturbed.is_none() && !self.unrecorded {
            self.board.note_told(self.resets);
        }
    }
}
