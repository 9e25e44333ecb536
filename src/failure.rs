//! Why a command did not do what was asked, and the exit code that says so.

use pump_bench::DoseError;
use pump_bench::calibration::CalibrationError;
use pump_bench::record::FolderError;
use pump_bench::report::Ending;

/// The reason why a command did not do what was asked, in words.
#[derive(Debug)]
pub(crate) struct Failure {
    kind: Kind,
    message: String,
}

/// The kinds of failure, by whether anything moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Refused before anything moved.
    Refused,
    /// Another process holds the pump or its device.
    Busy,
    /// An unfinished dose stands in the way.
    Unfinished,
    /// Something went wrong after motion began.
    Fault,
    /// The user stopped it by this signal, and the volume that was delivered is on record.
    Stopped(i32),
}

impl Failure {
    /// A refusal before anything moved.
    pub(crate) fn refused(message: impl ToString) -> Self {
        Self { kind: Kind::Refused, message: message.to_string() }
    }

    /// A fault after motion began.
    pub(crate) fn fault(message: impl ToString) -> Self {
        Self { kind: Kind::Fault, message: message.to_string() }
    }

    /// A stop by this signal.
    pub(crate) fn stopped(signal: i32, message: impl ToString) -> Self {
        Self { kind: Kind::Stopped(signal), message: message.to_string() }
    }

    /// The failure of a command that had moved the pump before: a refusal of its later part is a fault of the whole.
    pub(crate) fn after_motion(self) -> Self {
        let kind = if self.kind == Kind::Refused { Kind::Fault } else { self.kind };
        Self { kind, ..self }
    }

    /// True if nothing moved and nothing stands in the way.
    pub(crate) fn is_refusal(&self) -> bool {
        self.kind == Kind::Refused
    }

    /// The failure with more to say.
    pub(crate) fn with(mut self, more: &str) -> Self {
        self.message.push_str(more);
        self
    }

    /// The message for people.
    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    /// The exit code of the command.
    pub(crate) fn exit_code(&self) -> u8 {
        match self.kind {
            Kind::Fault => 1,
            Kind::Refused => 2,
            Kind::Busy => 3,
            Kind::Unfinished => 4,
            Kind::Stopped(signal) => 128 + u8::try_from(signal).unwrap_or(0),
        }
    }

    fn ended(ending: Ending, message: String) -> Self {
        let kind = match ending {
            Ending::Refused => Kind::Refused,
            Ending::Busy => Kind::Busy,
            Ending::Unfinished => Kind::Unfinished,
            Ending::Moved => Kind::Fault,
        };
        Self { kind, message }
    }
}

impl From<DoseError> for Failure {
    fn from(error: DoseError) -> Self {
        Self::ended(error.ending(), error.to_string())
    }
}

impl From<FolderError> for Failure {
    fn from(error: FolderError) -> Self {
        Self::ended(error.ending(), error.to_string())
    }
}

impl From<CalibrationError> for Failure {
    fn from(error: CalibrationError) -> Self {
        Self::refused(error)
    }
}
