//! The safety limits of a pump in its status.

use serde::Serialize;

use crate::bench::{Bench, system_now_s};
use crate::notice::{Remedy, Wording};
use crate::numbers::{duration, significant};
use crate::record::{PumpState, Stamp};
use crate::safety::{Stand, StandReason};

/// Volumes that safety limits count, and the stand of the pump if one is reached.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SafetyStatus {
    /// Most volume in any 24 hours, mL; null without that limit.
    pub max_ml_per_day: Option<f64>,
    /// Volume of the last 24 hours in either direction, mL.
    pub day_ml: f64,
    /// Volume that the limit of 24 hours leaves, mL; null without that limit.
    pub day_left_ml: Option<f64>,
    /// Volume that the receiving vessel holds, mL; null if nobody has said it.
    pub vessel_ml: Option<f64>,
    /// Volume that the vessel has received since it was emptied, mL.
    pub received_ml: f64,
    /// Volume that the vessel has room for, mL; null if nobody has said what it holds.
    pub vessel_left_ml: Option<f64>,
    /// How far the clock is behind the latest time on record, s; 0 if it is not.
    pub clock_behind_s: u64,
    /// Stand of the pump at a limit or by order; null if it may move.
    pub stand: Option<StandStatus>,
}

/// Stand of a pump at a safety limit, or by order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct StandStatus {
    /// Limit that was reached: `day` or `vessel`; `ordered` if a person or a program ordered the stand.
    pub limit: &'static str,
    /// Time at which the pump came to stand, RFC 3339.
    pub since: Stamp,
    /// Volume that counted before the motion that was refused, or after the run that the limit has ended, mL; 0 by
    /// order.
    pub used_ml: f64,
    /// Volume that was planned, mL; 0 for a run until it was stopped, and by order.
    pub planned_ml: f64,
    /// Volume that the limit allows, mL; 0 by order.
    pub allowed_ml: f64,
    /// Reason of the order; null at a limit. More than 120 bytes are cut.
    pub reason: Option<StandReason>,
    #[serde(skip)]
    stand: Stand,
}

impl SafetyStatus {
    /// Reads the limits of a bench whose `state` is on record.
    pub(super) fn of(bench: &Bench, state: Option<&PumpState>) -> Self {
        let (now_s, table) = (system_now_s(), &bench.file().safety);
        let account = bench.safety_account(state, now_s);
        let (day_ml, received_ml) = (account.day_ml(now_s), account.vessel_ml);
        let left = |allowed_ml: Option<f64>, used_ml: f64| {
            allowed_ml.map(|allowed_ml| (allowed_ml - used_ml).max(0.0))
        };
        Self {
            max_ml_per_day: table.max_ml_per_day,
            day_ml,
            day_left_ml: left(table.max_ml_per_day, day_ml),
            vessel_ml: table.vessel_ml,
            received_ml,
            vessel_left_ml: left(table.vessel_ml, received_ml),
            clock_behind_s: account.behind_s(now_s),
            stand: account.stand.map(StandStatus::of),
        }
    }

    /// Returns the limits once the rest of a motion has been made too, mL, negative in reverse.
    #[must_use]
    pub fn with_planned(self, rest_ml: f64) -> Self {
        let less = |left_ml: Option<f64>, ml: f64| left_ml.map(|left_ml| (left_ml - ml).max(0.0));
        let (pumped_ml, received_ml) = (rest_ml.abs(), rest_ml.max(0.0));
        Self {
            day_ml: self.day_ml + pumped_ml,
            day_left_ml: less(self.day_left_ml, pumped_ml),
            received_ml: self.received_ml + received_ml,
            vessel_left_ml: less(self.vessel_left_ml, received_ml),
            ..self
        }
    }

    /// The limits in words. `None` where nothing limits the pump and it does not stand.
    pub(in crate::report) fn line(&self, words: Wording) -> Option<String> {
        let ml = |volume_ml: f64| significant(volume_ml, 6);
        let day = self.max_ml_per_day.zip(self.day_left_ml).map(|(most_ml, left_ml)| {
            format!("{} of {} mL in the last 24 h, {} mL left", ml(self.day_ml), ml(most_ml), ml(left_ml))
        });
        let vessel = self.vessel_ml.zip(self.vessel_left_ml).map(|(holds_ml, left_ml)| {
            let received = ml(self.received_ml);
            format!("the vessel has received {received} of {} mL, {} mL left", ml(holds_ml), ml(left_ml))
        });
        let behind = (self.max_ml_per_day.is_some() && self.clock_behind_s > 0).then(|| {
            let behind = duration(self.clock_behind_s as f64);
            format!("the clock is {behind} behind the record, which frees no volume")
        });
        let stand = self.stand.map(|stand| {
            let first = stand.stand.has_full_vessel().then_some(Remedy::EmptyVessel);
            let remedies = first.into_iter().chain([Remedy::ClearStand]).map(words);
            let remedies: Vec<&str> = remedies.collect();
            format!("the pump STANDS since {}: {}; {}", stand.since, stand.stand, remedies.join("; "))
        });
        let said: Vec<String> = [day, vessel, behind, stand].into_iter().flatten().collect();
        (!said.is_empty()).then(|| format!("safety: {}", said.join("; ")))
    }

    /// The limits in words, a line each, for a person who asks for nothing else.
    pub fn text(&self, words: Wording) -> String {
        let unlimited = |limit: Option<f64>, line: String| limit.is_none().then_some(line);
        let lines = [
            self.line(words),
            unlimited(
                self.max_ml_per_day,
                format!("no limit of 24 h: {} mL were pumped in the last 24 h", significant(self.day_ml, 6)),
            ),
            unlimited(
                self.vessel_ml,
                format!(
                    "no limit of the vessel: it has received {} mL since it was emptied",
                    significant(self.received_ml, 6)
                ),
            ),
        ];
        lines.into_iter().flatten().map(|line| line + "\n").collect()
    }
}

impl StandStatus {
    /// Returns the limit and its volumes in words, or the reason of the order.
    pub fn words(&self) -> String {
        self.stand.to_string()
    }

    fn of(stand: Stand) -> Self {
        Self {
            limit: stand.limit.as_str(),
            since: Stamp::new(stand.unix_s, 0),
            used_ml: stand.used_ml,
            planned_ml: stand.planned_ml,
            allowed_ml: stand.allowed_ml,
            reason: stand.reason,
            stand,
        }
    }

    /// The words after `STANDS`: the place where the pump stands.
    pub(super) fn place(&self) -> &'static str {
        self.stand.place()
    }
}
