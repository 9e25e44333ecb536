//! An axis and the state that it is in.

use pump_ctl::drive::{Actuator, Fault, OnFault};
use pump_ctl::step::{Brake, Direction, Stepper};
use pump_link::message::{AxisConfig, AxisState, AxisStatus, End, MoveOrder, Stopping};
use pump_link::receiver::Expected;

use super::faults::Faults;
use super::timing::ns_in_ticks;
use crate::board::Pins;
use crate::driver::Driver;

/// An axis with a queue of `Q` segments.
#[derive(Debug)]
pub(crate) struct Axis<P, const Q: usize> {
    /// Pins that the host has not configured. They are inputs.
    bare: Option<P>,
    /// Motor and executor, once the pins are outputs.
    pub(super) actuator: Option<Actuator<Driver<P>, Q>>,
    pub(super) tick_hz: u32,
    pub(super) state: AxisState,
    pub(super) revision: u32,
    pub(super) move_number: u32,
    pub(super) order: MoveOrder,
    pub(super) expected: Expected,
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
    /// Tick from which the step pin may rise again.
    low_until: u64,
    /// Tick at which the step pin rises for a step that was taken.
    rises_at: Option<u64>,
    pub(super) angle_lost: bool,
    pub(super) faults: Faults,
}

/// A move of no steps.
const NO_ORDER: MoveOrder = MoveOrder { from: 0, last: 0, shortest_interval: u32::MAX };

impl<P: Pins, const Q: usize> Axis<P, Q> {
    /// Makes an axis whose pins are inputs.
    pub(crate) fn new(pins: P, tick_hz: u32) -> Self {
        Self {
            bare: Some(pins),
            actuator: None,
            tick_hz,
            state: AxisState::Unconfigured,
            revision: 0,
            move_number: 0,
            order: NO_ORDER,
            expected: Expected::default(),
            taken_end: 0,
            begun: false,
            stopping: Stopping { last_step_at: 0, final_count: 0 },
            ready_at: 0,
            rests_from: 0,
            low_until: 0,
            rises_at: None,
            angle_lost: false,
            faults: Faults::default(),
        }
    }

    /// Forgets what another session has configured and prepared. The motor must stand, and holds as before.
    pub(crate) fn forget_session(&mut self) {
        self.state = AxisState::Unconfigured;
        self.revision = 0;
        self.move_number = 0;
        self.begun = false;
    }

    /// Configures an axis that stands, and makes its pins outputs.
    pub(crate) fn configure(&mut self, revision: u32, config: AxisConfig, brake: Brake, now: u64) {
        let position = self.position();
        let energised = self.is_energised();
        let pins = match self.actuator.take() {
            Some(actuator) => Some(actuator.release().0.release()),
            None => self.bare.take(),
        };
        let Some(pins) = pins else {
            return;
        };
        let keep = energised && config.energised;
        let mut stepper = Stepper::new(brake);
        let _ = stepper.set_position(position);
        let actuator =
            self.actuator.insert(Actuator::new(Driver::new(pins, config, keep), stepper, OnFault::Hold));
        if config.energised {
            enable(actuator);
        }
        if !keep {
            self.ready_at = now + ns_in_ticks(config.enable_setup_ns, self.tick_hz);
        }
        self.revision = revision;
        self.state = AxisState::Ready;
        self.rests_from = now;
        self.angle_lost = false;
    }

    /// Returns the position, signed steps since power-up.
    pub(crate) fn position(&mut self) -> i64 {
        self.actuator.as_mut().map_or(0, |actuator| actuator.stepper().position())
    }

    pub(crate) fn revision(&self) -> u32 {
        self.revision
    }

    pub(crate) fn is_energised(&mut self) -> bool {
        self.actuator.as_mut().is_some_and(|actuator| actuator.motor().is_energised())
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
        // The sensor is read when a step is taken, before its pulse: it tells where the step before has led.
        let way = i64::from(Direction::of(self.order.last.saturating_sub(self.order.from)).sign());
        let index_at = self.actuator.as_ref().and_then(Actuator::index_at).map(|at| at.saturating_sub(way));
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

    /// Returns the tick at which the timer must fire, or `None` if the motor stands.
    pub(crate) fn next_deadline(&mut self) -> Option<u64> {
        self.actuator.as_mut()?.stepper().next_deadline()
    }

    /// Takes the step that is due at `within` or before. [`Self::rises_at`] then says when its pulse begins. A step
    /// that is due before `now` is late.
    pub(crate) fn take_step(&mut self, now: u64, within: u64) {
        let Some(actuator) = &mut self.actuator else {
            return;
        };
        let Some(due) = actuator.stepper().next_deadline().filter(|due| *due <= within) else {
            return;
        };
        let (at, before) = (due.max(now), actuator.stepper().position());
        let mut said = actuator.on_timer(at);
        if actuator.stepper().position() != before {
            self.rises_at = Some(at.max(self.low_until));
        }
        if said.is_ok() && !actuator.stepper().is_moving() {
            // The step was the last. The next call says how the move ended.
            said = actuator.on_timer(at);
        }
        if !actuator.stepper().is_moving() {
            self.ended_by_timer(said, at);
        }
    }

    /// Returns the tick at which the pulse of the step that was taken begins, or `None` if none was taken.
    pub(crate) fn rises_at(&self) -> Option<u64> {
        self.rises_at
    }

    /// Begins the pulse of the step that was taken. Returns its length, ns.
    pub(crate) fn rise(&mut self) -> u32 {
        self.rises_at = None;
        self.actuator.as_mut().map_or(0, |actuator| {
            actuator.motor().rise();
            actuator.motor().config().step_high_ns
        })
    }

    /// Ends the pulse of a step, if there is one.
    pub(crate) fn lower(&mut self, now: u64) {
        if let Some(actuator) = &mut self.actuator
            && actuator.motor().lower()
        {
            let low = ns_in_ticks(actuator.motor().config().step_low_ns, self.tick_hz);
            self.low_until = now + low + 1;
        }
    }

    /// Stops dead and lets go of the motor. Returns true if it was configured.
    pub(crate) fn cut(&mut self, end: End, now: u64) -> bool {
        let Some(actuator) = &mut self.actuator else {
            return false;
        };
        if let Err(Fault::Motor { error, .. }) = actuator.disable() {
            match error {}
        }
        self.angle_lost = true;
        if self.is_moving() || self.state == AxisState::Prepared {
            self.state = AxisState::Ended(end);
        }
        self.rests_from = now;
        true
    }

    /// Lets go of a motor that has rested for as long as its configuration says.
    pub(crate) fn rest(&mut self, now: u64) {
        let Some(actuator) = &mut self.actuator else {
            return;
        };
        let release_ms = u64::from(actuator.motor().config().idle_release_ms);
        let rested = now.saturating_sub(self.rests_from) >= release_ms * u64::from(self.tick_hz) / 1000;
        let stands = matches!(self.state, AxisState::Ready | AxisState::Ended(_) | AxisState::Unconfigured);
        if release_ms > 0 && rested && stands && self.is_energised() {
            self.cut(End::Complete, now);
        }
    }
}

/// Energises a motor, whose pins cannot fail.
pub(super) fn enable<P: Pins, const Q: usize>(actuator: &mut Actuator<Driver<P>, Q>) {
    if let Err(Fault::Motor { error, .. }) = actuator.enable() {
        match error {}
    }
}
