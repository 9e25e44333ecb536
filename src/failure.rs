//! Why a command did not do what was asked, and the exit code that says so.

use std::io;
use std::path::Path;

use pump_bench::calibration::CalibrationError;
use pump_bench::record::FolderError;
use pump_bench::report::{Ending, ErrorFacts, ErrorKind, ErrorReport, Explain};
use pump_bench::setup::SetupError;
use pump_bench::{DoseError, Session};

use crate::advice;
use crate::interrupt::{self, Unwatched};
use crate::shown::json_shown;
use crate::told_commands::{completed, setup_asks_again, setup_that_was_left};

/// The reason why a command did not do what was asked: words for people, facts for programs.
#[derive(Debug)]
pub(crate) struct Failure {
    how: How,
    facts: ErrorFacts,
    message: Box<str>,
    /// Smallest and largest volume that was delivered, in mL; none if nobody knows.
    delivered_ml: Option<(f64, f64)>,
    /// Name of the pump of a rack that failed; none for a pump by itself, and if no single one did.
    pump: Option<Box<str>>,
}

/// Words of a stop by a signal.
const BY_USER: &str = "stopped by the user";

/// The volume of a command in which nothing moved, in mL.
const NOTHING: Option<(f64, f64)> = Some((0.0, 0.0));

/// The ways to fail, by whether anything moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum How {
    /// Refused before anything moved.
    Refused,
    /// Another process holds the pump or its device.
    Busy,
    /// An unfinished dose stands in the way.
    Unfinished,
    /// The pump stands at a safety limit. `moved` is true if it moved in this command before.
    Stands { moved: bool },
    /// Something went wrong after motion began.
    Fault,
    /// The command did what was asked, and its result is not good enough.
    Failed,
    /// The user stopped it by this signal, and the volume that was delivered is on record.
    Stopped { signal: i32, moved: bool },
}

impl Failure {
    /// A refusal of the command line's words before anything moved.
    pub(crate) fn refused(message: impl ToString) -> Self {
        Self::new(How::Refused, ErrorKind::Usage, message)
    }

    /// An error of the library: it knows its facts, its remedies, and whether anything moved.
    pub(crate) fn of(error: impl Explain) -> Self {
        let how = match error.ending() {
            Ending::Refused => How::Refused,
            Ending::Busy => How::Busy,
            Ending::Unfinished => How::Unfinished,
            Ending::Stands => How::Stands { moved: false },
            Ending::Stopped => How::Stopped { signal: interrupt::signal().unwrap_or(0), moved: false },
            Ending::Moved => How::Fault,
        };
        Self {
            how,
            facts: error.facts(),
            message: advice::told(&error).into(),
            delivered_ml: NOTHING,
            pump: None,
        }
    }

    /// A file that cannot be read.
    pub(crate) fn unread(path: &Path, error: &io::Error) -> Self {
        let facts = ErrorFacts::of_file(ErrorKind::Input, path, error);
        let message = format!("cannot read {}: {error}", path.display());
        Self { how: How::Refused, facts, message: message.into(), delivered_ml: NOTHING, pump: None }
    }

    /// A file that cannot be written.
    pub(crate) fn unwritten(path: &Path, error: &io::Error) -> Self {
        let facts = ErrorFacts::of_file(ErrorKind::Output, path, error);
        let path_shown = path.display();
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
        let message = match folder.filter(|_| error.kind() == io::ErrorKind::NotFound) {
            Some(folder) => {
                let folder = folder.display();
                format!("cannot write {path_shown}: there is no folder {folder}; make it, or name another")
            }
            None => format!("cannot write {path_shown}: {error}"),
        };
        Self { how: How::Refused, facts, message: message.into(), delivered_ml: NOTHING, pump: None }
    }

    /// A fault after motion began.
    pub(crate) fn fault(kind: ErrorKind, message: impl ToString) -> Self {
        Self::new(How::Fault, kind, message)
    }

    /// A result that is not good enough. Nothing else went wrong, and whether the pump moved is another question.
    pub(crate) fn failed(kind: ErrorKind, message: impl ToString) -> Self {
        Self::new(How::Failed, kind, message)
    }

    /// A stop by this signal, of which `message` tells as of one by the user. `moved` is true if the pump moved before.
    pub(crate) fn stopped(signal: i32, moved: bool, message: impl ToString) -> Self {
        let message = message.to_string();
        // A supervising program stops for reasons of its own, as a guard does.
        let message = match interrupt::reason() {
            Some(reason) => message.replacen(BY_USER, &format!("stopped by {reason}"), 1),
            None => message,
        };
        Self::new(How::Stopped { signal, moved }, ErrorKind::Stopped, message)
    }

    fn new(how: How, kind: ErrorKind, message: impl ToString) -> Self {
        Self {
            how,
            facts: ErrorFacts::of(kind),
            message: message.to_string().into(),
            delivered_ml: NOTHING,
            pump: None,
        }
    }

    /// The failure after a volume between these was delivered, in mL.
    pub(crate) fn delivered(self, (least_ml, most_ml): (f64, f64)) -> Self {
        let delivered_ml = self.delivered_ml.map(|(least, most)| (least + least_ml, most + most_ml));
        Self { delivered_ml, ..self }
    }

    /// The smallest and the largest volume that was delivered, in mL; none if nobody knows.
    pub(crate) fn delivered_ml(&self) -> Option<(f64, f64)> {
        self.delivered_ml
    }

    /// The failure of this pump of a rack.
    pub(crate) fn of_pump(self, pump: Option<String>) -> Self {
        Self { pump: pump.map(Into::into), ..self }
    }

    /// The name of the pump of a rack that failed.
    pub(crate) fn pump(&self) -> Option<&str> {
        self.pump.as_deref()
    }

    /// The word of the kind.
    pub(crate) fn kind_word(&self) -> &'static str {
        self.facts.kind.as_str()
    }

    /// The failure as one of this kind.
    pub(crate) fn kind(mut self, kind: ErrorKind) -> Self {
        self.facts.kind = kind;
        self
    }

    /// The failure with the value that is wrong.
    pub(crate) fn value(self, value: impl ToString) -> Self {
        Self { facts: self.facts.value(value.to_string()), ..self }
    }

    /// The failure with the values that are allowed.
    pub(crate) fn allowed(self, allowed: impl ToString) -> Self {
        Self { facts: self.facts.allowed(allowed.to_string()), ..self }
    }

    /// The failure of a command that had moved the pump before: a refusal of its later part is a fault of the whole.
    pub(crate) fn after_motion(self) -> Self {
        let how = match self.how {
            How::Stopped { signal, .. } => How::Stopped { signal, moved: true },
            How::Stands { .. } => How::Stands { moved: true },
            How::Refused | How::Busy | How::Unfinished | How::Failed | How::Fault => How::Fault,
        };
        Self { how, ..self }
    }

    /// The failure of a command that has moved something before, if `moved`: it tells nothing of that volume.
    pub(crate) fn after_earlier_motion(self, moved: bool) -> Self {
        if moved { Self { delivered_ml: None, ..self.after_motion() } } else { self }
    }

    /// The failure of a command with a session that may have turned the motor before.
    pub(crate) fn of_session(self, session: &Session<'_>) -> Self {
        if !session.has_moved() {
            return self;
        }
        // A turn to the sensor or the rest of an earlier dose has pumped, and this failure tells nothing of it.
        let delivered_ml = self.delivered_ml.filter(|known| Some(*known) != NOTHING);
        Self { delivered_ml, ..self.after_motion() }
    }

    /// True if nothing moved and nothing stands in the way.
    pub(crate) fn is_refusal(&self) -> bool {
        self.how == How::Refused
    }

    /// True if nothing moved: the command was refused, or stopped before it.
    pub(crate) fn moved_nothing(&self) -> bool {
        self.is_any_refusal() || matches!(self.how, How::Stopped { moved: false, .. })
    }

    /// True if nothing moved: the command was refused, whatever stands in the way.
    pub(crate) fn is_any_refusal(&self) -> bool {
        matches!(self.how, How::Refused | How::Busy | How::Unfinished | How::Stands { moved: false })
    }

    /// True if the motor's controller cannot be used or failed.
    pub(crate) fn is_of_drive(&self) -> bool {
        self.facts.kind == ErrorKind::Drive
    }

    /// The failure with more to say.
    pub(crate) fn with(mut self, more: &str) -> Self {
        self.message = format!("{}{more}", self.message).into();
        self
    }

    /// The failure with words before its message.
    pub(crate) fn after(mut self, words: &str) -> Self {
        self.message = format!("{words}{}", self.message).into();
        self
    }

    /// The failure with other words.
    pub(crate) fn saying(self, message: String) -> Self {
        Self { message: message.into(), ..self }
    }

    /// The failure with its commands completed, as those of the pump that is meant now.
    pub(crate) fn completed(self) -> Self {
        let message = completed(&self.message).into_owned();
        self.saying(message)
    }

    /// The message for people.
    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    /// The report for programs, one line of JSON.
    pub(crate) fn json(&self) -> String {
        let moved = match self.how {
            How::Refused | How::Busy | How::Unfinished | How::Failed => false,
            How::Fault => true,
            How::Stopped { moved, .. } | How::Stands { moved } => moved,
        };
        let message = self.message.lines().map(str::trim).collect::<Vec<_>>().join(" ");
        let message = completed(&message);
        json_shown(&ErrorReport::new(self.exit_code(), &self.facts, &message, moved).json()).into_owned()
    }

    /// The exit code of the command.
    pub(crate) fn exit_code(&self) -> u8 {
        match self.how {
            How::Fault | How::Failed => 1,
            How::Refused => 2,
            How::Busy => 3,
            How::Unfinished => 4,
            How::Stands { .. } => 5,
            How::Stopped { signal, .. } => 128 + u8::try_from(signal).unwrap_or(0),
        }
    }
}

impl From<Unwatched> for Failure {
    fn from(Unwatched(error): Unwatched) -> Self {
        Self::refused(format!("signals cannot be watched for: {error}"))
    }
}

impl From<DoseError> for Failure {
    fn from(error: DoseError) -> Self {
        let delivered_ml = error.delivered_ml();
        let left = match &error {
            DoseError::Unconfirmed { pump, .. } => {
                setup_that_was_left(pump).or_else(|| setup_asks_again(pump))
            }
            _ => None,
        };
        let is_unconfirmed = matches!(&error, DoseError::Drive { .. }) && interrupt::signal().is_some();
        let failure = Self { delivered_ml, ..Self::of(error) };
        match left {
            // A stop that no board has confirmed is a fault: the steps that were made are not known.
            None if is_unconfirmed => failure.with("; the stop that you asked for was not confirmed"),
            Some(left) => failure.with(&format!("; {left}")),
            None => failure,
        }
    }
}

impl From<FolderError> for Failure {
    fn from(error: FolderError) -> Self {
        Self::of(error)
    }
}

impl From<SetupError> for Failure {
    fn from(error: SetupError) -> Self {
        Self::of(error)
    }
}

impl From<CalibrationError> for Failure {
    fn from(error: CalibrationError) -> Self {
        Self::of(error)
    }
}
