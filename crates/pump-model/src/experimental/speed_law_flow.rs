//! Mean flow against speed by a speed law, and the speed for a given flow.

use crate::error::{Allowed, ModelError, Parameter, refused, within};
use crate::pump::pump::Pump;

use super::speed_law::SpeedLaw;

/// Ratio of neighbouring speeds of the search. A rise and fall that no three of them show may be passed over.
const RATIO: f64 = 1.01;

/// Relative difference below which two speeds are equal: a last bit or two.
const SAME_SPEED: f64 = 4.0 * f64::EPSILON;

/// Mean flow Q_avg(omega) of a pump with a speed law, between two speeds.
///
/// The flow rises with the speed, but a resonance of the inlet's line may bend it: it need not rise
/// everywhere.
#[derive(Debug, Clone, Copy)]
pub struct SpeedLawFlow<'a> {
    law: &'a SpeedLaw,
    pump: &'a Pump,
    least_rad_s: f64,
    most_rad_s: f64,
    direction: f64,
}

impl<'a> SpeedLawFlow<'a> {
    /// Takes speeds between `least_rad_s` and `most_rad_s`, both positive, forward or in `reverse`. `pump` is
    /// the pump without the law.
    ///
    /// # Errors
    ///
    /// Refuses parameters of the law or speeds that are not allowed, and a slowest speed above the fastest.
    pub fn new(
        law: &'a SpeedLaw,
        pump: &'a Pump,
        [least_rad_s, most_rad_s]: [f64; 2],
        reverse: bool,
    ) -> Result<Self, ModelError> {
        law.validate()?;
        within(Parameter::SlowestSpeed, least_rad_s, Allowed::POSITIVE)?;
        within(Parameter::FastestSpeed, most_rad_s, Allowed::POSITIVE)?;
        if least_rad_s > most_rad_s {
            return Err(refused(Parameter::SlowestSpeed, least_rad_s, "no more than the fastest"));
        }
        let direction = if reverse { -1.0 } else { 1.0 };
        Ok(Self { law, pump, least_rad_s, most_rad_s, direction })
    }

    /// Returns the mean flow at a positive speed in rad/s, mL/s; positive either way.
    ///
    /// # Errors
    ///
    /// Fails where [`SpeedLaw::average_flow_ml_s`] does.
    pub fn at(&self, speed_rad_s: f64) -> Result<f64, ModelError> {
        let flow_ml_s = self.law.average_flow_ml_s(self.pump, self.direction * speed_rad_s)?;
        Ok(self.direction * flow_ml_s)
    }

    /// Returns the slowest speed whose mean flow is `flow_ml_s`, rad/s; `flow_ml_s` is positive. Returns none
    /// if the flow is less than at the slowest speed or more than at any.
    ///
    /// The search is for a bracketed root: speeds rise by 1 % until the flow is passed, then intervals are
    /// halved to the last bits.
    ///
    /// # Errors
    ///
    /// Fails where [`Self::at`] does.
    ///
    /// # Examples
    ///
    /// ```
    /// use pump_model::{Pump, SpeedLaw, SpeedLawFlow};
    /// let (law, pump) = (SpeedLaw::PUBLISHED, Pump::three_roller());
    /// let flow = SpeedLawFlow::new(&law, &pump, [1.0, 18.0], false)?;
    /// let speed_rad_s = flow.speed_rad_s(20.0)?.unwrap();
    /// assert!((flow.at(speed_rad_s)? - 20.0).abs() < 1e-9);
    /// assert_eq!(flow.speed_rad_s(500.0)?, None);
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn speed_rad_s(&self, flow_ml_s: f64) -> Result<Option<f64>, ModelError> {
        let mut slow = self.least_rad_s;
        let least_ml_s = self.at(slow)?;
        if flow_ml_s < least_ml_s || flow_ml_s.is_nan() {
            return Ok(None);
        }
        if flow_ml_s == least_ml_s {
            return Ok(Some(slow));
        }
        // The last two speeds tried, the slower first. A largest flow between them lies near a speed whose
        // neighbours have less.
        let (mut before, mut last) = ((slow, least_ml_s), (slow, least_ml_s));
        let mut fast = slow;
        loop {
            let ended = fast >= self.most_rad_s;
            fast = (fast * RATIO).min(self.most_rad_s);
            let next = (fast, self.at(fast)?);
            if next.1 >= flow_ml_s {
                slow = last.0;
                break;
            }
            if ended || (last.1 >= before.1 && last.1 >= next.1) {
                let (most_ml_s, at_rad_s) = self.peak(before.0, fast)?;
                if most_ml_s >= flow_ml_s {
                    (slow, fast) = (before.0, at_rad_s);
                    break;
                }
            }
            if ended {
                return Ok(None);
            }
            (before, last) = (last, next);
        }
        while fast - slow > SAME_SPEED * fast {
            let middle = 0.5 * (slow + fast);
            if self.at(middle)? >= flow_ml_s {
                fast = middle;
            } else {
                slow = middle;
            }
        }
        Ok(Some(fast))
    }

    /// Returns the largest mean flow, mL/s, and the slowest speed that has it, rad/s.
    ///
    /// # Errors
    ///
    /// Fails where [`Self::at`] does.
    pub fn largest(&self) -> Result<(f64, f64), ModelError> {
        let mut best = (self.at(self.least_rad_s)?, self.least_rad_s);
        let mut speed = self.least_rad_s;
        while speed < self.most_rad_s {
            speed = (speed * RATIO).min(self.most_rad_s);
            let flow_ml_s = self.at(speed)?;
            if flow_ml_s > best.0 {
                best = (flow_ml_s, speed);
            }
        }
        let slow = self.least_rad_s.max(best.1 / RATIO);
        let fast = self.most_rad_s.min(best.1 * RATIO);
        let peak = self.peak(slow, fast)?;
        Ok(if peak.0 > best.0 { peak } else { best })
    }

    /// Returns the largest flow, mL/s, and its speed, rad/s, between two speeds, by thirds. Between them the
    /// flow rises, if at all, and then falls.
    fn peak(&self, mut slow: f64, mut fast: f64) -> Result<(f64, f64), ModelError> {
        let mut best = (self.at(slow)?, slow);
        while fast - slow > 1e-9 * fast {
            let (lower, upper) = (slow + (fast - slow) / 3.0, fast - (fast - slow) / 3.0);
            let (at_lower, at_upper) = (self.at(lower)?, self.at(upper)?);
            for (flow_ml_s, speed) in [(at_lower, lower), (at_upper, upper)] {
                if flow_ml_s > best.0 {
                    best = (flow_ml_s, speed);
                }
            }
            if at_lower < at_upper {
                slow = lower;
            } else {
                fast = upper;
            }
        }
        Ok(best)
    }
}
