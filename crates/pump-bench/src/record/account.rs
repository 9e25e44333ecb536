//! The account of the doses from an angle that is not known exactly.

use pump_ctl::plan::Turned;
use pump_model::Pump;
use serde::{Deserialize, Serialize};

use crate::displacement::Correction;

/// Account of the doses from an angle that is not known exactly.
///
/// The sum of these doses depends on the first start angle and on the whole turn alone. So each dose is
/// planned for the sum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Account {
    /// Turn since the account began.
    pub(crate) turned: Turned,
    /// Correction of the displacement at the last dose.
    #[serde(default, skip_serializing_if = "Correction::is_none")]
    pub(crate) correction: Correction,
}

impl Account {
    /// Returns the smallest and the largest volume of the turn, in mL. `pump` is the uncorrected pump.
    pub(crate) fn range_ml(&self, pump: &Pump) -> (f64, f64) {
        let (least_ml, most_ml) = self.corrected().range_ml(&self.correction.pulsed(pump));
        (self.correction.factor * least_ml, self.correction.factor * most_ml)
    }

    /// Returns the middle of the volumes of the turn, in mL, or from a stated angle the volume from that angle.
    /// Doses are booked by it.
    pub(crate) fn middle_ml(&self, pump: &Pump) -> f64 {
        self.correction.factor * self.corrected().middle_ml(&self.correction.pulsed(pump))
    }

    /// Returns the largest distance of the volume of the turn from [`Self::middle_ml`], in mL.
    pub(crate) fn half_width_ml(&self, pump: &Pump) -> f64 {
        self.correction.factor * self.corrected().half_width_ml(&self.correction.pulsed(pump))
    }

    /// Returns by how much the sum of these doses and of later ones with the correction `to` is less sure, in mL:
    /// by the change between the two displacements. Both corrections have one shape.
    pub(crate) fn changed_ml(&self, to: &Correction, pump: &Pump) -> f64 {
        let change = (to.factor / self.correction.factor - 1.0).abs();
        change * self.half_width_ml(pump)
    }

    /// Returns the turn with its start from the zero of the corrected pump.
    fn corrected(&self) -> Turned {
        let Turned { start, .. } = self.turned;
        Turned { start: start.moved_to(start.angle_rad() + self.correction.zero_rad), ..self.turned }
    }
}
