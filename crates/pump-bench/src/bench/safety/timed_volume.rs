//! A volume of a series with its time.

/// Volume that a pump is to move at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedVolume {
    /// Time from now on, in s.
    pub at_s: f64,
    /// Volume, in mL. Negative in reverse.
    pub volume_ml: f64,
}
