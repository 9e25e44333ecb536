//! Many fine steps of a run at once, in search of the pressures at which the line turns.

use crate::motion::flow::Flow;
use crate::motion::leg::Leg;

use super::exact_run::ExactRun;
use super::extremes::Extremes;
use super::oscillator::{Oscillator, SHORT};
use super::reach::{ALL_CAUSES, Causes, LANES, Reach};
use crate::work::{Work, count as count_work};

/// Number of fine steps that cost less than one long one.
const FEW: usize = 100;

/// Fewest fine steps that are worth their lanes.
const FEWEST: usize = 2;

/// Fine steps of a line that swings: what they do does not depend on the motion.
#[derive(Debug, Clone)]
pub(crate) struct FineSteps {
    step_s: f64,
    /// Effects of a state and a flow over 0, 1, 2 ... steps; none for a line that does not swing.
    reach: Option<Reach<1>>,
    /// Effects for flows at changing speeds, as soon as there is one.
    ramp: Option<Reach<1, ALL_CAUSES>>,
}

impl FineSteps {
    pub(crate) fn new(oscillator: &Oscillator) -> Self {
        let step_s = SHORT / oscillator.norm();
        let reach = oscillator.swings().then(|| Reach::new(oscillator, step_s));
        Self { step_s, reach, ramp: None }
    }
}

/// Something that follows a line over fine steps.
pub(super) trait Follower {
    /// Follows the line from the first lane to lane `count`, which stand `step_s` apart. `flow` counts time from the
    /// first.
    fn follow(
        &mut self,
        oscillator: &Oscillator,
        step_s: f64,
        count: usize,
        states: &[[f64; LANES]; 2],
        flow: &Flow,
    );
}

impl Extremes {
    /// Returns true if the pressure cannot leave this range over a step. `ends` are its values at both ends, with the
    /// change over a step that leads inwards to first and second order.
    ///
    /// The quintic through both ends stays among its control points (Farouki as in `cover`), and the pressure stays
    /// near the quintic: over a step of |A| h = 1/2 within 0.5^6/(64 6!) = 4e-7 of the swing.
    fn hold(&self, ends: [(f64, f64, f64); 2]) -> bool {
        /// Part of the control points' distance from an end that is left for the quintic's error.
        const NEAR: f64 = 1e-4;
        ends.into_iter().all(|(end, slope, bend)| {
            let (one, two) = (0.2 * slope, 0.4 * slope + 0.05 * bend);
            let near = NEAR * (one.abs() + two.abs());
            end + one.max(two).max(0.0) + near <= self.max_kpa
                && end + one.min(two).min(0.0) - near >= self.min_kpa
        })
    }
}

impl Follower for Extremes {
    fn follow(
        &mut self,
        oscillator: &Oscillator,
        step_s: f64,
        count: usize,
        states: &[[f64; LANES]; 2],
        flow: &Flow,
    ) {
        oscillator.cover(step_s, count, states, flow, self);
    }
}

impl<M: Iterator<Item = Leg>> ExactRun<'_, M> {
    /// Goes on to `end_s`, by fine steps where they are few.
    pub(crate) fn go_by(&mut self, steps: &FineSteps, end_s: f64) {
        while self.time_s() < end_s {
            let stretch_s = self.stretch.end_s - self.stretch.start_s;
            let to_s = (end_s - self.stretch.start_s).min(stretch_s);
            if let Some(reach) = steps.reach.as_ref().filter(|_| self.flow.degree <= 4) {
                let whole = ((to_s - self.reached_s) / steps.step_s) as usize;
                // A long step is made by squaring.
                let mut left = if whole <= FEW { whole } else { 0 };
                while left > 0 {
                    let count = left.min(LANES - 1);
                    self.state = reach.state(count, &reach.causes(self.state, &self.flow, self.reached_s));
                    self.reached_s += count as f64 * steps.step_s;
                    left -= count;
                }
            }
            if self.stretch.end_s <= end_s {
                self.finish_stretch();
            } else {
                self.at(end_s);
                return;
            }
        }
    }

    /// Goes on inside the stretch by as many fine steps as fit before `end_s`, and follows the line on the way. Goes on
    /// by none where a step need not be fine.
    pub(super) fn follow_fine_steps(
        &mut self,
        steps: &mut FineSteps,
        end_s: f64,
        follower: &mut impl Follower,
    ) {
        let Some(reach) = &steps.reach else {
            return;
        };
        let stretch_s = self.stretch.end_s - self.stretch.start_s;
        let room_s = (end_s - self.stretch.start_s).min(stretch_s);
        while self.oscillator.fine_step_s(self.reached_s, stretch_s) <= steps.step_s {
            let count = ((room_s - self.reached_s) / steps.step_s).min((LANES - 1) as f64) as usize;
            if count < FEWEST {
                return;
            }
            let flow = self.flow.shifted(self.reached_s);
            if flow.degree <= 4 {
                self.follow_lanes(reach, &reach.causes(self.state, &flow, 0.0), &flow, count, follower);
            } else {
                let ramp = steps.ramp.get_or_insert_with(|| Reach::new(&self.oscillator, steps.step_s));
                self.follow_lanes(ramp, &ramp.all_causes(self.state, &flow), &flow, count, follower);
            }
        }
    }

    /// Follows the line over `count` steps, and goes on over them.
    fn follow_lanes<const C: usize>(
        &mut self,
        reach: &Reach<1, C>,
        causes: &Causes<C>,
        flow: &Flow,
        count: usize,
        follower: &mut impl Follower,
    ) {
        for states in reach.states(*causes) {
            count_work(Work::Lanes);
            follower.follow(&self.oscillator, reach.interval_s(), count, &states, flow);
        }
        self.state = reach.state(count, causes);
        self.reached_s += count as f64 * reach.interval_s();
    }
}

impl Oscillator {
    /// Covers the pressures from the first lane to lane `count`, which stand `step_s` apart. `flow` counts time from
    /// the first.
    fn cover(
        &self,
        step_s: f64,
        count: usize,
        [x, y]: &[[f64; LANES]; 2],
        flow: &Flow,
        extremes: &mut Extremes,
    ) {
        // Change of the pressure over a step, to first and second order.
        let (mut slope, mut bend) = ([0.0; LANES], [0.0; LANES]);
        let (mut q, mut q_rate) = ([0.0; LANES], [0.0; LANES]);
        for c in flow.terms().rev() {
            for lane in 0..LANES {
                let t = lane as f64 * step_s;
                q_rate[lane] = q_rate[lane] * t + q[lane];
                q[lane] = q[lane] * t + c;
            }
        }
        for lane in 0..LANES {
            let y_rate = self.rate * x[lane] - self.decay * y[lane];
            slope[lane] = step_s * self.rate * (self.impedance * q[lane] - y[lane]);
            bend[lane] = step_s * step_s * self.rate * (self.impedance * q_rate[lane] - y_rate);
        }
        for x in x.iter().take(count + 1).skip(1) {
            extremes.cover(*x);
        }
        for lane in 1..LANES {
            if lane > count {
                break;
            }
            let [from, to] = [lane - 1, lane];
            // Control points of the derivative of the quintic through both ends (Farouki, "The Bernstein polynomial
            // basis: a centennial retrospective", Computer Aided Geometric Design 29, 2012).
            let middle =
                5.0 * (x[to] - x[from]) - 2.0 * (slope[from] + slope[to]) + 0.25 * (bend[to] - bend[from]);
            let points = [
                slope[from],
                slope[from] + 0.25 * bend[from],
                middle,
                slope[to] - 0.25 * bend[to],
                slope[to],
            ];
            let noise = 1e-14 * (x[from].abs() + x[to].abs());
            let is_sure = points.iter().all(|point| point.abs() > noise);
            let changes =
                points.iter().zip(points.iter().skip(1)).filter(|(a, b)| (**a > 0.0) != (**b > 0.0)).count();
            let ends = [(x[from], slope[from], bend[from]), (x[to], -slope[to], bend[to])];
            if is_sure && changes == 0 || extremes.hold(ends) {
                continue;
            }
            let (before, after) = ([x[from], y[from]], [x[to], y[to]]);
            let flow = flow.shifted(from as f64 * step_s);
            if is_sure && changes == 1 {
                // There are as many roots as changes of sign, or fewer by an even number.
                let slope = self.pressure(step_s, before, after, &flow).derivative();
                let turn_s = step_s * slope.solve_monotone(0.0, 0.0, 1.0);
                extremes.cover(self.turning_kpa(turn_s, step_s, before, &flow));
            } else {
                self.turns(step_s, before, after, &flow, |kpa| extremes.cover(kpa));
            }
        }
    }
}
