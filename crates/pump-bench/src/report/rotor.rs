//! Where the rollers stand, in words, and the report of an unfinished dose that was accepted as it is.

use pump_model::units::degrees;
use serde::Serialize;

use crate::bench::{Accepted, Bench};
use crate::notice::{Remedy, Wording};
use crate::numbers::{between, microlitres, significant};
use crate::record::PumpState;

/// Says where the rollers stand. A front end words what finds an unknown angle.
pub fn rotor_text(bench: &Bench, state: &PumpState, words: Wording) -> String {
    if !state.phase().is_known(bench.model().pitch_rad()) {
        return format!("the rollers stand at an unknown angle; {}\n", words(Remedy::FindOrSayAngle));
    }
    let width = match degrees(state.half_width_rad) {
        0.0 => String::new(),
        width_deg => format!(" ± {width_deg:.2}°"),
    };
    format!("the rollers stand at {:.2}°{width}\n", degrees(state.angle_rad))
}

/// Warns that a carry is dropped; nothing if there was none.
pub fn carry_dropped_text(carry_ml: f64) -> String {
    let carry = microlitres(carry_ml);
    if carry == microlitres(0.0) {
        String::new()
    } else {
        format!("warning: a carry of {carry} is dropped\n")
    }
}

/// The report of an unfinished dose that was accepted (`schema` `accepted/1`).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct AcceptedReport {
    /// `accepted/1`.
    pub schema: &'static str,
    /// Id of the pump.
    pub pump: String,
    /// Name of the drive.
    pub driver: String,
    /// Volume that was asked for, mL.
    pub requested_ml: f64,
    /// Smallest volume that the dose has delivered, mL.
    pub delivered_least_ml: f64,
    /// Largest volume that the dose has delivered, mL.
    pub delivered_most_ml: f64,
    /// Carry that was dropped, mL, positive toward the outlet.
    pub dropped_carry_ml: f64,
    /// Angle of the rollers, deg; null if it is unknown.
    pub angle_deg: Option<f64>,
    /// True if the angle is known.
    pub angle_known: bool,
    /// Largest error of the angle either way, deg; half a pitch if it is unknown.
    pub half_width_deg: f64,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

impl AcceptedReport {
    /// Reports an unfinished dose of `bench` that was accepted, with these warnings.
    pub fn new(bench: &Bench, accepted: &Accepted, warnings: Vec<String>) -> Self {
        let (model, state) = (bench.model(), &accepted.state);
        let (delivered_least_ml, delivered_most_ml) = accepted.dose.delivered_ml(model);
        let angle_known = state.phase().is_known(model.pitch_rad());
        Self {
            schema: "accepted/1",
            pump: bench.file().pump.id.clone(),
            driver: bench.drive_id().to_owned(),
            requested_ml: accepted.dose.intent.whole_requested_ml(),
            delivered_least_ml,
            delivered_most_ml,
            dropped_carry_ml: accepted.dropped_ml,
            angle_deg: angle_known.then_some(degrees(state.angle_rad)),
            angle_known,
            half_width_deg: degrees(state.half_width_rad.min(0.5 * model.pitch_rad())),
            warnings,
        }
    }

    /// One line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("a report is plain data: {error}"))
    }
}

/// Says that an unfinished dose is accepted, what it delivered, where the rollers stand, and which carry is dropped.
pub fn accepted_text(bench: &Bench, accepted: &Accepted, words: Wording) -> String {
    let (rotor, dropped) =
        (rotor_text(bench, &accepted.state, words), carry_dropped_text(accepted.dropped_ml));
    let (least_ml, most_ml) = accepted.dose.delivered_ml(bench.model());
    let dose = if accepted.dose.is_endless() {
        "the unfinished run until stopped".to_owned()
    } else {
        format!("the unfinished dose of {} mL", significant(accepted.dose.intent.whole_requested_ml(), 6))
    };
    format!("{dose} is accepted as it is: {} were delivered\n{rotor}{dropped}", between(least_ml, most_ml))
}
