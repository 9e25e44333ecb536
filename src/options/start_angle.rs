//! The angle at which a person says that the rollers stand, and how well it is known.

use clap::Args;
use pump_bench::Bench;
use pump_bench::units::{self, StatedAngle};
use pump_model::units::{degrees, radians};

use crate::advice::Advised;

/// Tolerance of an angle that is stated without one, deg: an eye reads an angle off a pump head to a degree.
const ASSUMED_DEG: f64 = 1.0;

/// Tolerance of such an angle of a head without a drawing, deg. At angle 0 a roller's axis is a third of phi short of
/// the track's end, 20.0 deg with a standard uncertainty of 50 % (docs/pulse_prior.md): 10 deg, and a degree for the
/// eye.
const ASSUMED_UNDRAWN_DEG: f64 = 11.0;

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
        begins to leave the outlet. Without a tolerance 1deg is assumed, and 11deg of a head without a \
        drawing. The default is the angle on record."
    )]
    #[arg(long, value_name = "ANGLE", value_parser = stated_angle)]
    start_angle: Option<StatedAngle>,
}

impl StatedStartOption {
    /// The angle, rad, if one is given.
    pub(crate) fn angle_rad(&self) -> Option<f64> {
        self.start_angle.map(|stated| stated.angle_rad)
    }

    /// The tolerance of the angle, rad: as stated, or the assumed one of this pump.
    pub(crate) fn tolerance_rad(&self, bench: &Bench) -> f64 {
        self.start_angle.map_or(0.0, |stated| or_assumed_rad(stated.tolerance_rad, bench))
    }

    /// The message that a tolerance is assumed, if the angle has none.
    pub(crate) fn assumed(&self, bench: &Bench) -> Option<String> {
        let stated = self.start_angle.filter(|stated| stated.tolerance_rad.is_none())?;
        // Rounded as a person types it.
        let angle_deg = (1e6 * degrees(stated.angle_rad)).round() / 1e6;
        Some(format!(
            "the start angle has no tolerance: {} deg either way is assumed; {angle_deg}deg+-0deg is exact",
            assumed_deg(bench)
        ))
    }
}

/// A tolerance, rad, or the assumed one of this pump where none is stated.
pub(crate) fn or_assumed_rad(tolerance_rad: Option<f64>, bench: &Bench) -> f64 {
    tolerance_rad.unwrap_or_else(|| radians(assumed_deg(bench)))
}

/// The message, a line, that a tolerance is assumed of an angle that `dose home --set` sets.
pub(crate) fn assumed_of_set(bench: &Bench) -> String {
    let assumed_deg = assumed_deg(bench);
    format!("no tolerance was stated: {assumed_deg} deg either way is assumed; --tolerance 0deg is exact\n")
}

/// The tolerance, deg, that is assumed of an angle of this pump. Its zero is found once short doses were weighed.
fn assumed_deg(bench: &Bench) -> f64 {
    // A calibration that cannot be read is refused before anything moves.
    let is_found =
        || matches!(bench.calibrations().active(), Ok(Some(stored)) if stored.calibration.pulse.is_some());
    if bench.file().head.is_some() && !is_found() { ASSUMED_UNDRAWN_DEG } else { ASSUMED_DEG }
}
