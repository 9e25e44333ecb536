//! The turn since the rollers stood at an angle that is not known exactly.

use pump_model::{Allowed, Pump};

use crate::parameter::Parameter;

use super::error::{PlanError, within};
use super::phase::Phase;

/// Turn since the rollers stood at an angle that is not known exactly.
///
/// Each dose from such an angle may be wrong by as much as the first one. The sum of the doses need not be: it
/// depends on the first start angle and on the whole turn alone. So each dose is planned for the sum, and
/// books the growth of the middle of all possible sums. From a stated angle ([`Phase::is_stated`]) it books the
/// growth of the volume from that angle.
///
/// ```
/// use pump_ctl::plan::{Phase, Turned};
///
/// let pump = pump_model::Pump::three_roller();
/// let lost = Turned::at(Phase::unknown(pump.pitch_rad()));
/// let (least_ml, most_ml) = lost.by(0.4, 0.4).range_ml(&pump);
/// assert!(most_ml - least_ml > 1.0);
/// // A whole pitch has one volume from every angle.
/// let (least_ml, most_ml) = lost.by(0.4, 0.4).by(pump.pitch_rad() - 0.4, pump.pitch_rad() - 0.4).range_ml(&pump);
/// assert!(most_ml - least_ml < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Turned {
    /// Angle at which the rollers stood.
    pub start: Phase,
    /// Smallest turn since, rad, negative in reverse.
    pub least_rad: f64,
    /// Largest turn since, rad. It equals `least_rad` if every step was counted.
    pub most_rad: f64,
}

impl Turned {
    /// Makes the turn of rollers that stand at `start`: they have not turned yet.
    pub fn at(start: Phase) -> Self {
        Self { start, least_rad: 0.0, most_rad: 0.0 }
    }

    /// Returns the turn after another turn between `least_rad` and `most_rad`.
    #[must_use]
    pub fn by(self, least_rad: f64, most_rad: f64) -> Self {
        Self { least_rad: self.least_rad + least_rad, most_rad: self.most_rad + most_rad, ..self }
    }

    /// Returns true if the turn is exact: from a known angle, with every step counted.
    pub fn is_exact(&self) -> bool {
        self.start.half_width_rad == 0.0 && self.least_rad == self.most_rad
    }

    /// Returns the smallest and the largest volume of the turn, mL, over the angles at which the rollers may
    /// have stood.
    pub fn range_ml(&self, pump: &Pump) -> (f64, f64) {
        let Self { start, least_rad, most_rad } = *self;
        if least_rad == 0.0 && most_rad == 0.0 {
            return (0.0, 0.0);
        }
        if least_rad != most_rad && pump.outlet_curve().reverses() {
            // A longer turn may deliver less.
            return pump.outlet_curve().turns_range_ml(
                start.angle_rad,
                start.half_width_rad,
                least_rad,
                most_rad,
            );
        }
        if start.half_width_rad > 0.0 {
            return (start.range_ml(pump, least_rad).0, start.range_ml(pump, most_rad).1);
        }
        let curve = pump.outlet_curve();
        let start_ml = curve.volume_ml(start.angle_rad);
        let volume_ml = |turn_rad: f64| curve.volume_ml(start.angle_rad + turn_rad) - start_ml;
        let least_ml = volume_ml(least_rad);
        (least_ml, if least_rad == most_rad { least_ml } else { volume_ml(most_rad) })
    }

    /// Returns the middle of the volumes of the turn, mL: the volume from a stated angle, or the middle over all
    /// angles at which the rollers may have stood. Doses are booked by it.
    pub fn middle_ml(&self, pump: &Pump) -> f64 {
        let (least_ml, most_ml) = self.aimed().range_ml(pump);
        least_ml + 0.5 * (most_ml - least_ml)
    }

    /// Returns the largest distance of the volume of the turn from [`Self::middle_ml`], mL.
    pub fn half_width_ml(&self, pump: &Pump) -> f64 {
        let ((least_ml, most_ml), middle_ml) = (self.range_ml(pump), self.middle_ml(pump));
        (middle_ml - least_ml).max(most_ml - middle_ml)
    }

    /// Returns the turn from the angles that the steps of a dose are chosen for: from a stated angle as if it were
    /// exact.
    #[must_use]
    pub fn aimed(self) -> Self {
        Self { start: self.start.aimed(), ..self }
    }

    pub(in crate::plan) fn validate(&self) -> Result<(), PlanError> {
        self.start.validate()?;
        // A thousand of the largest doses.
        let allowed = || Allowed::EitherWay { most: 1e9 };
        within(Parameter::LeastTurn, self.least_rad, allowed())?;
        within(Parameter::MostTurn, self.most_rad, allowed())
    }
}
