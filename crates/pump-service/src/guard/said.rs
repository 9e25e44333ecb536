//! The word of an input as a program says it, over HTTP or as a message of MQTT.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::input::Word;

/// Word of an input of the guard.
#[derive(Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = InputBody)]
pub(crate) struct Said {
    /// True if all is well.
    #[schema(example = false)]
    pub(crate) ok: bool,
    /// Reason why not. An input that is well needs none.
    #[schema(example = "water under the rack")]
    pub(crate) reason: Option<String>,
}

/// Returns the word of a message. Nobody is there to hear that it cannot be read, so such a one says that all is not
/// well. `None` for one that says nothing: an empty one, and a good word that the broker has kept, whose age nobody
/// knows.
pub(super) fn word_of_message(payload: &[u8], is_retained: bool) -> Option<Word> {
    if payload.trim_ascii().is_empty() {
        // A retained message was deleted.
        return None;
    }
    match serde_json::from_slice(payload) {
        Ok(Said { ok: true, .. }) => (!is_retained).then_some(Word::Well),
        Ok(Said { ok: false, reason }) => Some(Word::bad(&reason.unwrap_or_default())),
        Err(error) => Some(Word::bad(&format!("its message cannot be read: {error}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_message_is_heard_only_where_it_says_that_all_is_not_well() {
        let (good, bad) = (br#"{"ok": true}"#, br#"{"ok": false, "reason": "empty"}"#);
        assert_eq!(word_of_message(good, false), Some(Word::Well));
        assert_eq!(word_of_message(good, true), None);
        for is_retained in [false, true] {
            assert_eq!(word_of_message(bad, is_retained), Some(Word::bad("empty")));
            assert_eq!(word_of_message(b" \n", is_retained), None);
        }
    }

    #[test]
    fn a_message_that_cannot_be_read_says_that_all_is_not_well() {
        for payload in [&b"OK"[..], b"{}", b"{\"ok\": \"yes\"}", b"{\"ok\": true, \"level\": 3}", b"\xff"] {
            let Some(Word::Bad(reason)) = word_of_message(payload, false) else { panic!("{payload:?}") };
            assert!(reason.starts_with("its message cannot be read: "), "{reason}");
        }
    }
}
