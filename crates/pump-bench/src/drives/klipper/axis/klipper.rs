//! The motor at a board with the Klipper firmware.

use std::sync::Arc;
use std::time::Duration;

use pump_ctl::plan::{FlowMotion, Motor, Plan, PlannedMotion};

use crate::drives::klipper::board::{
    Board, Met, SessionRecord, SharedBoard, Terms, check_driver, marks, meet,
};
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::link::{Link, Place};
use crate::drives::klipper::motion::{self, Fault, Made, Task, most_steps_s};
use crate::drives::wire::{BoardPort, NotShared, OpenPorts};
use crate::drives::{
    Abilities, BEGIN_LEAD, BeginPlace, BoardShare, Disturbance, Drive, DriveError, DriveFault, DriveLimits,
    Gate, IndexSearch, Opening,
};
use crate::notice::Notice;
use crate::pump_file::{DriveTable, DriverName, MotorTable, PumpFile};

/// Farthest count of a board either way: it counts in 32 bits from their middle (Klipper3d/klipper, `src/stepper.c`).
const FARTHEST: i64 = (1 << 30) - 1;

/// Longest time without a confirmation at rest. A computer under load may hold the board's bytes back for as long.
const REST_QUIET: Duration = Duration::from_secs(3);

/// Boards with this firmware that this process has open. Their motors share them.
static OPEN: OpenPorts<SharedBoard> = OpenPorts::new();

/// Opens the motor that `table` names, for the pump of `file`.
pub(crate) fn open(
    table: &DriveTable,
    file: &PumpFile,
    opening: &Opening,
) -> Result<Box<dyn Drive>, DriveError> {
    Ok(Box::new(Klipper::open(table, &file.motor, opening)?))
}

/// Motor at a board with the Klipper firmware, which makes each step at the plan's time.
#[derive(Debug)]
pub struct Klipper {
    motor: Motor,
    /// Steps of a full step of the motor.
    full_steps: u32,
    terms: Terms,
    at: At,
    /// Count of the board at rest. `None` if nobody knows it until the board is met anew.
    stands: Option<i64>,
    disturbed: Option<Disturbance>,
    /// True if the slip of the last motion was told with its fault. Once that is on record, no later meeting tells it
    /// again.
    tells_slip: bool,
    /// True if the last motion ended without current, by a shutdown or a reset, which was told with its fault.
    has_lost_current: bool,
    notes: Vec<Notice>,
    /// Place of the next motion among those that begin together.
    place: Option<BeginPlace>,
    shared: Arc<SharedBoard>,
}

/// Place of the link to the board.
#[derive(Debug)]
enum At {
    /// The board was met, and is configured.
    Met(Box<Board>),
    /// The board has to be met anew.
    Apart(Box<Link>),
    /// The link is handed on.
    Nowhere,
}

impl Klipper {
    /// Opens the port that `table` names, meets the board, configures it and gives the motor current. Moves nothing.
    /// Drives of one process share the port, so several threads may each drive a motor of one board.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the port is missing or in use, the table has no pins, no board with this firmware answers, it
    /// is another board than the one on record, it lacks a pin or a command, or another program has configured it.
    pub fn open(table: &DriveTable, motor: &MotorTable, opening: &Opening) -> Result<Self, DriveError> {
        let terms = Terms::new(table, motor, opening)?;
        let open = || -> Result<SharedBoard, KlipperError> {
            Ok(SharedBoard::new(Box::new(BoardPort::open(table.port.as_deref(), table.rate_baud())?)))
        };
        let is_gone = |board: &SharedBoard| board.trunk.is_gone();
        let shared = OPEN.share(table.port.as_deref(), table.rate_baud(), is_gone, open);
        let shared = shared.map_err(|error| match error {
            NotShared::Rate { device, open_baud } => {
                KlipperError::Rate { port: device, baud: table.rate_baud(), open_baud }
            }
            NotShared::Open(error) => error,
        })?;
        let place = Place { port: terms.port.clone(), baud: terms.baud };
        let link = Link::over(Arc::clone(&shared.trunk), place, terms.opening.stop.clone());
        let mut klipper = Self {
            motor: motor.at_pump_head(),
            full_steps: (motor.steps_per_rev / motor.full_steps_per_rev.max(1)).max(1),
            terms,
            at: At::Apart(Box::new(link)),
            stands: None,
            disturbed: None,
            tells_slip: false,
            has_lost_current: false,
            notes: Vec::new(),
            place: None,
            shared,
        };
        klipper.meet()?;
        Ok(klipper)
    }

    /// Meets the board, unless it was met.
    fn meet(&mut self) -> Result<(), KlipperError> {
        let link = match std::mem::replace(&mut self.at, At::Nowhere) {
            At::Apart(link) => *link,
            met => {
                self.at = met;
                return Ok(());
            }
        };
        match meet(link, &self.terms, &self.shared) {
            Ok(Met { board, position, disturbed, replaced, of_board }) => {
                self.notes.extend(replaced.notes());
                self.notes.extend(of_board.into_iter().map(Notice::from));
                self.at = At::Met(Box::new(board));
                self.has_lost_current = false;
                (self.stands, self.disturbed) = (Some(position), disturbed);
                // The session must hear what the board has told. A motion learns the drift again before it moves.
                match self.learn_drift(self.terms.opening.with_other_boards) {
                    Err(KlipperError::Interrupted) => Ok(()),
                    learnt => learnt,
                }
            }
            Err((link, error)) => {
                self.at = At::Apart(link);
                Err(error)
            }
        }
    }

    /// Has the board met anew before it moves again.
    fn part(&mut self) {
        self.at = match std::mem::replace(&mut self.at, At::Nowhere) {
            At::Met(mut board) => {
                self.terms.last = Some(board.record);
                board.talk.link.note_met(false);
                At::Apart(Box::new(board.talk.link))
            }
            apart => apart,
        };
    }

    /// Returns the task of `plan`, or refuses it before anything moves.
    fn task(&mut self, plan: PlannedMotion<'_>) -> Result<Task, KlipperError> {
        let At::Met(board) = &mut self.at else { return Err(KlipperError::Reset) };
        board.check()?;
        let position = board.position()?;
        let expected = self.stands.replace(position);
        if let Some(expected) = expected.filter(|expected| *expected != position) {
            return Err(KlipperError::Count { counted: position, expected });
        }
        Task::new(plan, board, self.full_steps)
    }

    /// Checks that the board can make a motion, and that it is where it was left.
    fn check_motion(&mut self, motion: PlannedMotion<'_>) -> Result<(), DriveError> {
        let checked = self.task(motion).and_then(|_| self.check_driver());
        if checked.is_err() {
            self.part();
        }
        Ok(checked?)
    }

    /// Refuses a stepper driver that has lost the motor's current.
    fn check_driver(&mut self) -> Result<(), KlipperError> {
        let At::Met(board) = &mut self.at else { return Ok(()) };
        let Some(address) = board.driver else { return Ok(()) };
        check_driver(&mut board.talk, address).map(drop).inspect_err(|error| {
            if error.is_of_driver() {
                self.disturbed = Some(Disturbance::CurrentLost);
            }
        })
    }

    /// Makes the steps of `plan`.
    fn travel(
        &mut self,
        plan: PlannedMotion<'_>,
        gate: &mut Gate<'_>,
        seeks: bool,
    ) -> Result<Made, DriveFault> {
        // A place that is not used is given up, and the others hear of it.
        let place = self.place.take();
        // Motors of one board begin at one tick of its clock, whatever that is.
        let is_of_one_board = !self.terms.opening.beside.is_empty() && !self.terms.opening.with_other_boards;
        let learnt = self.learn_drift(place.is_some() && !is_of_one_board);
        // From here on the gate hears the user.
        self.be_deaf(true);
        let made = learnt.and_then(|()| self.task(plan)).and_then(|task| self.announce(task).map(|()| task));
        let start = self.stands.unwrap_or(0);
        let (made, slip_steps) = match (made, &mut self.at) {
            (Ok(task), At::Met(board)) => motion::run(board, plan, task, start, (seeks, place), gate),
            (Ok(_), _) => (Err(Fault::at(0, KlipperError::Reset)), 0),
            (Err(error), _) => (Err(Fault::at(0, error)), 0),
        };
        self.at_rest();
        let made = made.map(|(made, warning)| {
            self.notes.extend(warning.map(Notice::from));
            made
        });
        let known = match &made {
            Ok(made) => Some(made.steps),
            Err(fault) => fault.known(),
        };
        let direction = i64::from(plan.direction().sign());
        let signed = known.and_then(|made| i64::try_from(made).ok());
        self.stands = self.stands.zip(signed).map(|(before, made)| before + direction * made);
        made.map_err(|fault| {
            self.part();
            let without_current = match fault.error {
                // The next meeting tells of a shutdown after which the board's count was not found.
                KlipperError::Shutdown { .. } => known.is_some(),
                // The board counts anew.
                KlipperError::Reset => {
                    self.stands = None;
                    true
                }
                _ => false,
            };
            if slip_steps > 0 || without_current {
                self.disturbed = Some(Disturbance::Halted { slip_steps, without_current });
                (self.tells_slip, self.has_lost_current) = (true, without_current);
            }
            fault.of_drive()
        })
    }

    /// Has the board's clock known well before a motion that begins together with those of other boards.
    fn learn_drift(&mut self, begins_together: bool) -> Result<(), KlipperError> {
        match &mut self.at {
            At::Met(board) if begins_together => board.learn_drift(),
            _ => Ok(()),
        }
    }

    /// Puts on record by how many steps the motor may slip if the motion ends without a ramp.
    fn announce(&mut self, task: Task) -> Result<(), KlipperError> {
        let At::Met(board) = &mut self.at else { return Ok(()) };
        if board.record.slip_steps != task.slip_steps {
            let record = SessionRecord { slip_steps: task.slip_steps, ..board.record };
            board.put_on_record(record)?;
        }
        Ok(())
    }

    /// Has the link hear no request to stop while a gate does.
    fn be_deaf(&mut self, is_deaf: bool) {
        match &mut self.at {
            At::Met(board) => board.talk.link.be_deaf(is_deaf),
            At::Apart(link) => link.be_deaf(is_deaf),
            At::Nowhere => {}
        }
    }

    /// Has the link hear the user again, and wait as long for the board as it does at rest.
    fn at_rest(&mut self) {
        self.be_deaf(false);
        if let At::Met(board) = &mut self.at {
            board.talk.link.set_quiet(REST_QUIET);
        }
    }

    /// Takes the current of the motor away. The disk knows it before the motor does.
    fn let_go(&mut self) -> Result<(), KlipperError> {
        let At::Met(board) = &mut self.at else { return Err(KlipperError::Reset) };
        let record = SessionRecord { has_current: false, slip_steps: 0, ..board.record };
        board.put_on_record(record)?;
        board.set_current(false)
    }
}

impl Drive for Klipper {
    fn id(&self) -> &str {
        DriverName::Klipper.as_str()
    }

    fn abilities(&self) -> Abilities {
        Abilities::KLIPPER
    }

    fn limits(&self) -> Option<DriveLimits> {
        let At::Met(board) = &self.at else { return None };
        Some(DriveLimits::of_speed(most_steps_s(board.timer) * self.motor.step_rad()))
    }

    fn count(&self) -> Option<i64> {
        self.stands
    }

    fn farthest_count(&self) -> Option<i64> {
        Some(FARTHEST)
    }

    fn disturbed(&mut self) -> Option<Disturbance> {
        self.disturbed.take()
    }

    fn is_without_current(&self) -> bool {
        self.has_lost_current
    }

    fn recorded(&mut self) {
        let (true, Some(last)) = (std::mem::take(&mut self.tells_slip), self.terms.last) else { return };
        let told = SessionRecord { slip_steps: 0, ..last };
        // Without this record the next meeting tells the slip once more, which is on the safe side.
        if self.terms.record.as_ref().is_none_or(|path| told.write(path).is_ok()) {
            self.terms.last = Some(told);
        }
    }

    fn put_on_record(&mut self) -> Result<(), DriveError> {
        let (At::Met(board), true) = (&self.at, self.terms.opening.records_later) else { return Ok(()) };
        let marks = marks(&board.talk, &self.terms);
        marks.put_on_record(&self.terms.opening).map_err(KlipperError::from)?;
        self.terms.opening.records_later = false;
        Ok(())
    }

    fn connect(&mut self) -> Result<(), DriveError> {
        Ok(self.meet()?)
    }

    fn check(&mut self, plan: &Plan) -> Result<(), DriveError> {
        self.check_motion(plan.into())
    }

    fn check_flow(&mut self, flow: &FlowMotion<'_>) -> Result<(), DriveError> {
        self.check_motion(flow.into())
    }

    fn board_share(&self, motion: PlannedMotion<'_>) -> Result<Option<BoardShare>, DriveError> {
        let At::Met(board) = &self.at else { return Ok(None) };
        if self.terms.opening.beside.is_empty() {
            return Ok(None);
        }
        Ok(Some(Task::new(motion, board, self.full_steps)?.share(board)))
    }

    fn begin_lead_s(&self) -> f64 {
        BEGIN_LEAD.as_secs_f64()
    }

    fn forget_plan(&mut self) {
        self.place = None;
    }

    fn begin_with(&mut self, place: BeginPlace) -> Result<(), DriveError> {
        self.place = Some(place);
        Ok(())
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        self.travel(plan.into(), gate, false).map(|made| made.steps)
    }

    fn run_flow(&mut self, flow: &FlowMotion<'_>, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        self.travel(flow.into(), gate, false).map(|made| made.steps)
    }

    fn seek(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<IndexSearch, DriveFault> {
        if self.terms.pins.index.is_none() {
            return Err(DriveFault::at(0, DriveError::no_index(self.id())));
        }
        let Made { steps, index_at } = self.travel(plan.into(), gate, true)?;
        Ok(IndexSearch { made: steps, beyond: index_at.map(|at| steps.saturating_sub(at)) })
    }

    fn notes(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.notes)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        if self.terms.pins.enable.is_none() {
            return Err(DriveError::no_release(self.id()));
        }
        self.meet()?;
        self.disturbed = Some(Disturbance::Disabled);
        let released = self.let_go();
        // The motor has current again once the board is met anew.
        self.part();
        Ok(released?)
    }
}
