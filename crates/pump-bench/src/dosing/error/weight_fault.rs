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
    #[error("the balance sent nothing for {for_s:.1} s while the pump turned; {allowed_s} s are allowed")]
    Quiet {
        /// Time for which the balance was listened to without a reading, in s.
        for_s: f64,
        /// Longest time without a reading, in s.
        allowed_s: f64,
    },
    /// Nobody read the balance while the pump turned: the computer was busy with other things.
    #[error(
        "the balance was not read for {for_s:.1} s while the pump turned, and {allowed_s} s are allowed: this computer \
         was too busy, and nobody knows if the balance was silent"
    )]
    Unread {
        /// Time without a reading, in s.
        for_s: f64,
        /// Longest time without a reading, in s.
        allowed_s: f64,
    },
    /// The balance does not rise, and the motor is simulated.
    #[error(
        "the balance rose by {} g where a simulated motor made the steps of {} mL: no motor moved",
        significant(*rose_g, 4), significant(*turned_ml, 4)
    )]
    NoMotor {
        /// Rise of the balance, in g.
        rose_g: f64,
        /// Volume by the model of the steps, in mL.
        turned_ml: f64,
    },
    /// The balance does not rise while the pump turns.
    #[error(
        "the balance rose by {} g in the last stretch, and {} mL at least had to reach it by then: is the vessel on \
         it, the tube in the vessel and the line filled?",
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
        "the pump has turned for {} mL, and {} mL is the most for {} mL requested; the balance shows {} mL",
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

impl WeightFault {
    /// Returns the fault as it is where a motor moves, or where it is simulated and nothing can arrive.
    #[must_use]
    pub(crate) fn where_motor_moves(self, moves: bool) -> Self {
        match self {
            Self::NotRising { rose_g, turned_ml } if !moves => Self::NoMotor { rose_g, turned_ml },
            fault => fault,
        }
    }

    /// Returns true if a rotor that stands at another angle than the record says may have brought the fault about.
    pub(crate) fn may_be_the_angle(&self) -> bool {
        match self {
            Self::NotRising { .. } | Self::TooMuch { .. } | Self::Ceiling { .. } => true,
            Self::Balance(_)
            | Self::Quiet { .. }
            | Self::Unread { .. }
            | Self::NoMotor { .. }
            | Self::Fell { .. }
            | Self::Endless { .. } => false,
        }
    }
}
