//! Bodies of requests.

use axum::body::Bytes;
use axum::http::StatusCode;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::failure::Failure;
use crate::order::{Options, read_options};

/// Volume and options of a dose, a prime or a purge.
#[derive(Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct VolumeBody {
    /// Volume or mass with its unit, as typed to the command: `25mL`, `-5mL`, `25g`.
    #[schema(example = "25mL")]
    pub(super) volume: String,
    /// Options of the command by their names without dashes: texts with units, or true.
    #[serde(default, deserialize_with = "read_options")]
    #[schema(value_type = Object, example = json!({"rate": "5mL/s", "smooth": true}))]
    pub(super) options: Options,
}

/// Options alone.
#[derive(Debug, Default, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct OptionsBody {
    /// Options of the command by their names without dashes: texts with units, or true.
    #[serde(default, deserialize_with = "read_options")]
    #[schema(value_type = Object)]
    pub(super) options: Options,
}

/// Reason of a person who clears a pump.
#[derive(Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ClearBody {
    /// Reason, which the pump's record keeps.
    #[schema(example = "the tank was changed")]
    pub(super) reason: String,
    /// Name of the person, which the record keeps behind the reason.
    #[schema(example = "Ada", required = true, value_type = String)]
    pub(super) by: Option<String>,
}

/// Calibration that doses use from now on.
#[derive(Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CalibrationBody {
    /// Number of the calibration, or `none` for the volumes of the model.
    #[schema(example = "1")]
    pub(super) calibration: String,
}

/// Reason of a person who puts a pump to stand.
#[derive(Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ReasonBody {
    /// Reason, which the pump's record keeps.
    #[schema(example = "the tank was changed")]
    pub(super) reason: String,
}

/// Reason of a stop.
#[derive(Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct StopBody {
    /// Reason, which the log keeps.
    pub(super) reason: Option<String>,
}

/// Reading of the last dose.
#[derive(Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ReadingBody {
    /// Mass or volume with its unit.
    #[schema(example = "23.8g")]
    pub(super) reading: String,
    /// Options of the command that takes the reading: `dose`, the order or the log's number of the dose that was
    /// weighed, so that the reading is refused if another dose came since; `scale`, `anew`, `anyway`, and `dry-run`,
    /// which keeps nothing.
    #[serde(default, deserialize_with = "read_options")]
    #[schema(value_type = Object, example = json!({"dose": "0123456789abcdef"}))]
    pub(super) options: Options,
}

/// Reads a body, or says what is wrong with it. An empty body is `{}`.
pub(super) fn body<T: DeserializeOwned>(bytes: &Bytes) -> Result<T, Failure> {
    let text: &[u8] = if bytes.is_empty() { b"{}" } else { bytes };
    serde_json::from_slice(text).map_err(|error| {
        Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "usage", format!("the body: {error}"))
    })
}
