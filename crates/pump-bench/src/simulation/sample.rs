//! The state of the pump at one instant, and columns of such states.

use std::slice::from_mut;

/// The state of the pump at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Sample {
    /// Time, in s.
    pub time_s: f64,
    /// Angle of the rotor, in rad, unwrapped.
    pub angle_rad: f64,
    /// Speed of the rotor, in rad/s.
    pub speed_rad_s: f64,
    /// Flow at the inlet rollers, in mL/s.
    pub q_in_ml_s: f64,
    /// Flow at the outlet rollers, in mL/s.
    pub q_out_ml_s: f64,
    /// Pressure at the inlet, in kPa absolute.
    pub p_in_kpa: f64,
    /// Pressure at the outlet, in kPa absolute.
    pub p_out_kpa: f64,
    /// Volume that has passed the outlet line, in mL.
    pub delivered_ml: f64,
}

/// Number of quantities in a [`Sample`].
pub const COLUMNS: usize = 8;

/// Columns for samples in order of time. Each field of [`Sample`] has its column, in order, and all have one
/// length.
pub(crate) type Columns<'c> = [&'c mut [f64]; COLUMNS];

impl Sample {
    /// Returns the sample as columns of length 1.
    pub(crate) fn as_columns(&mut self) -> Columns<'_> {
        [
            from_mut(&mut self.time_s),
            from_mut(&mut self.angle_rad),
            from_mut(&mut self.speed_rad_s),
            from_mut(&mut self.q_in_ml_s),
            from_mut(&mut self.q_out_ml_s),
            from_mut(&mut self.p_in_kpa),
            from_mut(&mut self.p_out_kpa),
            from_mut(&mut self.delivered_ml),
        ]
    }
}
