//! The lines while cruising, from which every way down that is tried starts.

use libm::floor;
use pump_model::Pump;

use super::lines::{Lines, States, of_motion};
use crate::plan::profile::Profile;

/// Number of moments at which the lines are known.
const MOMENTS: usize = 49;

/// Power of 1/e to which the line's swing from the start falls before the start no longer counts. It leaves
/// 0.25 % of the swing.
const FORGOTTEN: f64 = 6.0;

/// The states of the lines at equally spaced moments of a cruise.
pub(super) struct Cruise {
    from_s: f64,
    each_s: f64,
    states: [States; MOMENTS],
}

/// Returns true if the line has forgotten how the motion started at `t_s`.
pub(super) fn has_forgotten(pump: &Pump, t_s: f64) -> bool {
    t_s * pump.outlet().slowest_decay_per_s() > FORGOTTEN
}

impl Cruise {
    /// Follows the lines from `start` through the cruise of `profile` from `from_s` to its end.
    pub(super) fn new(pump: &Pump, lines: &Lines, profile: &Profile, from_s: f64, start: &States) -> Self {
        let volume_ml = of_motion(pump.outlet_curve(), profile);
        let to_s = profile.left_s();
        let mut states = *start;
        let mut begin_s = 0.0;
        if has_forgotten(pump, from_s) {
            begin_s = from_s - FORGOTTEN / pump.outlet().slowest_decay_per_s();
            let direction = f64::from(profile.course.direction);
            states = lines.steady(direction * pump.average_flow_ml_s(profile.cruise_rad_s()));
        }
        lines.run(&volume_ml, (begin_s, from_s), &mut states, None);
        let each_s = (to_s - from_s).max(0.0) / (MOMENTS - 1) as f64;
        let mut cruise = Self { from_s, each_s, states: [states; MOMENTS] };
        let fine = lines.with_steps_of(each_s.max(f64::MIN_POSITIVE));
        let mut time_s = from_s;
        for moment in cruise.states.iter_mut().skip(1) {
            fine.run(&volume_ml, (time_s, time_s + each_s), &mut states, None);
            time_s += each_s;
            *moment = states;
        }
        cruise
    }

    /// Returns the states at `t_s`, on a straight line between two moments.
    pub(super) fn at(&self, t_s: f64) -> States {
        let place = if self.each_s > 0.0 { ((t_s - self.from_s) / self.each_s).max(0.0) } else { 0.0 };
        let number = (floor(place) as usize).min(MOMENTS - 2);
        let part = (place - number as f64).min(1.0);
        match self.states.get(number..) {
            Some([before, after, ..]) => {
                let mut states = *before;
                for (state, after) in states.iter_mut().zip(after) {
                    state.above_reservoir_kpa +=
                        part * (after.above_reservoir_kpa - state.above_reservoir_kpa);
                    state.flow_ml_s += part * (after.flow_ml_s - state.flow_ml_s);
                }
                states
            }
            // There are always two moments there.
            _ => [pump_model::LineState::AT_REST; 3],
        }
    }
}
