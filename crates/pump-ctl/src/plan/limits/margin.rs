//! The margin of a dose to one limit.

/// The margin of a dose to one limit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Margin {
    /// Worst predicted value, kPa absolute or N m. A pressure includes the change by the motor's steps.
    pub reached: f64,
    /// Limit, in the unit of `reached`. The limit of a torque is the motor's torque at that speed.
    pub limit: f64,
    /// Used part of the limit: 0 at rest, 1 at the limit, more beyond it.
    pub used: f64,
}

impl Margin {
    /// Makes the margin of a pressure that is `rest` while the rotor stands. `sign` is 1 for a limit from
    /// above and -1 for a limit from below.
    pub(in crate::plan) fn of_pressure(reached: f64, limit: f64, rest: f64, sign: f64) -> Self {
        let room = sign * (limit - rest);
        let used = if room > 0.0 {
            sign * (reached - rest) / room
        } else if sign * (reached - limit) > 0.0 {
            f64::INFINITY
        } else {
            1.0
        };
        Self { reached, limit, used }
    }

    /// Makes the margin of a torque, which is not negative.
    pub(in crate::plan) fn of_torque(needed_n_m: f64, limit_n_m: f64) -> Self {
        let used = if needed_n_m > 0.0 { needed_n_m / limit_n_m } else { 0.0 };
        Self { reached: needed_n_m, limit: limit_n_m, used }
    }
}
