//! Changes of a move under way: another volume, planned from the last segment that was sent.

use pump_ctl::plan::{Cruise, Doser, Limits, Plan, Retarget};
use pump_ctl::step::Segment;
use pump_link::message::MoveChange;

use crate::host_axis::HostAxis;
use crate::plans::{PUMP, TICK_RATE, lasts_long_enough, shortest_interval};

/// Volume after each change, as a part of the plan's volume.
const PARTS: [f64; 2] = [1.5, 1.2];

/// Change of a move, which the node may not have yet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Change {
    pub(crate) order: MoveChange,
    pub(crate) accepted: bool,
}

impl HostAxis {
    /// Plans another volume for the rest of the move. Nothing changes if the motor cannot stop there.
    pub(crate) fn change(&mut self) {
        let number = self.tried;
        let Some(part) = PARTS.get(number as usize) else { return };
        self.tried += 1;
        let takeover = self.stream.retarget();
        let first = takeover.first as usize;
        self.pushed = first;
        self.rounded_anew.push(first);
        let Some((plan, rest)) = self.planned(takeover.position, part * self.plan.volume_ml) else {
            self.stream.go_on();
            return;
        };
        let mut segments = self.segments[..first].to_vec();
        segments.extend(&rest);
        if !lasts_long_enough(&segments) {
            self.stream.go_on();
            return;
        }
        self.segments = segments;
        self.whole = plan;
        self.planned_from = takeover.position;
        self.last = takeover.position + self.whole.steps();
        self.farthest =
            if self.plan.steps > 0 { self.farthest.max(self.last) } else { self.farthest.min(self.last) };
        self.bracket.retargeted(self.last);
        let order = MoveChange {
            number: number + 1,
            first: takeover.first,
            last: self.last,
            shortest_interval: shortest_interval(&rest),
        };
        self.change = Some(Change { order, accepted: false });
    }

    /// Returns the plan of the rest from a position on, and its segments.
    fn planned(&self, position: i64, volume_ml: f64) -> Option<(Plan, Vec<Segment>)> {
        let made = (position - self.planned_from).unsigned_abs();
        let doser = Doser::new(&PUMP, Limits::new(self.plan.motor)).unwrap();
        let cruise = Cruise::Flow { ml_s: self.plan.ml_s };
        let plan = doser.retarget(&self.whole, &Retarget::new(made, volume_ml, cruise)).ok()?;
        let forward = plan.steps().signum() == self.plan.steps.signum();
        let segments: Vec<Segment> = plan.segments(TICK_RATE).collect();
        forward.then_some((plan, segments))
    }
}
