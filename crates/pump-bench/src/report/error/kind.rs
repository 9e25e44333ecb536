//! The kinds of error that a program can tell apart.

use crate::words::words_of_reports;

/// Kind of an error. `docs/errors.md` documents each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The words of the command line cannot be obeyed.
    Usage,
    /// A text is no quantity of its kind.
    Quantity,
    /// A value is outside its range.
    Range,
    /// The request would exceed a limit of the pump, the motor, the tube or the calibration.
    Limit,
    /// The request cannot be planned from where the rollers stand.
    Plan,
    /// The model cannot compute this pump, line or motion.
    Model,
    /// A pump file is wrong, or there is no such pump.
    PumpFile,
    /// The configuration is wrong, or its names contradict one another.
    Config,
    /// The file of a rack is wrong, or its pumps cannot run together.
    Rack,
    /// A file cannot be read.
    Input,
    /// A file or the report cannot be written.
    Output,
    /// A table of measurements is wrong.
    Table,
    /// The measurements do not determine a line.
    Identification,
    /// A calibration cannot be made or used.
    Calibration,
    /// The doses of a verification are not within their tolerance.
    Tolerance,
    /// The balance under the vessel cannot be read.
    Balance,
    /// The rollers' angle is not known or not found.
    Angle,
    /// The record cannot be read or written, or has nothing of the kind that was asked for.
    Record,
    /// The thing that the words are about has changed since.
    Changed,
    /// The motor's controller cannot be used or failed.
    Drive,
    /// Another process holds the pump or its device.
    Busy,
    /// An unfinished dose is on record.
    Unfinished,
    /// The pump stands at a safety limit or by order, or is not cleared.
    Safety,
    /// A dose of a batch was skipped: its time had passed.
    Missed,
    /// A person or a signal stopped the command.
    Stopped,
}

words_of_reports!(ErrorKind {
    Usage = "usage",
    Quantity = "quantity",
    Range = "range",
    Limit = "limit",
    Plan = "plan",
    Model = "model",
    PumpFile = "pump_file",
    Config = "config",
    Rack = "rack",
    Input = "input",
    Output = "output",
    Table = "table",
    Identification = "identification",
    Calibration = "calibration",
    Tolerance = "tolerance",
    Balance = "balance",
    Angle = "angle",
    Record = "record",
    Changed = "changed",
    Drive = "drive",
    Busy = "busy",
    Unfinished = "unfinished",
    Safety = "safety",
    Missed = "missed",
    Stopped = "stopped",
});
