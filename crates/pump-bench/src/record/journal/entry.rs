//! The entries of a journal.

use serde::{Deserialize, Serialize};

use crate::record::{Intent, LogEntry, PumpState};

/// Entry of a journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[allow(
    clippy::large_enum_variant,
    reason = "entries are written and read one at a time, never kept in numbers"
)]
pub(crate) enum Entry {
    /// A journal begins: its first line.
    Begins {
        /// Format of the journal's lines.
        format: u32,
    },
    /// A motion is about to begin.
    Intent(Intent),
    /// The motion under way made `made` steps. Before the next entry it makes up to `may`.
    Progress {
        /// Steps known to be made.
        made: u64,
        /// Most steps that may be made before the next entry.
        may: u64,
    },
    /// The rotor stands.
    Rest {
        /// Time of the entry by the system clock, in seconds since 1970. Only people read it.
        unix_s: u64,
        /// Reason for which the rotor stands.
        why: Why,
        /// State of the pump.
        state: PumpState,
        /// Dose that ended, for the log. `None` if none did.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        dose: Option<LogEntry>,
        /// Reason of a person. `None` where nobody gives one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reason: Option<String>,
    },
}

/// Reason for which the rotor stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Why {
    /// The dose was delivered.
    Done,
    /// The user stopped the dose.
    Stopped,
    /// The drive failed, or the journal could not be written.
    Fault,
    /// The process that ran the dose ended before it could record the end.
    CutOff,
    /// The user accepted an unfinished dose.
    Discarded,
    /// A balance ended the dose.
    Weighed,
    /// The user set the rotor's angle.
    Set,
    /// The rotor's angle was found by the mark.
    Mark,
    /// The rotor's angle was found by the index sensor.
    Sensor,
    /// The device was met in another state than it was left in.
    Met,
    /// The motor was released.
    Released,
    /// The tube was replaced.
    NewTube,
    /// The user confirmed values of the pump that the program had filled in.
    Confirmed,
    /// A motion would have exceeded a safety limit, or the pump was ordered to stand.
    Stands,
    /// A person cleared the stand.
    Cleared,
    /// The receiving vessel was emptied.
    Emptied,
}
