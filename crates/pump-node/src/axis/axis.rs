//! An axis and the state that it is in.

use pump_ctl::drive::{Actuator, Fault, OnFault};
use pump_ctl::step::{Brake, Direction, Stepper};
use pump_link::message::{AxisState, AxisStatus, End, MoveOrder, Stopping};
use pump_link::receiver::Expected;

use super::faults::Faults;
use super::pulse::Pulse;
use super::setup::{Setup, Times};
use super::timing::tick_rate;
use crate::board::{Board, Edge, Pins};
use crate::driver::Driver;

/// An axis of a node with a queue of `Q` segments. [`crate::Axes`] work with those that a firmware has made, each in
/// its place.
// The actuator comes last, for the reason that is given at `pump_ctl::step::Stepper`.
#[derive(Debug)]
#[repr(C)]
pub struct Axis<P, const Q: usize> {
    pulse: Pulse,
    pub(super) times: Times,
    pub(super) state: AxisState,
    pub(super) revision: u32,
    pub(super) move_number: u32,
    pub(super) order: MoveOrder,
    pub(super) expected: Expected,
    /// Number of the last change of the move.
    pub(super) changes: u32,
    /// Position after the segments taken, signed steps.
    pub(super) taken_end: i64,
    /// True if the last move was begun.
    pub(super) begun: bool,
    /// End of the last stop.
    pub(super) stopping: Stopping,
    /// Tick from which an energised motor may step.
    pub(super) ready_at: u64,
    /// Tick since which the motor stands.
    pub(super) rests_from: u64,
    pub(super) angle_lost: bool,
    pub(super) faults: Faults,
    /// Motor and executor. The pins are inputs until a host has configured the axis.
    pub(super) actuator: Actuator<Driver<P>, Q>,
}

/// Ticks after which no step comes, because the motor stands.
pub(crate) const NEVER: u32 = u32::MAX;

/// Most ticks to a step that is far. The interrupt asks again before.
const FAR: u32 = NEVER - 1;

/// A move of no steps.
const NO_ORDER: MoveOrder = MoveOrder { from: 0, last: 0, shortest_interval: u32::MAX };

impl<P: Pins, const Q: usize> Axis<P, Q> {
    /// Makes an axis on a timer of this rate, Hz. Pins stay inputs.
    pub fn new(pins: P, tick_hz: u32) -> Self {
        // No move is taken before a configuration has brought the motor's own brake.
        let brake = Brake::standing(tick_rate(tick_hz));
        Self {
            pulse: Pulse::default(),
            times: Times::default(),
            state: AxisState::Unconfigured,
            revision: 0,
            move_number: 0,
            order: NO_ORDER,
            expected: Expected::default(),
            changes: 0,
            taken_end: 0,
            begun: false,
            stopping: Stopping { last_step_at: 0, final_count: 0 },
            ready_at: 0,
            rests_from: 0,
            angle_lost: false,
            faults: Faults::default(),
            actuator: Actuator::new(Driver::new(pins), Stepper::new(brake), OnFault::Hold),
        }
    }

    /// Forgets what another session has configured and prepared. The motor must stand, and holds as before.
    pub(crate) fn forget_session(&mut self) {
        self.state = AxisState::Unconfigured;
        self.revision = 0;
        self.move_number = 0;
        self.begun = false;
    }

    /// Configures an axis that stands, and makes its pins outputs. The interrupt is kept off meanwhile, so nothing
    /// large is moved but the brake.
    pub(crate) fn configure(&mut self, revision: u32, setup: &Setup, now: u64) {
        let Setup { config, times, brake } = setup;
        if !self.actuator.stepper().set_brake(brake) {
            return;
        }
        let keep = self.is_energised() && config.energised;
        if self.is_energised() && !keep {
            self.disable();
        }
        self.actuator.motor().set_up(*config, keep);
        self.pulse = Pulse::new(self.actuator.motor().step_pin(), config.step_active_low, times);
        self.times = *times;
        if config.energised {
            self.enable();
        }
        if !keep {
            self.ready_at = now + times.enable;
        }
        self.revision = revision;
        self.state = AxisState::Ready;
        self.rests_from = now;
        self.angle_lost = false;
    }

    /// Energises the motor.
    pub(super) fn enable(&mut self) {
        if let Err(Fault::Motor { error, .. }) = self.actuator.enable() {
            match error {}
        }
    }

    /// Stops dead and lets go of the motor.
    fn disable(&mut self) {
        if let Err(Fault::Motor { error, .. }) = self.actuator.disable() {
            match error {}
        }
    }

    /// Returns true if a host has configured the axis since power-up.
    pub(super) fn is_set_up(&mut self) -> bool {
        self.actuator.motor().is_set_up
    }

    /// Returns the position, signed steps since power-up.
    pub(crate) fn position(&mut self) -> i64 {
        self.actuator.stepper().position()
    }

    pub(crate) fn revision(&self) -> u32 {
        self.revision
    }

    pub(crate) fn is_energised(&mut self) -> bool {
        self.actuator.motor().is_energised()
    }

    /// Returns true if a move has a tick at which it begins, or is under way.
    pub(crate) fn is_moving(&self) -> bool {
        matches!(self.state, AxisState::Moving | AxisState::Ending(_))
    }

    /// Returns the shortest interval that the axis may make now, ticks.
    pub(crate) fn reserved_interval(&self) -> Option<u32> {
        let reserves = self.is_moving() || self.state == AxisState::Prepared;
        reserves.then_some(self.order.shortest_interval)
    }

    pub(crate) fn status(&mut self) -> AxisStatus {
        // The sensor is read just after the pin has risen: it tells where the step before has led.
        let way = i64::from(Direction::of(self.order.last.saturating_sub(self.order.from)).sign());
        let index_at = self.actuator.index_at().map(|at| at.saturating_sub(way));
        AxisStatus {
            position: self.position(),
            state: self.state,
            revision: self.revision,
            move_number: self.move_number,
            next_segment: self.expected.next(),
            room: self.room(),
            energised: self.is_energised(),
            angle_lost: self.angle_lost,
            index_at,
            faults: self.faults.counted,
            unread: self.faults.unread(),
        }
    }

    /// Returns the ticks from `called` to the next rise of the step pin. They are 0 if it is overdue, and [`NEVER`] if
    /// the motor stands.
    #[inline]
    pub(crate) fn rises_after(&self, called: u64) -> u32 {
        let Some(tick) = self.next_rise() else { return NEVER };
        let ticks = tick.wrapping_sub(called);
        match (ticks >> 32) as i32 {
            0 => (ticks as u32).min(FAR),
            ..0 => 0,
            _ => FAR,
        }
    }

    /// Returns the tick at which the step pin rises next, or `None` if the motor stands.
    #[inline]
    pub(crate) fn next_rise(&self) -> Option<u64> {
        self.actuator.next_deadline().map(|due| due.max(self.pulse.low_until))
    }

    /// Returns the edge that begins the pulse of the next step.
    #[inline]
    pub(crate) fn rise(&self) -> Edge {
        self.pulse.begin
    }

    /// Notes that the step pin has risen by tick `now`. [`Self::count_step`] must follow.
    #[inline]
    pub(crate) fn rose(&mut self, now: u64) {
        self.pulse.high_since = Some(now);
    }

    /// Returns true if the pulse of a step is under way.
    #[inline]
    pub(crate) fn is_high(&self) -> bool {
        self.pulse.high_since.is_some()
    }

    /// Counts the step whose pulse is under way, and finds the time of the next.
    #[inline]
    pub(crate) fn count_step(&mut self) {
        let Some(at) = self.pulse.high_since else { return };
        let mut said = self.actuator.on_timer(at);
        if self.actuator.is_moving() {
            return;
        }
        if said.is_ok() {
            // The step was the last. The next call says how the move ended.
            said = self.actuator.on_timer(at);
        }
        self.ended_by_timer(said, at);
    }

    /// Ends the pulse that is under way, in an interrupt that was `called` at this tick.
    #[inline]
    pub(crate) fn lower(&mut self, board: &mut impl Board, called: u64) {
        if let Some(tick) = self.pulse.ends_at() {
            board.wait_until(tick);
            board.set_steps(self.pulse.end);
            self.pulse.ended(called + u64::from(board.since(called)));
        }
    }

    /// Stops dead and lets go of the motor. Returns true if it was configured.
    pub(crate) fn cut(&mut self, end: End, now: u64) -> bool {
        if !self.is_set_up() {
            return false;
        }
        self.disable();
        self.angle_lost = true;
        if self.is_moving() || self.state == AxisState::Prepared {
            self.state = AxisState::Ended(end);
        }
        self.rests_from = now;
        true
    }

    /// Lets go of a motor that has rested for as long as its configuration says.
    pub(crate) fn rest(&mut self, now: u64) {
        let stands = matches!(self.state, AxisState::Ready | AxisState::Ended(_) | AxisState::Unconfigured);
        if self.times.idle == 0 || !stands {
            return;
        }
        let rested = now.saturating_sub(self.rests_from) >= self.times.idle;
        if rested && self.is_energised() {
            self.cut(End::Complete, now);
        }
    }
}
