//! How sure the pulse of a pump is: roller volume, engagement angle and zero.

use pump_model::Pump;
use pump_model::units::degrees;

use crate::calibration::Applied;
use crate::pump_file::PumpFile;

/// Standard uncertainty of the engagement angle, in deg: read to 1 deg either way, rectangular, 1/sqrt(3) (GUM,
/// JCGM 100:2008, 4.3.7). Two sets of dimensions of the paper's one pump differ by 0.7 deg in the angle of full
/// contact, 66.8 and 66.1 deg.
const ENGAGEMENT_DEG: f64 = 0.577;

/// Standard uncertainties of a pump's pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PulseStandards {
    /// Standard uncertainty of the roller volume, in mL.
    pub(crate) roller_volume_ml: f64,
    /// Standard uncertainty of the engagement angle, in deg.
    pub(crate) engagement_deg: f64,
    /// Standard uncertainty of the zero of the angle, in rad.
    pub(crate) zero_rad: f64,
}

impl PulseStandards {
    /// Returns what short doses found of the pulse, or else what the pump file states. `pump` is the corrected pump.
    pub(crate) fn of(file: &PumpFile, pump: &Pump, applied: Option<&Applied>) -> Self {
        match applied.and_then(|applied| applied.pulse) {
            Some(fitted) => {
                let [roller_part, engagement_rad, zero_rad] = fitted.standards();
                Self {
                    roller_volume_ml: roller_part * pump.roller_volume().total_ml(),
                    engagement_deg: degrees(engagement_rad),
                    zero_rad,
                }
            }
            None => Self {
                roller_volume_ml: file.uncertainty.roller_volume_ml,
                engagement_deg: ENGAGEMENT_DEG,
                zero_rad: applied.map_or(0.0, |applied| applied.zero_standard_rad),
            },
        }
    }
}
