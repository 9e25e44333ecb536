//! The hydraulic line of one port, between the rollers and the reservoir.

use libm::{acos, exp, pow, sqrt};

use crate::error::{ModelError, Parameter, within};
use crate::head::paper;

/// Lumped line of one port (McIntyre et al.): C at the pump, R and L in series to a reservoir.
///
/// ```
/// use pump_model::Line;
/// let line = Line { inertance_kpa_s2_ml: 0.006, ..Line::PUBLISHED };
/// line.validate()?;
/// assert!((Line::PUBLISHED.damping_ratio() - 0.162).abs() < 5e-4);
/// assert!(line.damping_ratio() < Line::PUBLISHED.damping_ratio());
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Line {
    /// Resistance R, kPa s/mL, 0 to 1e6.
    pub resistance_kpa_s_ml: f64,
    /// Compliance C, mL/kPa, 1e-6 to 1e6.
    pub compliance_ml_kpa: f64,
    /// Inertance L, kPa s²/mL, 1e-6 to 1e6.
    pub inertance_kpa_s2_ml: f64,
    /// Reservoir pressure P_res, kPa absolute, 0.001 to 1e6.
    pub reservoir_kpa: f64,
}

impl Line {
    /// Line of McIntyre et al., equal at inlet and outlet.
    pub const PUBLISHED: Self = Self {
        resistance_kpa_s_ml: paper::LINE_RESISTANCE_KPA_S_ML,
        compliance_ml_kpa: paper::LINE_COMPLIANCE_ML_KPA,
        inertance_kpa_s2_ml: paper::LINE_INERTANCE_KPA_S2_ML,
        reservoir_kpa: paper::RESERVOIR_KPA,
    };

    /// Checks the line.
    ///
    /// # Errors
    ///
    /// Refuses parameters outside their ranges.
    pub fn validate(&self) -> Result<(), ModelError> {
        within(Parameter::LineResistance, self.resistance_kpa_s_ml, 0.0..=1e6)?;
        within(Parameter::LineCompliance, self.compliance_ml_kpa, 1e-6..=1e6)?;
        within(Parameter::LineInertance, self.inertance_kpa_s2_ml, 1e-6..=1e6)?;
        within(Parameter::ReservoirPressure, self.reservoir_kpa, 1e-3..=1e6)
    }

    /// Returns the undamped natural frequency 1 / sqrt(L C), rad/s.
    pub fn natural_rad_s(&self) -> f64 {
        1.0 / sqrt(self.inertance_kpa_s2_ml * self.compliance_ml_kpa)
    }

    /// Returns the damping ratio R/2 sqrt(C/L).
    ///
    /// ```
    /// assert!((pump_model::Line::PUBLISHED.damping_ratio() - 0.162).abs() < 5e-4);
    /// ```
    pub fn damping_ratio(&self) -> f64 {
        0.5 * self.resistance_kpa_s_ml * sqrt(self.compliance_ml_kpa / self.inertance_kpa_s2_ml)
    }

    /// Returns the largest change of pressure that a flow at the rollers can make, over that flow, kPa s/mL.
    ///
    /// A flow within `flow` either way moves the pressure of a line that was at rest by at most `flow` times
    /// this. It is infinite for a line without resistance, which may resonate.
    ///
    /// It is the integral of |p| after 1 mL is pushed in at once: p'' + (R/L) p' + p/(L C) = 0 from 1/C with
    /// p' = 0. In an overdamped line p stays positive, and the integral is R. Otherwise it is
    /// R + 2 L (Q_1 + Q_2 + ...) with the flows Q_n at the zeros of p. These fall by exp(-pi k) each,
    /// k = z/sqrt(1 - z²) with the damping ratio z, from Q_1 = w exp(-k (pi/2 + asin z)), w = 1/sqrt(L C). As
    /// asin z >= z, z stands for asin z and gives a bound.
    pub fn worst_kpa_s_ml(&self) -> f64 {
        use core::f64::consts::{E, PI};
        let z = self.damping_ratio();
        if z >= 1.0 {
            return self.resistance_kpa_s_ml;
        }
        let k = z / sqrt(1.0 - z * z);
        let first = self.inertance_kpa_s2_ml * self.natural_rad_s() * pow(E, -k * (0.5 * PI + z));
        self.resistance_kpa_s_ml + 2.0 * first / (1.0 - pow(E, -k * PI))
    }

    /// Returns the largest distance between the pressure of a motion in steps and that of the smooth motion
    /// through the steps, over the volume of the largest step, kPa/mL. Two steps are `shortest_s` to `longest_s`
    /// apart, and the motion takes `duration_s`.
    ///
    /// After 1 mL is pushed in at once the pressure is h(t), from h(0) = 1/C with h' = 0. Let the steps lie
    /// x_0 < x_1 < ... in the past, and the flow be even between two of them. Then the distance is dV times
    /// the sum of h(x_i) - mean of h from x_i to x_(i+1), less a part of the mean since the last step. Three
    /// bounds of this sum hold, and the smallest one is returned, over C:
    ///
    /// - Steps that are close. h(x_i) - mean is (h(x_i) - h(x_(i+1)))/2 and the error of the trapezoid, which
    ///   is at most longest/8 times the integral of |h''| there. So the sum is at most 1 + longest/8 times
    ///   the integral of |h''|. The extremes of h' are w exp(-k acos z) and fall by exp(-pi k) each.
    /// - Steps that are far apart. |h| is at most exp(-s t)/sqrt(1 - z²), s = R/2L, so the steps before the last
    ///   add at most the geometric series of exp(-s shortest) over that root. The smooth flow is at most
    ///   dV/shortest, and its pressure follows from [`Self::worst_kpa_s_ml`].
    /// - Any steps. Let h fall from a peak p to a valley. Close steps on the way down to v add (p - v)/2, and
    ///   the last one skips the rise and adds v less a mean near 0, so a peak adds p at most. The peaks are a
    ///   geometric series, since they fall by exp(-2 pi k): 1/(1 - exp(-2 pi k)), or as many as the motion
    ///   has swings. Steps once a swing reach this, less the mean. An overdamped line has the first peak alone.
    ///
    /// Here w = 1/sqrt(L C), z is the damping ratio and k = z/sqrt(1 - z²).
    ///
    /// ```
    /// let line = pump_model::Line::PUBLISHED;
    /// let over_single = |apart_s| line.compliance_ml_kpa * line.worst_step_kpa_ml(apart_s, apart_s, 60.0);
    /// assert!((over_single(0.08) - 1.55).abs() < 0.01);
    /// assert!(over_single(0.001) < 1.05 && over_single(1.0) < 1.06);
    /// ```
    pub fn worst_step_kpa_ml(&self, shortest_s: f64, longest_s: f64, duration_s: f64) -> f64 {
        use core::f64::consts::{PI, TAU};
        let z = self.damping_ratio();
        let single = 1.0 / self.compliance_ml_kpa;
        if z >= 1.0 {
            return single;
        }
        let (k, natural_rad_s) = (z / sqrt(1.0 - z * z), self.natural_rad_s());
        // The first is infinite for a line without resistance.
        let swings = 1.0 + duration_s * natural_rad_s / TAU;
        let peaks = (1.0 / (1.0 - exp(-TAU * k))).min(swings);
        let slopes = (1.0 / (1.0 - exp(-PI * k))).min(2.0 * swings);
        let curved = 2.0 * natural_rad_s * exp(-k * acos(z)) * slopes;
        let left = exp(-z * natural_rad_s * shortest_s);
        // It is infinite, or not a number, where nothing dies out. `min` then keeps the other bound.
        let smooth = self.compliance_ml_kpa * self.worst_kpa_s_ml() / shortest_s;
        let sparse = 1.0 + smooth + left / ((1.0 - left) * sqrt(1.0 - z * z));
        single * peaks.min(1.0 + 0.125 * longest_s * curved).min(sparse)
    }
}
