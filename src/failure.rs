//! Why a command did not do what was asked, and the exit code that says so.

use std::io::{self, ErrorKind, Write};

use pump_bench::DoseError;
use pump_bench::calibration::CalibrationError;
use pump_bench::dosing::ErrorClass;
use pump_bench::record::FolderError;

/// Why the command did not do what was asked.
pub(crate) enum Failure {
    /// Refused before anything moved: exit code 2.
    Refused(String),
    /// Another process holds the pump: exit code 3.
    Busy(String),
    /// An unfinished dose stands in the way: exit code 4.
    Unfinished(String),
    /// Something went wrong after motion began: exit code 1.
    Fault(String),
    /// The user stopped it by this signal, and what was delivered is recorded: exit code 128 + the signal's number.
    Stopped(i32, String),
}

impl Failure {
    /// A refusal with this message.
    pub(crate) fn refused(message: impl ToString) -> Self {
        Self::Refused(message.to_string())
    }

    /// The same failure with more to say.
    pub(crate) fn with(mut self, more: &str) -> Self {
        let (Self::Refused(message)
        | Self::Busy(message)
        | Self::Unfinished(message)
        | Self::Fault(message)
        | Self::Stopped(_, message)) = &mut self;
        message.push_str(more);
        self
    }
}

impl From<DoseError> for Failure {
    fn from(error: DoseError) -> Self {
        let message = error.to_string();
        match error.class() {
            ErrorClass::Refused => Self::Refused(message),
            ErrorClass::Busy => Self::Busy(message),
            ErrorClass::Unfinished => Self::Unfinished(message),
            ErrorClass::Fault => Self::Fault(message),
        }
    }
}

impl From<CalibrationError> for Failure {
    fn from(error: CalibrationError) -> Self {
        Self::Refused(error.to_string())
    }
}

impl From<FolderError> for Failure {
    fn from(error: FolderError) -> Self {
        DoseError::from(error).into()
    }
}

/// Prints to standard output. A reader that went away is no failure of the dose.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    match io::stdout().write_all(text.as_bytes()).and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Refused(format!("the report could not be printed: {error}")))
        }
        _ => Ok(()),
    }
}
