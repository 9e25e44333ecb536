//! An axis as the host knows it: its plan, the segments on their way, and what the node has told of it.

use pump_ctl::plan::Plan;
use pump_ctl::step::Segment;
use pump_link::message::{AxisState, AxisStatus, Stopping};
use pump_link::sender::{Bracket, Stream};

use crate::changes::Change;
use crate::plans::PlanData;

#[derive(Debug)]
pub(crate) struct HostAxis {
    pub(crate) plan: &'static PlanData,
    /// Segments of the move, those of a change included.
    pub(crate) segments: Vec<Segment>,
    /// Segments that were pushed.
    pub(crate) pushed: usize,
    /// Segments from which on the rounding began anew.
    pub(crate) rounded_anew: Vec<usize>,
    /// Plan of the move's rest, and the position from which it leads.
    pub(crate) whole: Plan,
    pub(crate) planned_from: i64,
    /// Position after the move, and the farthest one that was ever planned.
    pub(crate) last: i64,
    pub(crate) farthest: i64,
    /// Last change, and number of changes that were tried.
    pub(crate) change: Option<Change>,
    pub(crate) tried: u32,
    pub(crate) stream: Stream<64>,
    pub(crate) bracket: Bracket,
    pub(crate) from: i64,
    pub(crate) status: Option<AxisStatus>,
    pub(crate) stopping: Option<Stopping>,
    pub(crate) brake_sent: u8,
    pub(crate) config_sent: bool,
    pub(crate) configured: bool,
    /// True once the move's order is made.
    pub(crate) ordered: bool,
    /// True once the node has the move's order.
    pub(crate) prepared: bool,
}

impl HostAxis {
    pub(crate) fn new(plan: &'static PlanData) -> Self {
        Self {
            plan,
            segments: plan.segments.clone(),
            pushed: 0,
            rounded_anew: Vec::new(),
            whole: plan.plan.clone(),
            planned_from: 0,
            last: plan.steps,
            farthest: plan.steps,
            change: None,
            tried: 0,
            stream: Stream::new(0),
            bracket: Bracket::new(0, plan.steps, 0),
            from: 0,
            status: None,
            stopping: None,
            brake_sent: 0,
            config_sent: false,
            configured: false,
            ordered: false,
            prepared: false,
        }
    }

    /// Returns true if steps enough are made for the next change.
    pub(crate) fn changes_now(&self) -> bool {
        let way = self.status.filter(|status| status.state == AxisState::Moving);
        let way = way.map_or(0, |status| (status.position - self.from).abs());
        let is_over = self.change.is_none_or(|change| change.accepted);
        is_over && way > self.plan.steps.abs() * i64::from(1 + self.tried) / 4
    }

    pub(crate) fn has_ended(&self) -> bool {
        self.status.is_some_and(|status| matches!(status.state, AxisState::Ended(_)))
    }

    /// Pushes segments as far as there is room.
    pub(crate) fn push(&mut self) {
        while self.stream.room() > 0 && self.pushed < self.segments.len() {
            self.stream.push(self.segments[self.pushed]).unwrap();
            self.pushed += 1;
        }
    }
}
