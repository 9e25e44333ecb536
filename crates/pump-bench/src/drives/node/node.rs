//! One axis of a node, as the drive of a pump.

use std::sync::Arc;
use std::time::Duration;

use pump_ctl::plan::{FlowMotion, Motor, Plan, PlannedMotion};
use pump_ctl::step::Brake;
use pump_link::message::FaultCounts;

use super::board::Board;
use super::connect::{self, Met, Terms};
use super::error::NodeError;
use super::link::Link;
use super::motion::{self, AHEAD, Fault, LastAsked, Made, Motion, Room, Task, most_steps_s};
use super::node_board::NodeBoard;
use super::unread_faults::faults_noted;
use crate::drives::drive::wait_of;
use crate::drives::sent_lead::SentLead;
use crate::drives::stepped::Lead;
use crate::drives::wire::Wire;
use crate::drives::{
    Abilities, BeginPlace, BoardShare, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Gate,
    IndexSearch, Opening, Watch,
};
use crate::notice::Notice;
use crate::pump_file::{DriveTable, DriverName, MotorTable, PumpFile};

/// Time between two questions of a wait at rest.
const POLL: Duration = Duration::from_millis(20);

/// Opens the axis that `table` names, for the pump of `file`.
pub(crate) fn open(
    table: &DriveTable,
    file: &PumpFile,
    opening: &Opening,
) -> Result<Box<dyn Drive>, DriveError> {
    Ok(Box::new(Node::open(table, &file.motor, opening)?))
}

/// One axis of a node: a board with this project's own firmware, which makes each step at the plan's time.
#[derive(Debug)]
pub struct Node {
    motor: Motor,
    terms: Terms,
    /// Board, or the link to it while it has to be met anew.
    at: At,
    /// Count of the board at rest. `None` if nobody knows it until the board is met anew.
    stands: Option<i64>,
    disturbed: Option<Disturbance>,
    current: Current,
    /// True if the record says that the pump's journal counts by this axis.
    is_axis_recorded: bool,
    notes: Vec<Notice>,
    /// True if the last motion has told a fault that the board has counted too.
    tells_fault: bool,
    /// Place of the next motion among those that begin together.
    place: Option<BeginPlace>,
    /// The needs of the plan that was looked at last.
    last_asked: LastAsked,
}

/// Current of the motor, as far as its want has disturbed the rotor.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum Current {
    /// The motor has held since it was met, or has moved since.
    #[default]
    Held,
    /// The meeting told a disturbance, and the motor has not moved since.
    Told,
    /// The motor was found without current, and that was told.
    Missing,
}

/// Place of the link to the board.
#[derive(Debug)]
enum At {
    /// The board was met, and its axis is configured.
    Met { board: Box<Board>, brake: Box<Brake> },
    /// The board has to be met anew.
    Apart(Box<Link>),
    /// The link is handed on.
    Nowhere,
}

impl Node {
    /// Opens the port that `table` names, meets the board, and configures its axis. Moves nothing. Drives of one
    /// process share the port, so several threads may each drive an axis of one board.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the port is missing or in use, no node answers, it is another board than the one on record,
    /// or it lacks the axis.
    pub fn open(table: &DriveTable, motor: &MotorTable, opening: &Opening) -> Result<Self, DriveError> {
        NodeBoard::open(table.port.as_deref(), table.rate_baud())?.axis(table, motor, opening)
    }

    /// Opens the board at the other end of `wire`, as [`Self::open`] does.
    #[doc(hidden)]
    pub fn over(
        wire: Box<dyn Wire>,
        table: &DriveTable,
        motor: &MotorTable,
        opening: &Opening,
    ) -> Result<Self, DriveError> {
        NodeBoard::over(wire).axis(table, motor, opening)
    }

    /// Meets the board at the other end of `link`, and configures the axis.
    pub(super) fn linked(
        link: Link,
        table: &DriveTable,
        motor: &MotorTable,
        opening: &Opening,
    ) -> Result<Self, DriveError> {
        let mut node = Self {
            motor: motor.at_pump_head(),
            terms: Terms::new(table, opening),
            at: At::Apart(Box::new(link)),
            stands: None,
            disturbed: None,
            current: Current::Held,
            is_axis_recorded: false,
            notes: Vec::new(),
            tells_fault: false,
            place: None,
            last_asked: LastAsked::default(),
        };
        node.meet()?;
        Ok(node)
    }

    /// Meets the board, unless it was met.
    fn meet(&mut self) -> Result<(), NodeError> {
        let link = match std::mem::replace(&mut self.at, At::Nowhere) {
            At::Apart(link) => *link,
            met => {
                self.at = met;
                return Ok(());
            }
        };
        let motor = self.motor;
        match connect::meet(link, &self.terms, |tick_rate| Ok(motor.brake(tick_rate)?)) {
            Ok(Met { board, brake, position, disturbed, unread, replaced, is_axis_recorded }) => {
                self.is_axis_recorded = is_axis_recorded;
                self.notes.extend(replaced.notes());
                self.at = At::Met { board: Box::new(board), brake: Box::new(brake) };
                self.stands = Some(position);
                self.disturbed = disturbed;
                self.current = if disturbed.is_some() { Current::Told } else { Current::Held };
                self.notes.extend(faults_noted(unread));
                // The session must hear what the board has told. A motion learns the clock again before it moves.
                match self.learn_clock(self.terms.opening.with_other_boards) {
                    Err(NodeError::Interrupted) => Ok(()),
                    learnt => learnt,
                }
            }
            Err((link, error)) => {
                self.at = At::Apart(link);
                Err(error)
            }
        }
    }

    /// Has the board's clock known well before a motion that begins together with those at other boards.
    fn learn_clock(&mut self, begins_together: bool) -> Result<(), NodeError> {
        match &mut self.at {
            At::Met { board, .. } if begins_together => board.learn_clock(),
            _ => Ok(()),
        }
    }

    /// Has the board met anew before it moves again.
    fn part(&mut self) {
        self.at = match std::mem::replace(&mut self.at, At::Nowhere) {
            At::Met { board, .. } => At::Apart(Box::new(board.link)),
            apart => apart,
        };
    }

    /// Returns the task of `plan`, or refuses it before anything moves. It has its part of the line and of the board's
    /// steps from now on.
    pub(super) fn task(&mut self, plan: PlannedMotion<'_>) -> Result<Task, NodeError> {
        let At::Met { board, brake } = &mut self.at else { return Err(NodeError::Reset) };
        let (status, _) = board.status()?;
        if status.angle_lost || !status.energised {
            return Err(self.found_without_current(status.unread));
        }
        let expected = self.stands.replace(status.position);
        if let Some(expected) = expected.filter(|expected| *expected != status.position) {
            return Err(NodeError::Count { counted: status.position, expected });
        }
        // Two plans never take the same part of the line, and the motions of other axes go on meanwhile.
        let shared = Arc::clone(board.link.shared());
        let _meeting = board.link.meeting(&shared)?;
        let lane = board.link.lane();
        let config = self.terms.config(true, brake);
        let room = Room::new(self.terms.baud, &board.identity, &config, shared.lock().others(lane));
        let task = Task::new(plan, brake, &board.identity, room, &self.last_asked)?;
        if let Some(lane) = shared.lock().lane(lane) {
            (lane.needs_bytes_s, lane.needs_steps_s) = (task.needs_bytes_s, task.needs_steps_s);
        }
        Ok(task)
    }

    /// Notes that the motor is without current, and returns the cause by the faults that the board has counted.
    ///
    /// A motor that was met without current and could not be given any, because its stepper driver still reports a
    /// fault, was disturbed once.
    fn found_without_current(&mut self, unread: FaultCounts) -> NodeError {
        let (event, error) = match unread {
            FaultCounts { estop: 1.., .. } => (Disturbance::EmergencyStop, NodeError::Estop),
            FaultCounts { driver: 1.., .. } => (Disturbance::Disabled, NodeError::Driver),
            _ => (Disturbance::Disabled, NodeError::LetGo),
        };
        if self.current == Current::Held || event == Disturbance::EmergencyStop {
            self.disturbed = Some(event);
        }
        self.current = Current::Missing;
        error
    }

    /// Gives up the part of the line and of the board's steps that a task has.
    pub(super) fn needs_nothing(&mut self) {
        if let At::Met { board, .. } = &mut self.at
            && let Some(lane) = board.link.line().lane(board.link.lane())
        {
            (lane.needs_bytes_s, lane.needs_steps_s) = (0, 0);
        }
    }

    /// Returns the motion that makes the steps of `plan`, for a board that was met.
    pub(super) fn motion<'a>(
        &'a mut self,
        plan: PlannedMotion<'a>,
        task: Task,
        leads: (&'a SentLead<'a>, &'a Lead),
        seeks: bool,
    ) -> Option<Motion<'a>> {
        let start = self.stands.unwrap_or(0);
        let At::Met { board, .. } = &mut self.at else { return None };
        Some(Motion::new(board, plan, task, leads, start, seeks))
    }

    /// Makes the steps of `plan`. Returns the number of steps made, with the step at which the index was found.
    fn travel(
        &mut self,
        plan: PlannedMotion<'_>,
        gate: &mut Gate<'_>,
        seeks: bool,
    ) -> Result<Made, DriveFault> {
        let place = self.place.take();
        let learnt = self.learn_clock(place.as_ref().is_some_and(BeginPlace::is_of_boards));
        // From here on the gate hears the user.
        self.be_deaf(true);
        let task = learnt.and_then(|()| self.task(plan));
        let made = task.map_err(Fault::at_rest).and_then(|task| {
            let (leads, free) = ([SentLead::new(plan, AHEAD, task.brake_steps)], Lead::free());
            let [lead] = &leads;
            let motion = self.motion(plan, task, (lead, &free), seeks);
            let motions = motion.into_iter().collect();
            motion::run(motions, &leads, &mut [gate], place)
                .pop()
                .unwrap_or(Err(Fault::at_rest(NodeError::Reset)))
        });
        self.after(plan, made)
    }

    /// Checks that the board can make a motion, and that it is where it was left.
    fn check_motion(&mut self, motion: PlannedMotion<'_>) -> Result<(), DriveError> {
        let checked = self.task(motion);
        if checked.is_err() {
            self.needs_nothing();
            self.part();
        }
        Ok(checked.map(drop)?)
    }

    /// Notes where a motion has led.
    pub(super) fn after(
        &mut self,
        plan: PlannedMotion<'_>,
        made: Result<Made, Fault>,
    ) -> Result<Made, DriveFault> {
        self.be_deaf(false);
        self.needs_nothing();
        if self.current == Current::Told {
            self.current = Current::Held;
        }
        let known = match &made {
            Ok(made) => Some(made.steps as i64),
            Err(fault) => fault.known(),
        };
        let direction = i64::from(plan.direction().sign());
        self.stands = self.stands.zip(known).map(|(before, made)| before + direction * made);
        made.map_err(|fault| {
            self.part();
            self.tells_fault = matches!(fault.error, NodeError::Estop | NodeError::Driver);
            if matches!(fault.error, NodeError::Reset) {
                // The motor was without current, and the board counts anew.
                (self.disturbed, self.current, self.stands) =
                    (Some(Disturbance::Reset), Current::Missing, None);
            }
            fault.of_drive()
        })
    }

    /// Has the link hear no request to stop while a gate does.
    pub(super) fn be_deaf(&mut self, is_deaf: bool) {
        match &mut self.at {
            At::Met { board, .. } => board.link.is_deaf = is_deaf,
            At::Apart(link) => link.is_deaf = is_deaf,
            At::Nowhere => {}
        }
    }
}

impl Drive for Node {
    fn id(&self) -> &str {
        DriverName::Node.as_str()
    }

    fn abilities(&self) -> Abilities {
        Abilities::NODE
    }

    fn limits(&self) -> Option<DriveLimits> {
        let At::Met { board, brake } = &self.at else { return None };
        let most_steps_s = most_steps_s(&board.identity, &self.terms.config(true, brake));
        Some(DriveLimits::of_speed(most_steps_s * self.motor.step_rad()))
    }

    fn count(&self) -> Option<i64> {
        self.stands
    }

    fn disturbed(&mut self) -> Option<Disturbance> {
        self.disturbed.take()
    }

    fn is_without_current(&self) -> bool {
        self.current == Current::Missing
    }

    fn recorded(&mut self) {
        if let (false, At::Met { board, .. }) = (self.is_axis_recorded, &self.at) {
            // An axis that is not on record is told again, which makes the angle less sure and never too sure.
            self.is_axis_recorded = connect::record_axis(board, &self.terms).is_ok();
        }
        if let (true, At::Apart(link)) = (std::mem::take(&mut self.tells_fault), &mut self.at) {
            // A board that is out of reach tells the fault once more when it is met, which is no harm.
            let _ = connect::confirm_faults(link, self.terms.axis as u8);
        }
    }

    fn put_on_record(&mut self) -> Result<(), DriveError> {
        let (At::Met { board, .. }, true) = (&self.at, self.terms.opening.records_later) else {
            return Ok(());
        };
        let marks = connect::marks(&board.identity, &self.terms);
        marks.put_on_record(&self.terms.opening).map_err(NodeError::from)?;
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
        let At::Met { board, brake } = &self.at else { return Ok(None) };
        let config = self.terms.config(true, brake);
        let room = Room::new(self.terms.baud, &board.identity, &config, std::iter::empty());
        let task = Task::new(motion, brake, &board.identity, room, &self.last_asked)?;
        Ok(Some(task.share(&board.identity, room)))
    }

    fn run_flow(&mut self, flow: &FlowMotion<'_>, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        self.travel(flow.into(), gate, false).map(|made| made.steps)
    }

    fn forget_plan(&mut self) {
        self.needs_nothing();
    }

    fn begin_with(&mut self, place: BeginPlace) -> Result<(), DriveError> {
        self.place = Some(place);
        Ok(())
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        self.travel(plan.into(), gate, false).map(|made| made.steps)
    }

    fn seek(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<IndexSearch, DriveFault> {
        if !self.terms.has_index {
            return Err(DriveFault::at(0, DriveError::no_index(self.id())));
        }
        let Made { steps, index_at } = self.travel(plan.into(), gate, true)?;
        Ok(IndexSearch { made: steps, beyond: index_at.map(|at| steps.saturating_sub(at)) })
    }

    fn settle(&mut self, settle_s: f64, watch: &mut Watch<'_>) -> Result<Option<f64>, DriveError> {
        let link = match &mut self.at {
            At::Met { board, .. } => &mut board.link,
            At::Apart(link) => link,
            At::Nowhere => return Ok(None),
        };
        let until = link.now().saturating_add(wait_of(settle_s));
        loop {
            let left = until.saturating_sub(link.now());
            if left.is_zero() || watch().is_break() || link.heed().is_err() {
                return Ok(None);
            }
            // A connection that broke at rest is the next motion's fault: the steps made are known.
            if link.pass(left.min(POLL)).is_err() {
                link.sleep(left.min(POLL));
            }
        }
    }

    fn notes(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.notes)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        let At::Met { board, brake } = &mut self.at else { return Err(NodeError::Reset.into()) };
        connect::configure(board, &self.terms, brake, false)?;
        self.disturbed = Some(Disturbance::Disabled);
        self.part();
        Ok(())
    }
}
