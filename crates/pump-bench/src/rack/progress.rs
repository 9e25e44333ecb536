//! The progress of a rack, as its threads tell it.

use crate::notice::Notice;

/// Progress of one pump of a rack.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RackProgress<'a> {
    /// Name of the pump in the rack.
    pub pump: &'a str,
    /// Number of the step in the rack, from 1.
    pub step: usize,
    /// Motor steps made of this step, without their sign.
    pub made: u64,
    /// Motor steps of this step, without their sign.
    pub steps: u64,
    /// Volume of the motor steps made, in mL, by the model.
    pub volume_ml: f64,
    /// Volume of all motor steps of this step of the rack, in mL, by the model.
    pub whole_ml: f64,
    /// Angle of the rollers after the motor steps made, in rad.
    pub angle_rad: f64,
    /// Warnings of the motion, before its first step. Empty from then on.
    pub warnings: &'a [Notice],
}
