//! How the lines are when a plan begins.

use pump_model::{ExactRun, Leg, Port, Pump};

use super::Plan;

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
    /// As `legs` leave them at `time_s`, having found them as `were`.
    After {
        /// At the start of the legs.
        were: LineStates,
        /// The motion.
        legs: [Leg; 3],
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
            Self::After { were: [inlet, outlet], legs, time_s } => {
                let after = |port, state| ExactRun::new(pump, port, legs, state).at(time_s);
                [after(Port::Inlet, inlet), after(Port::Outlet, outlet)]
            }
        }
    }
}

impl Plan {
    /// The line of a port during this dose.
    pub(super) fn run<'a>(&self, pump: &'a Pump, port: Port) -> ExactRun<'a, core::array::IntoIter<Leg, 3>> {
        let [inlet, outlet] = self.lines.states(pump);
        let state = if port == Port::Inlet { inlet } else { outlet };
        ExactRun::new(pump, port, self.legs(), state)
    }

    /// The lines as this plan leaves them when `made` steps are made.
    pub(super) fn lines_at(&self, pump: &Pump, made: u64) -> Lines {
        let time_s = self.profile.time_of(made as f64 * self.step_rad);
        Lines::After { were: self.lines.states(pump), legs: self.legs(), time_s }
    }
}
