//! The end of a dose in the log.

use serde::{Deserialize, Serialize};

use crate::words::words;

/// End of a dose in the log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum LogEnd {
    /// The dose was delivered.
    Done,
    /// A balance ended the dose.
    Weighed,
    /// The user stopped the dose.
    Stopped,
    /// The drive failed, the journal could not be written, or the balance could not be read.
    Fault,
    /// The process that ran the dose ended before it could record the end.
    CutOff,
}

words!(LogEnd {
    Done = "done",
    Weighed = "weighed",
    Stopped = "stopped",
    Fault = "fault",
    CutOff = "cut-off",
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_and_reports_name_an_end_by_its_word() {
        for end in LogEnd::ALL {
            assert_eq!(serde_json::to_string(end).unwrap(), format!("\"{end}\""));
        }
    }
}
