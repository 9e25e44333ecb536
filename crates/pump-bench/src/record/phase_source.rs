//! The source of the rotor's angle.

use serde::{Deserialize, Serialize};

use crate::words::words;

/// Source of the rotor's angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PhaseSource {
    /// The angle was set by hand or found by a sensor. A fresh simulated pump stands at 0 deg.
    Home,
    /// The rotor's mark was turned to the housing's mark.
    Mark,
    /// The angle follows from the record of motion since it was found.
    #[default]
    Recorded,
    /// The request gave the angle.
    Given,
    /// The angle is unknown: the middle of the possible angles stands for it.
    Assumed,
}

words!(PhaseSource {
    Home = "home",
    Mark = "mark",
    Recorded = "recorded",
    Given = "given",
    Assumed = "assumed",
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_and_reports_name_a_source_by_its_word() {
        for source in PhaseSource::ALL {
            assert_eq!(serde_json::to_string(source).unwrap(), format!("\"{source}\""));
            assert_eq!(source.as_str().parse(), Ok(*source));
        }
    }
}
