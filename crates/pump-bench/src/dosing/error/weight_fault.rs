//! Faults that end a dose by weight.

use thiserror::Error;

use crate::balance::BalanceError;
use crate::numbers::significant;

/// Fault that ends a dose by weight.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WeightFault {
    /// The balance cannot be read.
    #[error("the balance cannot be read")]
    Balance(#[source] BalanceError),
    /// The balance told nothing while the pump turned.
    #[error("the balance told nothing for {for_s:.1} s while the pump turned; {allowed_s} s are allowed")]
    Quiet {
        /// Time without a reading, in s.
        for_s: f64,
        /// Longest time without a reading, in s.
        allowed_s: f64,
    },
    /// The balance does not rise while the pump turns.
    #[error(
        "the balance rose by {} g where the pump turned for {} mL: is the vessel on it, the tube in the vessel and \
         the line filled?",
        significant(*rose_g, 4), significant(*turned_ml, 4)
    )]
    NotRising {
        /// Rise of the balance, in g.
        rose_g: f64,
        /// Volume by the model that should have arrived, in mL.
        turned_ml: f64,
    },
    /// The balance lost mass.
    #[error(
        "the balance fell from {} to {} g while the pump turned: was the vessel touched or taken away?",
        significant(*from_g, 7), significant(*to_g, 7)
    )]
    Fell {
        /// Largest reading, in g.
        from_g: f64,
        /// Present reading, in g.
        to_g: f64,
    },
    /// The balance shows more than the pump can have delivered.
    #[error(
        "the balance shows {} mL, and the pump has turned for {} ± {} mL: something else is on the balance, or the \
         pump is another one",
        significant(*weighed_ml, 5), significant(*turned_ml, 5), significant(*unsure_ml, 2)
    )]
    TooMuch {
        /// Volume by the balance, in mL.
        weighed_ml: f64,
        /// Volume by the model, in mL.
        turned_ml: f64,
        /// Largest difference that is allowed, in mL.
        unsure_ml: f64,
    },
    /// The pump has turned for the most that it may deliver, and the balance shows less than was asked for.
    #[error(
        "the pump has turned for {} mL, and {} mL is the most for {} mL asked; the balance shows {} mL",
        significant(*turned_ml, 5), significant(*most_ml, 5), significant(*asked_ml, 5), significant(*weighed_ml, 5)
    )]
    Ceiling {
        /// Volume by the model, in mL.
        turned_ml: f64,
        /// Most volume by the model that is allowed, in mL.
        most_ml: f64,
        /// Volume asked for, in mL.
        asked_ml: f64,
        /// Volume by the balance, in mL.
        weighed_ml: f64,
    },
    /// The rest does not arrive, however often it is added.
    #[error("after {stretches} stretches {} mL of the dose have not arrived", significant(*rest_ml, 3))]
    Endless {
        /// Number of stretches.
        stretches: u32,
        /// Volume that has not arrived, in mL.
        rest_ml: f64,
    },
}
