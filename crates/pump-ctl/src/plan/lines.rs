//! How the lines are when a plan begins.

use pump_model::{ExactRun, Port, Pump};

use super::profile::{Course, Profile};
use super::{Legs, Plan};

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

    /// The lines themselves.
    pub(super) fn states(&self, pump: &Pump) -> LineStates {
        match *self {
            Self::Are(states) => states,
            Self::After { were: [inlet, outlet], course, time_s } => {
                let profile = Profile::new(course, pump.outlet_curve());
                let after = |port, state| ExactRun::new(pump, port, profile.legs(), state).at(time_s);
                [after(Port::Inlet, inlet), after(Port::Outlet, outlet)]
            }
        }
    }
}

impl Plan {
    /// The line of a port during this dose.
    pub(super) fn run<'a>(&'a self, pump: &'a Pump, port: Port) -> ExactRun<'a, Legs<'a>> {
        let [inlet, outlet] = self.lines.states(pump);
        let state = if port == Port::Inlet { inlet } else { outlet };
        ExactRun::new(pump, port, self.legs(), state)
    }

    /// The lines as this plan leaves them when `made` steps are made.
    pub(super) fn lines_at(&self, pump: &Pump, made: u64) -> Lines {
        let time_s = self.profile.time_of(made as f64 * self.step_rad);
        Lines::After { were: self.lines.states(pump), course: self.profile.course, time_s }
    }
}
