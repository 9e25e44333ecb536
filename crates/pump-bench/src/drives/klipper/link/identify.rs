//! The board's dictionary over a link.

use std::sync::Arc;

use super::link::Link;
use crate::drives::klipper::dictionary::{Dictionary, DictionaryError, Download};
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::protocol::Format;

/// Question for a piece of the dictionary, whose number is fixed.
///
/// Source: Klipper3d/klipper, `docs/Protocol.md`, "Data Dictionary".
const QUESTION: (i32, &str) = (1, "identify offset=%u count=%c");

/// Answer with a piece of the dictionary, whose number is fixed.
///
/// Source: Klipper3d/klipper, `docs/Protocol.md`, "Data Dictionary".
const ANSWER: (i32, &str) = (0, "identify_response offset=%u data=%.*s");

impl Link {
    /// Reads the board's dictionary.
    pub(in crate::drives::klipper) fn identify(&mut self) -> Result<Dictionary, KlipperError> {
        let format = |(id, string): (i32, &str)| {
            let unreadable = || DictionaryError::Entry { entry: "message", text: string.to_owned() };
            Format::new(id, string).ok_or_else(unreadable)
        };
        let (question, answer) = (format(QUESTION)?, Arc::new(format(ANSWER)?));
        let mut download = Download::default();
        loop {
            let (place, count) = download.wanted();
            let piece = self.ask(&question, &[place.into(), count.into()], |_, _, arrival| {
                let mut content = arrival.content.as_slice();
                if Format::take_id(&mut content)? != answer.id() {
                    return Ok(None);
                }
                let message = answer.take(&mut content)?;
                // A piece for another place is an answer that came twice.
                let fits = message.unsigned("offset")? == place;
                Ok(if fits { Some(message.bytes("data")?.to_vec()) } else { None })
            })?;
            if let Some(dictionary) = download.take(place, &piece)? {
                return Ok(dictionary);
            }
        }
    }
}
