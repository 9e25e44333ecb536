//! The angle at which a person says that the rollers stand, and how well it is known.

use clap::Args;
use pump_bench::units::{self, StatedAngle};
use pump_model::units::{degrees, radians};

use crate::advice::Advised;

/// Tolerance of an angle that is stated without one, deg: an eye reads an angle off a pump head to a degree.
const ASSUMED_DEG: f64 = 1.0;

/// Reads an angle with its tolerance, as 30deg+-1deg. Its refusal has the command's advice.
pub(crate) fn stated_angle(text: &str) -> Result<StatedAngle, Advised> {
    units::stated_angle(text).map_err(Advised)
}

/// The angle of the rollers at the start of a dose.
#[derive(Debug, Args)]
#[command(next_help_heading = "Amount and speed")]
pub(crate) struct StatedStartOption {
    /// Angle of the rollers at the start, as 30deg+-1deg [default: as recorded]
    #[arg(
        long_help = "Angle of the rollers at the start and its tolerance, as 30deg+-1deg. At 0deg a roller \
        begins to leave the outlet. Without a tolerance 1deg is assumed. The default is the angle on record."
    )]
    #[arg(long, value_name = "ANGLE", value_parser = stated_angle)]
    start_angle: Option<StatedAngle>,
}

impl StatedStartOption {
    /// The angle, rad, if one is given.
    pub(crate) fn angle_rad(&self) -> Option<f64> {
        self.start_angle.map(|stated| stated.angle_rad)
    }

    /// The tolerance of the angle, rad: as stated, or the assumed one.
    pub(crate) fn tolerance_rad(&self) -> f64 {
        self.start_angle.map_or(0.0, |stated| or_assumed_rad(stated.tolerance_rad))
    }

    /// The message that a tolerance is assumed, if the angle has none.
    pub(crate) fn assumed(&self) -> Option<String> {
        let stated = self.start_angle.filter(|stated| stated.tolerance_rad.is_none())?;
        // Rounded as a person types it.
        let angle_deg = (1e6 * degrees(stated.angle_rad)).round() / 1e6;
        Some(format!(
            "the start angle has no tolerance: {ASSUMED_DEG} deg either way is assumed; {angle_deg}deg+-0deg is exact"
        ))
    }
}

/// A tolerance, rad, or the assumed one where none is stated.
pub(crate) fn or_assumed_rad(tolerance_rad: Option<f64>) -> f64 {
    tolerance_rad.unwrap_or(radians(ASSUMED_DEG))
}

/// The message, a line, that a tolerance is assumed of an angle that `dose home --set` sets.
pub(crate) fn assumed_of_set() -> String {
    format!("no tolerance was stated: {ASSUMED_DEG} deg either way is assumed; --tolerance 0deg is exact\n")
}
