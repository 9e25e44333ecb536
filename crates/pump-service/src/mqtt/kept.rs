//! The volume that a pump's button `Dose` doses.

use crate::history::{History, HistoryError};

/// Returns the kept volume of a pump as a number in mL.
pub(super) fn kept(history: &History, pump: &str) -> Result<Option<String>, HistoryError> {
    history.word(&word(pump))
}

/// Keeps a volume, mL. Returns it as it is kept.
pub(super) fn keep(history: &History, pump: &str, volume_ml: f64) -> Result<String, HistoryError> {
    let text = volume_ml.to_string();
    history.keep_word(&word(pump), &text)?;
    Ok(text)
}

fn word(pump: &str) -> String {
    format!("mqtt volume {pump}")
}
