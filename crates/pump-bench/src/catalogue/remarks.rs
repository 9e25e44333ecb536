//! Remarks in a new pump file on what its owner states: the motor and the place.

use crate::pump_file::{AmbientSource, PumpFile};

/// Returns the remark above `[motor]`. `source` names the document that does not tell of the motor.
pub(super) fn motor_remark(file: &PumpFile, source: &str) -> String {
    if file.motor.confirmed == Some(false) {
        return format!(
            "# Assumed: a {source} does not tell. Change it to yours. The steps are a stand-in for simulations:\n\
             # a real motor does not move until you write yours (full steps x microsteps, as 200 x 16 = 3200)\n\
             # and take out `confirmed = false`."
        );
    }
    let direction = match file.motor.direction_confirmed {
        Some(false) => {
            "\n# Nobody has said which way it turns: a real motor does not move until you have seen it, written\n# \
             `invert` in [drive] and taken out `direction_confirmed = false`."
        }
        _ => "",
    };
    format!("# Steps and gear as given. Assumed: speed and acceleration. Change them to yours.{direction}")
}

/// Returns the remark above `[ambient]`.
pub(super) fn ambient_remark(file: &PumpFile) -> &'static str {
    match file.ambient.source() {
        AmbientSource::SeaLevel => {
            "# Assumed: sea level, 101.325 kPa (ISO 2533). Give your place: altitude_m, or pressure_kpa."
        }
        AmbientSource::Altitude(_) | AmbientSource::Pressure => "# As given.",
    }
}
