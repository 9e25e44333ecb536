//! Pressures at which a line turns, between two of its states.

use crate::motion::flow::Flow;

use super::oscillator::{Balanced, Oscillator};
use crate::work::{Work, count};

impl Oscillator {
    /// Reports the pressures at which the line turns within `length_s` after `before` to `found`, kPa.
    ///
    /// Over a step short beside the swing, the quintic polynomial through both ends shows the turns. Newton's
    /// method on dp/dt, whose derivative is known, then places them. Over a longer step only slow parts are
    /// left, and a change of sign of dp/dt is bisected. The remaining error of the place counts in second
    /// order only.
    pub(crate) fn turns(
        &self,
        length_s: f64,
        before: Balanced,
        after: Balanced,
        flow: &Flow,
        mut found: impl FnMut(f64),
    ) {
        let slope_at = |t| self.derivative(self.after(t, before, flow), flow.at(t))[0];
        if self.norm() * length_s <= 10.0 {
            let slope = self.pressure(length_s, before, after, flow).derivative();
            for turn in slope.roots_in(0.0, 1.0).as_slice() {
                found(self.turning_kpa(turn * length_s, length_s, before, flow));
            }
            return;
        }
        let (first, last) = (slope_at(0.0), self.derivative(after, flow.at(length_s))[0]);
        // Slopes below this are rounding of their two large parts.
        let noise =
            1e-14 * self.norm() * (before[0].abs() + before[1].abs() + after[0].abs() + after[1].abs());
        if first * last >= 0.0 || first.abs().min(last.abs()) < noise {
            return;
        }
        let (mut low, mut high) = (0.0, length_s);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if (slope_at(middle) > 0.0) == (first > 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        found(self.after(low, before, flow)[0]);
    }

    /// Returns the pressure at the turn near `near_s` after `state`, kPa.
    ///
    /// Beyond `length_s` the flow is another one, so a turn that would lie there is taken at the end. (In a
    /// sliver of a stretch rounding makes such turns.)
    pub(crate) fn turning_kpa(&self, near_s: f64, length_s: f64, state: Balanced, flow: &Flow) -> f64 {
        count(Work::Turn);
        let mut t = near_s;
        let mut there = self.after(t, state, flow);
        for _ in 0..2 {
            let slope = self.derivative(there, flow.at(t));
            let curvature = self.derivative(slope, flow.rate_at(t));
            let shift = slope[0] / curvature[0];
            // A flat curve leaves nothing to gain.
            if shift.is_nan() || shift.abs() >= 0.1 / self.norm() {
                break;
            }
            let turn = t - shift;
            if shift.abs() <= 1e-5 / self.norm() && turn >= 0.0 && turn <= length_s {
                // The parabola through the point is a millionth of a millionth of the swing beside the curve.
                return there[0] - 0.5 * slope[0] * shift;
            }
            t = turn.max(0.0).min(length_s);
            there = self.after(t, state, flow);
        }
        there[0]
    }
}
