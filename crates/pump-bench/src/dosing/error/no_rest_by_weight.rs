//! Reasons for which a balance cannot end the rest of a dose.

use libm::log10;
use thiserror::Error;

use crate::numbers::significant;

/// Reason for which a balance cannot end the rest of an unfinished dose.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum NoRestByWeight {
    /// No balance was to end the dose.
    #[error("the unfinished dose was asked for by volume, and no balance was read before it")]
    ByVolume,
    /// The record does not have the reading before the dose.
    #[error(
        "an earlier version of this program began the dose, and its record lacks what the balance showed before it"
    )]
    NoTare,
    /// The balance shows a load that the pump cannot have brought about.
    #[error(
        "the balance shows {} g, and {} to {} g were expected: it showed {} g before the dose, and the pump has turned \
         since; the vessel was moved or changed, the balance was tared, or the dose went elsewhere",
        grams(*shown_g, *digit_g), grams(*least_g, *digit_g), grams(*most_g, *digit_g), grams(*tare_g, *digit_g)
    )]
    OtherLoad {
        /// Reading at rest now, in g.
        shown_g: f64,
        /// Reading before the dose, in g.
        tare_g: f64,
        /// Least reading that the pump explains, in g.
        least_g: f64,
        /// Most reading that the pump explains, in g.
        most_g: f64,
        /// Step of the balance's last digit, in g.
        digit_g: f64,
    },
    /// The pump has turned for the most that it may.
    #[error(
        "the pump has turned for {} mL, and {} mL is the most that it may turn for in this dose",
        significant(*turned_ml, 5), significant(*most_ml, 5)
    )]
    Ceiling {
        /// Volume by the model, in mL.
        turned_ml: f64,
        /// Most volume by the model that is allowed, in mL.
        most_ml: f64,
    },
}

/// Words a mass with the decimals of the balance.
fn grams(mass_g: f64, digit_g: f64) -> String {
    let decimals = (-log10(digit_g)).clamp(0.0, 6.0).round() as usize;
    format!("{mass_g:.decimals$}")
}
