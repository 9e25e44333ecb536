//! The topics of the questions that a person has answered: each can be asked anew.

use serde::{Deserialize, Serialize};

use super::answers::Answers;

/// Topic of a question of a first run, in the order in which the questions come.
///
/// ```
/// use pump_bench::setup::{Answers, Topic};
///
/// let mut answers = Answers::of("acid");
/// answers.rollers = Some(3);
/// Topic::Rollers.forget(&mut answers);
/// assert_eq!(answers.rollers, None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Topic {
    /// Head of the pump.
    Head,
    /// Bore of the tube.
    Bore,
    /// Rollers, and the dimensions of a drawing.
    Rollers,
    /// Full steps of the motor.
    FullSteps,
    /// Microsteps of the motor.
    Microsteps,
    /// Gear of the motor.
    Gear,
    /// Driver of the motor.
    Driver,
    /// Port of the board.
    Port,
    /// Axis of the board.
    Axis,
    /// Socket of the board.
    Socket,
    /// Current of the motor.
    Current,
    /// Current of the motor at rest.
    HoldCurrent,
    /// Pressure of the air.
    Ambient,
    /// Height of the pump above the supply.
    SuctionLift,
    /// Height of the vessel above the pump.
    DischargeLift,
    /// Place of the outlet's end.
    OutletEnd,
    /// Diameter of the outlet's end.
    Nozzle,
    /// Rate of a dose that names none.
    Rate,
    /// Volume that fills the line.
    Prime,
    /// Volume of the dose that is weighed.
    Volume,
}

impl Topic {
    /// Forgets the answer to the question, so that it is asked anew.
    pub fn forget(self, answers: &mut Answers) {
        answers.asked.remove(&self);
        match self {
            Self::Head => answers.head = None,
            Self::Bore => answers.tube_bore_mm = None,
            Self::Rollers => answers.rollers = None,
            Self::FullSteps => answers.full_steps = None,
            Self::Microsteps => (answers.microsteps, answers.steps_per_rev) = (None, None),
            Self::Gear => answers.gear = None,
            // The settings that may be written are those of the driver's board.
            Self::Driver => (answers.driver, answers.configure) = (None, None),
            Self::Port => answers.port = None,
            Self::Axis => answers.axis = None,
            Self::Socket => answers.socket = None,
            Self::Current => answers.current_a = None,
            Self::HoldCurrent => answers.hold_a = None,
            Self::Ambient => (answers.altitude_m, answers.ambient_kpa) = (None, None),
            Self::SuctionLift => answers.suction_lift_mm = None,
            Self::DischargeLift => answers.discharge_lift_mm = None,
            Self::OutletEnd => answers.outlet_end = None,
            Self::Nozzle => answers.nozzle_bore_mm = None,
            Self::Rate => answers.rate_ml_s = None,
            Self::Prime => answers.prime_ml = None,
            Self::Volume => answers.volume_ml = None,
        }
    }
}
