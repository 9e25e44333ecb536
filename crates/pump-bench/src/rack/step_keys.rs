//! The keys of a step, and the step that they mean.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::error::RackError;
use super::step::{Begin, Flow, RackStep};
use crate::units::{QuantityError, flow_ml_s, instant_s, time_s, volume_ml};

/// Keys of a step.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StepKeys {
    at: Option<String>,
    after: Option<String>,
    pump: Option<String>,
    ratio: Option<BTreeMap<String, f64>>,
    volume: Option<String>,
    rate: Option<String>,
    #[serde(rename = "for")]
    time: Option<String>,
    #[serde(default)]
    reverse: bool,
    #[serde(default)]
    smooth: bool,
}

/// Key whose value is not allowed.
#[derive(Debug)]
pub(super) struct WrongKey {
    key: String,
    fault: Fault,
}

#[derive(Debug)]
enum Fault {
    Value { value: String, allowed: String },
    Quantity(QuantityError),
}

impl WrongKey {
    /// Names a value that is not allowed.
    pub(super) fn value(key: &str, value: &str, allowed: &str) -> Self {
        let fault = Fault::Value { value: value.to_owned(), allowed: allowed.to_owned() };
        Self { key: key.to_owned(), fault }
    }

    /// Returns the error of the rack at `path`.
    pub(super) fn at(self, path: &Path) -> RackError {
        let (path, key) = (path.to_owned(), self.key);
        match self.fault {
            Fault::Value { value, allowed } => RackError::Value { path, key, value, allowed },
            Fault::Quantity(source) => RackError::Quantity { path, key, source: Box::new(source) },
        }
    }
}

/// Total volume of a step, in mL, and its total flow, in mL/s. `None` takes the pump file's default rate.
type Amount = (f64, Option<f64>);

impl StepKeys {
    /// Reads the step of this number, from 1, of a rack with these pumps.
    pub(super) fn read(&self, number: usize, pumps: &[&str]) -> Result<RackStep, WrongKey> {
        let begin = self.begin(number)?;
        let shares = self.shares(number, pumps)?;
        let (whole_ml, rate_ml_s) = self.amount(number)?;
        if shares.len() > 1 && rate_ml_s.is_none() {
            let allowed = "a ratio with two of volume, rate and for";
            return Err(WrongKey::value(&format!("step {number}"), "a ratio without rate", allowed));
        }
        let sum: f64 = shares.iter().map(|(_, share)| share).sum();
        let sign = if self.reverse { -1.0 } else { 1.0 };
        let flow = |(pump, share): (usize, f64)| Flow {
            pump,
            volume_ml: sign * whole_ml * share / sum,
            rate_ml_s: rate_ml_s.map(|rate_ml_s| rate_ml_s * share / sum),
        };
        Ok(RackStep { begin, flows: shares.into_iter().map(flow).collect(), smooth: self.smooth })
    }

    fn begin(&self, number: usize) -> Result<Begin, WrongKey> {
        match (&self.at, &self.after) {
            (Some(_), Some(_)) => {
                Err(WrongKey::value(&format!("step {number}"), "at and after", "one of at and after"))
            }
            (Some(at), None) => Ok(Begin::At { time_s: read(number, "at", at, instant_s)? }),
            (None, Some(after)) => Ok(Begin::After { time_s: read(number, "after", after, instant_s)? }),
            (None, None) => Ok(Begin::After { time_s: 0.0 }),
        }
    }

    /// Returns the numbers of the pumps that take part, each with its share of the step.
    fn shares(&self, number: usize, pumps: &[&str]) -> Result<Vec<(usize, f64)>, WrongKey> {
        let place = |key: &str, name: &str| {
            let unknown = || WrongKey::value(&format!("step {number}, {key}"), name, &pumps.join(", "));
            pumps.iter().position(|pump| *pump == name).ok_or_else(unknown)
        };
        match (&self.pump, &self.ratio) {
            (Some(pump), None) => Ok(vec![(place("pump", pump)?, 1.0)]),
            (None, Some(ratio)) if ratio.len() > 1 => ratio
                .iter()
                .map(|(name, share)| {
                    let pump = place("ratio", name)?;
                    if *share > 0.0 && share.is_finite() && *share <= MOST_SHARE {
                        return Ok((pump, *share));
                    }
                    let key = format!("step {number}, ratio of {name}");
                    Err(WrongKey::value(&key, &share.to_string(), "a number above 0, 1e9 at most"))
                })
                .collect(),
            (None, Some(ratio)) => Err(WrongKey::value(
                &format!("step {number}, ratio"),
                &format!("{} pump{}", ratio.len(), if ratio.len() == 1 { "" } else { "s" }),
                "two pumps or more; a step of one names it as `pump`",
            )),
            (both, _) => Err(WrongKey::value(
                &format!("step {number}"),
                if both.is_some() { "pump and ratio" } else { "neither pump nor ratio" },
                "pump = \"NAME\", or ratio = { NAME = 2, OTHER = 1 }",
            )),
        }
    }

    fn amount(&self, number: usize) -> Result<Amount, WrongKey> {
        let volume_ml =
            self.volume.as_ref().map(|text| read(number, "volume", text, volume_ml)).transpose()?;
        let rate_ml_s = self.rate.as_ref().map(|text| read(number, "rate", text, flow_ml_s)).transpose()?;
        let for_s = self.time.as_ref().map(|text| read(number, "for", text, time_s)).transpose()?;
        let allowed = "two of volume, rate and for; a step of one pump may have its volume alone";
        let wrong = |value| Err(WrongKey::value(&format!("step {number}"), value, allowed));
        match (volume_ml, rate_ml_s, for_s) {
            (Some(_), Some(_), Some(_)) => wrong("volume, rate and for"),
            (Some(volume_ml), rate_ml_s, None) => Ok((volume_ml, rate_ml_s)),
            (Some(volume_ml), None, Some(for_s)) => Ok((volume_ml, Some(volume_ml / for_s))),
            (None, Some(rate_ml_s), Some(for_s)) => Ok((rate_ml_s * for_s, Some(rate_ml_s))),
            (None, Some(_), None) => wrong("rate without volume or for"),
            (None, None, Some(_)) => wrong("for without volume or rate"),
            (None, None, None) => wrong("no volume"),
        }
    }
}

/// Largest number of a ratio.
const MOST_SHARE: f64 = 1e9;

/// Reads a quantity of a step.
fn read(
    number: usize,
    key: &str,
    text: &str,
    reads: impl FnOnce(&str) -> Result<f64, QuantityError>,
) -> Result<f64, WrongKey> {
    reads(text)
        .map_err(|error| WrongKey { key: format!("step {number}, {key}"), fault: Fault::Quantity(error) })
}
