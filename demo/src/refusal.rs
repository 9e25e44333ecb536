//! The reason why a dose is not planned, in the words of the libraries.

use core::fmt;

use pump_ctl::plan::PlanError;
use pump_model::ModelError;

/// The reason why a dose is not planned.
#[derive(Debug)]
pub(crate) enum Refusal {
    /// The head has a number of rollers that is not allowed.
    Rollers(f64),
    /// The model refuses the head or the line.
    Model(ModelError),
    /// The planner refuses the dose.
    Plan(PlanError),
}

impl From<ModelError> for Refusal {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

impl From<PlanError> for Refusal {
    fn from(error: PlanError) -> Self {
        Self::Plan(error)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rollers(rollers) => write!(to, "number of rollers is {rollers}; allowed: whole, 2 to 24"),
            // Text of an error leaves out that of its source.
            Self::Plan(PlanError::Model(error)) | Self::Model(error) => error.fmt(to),
            Self::Plan(error) => error.fmt(to),
        }
    }
}

/// A text of fixed room. The end is cut off where it does not fit.
#[derive(Debug)]
pub(crate) struct Words {
    bytes: [u8; 512],
    length: usize,
}

impl Words {
    /// No words.
    pub(crate) const NONE: Self = Self { bytes: [0; 512], length: 0 };

    /// Returns the words as UTF-8.
    pub(crate) fn as_bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

impl fmt::Write for Words {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for c in text.chars() {
            let Some(room) = self.bytes.get_mut(self.length..self.length + c.len_utf8()) else {
                return Err(fmt::Error);
            };
            c.encode_utf8(room);
            self.length += c.len_utf8();
        }
        Ok(())
    }
}
