//! The axes of a node on one timer.

use pump_link::message::{AXES, AxisStatus, End, FaultCounts, MoveChange, MoveOrder, Refusal, Stopping};
use pump_link::timing::{ns_in_ticks, rate_hz};

use crate::axis::{Axis, Checked, NEVER, Setup};
use crate::board::{Board, Edge, Pins};

/// Largest sum of the step rates of all axes, Hz (measured in an emulator of an RP2040 at 200 MHz, docs/node.md).
pub const MAX_STEP_HZ: u32 = 100_000;

/// Time before a step at which the interrupt begins, ns. It covers the way into the interrupt. A firmware keeps its
/// thread's critical sections clear of the alarm ([`crate::Shared`]).
pub const LEAD_NS: u32 = 3_000;

/// Time for which the interrupt counts a step at most, ns. Steps that come due within it are made before.
const COUNT_NS: u32 = 3_000;

/// Time from a request to begin to the earliest tick at which a move can begin, ns: 1 ms.
const BEGIN_LEAD_NS: u32 = 1_000_000;

/// The axes of a node, `A` of them, with queues of `Q` segments each. The timer's interrupt calls
/// [`Self::on_timer`], and everything else is the [`crate::Node`]'s.
#[derive(Debug)]
pub struct Axes<'a, P, B, const Q: usize, const A: usize> {
    board: B,
    tick_hz: u32,
    /// [`LEAD_NS`] in ticks.
    lead: u32,
    /// [`COUNT_NS`] in ticks.
    count: u32,
    /// [`BEGIN_LEAD_NS`] in ticks.
    begin_lead: u64,
    /// True while the emergency stop is pressed.
    estop: bool,
    axes: &'a mut [Axis<P, Q>; A],
}

impl<'a, P: Pins, B: Board, const Q: usize, const A: usize> Axes<'a, P, B, Q, A> {
    /// Joins the axes of a board whose timer has this rate, Hz. Pins stay inputs.
    pub fn new(axes: &'a mut [Axis<P, Q>; A], board: B, tick_hz: u32) -> Self {
        const { assert!(A >= 1 && A <= AXES, "a node has one to four axes") };
        Self {
            board,
            tick_hz,
            lead: ns_in_ticks(LEAD_NS, tick_hz) as u32,
            count: ns_in_ticks(COUNT_NS, tick_hz) as u32,
            begin_lead: ns_in_ticks(BEGIN_LEAD_NS, tick_hz),
            estop: false,
            axes,
        }
    }

    /// Makes the steps that are due within [`LEAD_NS`], each at its own tick. Returns the tick at which the timer must
    /// fire next, or `None` if all motors stand. If the tick has passed, call again at once.
    ///
    /// Pins rise first, and the steps are counted while they are high. The tick of each step is known since the step
    /// before, so the pins of several axes rise together, and no step waits for the arithmetic of another. Times are
    /// those since the call, in 32 bits: a small processor compares them in a third of the instructions.
    pub fn on_timer(&mut self) -> Option<u64> {
        self.look_at_estop();
        let called = self.board.now();
        let mut rises = self.axes.each_ref().map(|axis| axis.rises_after(called));
        let mut ahead = self.lead;
        loop {
            let latest = self.board.since(called).saturating_add(ahead);
            ahead = self.count;
            let soonest = rises.iter().fold(NEVER, |soonest, ticks| soonest.min(*ticks));
            if soonest <= latest {
                self.raise(called, soonest, &mut rises);
                continue;
            }
            let Some((axis, ticks)) = self.axes.iter_mut().zip(&mut rises).find(|(axis, _)| axis.is_high())
            else {
                return (soonest != NEVER).then(|| called + u64::from(soonest.saturating_sub(self.lead)));
            };
            axis.count_step();
            axis.lower(&mut self.board, called);
            *ticks = axis.rises_after(called);
        }
    }

    /// Begins the pulses that are due `soonest` ticks after the interrupt was `called`, all at once.
    #[inline]
    fn raise(&mut self, called: u64, soonest: u32, rises: &mut [u32; A]) {
        let mut edge = Edge::default();
        for (axis, ticks) in self.axes.iter().zip(rises.iter()) {
            if *ticks <= soonest {
                edge.join(axis.rise());
            }
        }
        self.board.wait_until(called + u64::from(soonest));
        self.board.set_steps(edge);
        let now = called + u64::from(self.board.since(called));
        for (axis, ticks) in self.axes.iter_mut().zip(rises) {
            if *ticks <= soonest {
                *ticks = NEVER;
                axis.rose(now);
            }
        }
    }

    /// Returns the tick at which the timer must fire next, or `None` if all motors stand. It is [`LEAD_NS`] before the
    /// next step.
    pub fn next_alarm(&self) -> Option<u64> {
        self.next_deadline().map(|tick| tick.saturating_sub(self.lead.into()))
    }

    /// Returns the tick of the next step, or `None` if all motors stand.
    pub fn next_deadline(&self) -> Option<u64> {
        // The thread asks within its critical sections, so the ticks are not gathered first.
        self.axes.iter().filter_map(Axis::next_rise).reduce(u64::min)
    }

    /// Returns the board.
    pub fn board(&mut self) -> &mut B {
        &mut self.board
    }

    /// Returns the state of an axis, or `None` if there is no such axis.
    pub fn status(&mut self, axis: u8) -> Option<AxisStatus> {
        self.axis(axis).ok().map(Axis::status)
    }

    /// Returns true if any axis moves, or has a tick at which it begins.
    pub fn is_moving(&self) -> bool {
        self.axes.iter().any(Axis::is_moving)
    }

    /// Looks at the emergency stop, at the drivers' faults and at motors that have rested long enough. Call it every
    /// ms.
    pub(crate) fn look(&mut self) {
        self.look_at_estop();
        let now = self.board.now();
        for axis in self.axes.iter_mut() {
            axis.look_at_driver(now);
            axis.rest(now);
        }
    }

    fn look_at_estop(&mut self) {
        let pressed = self.board.estop_is_pressed();
        if pressed && !self.estop {
            let now = self.board.now();
            self.axes.iter_mut().for_each(|axis| axis.estop(now));
        }
        self.estop = pressed;
    }

    /// Decelerates every axis, because the host was not heard for too long.
    pub(crate) fn dead_man(&mut self) {
        let now = self.board.now();
        self.axes.iter_mut().for_each(|axis| axis.dead_man(now));
    }

    pub(crate) fn forget_session(&mut self) {
        self.axes.iter_mut().for_each(Axis::forget_session);
    }

    /// Returns the revision of an axis's configuration, if its motor stands or `revision` is that one.
    pub(crate) fn may_configure(&mut self, axis: u8, revision: u32) -> Result<bool, Refusal> {
        let axis = self.axis(axis)?;
        let newest = axis.revision();
        match revision {
            _ if revision == newest && revision != 0 => Ok(true),
            _ if revision <= newest => Err(Refusal::Old { newest }),
            _ if axis.is_moving() => Err(Refusal::Moving),
            _ => Ok(false),
        }
    }

    pub(crate) fn configure(&mut self, axis: u8, revision: u32, setup: &Setup) -> Result<(), Refusal> {
        let there = self.may_configure(axis, revision)?;
        self.estop_is_released()?;
        let now = self.board.now();
        if !there {
            self.axis(axis)?.configure(revision, setup, now);
        }
        Ok(())
    }

    pub(crate) fn prepare(
        &mut self,
        axis: u8,
        move_number: u32,
        order: MoveOrder,
    ) -> Result<(u32, u16), Refusal> {
        if !self.axis(axis)?.may_prepare(move_number, &order)? {
            self.estop_is_released()?;
            self.has_rate(axis, order.shortest_interval)?;
            let now = self.board.now();
            self.axis(axis)?.prepare(move_number, order, now)?;
        }
        self.accepted(axis)
    }

    /// Changes a move under way. Returns the same as [`Self::accepted`].
    pub(crate) fn retarget(
        &mut self,
        axis: u8,
        move_number: u32,
        change: &MoveChange,
    ) -> Result<(u32, u16), Refusal> {
        if !self.axis(axis)?.may_change(move_number, change)? {
            self.has_rate(axis, change.shortest_interval)?;
            self.axis(axis)?.change(change)?;
        }
        self.accepted(axis)
    }

    /// Refuses steps of an axis that would be more than the axes can make together.
    fn has_rate(&self, number: u8, shortest_interval: u32) -> Result<(), Refusal> {
        let others = self.axes.iter().enumerate().filter(|(n, _)| *n != usize::from(number));
        let rates = others.filter_map(|(_, axis)| axis.reserved_interval());
        let rates = rates.map(|ticks| rate_hz(ticks, self.tick_hz));
        let sum_hz = rates.fold(rate_hz(shortest_interval, self.tick_hz), u32::saturating_add);
        if sum_hz > MAX_STEP_HZ {
            return Err(Refusal::StepRate { sum_hz, allowed_hz: MAX_STEP_HZ });
        }
        Ok(())
    }

    /// Returns the number of the segment that comes next, and the room for segments.
    pub(crate) fn accepted(&mut self, axis: u8) -> Result<(u32, u16), Refusal> {
        let axis = self.axis(axis)?;
        Ok((axis.next_segment(), axis.room()))
    }

    pub(crate) fn takes(&mut self, axis: u8, move_number: u32, first: u32) -> Result<(), Refusal> {
        self.axis(axis)?.takes(move_number, first)
    }

    pub(crate) fn take(
        &mut self,
        axis: u8,
        move_number: u32,
        number: u32,
        segment: &Checked,
    ) -> Result<bool, Refusal> {
        self.axis(axis)?.take(move_number, number, segment)
    }

    /// Begins the moves that are named, all or none of them.
    pub(crate) fn begin(&mut self, at: u64, moves: [u32; AXES]) -> Result<(), Refusal> {
        self.named(moves)?;
        self.estop_is_released()?;
        let soonest = self.board.now().saturating_add(self.begin_lead);
        let mut there = [true; AXES];
        for ((axis, number), there) in self.axes.iter_mut().zip(moves).zip(&mut there) {
            if number != 0 {
                *there = axis.may_begin(number, at, soonest)?;
            }
        }
        for ((axis, _), there) in self.axes.iter_mut().zip(moves).zip(there) {
            if !there {
                axis.begin(at)?;
            }
        }
        Ok(())
    }

    /// Stops a move of an axis, and every earlier one.
    pub(crate) fn stop(&mut self, axis: u8, move_number: u32) -> Result<Option<Stopping>, Refusal> {
        let now = self.board.now();
        Ok(self.axis(axis)?.stop(move_number, End::Stopped, now))
    }

    pub(crate) fn confirm(&mut self, axis: u8, read: FaultCounts) -> Result<FaultCounts, Refusal> {
        Ok(self.axis(axis)?.confirm(read))
    }

    /// Checks that moves are named for axes that are there, and for one at least.
    pub(crate) fn named(&self, moves: [u32; AXES]) -> Result<(), Refusal> {
        let missing = moves.iter().skip(A).any(|number| *number != 0);
        if missing || moves == [0; AXES] { Err(no_such_axis::<A>()) } else { Ok(()) }
    }

    fn estop_is_released(&mut self) -> Result<(), Refusal> {
        self.look_at_estop();
        if self.estop { Err(Refusal::Estop) } else { Ok(()) }
    }

    fn axis(&mut self, axis: u8) -> Result<&mut Axis<P, Q>, Refusal> {
        self.axes.get_mut(usize::from(axis)).ok_or(no_such_axis::<A>())
    }
}

fn no_such_axis<const A: usize>() -> Refusal {
    Refusal::Axis { axes: A as u8 }
}
