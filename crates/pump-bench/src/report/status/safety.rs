//! The safety limits of a pump in its status.

use serde::Serialize;

use crate::bench::{Bench, system_now_s};
use crate::notice::{Remedy, Wording};
use crate::numbers::{duration, significant};
use crate::record::{PumpState, Stamp, Unfinished};
use crate::safety::{Stand, StandReason};

/// Volumes that safety limits count, and the stand of the pump if one is reached.
///
/// A motion under way counts with the most that it may have pumped so far. The rest of its plan is `under_way_ml`, and
/// no longer free: what is used, under way and left adds up to the limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SafetyStatus {
    /// Most volume in any 24 hours, mL; null without that limit.
    pub max_ml_per_day: Option<f64>,
    /// Volume of the last 24 hours in either direction, mL.
    pub day_ml: f64,
    /// Volume that the limit of 24 hours leaves beside the motion under way, mL; null without that limit.
    pub day_left_ml: Option<f64>,
    /// Volume that the receiving vessel holds, mL; null if nobody has said it.
    pub vessel_ml: Option<f64>,
    /// Volume that the vessel has received since it was emptied, mL.
    pub received_ml: f64,
    /// Volume that the vessel has room for beside the motion under way, mL; null if nobody has said what it holds.
    pub vessel_left_ml: Option<f64>,
    /// Volume that the motion under way will still pump at most, in either direction, mL; 0 while nothing moves, and
    /// in a run until it is stopped.
    pub under_way_ml: f64,
    /// How far the clock is behind the latest time on record, s; 0 if it is not.
    pub clock_behind_s: u64,
    /// Time at which a person has cleared the limit of 24 hours, RFC 3339: `day_ml` counts since then. Null if that is
    /// more than 24 hours ago.
    pub cleared: Option<Stamp>,
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
    /// Reads the limits of a bench whose `state` is on record, while `motion` is under way.
    pub(super) fn of(bench: &Bench, state: Option<&PumpState>, motion: Option<&Unfinished>) -> Self {
        let (now_s, table) = (system_now_s(), &bench.file().safety);
        let account = bench.safety_account(state, now_s);
        let (day_ml, received_ml) = (account.day_ml(now_s), account.vessel_ml);
        let rest_ml = motion.map_or(0.0, |motion| motion.still_to_count_ml(bench.model()));
        let left = |allowed_ml: Option<f64>, used_ml: f64| {
            allowed_ml.map(|allowed_ml| (allowed_ml - used_ml).max(0.0))
        };
        Self {
            max_ml_per_day: table.max_ml_per_day,
            day_ml,
            day_left_ml: left(table.max_ml_per_day, day_ml + rest_ml.abs()),
            vessel_ml: table.vessel_ml,
            received_ml,
            vessel_left_ml: left(table.vessel_ml, received_ml + rest_ml.max(0.0)),
            under_way_ml: rest_ml.abs(),
            clock_behind_s: account.behind_s(now_s),
            cleared: account.cleared_in_day_s(now_s).map(|unix_s| Stamp::new(unix_s, 0)),
            stand: account.stand.map(StandStatus::of),
        }
    }

    /// The limits in words. `None` where nothing limits the pump and it does not stand.
    pub(in crate::report) fn line(&self, words: Wording) -> Option<String> {
        let ml = |volume_ml: f64| significant(volume_ml, 6);
        let under_way = self.under_way_words();
        let day = self.max_ml_per_day.zip(self.day_left_ml).map(|(most_ml, left_ml)| {
            let (used, most, left) = (ml(self.day_ml), ml(most_ml), ml(left_ml));
            let within = self.day_words();
            format!("{used} of {most} mL {within}{under_way}, {left} mL left")
        });
        let vessel = self.vessel_ml.zip(self.vessel_left_ml).map(|(holds_ml, left_ml)| {
            let received = ml(self.received_ml);
            let (holds, left) = (ml(holds_ml), ml(left_ml));
            format!("the vessel has received {received} of {holds} mL{under_way}, {left} mL left")
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

    /// The time that the volume of a day is of, in words.
    fn day_words(&self) -> String {
        let since = |cleared: Stamp| format!("since it was cleared at {cleared}, less than 24 h ago");
        self.cleared.map_or_else(|| "in the last 24 h".to_owned(), since)
    }

    /// The rest of the motion under way in words; empty without one.
    fn under_way_words(&self) -> String {
        let volume = || format!(", up to {} mL under way", significant(self.under_way_ml, 6));
        if self.under_way_ml > 0.0 { volume() } else { String::new() }
    }

    /// The limits in words, a line each, for a person who asks for nothing else.
    pub fn text(&self, words: Wording) -> String {
        let unlimited = |limit: Option<f64>, line: String| limit.is_none().then_some(line);
        let lines = [
            self.line(words),
            unlimited(
                self.max_ml_per_day,
                format!(
                    "no limit of 24 h: {} mL were pumped {}{}",
                    significant(self.day_ml, 6),
                    self.day_words(),
                    self.under_way_words()
                ),
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
