//! The dictionary as it comes: compressed JSON.

use std::collections::BTreeMap;

use miniz_oxide::inflate::{TINFLStatus, decompress_to_vec_zlib_with_limit};
use serde::Deserialize;
use serde_json::Value;

use super::error::DictionaryError;

/// Most bytes of a dictionary's JSON: some 30 times that of a large board with every option of the firmware.
const JSON_MOST: usize = 1 << 20;

/// Dictionary as JSON has it. Keys that are not named here say nothing that a drive needs.
///
/// Source: Klipper3d/klipper, `docs/Protocol.md`, and the keys that its host reads (`klippy/msgproto.py`).
#[derive(Debug, Deserialize)]
pub(super) struct Document {
    /// Formats of the commands, and their numbers.
    pub(super) commands: BTreeMap<String, i32>,
    /// Formats of the messages, and their numbers.
    pub(super) responses: BTreeMap<String, i32>,
    /// Formats of the outputs for people, and their numbers.
    #[serde(default)]
    pub(super) output: BTreeMap<String, i32>,
    /// Names for numbers, by the parameter that they are for.
    #[serde(default)]
    pub(super) enumerations: BTreeMap<String, BTreeMap<String, Value>>,
    /// Constants.
    #[serde(default)]
    pub(super) config: BTreeMap<String, Value>,
    /// Name of the firmware. Old firmware has none.
    #[serde(default)]
    pub(super) app: Option<String>,
    /// Version of the firmware.
    #[serde(default)]
    pub(super) version: String,
}

impl Document {
    /// Reads a dictionary as the board sends it.
    pub(super) fn of_compressed(bytes: &[u8]) -> Result<Self, DictionaryError> {
        let json =
            decompress_to_vec_zlib_with_limit(bytes, JSON_MOST).map_err(|error| match error.status {
                TINFLStatus::HasMoreOutput => {
                    DictionaryError::Large { form: "uncompressed", most: JSON_MOST }
                }
                _ => DictionaryError::Damaged { bytes: bytes.len() },
            })?;
        serde_json::from_slice(&json)
            .map_err(|error| DictionaryError::Unreadable { reason: error.to_string() })
    }
}
