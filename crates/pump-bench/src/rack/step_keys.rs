//! The keys of a step, and the step that they mean.

use std::collections::BTreeMap;
use std::path::Path;

use pump_ctl::plan::MAX_DURATION_S;
use pump_model::Shown;
use serde::Deserialize;

use super::error::RackError;
use super::gradient::Gradient;
use super::step::{Begin, Flow, RackStep};
use crate::record::ShortText;
use crate::units::{QuantityError, flow_ml_s, instant_s, time_s, volume_ml};

/// Keys of a step.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StepKeys {
    at: Option<String>,
    after: Option<String>,
    pump: Option<String>,
    ratio: Option<BTreeMap<String, f64>>,
    gradient: Option<BTreeMap<String, [f64; 2]>>,
    ramp: Option<String>,
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

/// Volume of a step, in mL, its rate, in mL/s, and its time, in s.
type Quantities = (Option<f64>, Option<f64>, Option<f64>);

/// Total volume of a step, in mL, and its total flow, in mL/s. `None` takes the pump file's default rate.
type Amount = (f64, Option<f64>);

impl StepKeys {
    /// Reads the step of this number, from 1, of a rack with these pumps.
    pub(super) fn read(&self, number: usize, pumps: &[&str]) -> Result<RackStep, WrongKey> {
        let begin = self.begin(number)?;
        let shares = self.shares(number, pumps)?;
        let flows = if self.gradient.is_some() || self.ramp.is_some() {
            self.flows_over_time(number, &shares)?
        } else {
            self.doses(number, &shares)?
        };
        Ok(RackStep { begin, flows, smooth: self.smooth })
    }

    /// Returns the flows of doses with these shares.
    fn doses(&self, number: usize, shares: &[Share]) -> Result<Vec<Flow>, WrongKey> {
        let (whole_ml, rate_ml_s) = self.amount(number)?;
        if shares.len() > 1 && rate_ml_s.is_none() {
            let allowed = "a ratio with two of volume, rate and for";
            return Err(WrongKey::value(&format!("step {number}"), "a ratio without rate", allowed));
        }
        let sum: f64 = shares.iter().map(|share| share.first).sum();
        let flow = |share: &Share| Flow {
            pump: share.pump,
            asked: match shares {
                [_] => self.asked(""),
                _ => self.asked(&format!(", {} of {}", Shown(share.first), Shown(sum))),
            },
            volume_ml: self.sign() * whole_ml * share.first / sum,
            rate_ml_s: rate_ml_s.map(|rate_ml_s| rate_ml_s * share.first / sum),
            profile: None,
        };
        Ok(shares.iter().map(flow).collect())
    }

    /// Returns the flows over time of these shares.
    fn flows_over_time(&self, number: usize, shares: &[Share]) -> Result<Vec<Flow>, WrongKey> {
        if self.smooth {
            let allowed = "smooth for doses: a flow over time follows the rollers anyhow";
            return Err(WrongKey::value(&format!("step {number}, smooth"), "true", allowed));
        }
        let ramp_s = self.ramp.as_ref().map(|text| read(number, "ramp", text, time_s)).transpose()?;
        let gradient = Gradient::of(number, self.quantities(number)?, ramp_s.unwrap_or(USUAL_RAMP_S))?;
        let sum = |of: fn(&Share) -> f64| shares.iter().map(of).sum::<f64>();
        let (first, last) = (sum(|share| share.first), sum(|share| share.last));
        if first <= 0.0 || last <= 0.0 {
            let allowed = "a share above 0 of one pump or more at the begin, and at the end";
            return Err(WrongKey::value(&format!("step {number}, gradient"), "nothing flows", allowed));
        }
        let flow = |share: &Share| {
            let asked = match shares {
                [_] => self.asked(""),
                _ if self.gradient.is_some() => {
                    self.asked(&format!(", {} to {}", Shown(share.first), Shown(share.last)))
                }
                _ => self.asked(&format!(", {} of {}", Shown(share.first), Shown(first))),
            };
            let ends = (share.first / first, share.last / last);
            let (volume_ml, profile) = gradient.flow(asked.as_str(), ends, self.sign());
            Flow { pump: share.pump, asked, volume_ml, rate_ml_s: None, profile: Some(profile) }
        };
        Ok(shares.iter().map(flow).collect())
    }

    /// Returns the amount of the step as it is typed, with the share of a pump after it.
    fn asked(&self, share: &str) -> ShortText {
        let typed = |text: &Option<String>| text.as_deref().unwrap_or_default().trim().to_owned();
        let amount = match &self.volume {
            Some(_) => typed(&self.volume),
            None => format!("{} for {}", typed(&self.rate), typed(&self.time)),
        };
        ShortText::new(&format!("{}{amount}{share}", if self.reverse { "-" } else { "" }))
    }

    fn sign(&self) -> f64 {
        if self.reverse { -1.0 } else { 1.0 }
    }

    fn begin(&self, number: usize) -> Result<Begin, WrongKey> {
        match (&self.at, &self.after) {
            (Some(_), Some(_)) => {
                Err(WrongKey::value(&format!("step {number}"), "at and after", "one of at and after"))
            }
            (Some(at), None) => Ok(Begin::At { time_s: instant(number, "at", at)? }),
            (None, Some(after)) => Ok(Begin::After { time_s: instant(number, "after", after)? }),
            (None, None) => Ok(Begin::After { time_s: 0.0 }),
        }
    }

    /// Returns the pumps that take part, each with its share of the step.
    fn shares(&self, number: usize, pumps: &[&str]) -> Result<Vec<Share>, WrongKey> {
        let place = |key: &str, name: &str| {
            let unknown = || WrongKey::value(&format!("step {number}, {key}"), name, &pumps.join(", "));
            pumps.iter().position(|pump| *pump == name).ok_or_else(unknown)
        };
        match (&self.pump, &self.ratio, &self.gradient) {
            (Some(pump), None, None) => Ok(vec![Share { pump: place("pump", pump)?, first: 1.0, last: 1.0 }]),
            (None, Some(ratio), None) => {
                two_or_more(number, "ratio", ratio.len())?;
                let share = |(name, share): (&String, &f64)| {
                    let pump = place("ratio", name)?;
                    let allowed = "a number above 0, 1e9 at most";
                    let share = of_range(number, "ratio", name, *share, f64::MIN_POSITIVE, allowed)?;
                    Ok(Share { pump, first: share, last: share })
                };
                ratio.iter().map(share).collect()
            }
            (None, None, Some(gradient)) => {
                two_or_more(number, "gradient", gradient.len())?;
                let share = |(name, ends): (&String, &[f64; 2])| {
                    let pump = place("gradient", name)?;
                    let allowed = "two numbers of 0 to 1e9, not both 0";
                    let [first, last] = *ends;
                    let first = of_range(number, "gradient", name, first, 0.0, allowed)?;
                    let least = if first > 0.0 { 0.0 } else { f64::MIN_POSITIVE };
                    let last = of_range(number, "gradient", name, last, least, allowed)?;
                    Ok(Share { pump, first, last })
                };
                gradient.iter().map(share).collect()
            }
            _ => Err(self.not_one_kind(number)),
        }
    }

    /// Returns the refusal of a step that is not one of pump, ratio and gradient.
    fn not_one_kind(&self, number: usize) -> WrongKey {
        let named = [
            ("pump", self.pump.is_some()),
            ("ratio", self.ratio.is_some()),
            ("gradient", self.gradient.is_some()),
        ];
        let named: Vec<_> = named.iter().filter(|(_, is_named)| *is_named).map(|(key, _)| *key).collect();
        let found = match named.len() {
            0 => "neither pump nor ratio nor gradient".to_owned(),
            _ => named.join(" and "),
        };
        let allowed = "one of pump = \"NAME\", ratio = { NAME = 2, OTHER = 1 } and gradient = { NAME = [1, 0], OTHER = \
                       [0, 1] }";
        WrongKey::value(&format!("step {number}"), &found, allowed)
    }

    /// Returns the volume, in mL, the rate, in mL/s, and the time, in s, as far as they are given.
    fn quantities(&self, number: usize) -> Result<Quantities, WrongKey> {
        let volume_ml =
            self.volume.as_ref().map(|text| read(number, "volume", text, volume_ml)).transpose()?;
        let rate_ml_s = self.rate.as_ref().map(|text| read(number, "rate", text, flow_ml_s)).transpose()?;
        let for_s = self.time.as_ref().map(|text| read(number, "for", text, time_s)).transpose()?;
        Ok((volume_ml, rate_ml_s, for_s))
    }

    fn amount(&self, number: usize) -> Result<Amount, WrongKey> {
        let allowed = "two of volume, rate and for; a step of one pump may have its volume alone";
        let wrong = |value| Err(WrongKey::value(&format!("step {number}"), value, allowed));
        match self.quantities(number)? {
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

/// Time of the ramps of a flow over time that names none, in s.
const USUAL_RAMP_S: f64 = 1.0;

/// Share of a pump in a step, at its begin and at its end.
#[derive(Debug, Clone, Copy)]
struct Share {
    /// Number of the pump in the rack, from 0.
    pump: usize,
    first: f64,
    last: f64,
}

/// Refuses a ratio of fewer than two pumps.
fn two_or_more(number: usize, key: &str, pumps: usize) -> Result<(), WrongKey> {
    if pumps > 1 {
        return Ok(());
    }
    let found = format!("{pumps} pump{}", if pumps == 1 { "" } else { "s" });
    let allowed = "two pumps or more; a step of one names it as `pump`";
    Err(WrongKey::value(&format!("step {number}, {key}"), &found, allowed))
}

/// Refuses a share that is out of its range.
fn of_range(
    number: usize,
    key: &str,
    name: &str,
    share: f64,
    least: f64,
    allowed: &str,
) -> Result<f64, WrongKey> {
    if (least..=MOST_SHARE).contains(&share) {
        return Ok(share);
    }
    Err(WrongKey::value(&format!("step {number}, {key} of {name}"), &Shown(share).to_string(), allowed))
}

/// Reads the time at which a step begins, which is no longer than any dose may take.
fn instant(number: usize, key: &str, text: &str) -> Result<f64, WrongKey> {
    let at_s = read(number, key, text, instant_s)?;
    if at_s <= MAX_DURATION_S {
        return Ok(at_s);
    }
    let allowed = format!("{MAX_DURATION_S:e} s (58 days) at most");
    Err(WrongKey::value(&format!("step {number}, {key}"), text, &allowed))
}

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
