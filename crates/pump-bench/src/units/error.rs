//! Texts that are no quantity.

use thiserror::Error;

use super::kind::Kind;

/// A text that is not a quantity of the expected kind.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// The text is empty.
    #[error("empty {kind}; write it with its unit, as in {}", .kind.example())]
    Empty {
        /// Kind of quantity that was expected.
        kind: Kind,
    },
    /// The text does not start with a number.
    #[error(
        "`{text}` is not {}: it does not start with a number; write for example {}",
        .kind.with_article(), .kind.example()
    )]
    NotANumber {
        /// Text that was read.
        text: String,
        /// Kind of quantity that was expected.
        kind: Kind,
    },
    /// The number has a comma, as decimal mark or between thousands.
    #[error("`{text}` has a comma; write the decimal mark as a point and no thousands separators")]
    Comma {
        /// Text that was read.
        text: String,
    },
    /// The number is NaN, infinite or too large for double precision.
    #[error("`{text}` is not a finite number; write for example {}", .kind.example())]
    NotFinite {
        /// Text that was read.
        text: String,
        /// Kind of quantity that was expected.
        kind: Kind,
    },
    /// The number has no unit.
    #[error(
        "`{text}` has no unit; write for example {}, or another of: {}",
        .kind.example(), .kind.units_listed()
    )]
    NoUnit {
        /// Text that was read.
        text: String,
        /// Kind of quantity that was expected.
        kind: Kind,
    },
    /// The unit does not exist or does not fit.
    #[error("`{text}`: unknown {kind} unit `{unit}`{hint}; accepted: {}", .kind.units_listed())]
    UnknownUnit {
        /// Text that was read.
        text: String,
        /// Unit that was read.
        unit: String,
        /// Kind of quantity that was expected.
        kind: Kind,
        /// Unit that may have been meant, after a comma. Empty if no unit is near.
        hint: String,
    },
    /// The pressure may be absolute or gauge.
    #[error(
        "`{text}` may be absolute or gauge; write `{number}{unit}a` (absolute) or \
         `{number}{unit}g` (above ambient)"
    )]
    AbsoluteOrGauge {
        /// Text that was read.
        text: String,
        /// Number that was read.
        number: String,
        /// Unit that was read.
        unit: String,
    },
    /// The tube lacks one of its two diameters.
    #[error("`{text}` is not a tube; write bore x outer diameter with their unit, such as 10x14mm")]
    NoTube {
        /// Text that was read.
        text: String,
    },
    /// The tube's outer diameter is not more than its bore.
    #[error(
        "`{text}` has no wall: the outer diameter, {outer_mm} mm, must be more than the bore, {bore_mm} mm; write the \
         bore first, as 10x14mm"
    )]
    NoWall {
        /// Text that was read.
        text: String,
        /// Bore that was said, in mm.
        bore_mm: f64,
        /// Outer diameter that was said, in mm.
        outer_mm: f64,
    },
    /// The hose lacks its tube or its length.
    #[error("`{text}` is no hose; write bore x outer diameter and the length, as 6x10mm,1m")]
    NoHose {
        /// Text that was read.
        text: String,
    },
    /// The sign of a tolerance follows an angle, and no tolerance follows the sign.
    #[error("`{text}` has no tolerance; write for example 30deg+-1deg")]
    NoTolerance {
        /// Text that was read.
        text: String,
    },
    /// The tolerance of an angle is outside its range.
    #[error(
        "`{text}` is no tolerance of an angle: it is {tolerance_deg} deg; allowed: 0 to {most_deg} deg, as in \
         30deg+-1deg"
    )]
    Tolerance {
        /// Text that was read.
        text: String,
        /// Tolerance that was read, in deg.
        tolerance_deg: String,
        /// Largest tolerance that is allowed, in deg.
        most_deg: String,
    },
    /// The text is no whole number within a range.
    #[error("{name} is {text}; allowed: whole numbers from {least} to {most}")]
    Count {
        /// Name of the number, as `number of rollers`.
        name: &'static str,
        /// Text that was read.
        text: String,
        /// Least number that is allowed.
        least: u32,
        /// Largest number that is allowed.
        most: u32,
    },
    /// The quantity is zero, where zero means nothing.
    #[error("`{text}` is zero; {} must be more than that", .kind.with_article())]
    Zero {
        /// Text that was read.
        text: String,
        /// Kind of quantity that was expected.
        kind: Kind,
    },
    /// The quantity is beyond the range in which it is likely to be meant.
    #[error("`{text}` is out of range; allowed: {allowed}")]
    OutOfRange {
        /// Text that was read.
        text: String,
        /// Range that is allowed, and what to write instead.
        allowed: &'static str,
    },
    /// The quantity is negative, where a negative one means nothing.
    #[error(
        "`{text}` is negative; {} must be positive (only the volume of a dose may be negative: it runs in \
         reverse)",
        .kind.with_article()
    )]
    Negative {
        /// Text that was read.
        text: String,
        /// Kind of quantity that was expected.
        kind: Kind,
    },
}
