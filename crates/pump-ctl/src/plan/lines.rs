//! How the lines are when a plan begins.

use pump_model::{ExactRun, Port, Pump};

use super::Plan;
use super::profile::{Course, Profile};

/// Pressure above the reservoir, kPa, and flow, mL/s, of the inlet and of the outlet line.
pub(super) type LineStates = [[f64; 2]; 2];

/// Inlet and outlet line at the start of a plan. What an earlier plan leaves is computed when it is asked for: on a
/// microcontroller that takes longer than a motor may wait for its next step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) enum Lines {
    /// Known.
    Are(LineStates),
    /// As the motion over `course` leaves them at `time_s`, having found them as `were`.
    After {
        /// At the start of the motion.
        were: LineStates,
        /// The motion.
        course: Course,
        /// s since its start.
        time_s: f64,
    },
}

impl Lines {
    pub(super) const AT_REST: Self = Self::Are([[0.0; 2]; 2]);

    /// The lines themselves, where the rollers stand `off_rad` beside what the motion takes for their angle.
    pub(super) fn states(&self, pump: &Pump, off_rad: f64) -> LineStates {
        match *self {
            Self::Are(states) => states,
            Self::After { were: [inlet, outlet], course, time_s } => {
                let profile = Profile::new(course, pump.outlet_curve());
                let after = |port, state| {
                    let legs = profile.legs().map(|leg| leg.beside(off_rad));
                    ExactRun::new(pump, port, legs, state).at(time_s)
                };
                [after(Port::Inlet, inlet), after(Port::Outlet, outlet)]
            }
        }
    }
}

impl Plan {
    /// The lines as this plan leaves them when `made` steps are made. What was before this plan is that of the middle angle.
    pub(super) fn lines_at(&self, pump: &Pump, made: u64) -> Lines {
        let time_s = self.profile.time_of(made as f64 * self.step_rad);
        Lines::After { were: self.lines.states(pump, 0.0), course: self.profile.course, time_s }
    }
}
