//! The state of both lines when a plan begins.

use pump_model::{ExactRun, LineState, Port, Pump};

use super::profile::{Course, Profile};

/// The states of inlet and outlet line at the start of a plan.
///
/// The states that an earlier plan leaves are computed only on request. On a microcontroller that takes
/// longer than a motor may wait for its next step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) enum LineStates {
    /// The states are known.
    Known([LineState; 2]),
    /// The states follow from a motion over `course`, which starts with the states `were`, after `time_s`.
    After {
        /// States at the start of the motion.
        were: [LineState; 2],
        /// Course of the motion.
        course: Course,
        /// Time since the start of the motion, s.
        time_s: f64,
    },
}

impl LineStates {
    /// Lines at rest, without flow.
    pub(super) const AT_REST: Self = Self::Known([LineState::AT_REST; 2]);

    /// Returns the states where the rollers stand `off_rad` beside the angle that the motion assumes.
    pub(super) fn states(&self, pump: &Pump, off_rad: f64) -> [LineState; 2] {
        match *self {
            Self::Known(states) => states,
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
