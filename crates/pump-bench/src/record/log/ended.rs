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

impl LogEnd {
    /// Returns the end in words, with its cause if one is on record.
    pub(crate) fn told(self, cause: Option<&str>) -> String {
        let because = cause.map_or(String::new(), |cause| format!(" ({cause})"));
        match self {
            Self::Done => format!("done{because}"),
            Self::Weighed => format!("ended by the balance{because}"),
            Self::Stopped => format!("stopped by {}", cause.unwrap_or("the user")),
            Self::Fault => format!("ended by a fault{because}"),
            Self::CutOff => format!("cut off: the process ended{because}"),
        }
    }
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
