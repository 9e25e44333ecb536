//! Why a text is no quantity.

use thiserror::Error;

use super::kind::Kind;

/// A text that is no such quantity: what was read, and what is accepted.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// Nothing there.
    #[error("empty {kind}; write it with its unit, as in {}", .kind.example())]
    Empty {
        /// What was expected.
        kind: Kind,
    },
    /// No number at the start.
    #[error("`{text}` is not a {kind}: it does not start with a number; write for example {}", .kind.example())]
    NotANumber {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
    /// A comma as decimal mark.
    #[error("`{text}` has a comma; write the decimal mark as a point and no thousands separators")]
    Comma {
        /// What was read.
        text: String,
    },
    /// NaN, infinity or a number too large for double precision.
    #[error("`{text}` is not a finite number; write for example {}", .kind.example())]
    NotFinite {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
    /// A number alone.
    #[error("`{text}` has no unit; write for example {}, or another of: {}", .kind.example(), .kind.units_listed())]
    NoUnit {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
    /// A unit that does not exist or does not fit.
    #[error("`{text}`: unknown {kind} unit `{unit}`{hint}; accepted: {}", .kind.units_listed())]
    UnknownUnit {
        /// What was read.
        text: String,
        /// The unit.
        unit: String,
        /// What was expected.
        kind: Kind,
        /// What may have been meant, starting with a comma, or nothing.
        hint: String,
    },
    /// A pressure that may be absolute or gauge.
    #[error(
        "`{text}` may be absolute or gauge; write `{number}{unit}a` (absolute) or `{number}{unit}g` (above ambient)"
    )]
    AbsoluteOrGauge {
        /// What was read.
        text: String,
        /// Its number.
        number: String,
        /// Its unit.
        unit: String,
    },
    /// A tube that does not say its two diameters.
    #[error("`{text}` is no tube; write bore x outer diameter with their unit, as 10x14mm")]
    NoTube {
        /// What was read.
        text: String,
    },
    /// Zero where it means nothing.
    #[error("`{text}` is zero; a {kind} must be more than that")]
    Zero {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
    /// Negative where it means nothing.
    #[error(
        "`{text}` is negative; a {kind} must be positive (a dose runs in reverse by --reverse or a negative volume)"
    )]
    Negative {
        /// What was read.
        text: String,
        /// What was expected.
        kind: Kind,
    },
}
