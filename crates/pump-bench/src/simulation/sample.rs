//! What is known of the pump at one instant, and at many.

use std::slice::from_mut;

/// The state of the pump at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// s.
    pub time_s: f64,
    /// Angle of the rotor, rad, unwrapped.
    pub angle_rad: f64,
    /// Speed of the rotor, rad/s.
    pub speed_rad_s: f64,
    /// Flow at the inlet rollers, mL/s.
    pub q_in_ml_s: f64,
    /// Flow at the outlet rollers, mL/s.
    pub q_out_ml_s: f64,
    /// Pressure at the inlet, kPa absolute.
    pub p_in_kpa: f64,
    /// Pressure at the outlet, kPa absolute.
    pub p_out_kpa: f64,
    /// Volume that has passed the outlet line, mL.
    pub delivered_ml: f64,
}

/// Quantities in a [`Sample`].
pub const COLUMNS: usize = 8;

/// Room for samples in order of time: a column for every field of [`Sample`], in their order, all of one length.
pub type Columns<'c> = [&'c mut [f64]; COLUMNS];

impl Sample {
    /// The sample as columns of length 1.
    pub fn as_columns(&mut self) -> Columns<'_> {
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
