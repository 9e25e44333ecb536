//! Messages by which a board says that it no longer does what it was told.

use super::dictionary::Dictionary;
use super::error::KlipperError;
use super::protocol::{Message, MessageError};

/// Returns the fault that a message of the board tells. `None` if it tells none.
///
/// Source: Klipper3d/klipper, `src/sched.c` and `src/basecmd.c`: `shutdown` comes once, `is_shutdown` for each command
/// that a board which has shut down does not carry out, and `starting` after a reset.
pub(super) fn fault(
    message: &Message,
    dictionary: &Dictionary,
) -> Result<Option<KlipperError>, MessageError> {
    Ok(match message.name() {
        "shutdown" | "is_shutdown" => {
            let reason = dictionary.firmware_text(message.unsigned("static_string_id")?);
            Some(KlipperError::Shutdown { reason })
        }
        "starting" => Some(KlipperError::Reset),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::klipper::dictionary::Download;
    use crate::drives::klipper::protocol::Value;

    fn board() -> Dictionary {
        let bytes = include_bytes!("dictionary/samples/board.zlib");
        let mut download = Download::default();
        download.take(0, bytes).unwrap();
        download.take(bytes.len() as u32, &[]).unwrap().unwrap()
    }

    /// Returns the fault that a message of the board tells, in words.
    fn told(format: &str, values: &[u32]) -> Option<String> {
        let board = board();
        let values: Vec<_> = values.iter().map(|value| Value::from(*value)).collect();
        let content = board.response(format).unwrap().encode(&values).unwrap();
        fault(&board.read(&content).unwrap()[0], &board).unwrap().map(|fault| fault.to_string())
    }

    #[test]
    fn a_shutdown_is_told_with_its_reason() {
        let told = |format, values: &[u32]| told(format, values).unwrap();
        assert_eq!(
            told("shutdown clock=%u static_string_id=%hu", &[7, 2]),
            "the board has shut itself down: Timer too close (a step came too late: this computer or the line was held \
             up); its motors are without steps until it is reset"
        );
        assert!(told("is_shutdown static_string_id=%hu", &[3]).contains("down: Move queue overflow ("));
        assert!(told("is_shutdown static_string_id=%hu", &[99]).contains("down: reason 99, which"));
    }

    #[test]
    fn a_reset_is_told_and_other_messages_are_none() {
        let reset = "the board was reset, or lost its supply for a moment; its motor may have moved";
        assert_eq!(told("starting", &[]).as_deref(), Some(reset));
        assert_eq!(told("clock clock=%u", &[7]), None);
    }
}
