//! The moves of an axis: prepared, fed, begun, stopped, ended.

use core::convert::Infallible;

use pump_ctl::drive::{Actuator, Fault, Timer};
use pump_ctl::step::{Direction, PushError, Segment, ValidSegment};
use pump_link::message::{AxisState, End, MoveChange, MoveOrder, Refusal, Stopping};
use pump_link::receiver::{Arrival, Expected};

use super::axis::Axis;
use crate::board::Pins;
use crate::driver::Driver;

/// A segment whose intervals the thread has checked, so that the interrupt is kept off for a short time when an axis
/// takes it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Checked {
    segment: ValidSegment,
    /// Shortest interval, whole ticks.
    shortest: u32,
}

impl Checked {
    /// Checks a segment. The result is `None` if it is not valid.
    pub(crate) fn new(segment: Segment) -> Option<Self> {
        let valid = segment.validated()?;
        let [first, last] = [1, segment.steps()].map(|k| segment.interval_before(k).whole);
        let shortest = u32::try_from(first.min(last)).unwrap_or(u32::MAX);
        Some(Self { segment: valid, shortest })
    }
}

impl<P: Pins, const Q: usize> Axis<P, Q> {
    /// Returns the number of segments that fit now. It is 0 if the last move takes none.
    pub(crate) fn room(&mut self) -> u16 {
        let takes = matches!(self.state, AxisState::Prepared | AxisState::Moving);
        let room = if takes { self.actuator.stepper().room() } else { 0 };
        u16::try_from(room).unwrap_or(u16::MAX)
    }

    /// Returns the number of the segment that comes next.
    pub(crate) fn next_segment(&self) -> u32 {
        self.expected.next()
    }

    /// Checks that a move can be prepared. Returns true if it is there already.
    pub(crate) fn may_prepare(&mut self, move_number: u32, order: &MoveOrder) -> Result<bool, Refusal> {
        self.is_configured()?;
        let newest = self.move_number;
        if move_number == newest && self.order == *order && self.reserved_interval().is_some() {
            return Ok(true);
        }
        if move_number <= newest {
            return Err(Refusal::Old { newest });
        }
        if self.is_moving() {
            return Err(Refusal::Moving);
        }
        if self.angle_lost {
            return Err(Refusal::AngleLost);
        }
        let position = self.position();
        if order.from != position {
            return Err(Refusal::Position { position });
        }
        if order.last == position {
            return Err(Refusal::Empty);
        }
        if self.configured()?.motor().has_fault() {
            return Err(Refusal::Driver);
        }
        if u64::from(order.shortest_interval) < self.times.pulse.max(1) {
            return Err(Refusal::Pulse);
        }
        Ok(false)
    }

    /// Prepares a move that [`Self::may_prepare`], and energises the motor.
    pub(crate) fn prepare(&mut self, move_number: u32, order: MoveOrder, now: u64) -> Result<(), Refusal> {
        let actuator = self.configured()?;
        // From here on the executor knows where the move ends, and never goes beyond.
        if !actuator.stepper().clear() || actuator.stepper().set_end(order.last).is_err() {
            return Err(Refusal::Moving);
        }
        if let Err(Fault::Motor { error, .. }) = actuator.watch_index() {
            match error {}
        }
        if !actuator.motor().is_energised() {
            self.enable();
            self.ready_at = now + self.times.enable;
        }
        self.move_number = move_number;
        self.order = order;
        self.expected = Expected::default();
        self.changes = 0;
        self.taken_end = order.from;
        self.begun = false;
        self.state = AxisState::Prepared;
        Ok(())
    }

    /// Checks that the move takes segments from number `first` on.
    pub(crate) fn takes(&mut self, move_number: u32, first: u32) -> Result<(), Refusal> {
        self.is_configured()?;
        let newest = self.move_number;
        if move_number < newest {
            return Err(Refusal::Old { newest });
        }
        if move_number != newest || !matches!(self.state, AxisState::Prepared | AxisState::Moving) {
            return Err(Refusal::NoSuchMove { newest });
        }
        if self.expected.arrival(first) == Arrival::Gap {
            return Err(Refusal::Gap { next: self.expected.next() });
        }
        Ok(())
    }

    /// Takes the segment of this number. A segment that came before is ignored. The result is false if the queue has
    /// no room.
    pub(crate) fn take(&mut self, move_number: u32, number: u32, checked: &Checked) -> Result<bool, Refusal> {
        self.takes(move_number, number)?;
        if self.expected.arrival(number) == Arrival::Repeated {
            return Ok(true);
        }
        let Checked { segment, shortest } = *checked;
        let count = segment.segment().count;
        let end = self.taken_end.checked_add(count.into());
        let within = |end: &i64| {
            if self.order.last >= self.order.from {
                count > 0 && *end <= self.order.last
            } else {
                count < 0 && *end >= self.order.last
            }
        };
        let refused = Refusal::Segment { number };
        let end = end.filter(within).filter(|_| shortest >= self.order.shortest_interval).ok_or(refused)?;
        let actuator = self.configured()?;
        let tick_rate = actuator.stepper().tick_rate();
        match actuator.stepper().push_valid(segment, tick_rate) {
            Ok(()) => {}
            Err(PushError::Full) => return Ok(false),
            // The queue has run dry, and the motor decelerates.
            Err(PushError::Stopped) => return Err(Refusal::NoSuchMove { newest: move_number }),
            Err(_) => return Err(refused),
        }
        self.taken_end = end;
        self.expected.taken();
        Ok(true)
    }

    /// Checks that a move can be changed. Returns true if it has the change already.
    pub(crate) fn may_change(&mut self, move_number: u32, change: &MoveChange) -> Result<bool, Refusal> {
        self.is_configured()?;
        let newest = self.move_number;
        let lives = matches!(self.state, AxisState::Prepared | AxisState::Moving);
        match move_number {
            _ if move_number < newest => return Err(Refusal::Old { newest }),
            _ if move_number != newest || !lives => return Err(Refusal::NoSuchMove { newest }),
            _ if change.number == self.changes && self.changes != 0 => return Ok(true),
            _ if change.number <= self.changes => return Err(Refusal::Old { newest: self.changes }),
            _ => {}
        }
        let (next, position) = (self.expected.next(), self.taken_end);
        let goes_on =
            if self.order.last >= self.order.from { change.last > position } else { change.last < position };
        // The motor comes to rest where the plan ends on its queue.
        if change.first < next || !goes_on || position == self.order.last {
            return Err(Refusal::Change { next, position });
        }
        if u64::from(change.shortest_interval) < self.times.pulse.max(1) {
            return Err(Refusal::Pulse);
        }
        Ok(false)
    }

    /// Changes a move that [`Self::may_change`]. The segments that were taken stay.
    pub(crate) fn change(&mut self, change: &MoveChange) -> Result<(), Refusal> {
        let newest = self.move_number;
        let ended = self.configured()?.stepper().set_end(change.last);
        ended.map_err(|_| Refusal::NoSuchMove { newest })?;
        self.order.last = change.last;
        self.order.shortest_interval = self.order.shortest_interval.min(change.shortest_interval);
        self.changes = change.number;
        Ok(())
    }

    /// Checks that a move can begin at tick `at`. Returns true if it has begun already.
    pub(crate) fn may_begin(&mut self, move_number: u32, at: u64, soonest: u64) -> Result<bool, Refusal> {
        self.is_configured()?;
        let newest = self.move_number;
        if move_number == newest && self.begun {
            return Ok(true);
        }
        if move_number != newest || self.state != AxisState::Prepared {
            return Err(Refusal::NoSuchMove { newest });
        }
        if self.expected.next() == 0 {
            return Err(Refusal::Empty);
        }
        let earliest = soonest.max(self.ready_at);
        let tick_hz = self.actuator.stepper().tick_rate().hz();
        let latest = earliest.saturating_add(u64::from(tick_hz) * LATEST_BEGIN_S);
        if (earliest..=latest).contains(&at) { Ok(false) } else { Err(Refusal::Begin { earliest }) }
    }

    /// Begins a move that [`Self::may_begin`].
    pub(crate) fn begin(&mut self, at: u64) -> Result<(), Refusal> {
        let direction = Direction::of(self.order.last.saturating_sub(self.order.from));
        let newest = self.move_number;
        let actuator = self.configured()?;
        // The last step was made ms ago, and the first comes a ms from now: both times of the direction pin are kept.
        actuator.motor().face(direction);
        actuator.start(at).map_err(|_| Refusal::NoSuchMove { newest })?;
        self.begun = true;
        self.state = AxisState::Moving;
        Ok(())
    }

    /// Decelerates a move, and every earlier one. A move of this number or a smaller one that has not begun never
    /// begins. The result is `None` if a newer move is there.
    pub(crate) fn stop(&mut self, move_number: u32, end: End, now: u64) -> Option<Stopping> {
        if move_number < self.move_number {
            return None;
        }
        let known = move_number == self.move_number;
        match self.state {
            AxisState::Moving => {
                let plan = self.actuator.stop(now);
                let moves = self.actuator.is_moving();
                self.stopping = Stopping { last_step_at: plan.last_step_at, final_count: plan.final_count };
                self.state = if moves { AxisState::Ending(end) } else { AxisState::Ended(end) };
                self.rests_from = now;
            }
            AxisState::Prepared => {
                self.stand_still(now);
                self.state = AxisState::Ended(end);
            }
            AxisState::Ending(_) => {}
            AxisState::Ended(_) if known => {}
            AxisState::Unconfigured => self.stand_still(now),
            _ => {
                self.stand_still(now);
                self.state = AxisState::Ended(end);
            }
        }
        self.move_number = move_number;
        Some(self.stopping)
    }

    /// Returns the number of the last move.
    pub(crate) fn move_number(&self) -> u32 {
        self.move_number
    }

    /// Notes how a move ended whose motor stands now.
    pub(super) fn ended_by_timer(&mut self, said: Result<Timer, Fault<Infallible>>, now: u64) {
        let end = match said {
            Err(Fault::Starved { .. }) => End::Starved,
            Err(Fault::Late { .. }) => End::Late,
            _ => match self.state {
                AxisState::Ending(end) => end,
                _ => End::Complete,
            },
        };
        match end {
            End::Starved => self.faults.counted.starved = self.faults.counted.starved.saturating_add(1),
            End::Late => self.faults.counted.late = self.faults.counted.late.saturating_add(1),
            _ => {}
        }
        self.state = AxisState::Ended(end);
        self.rests_from = now;
    }

    /// Drops a move whose motor stands.
    fn stand_still(&mut self, now: u64) {
        let final_count = self.position();
        let _ = self.actuator.stop(now);
        self.stopping = Stopping { last_step_at: now, final_count };
    }

    fn is_configured(&self) -> Result<(), Refusal> {
        if self.state == AxisState::Unconfigured { Err(Refusal::NotConfigured) } else { Ok(()) }
    }

    fn configured(&mut self) -> Result<&mut Actuator<Driver<P>, Q>, Refusal> {
        if self.is_set_up() { Ok(&mut self.actuator) } else { Err(Refusal::NotConfigured) }
    }
}

/// Longest time from the earliest tick at which a move can begin to the tick at which it does, s.
const LATEST_BEGIN_S: u64 = 10;
