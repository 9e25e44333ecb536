//! The ripple of the flow at the end of a pump's outlet line.

use crate::line::outflow_ripple::outflow_ripple;
use crate::motion::leg::Leg;
use crate::motion::ripple::Ripple;

use super::pump::Pump;

impl Pump {
    /// Returns the ripple over time of the flow at the end of the outlet line, for a motion that repeats
    /// itself without end. Returns none if there is no flow, or at a resonance that nothing damps.
    ///
    /// Every leg must end, and the `legs` must turn whole pitches. The state that repeats itself is exact, as
    /// in [`Pump::periodic_state`]. Over steps short beside the swing the flow is the quintic through value,
    /// slope and curvature at both ends.
    ///
    /// ```
    /// use pump_model::{Leg, Pump};
    ///
    /// let pump = Pump::three_roller();
    /// let leg = Leg { duration_s: pump.pitch_rad() / 5.0, ..Leg::constant_speed(0.0, 5.0) };
    /// let (at_rollers, at_end) = (pump.outlet_curve().ripple(), pump.outflow_ripple([leg]).unwrap());
    /// assert!(at_end.peak_to_peak > 1.2 * at_rollers.peak_to_peak);
    /// ```
    pub fn outflow_ripple<I>(&self, legs: I) -> Option<Ripple>
    where
        I: IntoIterator<Item = Leg> + Clone,
    {
        outflow_ripple(self.outlet(), self.outlet_curve(), legs)
    }

    /// Returns the ripple over time of the flow at the end of the outlet line at constant speed, which must
    /// not be zero. Returns none as [`Self::outflow_ripple`] does.
    pub fn constant_speed_outflow_ripple(&self, speed_rad_s: f64) -> Option<Ripple> {
        let duration_s = self.pitch_rad() / speed_rad_s.abs();
        self.outflow_ripple([Leg { duration_s, ..Leg::constant_speed(0.0, speed_rad_s) }])
    }
}
