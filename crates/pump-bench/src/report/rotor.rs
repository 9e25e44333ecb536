//! The rollers' angle in words.

use pump_model::units::degrees;

use crate::bench::Bench;
use crate::record::PumpState;

/// Says where the rollers stand.
pub fn rotor_text(bench: &Bench, state: &PumpState) -> String {
    if !state.phase().is_known(bench.model().pitch_rad()) {
        return "the rollers stand at an unknown angle; `dose home` finds it, or `dose home --set <ANGLE>` says it\n"
            .to_owned();
    }
    let width = match degrees(state.half_width_rad) {
        0.0 => String::new(),
        width_deg => format!(" ± {width_deg:.2}°"),
    };
    format!("the rollers stand at {:.2}°{width}\n", degrees(state.angle_rad))
}

/// Warns that a carry is dropped; nothing if there was none.
pub fn carry_dropped_text(carry_ml: f64) -> String {
    match carry_ml {
        0.0 => String::new(),
        carry_ml => format!("warning: a carry of {:.2} µL is dropped\n", 1e3 * carry_ml),
    }
}
