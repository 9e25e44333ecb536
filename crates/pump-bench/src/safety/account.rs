//! The account of the volumes that safety limits count.

use serde::{Deserialize, Serialize};

use super::day::LastDay;
use super::passed_time::PassedTime;
use super::{SafetyLimit, SafetyLimits, Stand};

/// Volume by which a sum may exceed its limit, in mL: the rounding of sums.
const ROUNDING_ML: f64 = 1e-9;

/// Motion that counts as of its begin, in s: a dose that comes every 24 hours then fits. A longer one counts in parts
/// of `PART_S` at most, or in `MOST_PARTS`.
const SHORT_S: u64 = 60;
const PART_S: u64 = 3600;
const MOST_PARTS: u64 = 1000;

/// Length of a day, in s.
const DAY_S: u64 = 86_400;

/// Account of the volumes that safety limits count. It is kept whether there are limits or not.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SafetyAccount {
    /// Time of the record. `None` before the first motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    time: Option<PassedTime>,
    /// Volumes of the last 24 hours.
    #[serde(default)]
    day: LastDay,
    /// Volume that the vessel has received since it was emptied, in mL, never negative.
    #[serde(default)]
    pub(crate) vessel_ml: f64,
    /// Stand of the pump. `None` if it may move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) stand: Option<Stand>,
    /// Time at which a person has cleared the volumes of a day, in seconds since 1970. `None` if nobody has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cleared_s: Option<u64>,
}

impl SafetyAccount {
    /// Returns the account of a record of an early version, which has no times: everything that the tube has pumped
    /// counts as of `now_s`, and as what the vessel has received.
    pub(crate) fn of_early_record(pumped_ml: f64, now_s: u64) -> Self {
        if pumped_ml > 0.0 { Self::default().pumped(now_s, 0, pumped_ml, pumped_ml) } else { Self::default() }
    }

    /// Returns the account after a motion that began at `began_s` and took `lasted_s`: `day_ml` counts for the day, and
    /// the vessel received `vessel_ml`, negative if that left it.
    ///
    /// A motion of less than a minute counts as of its begin. A longer one counts in even parts of an hour at most,
    /// each as of its end, so that no 24 hours hold more than was counted.
    pub(crate) fn pumped(self, began_s: u64, lasted_s: u64, day_ml: f64, vessel_ml: f64) -> Self {
        let (parts, lasted_s) = match lasted_s {
            0..SHORT_S => (1, 0),
            _ => (lasted_s.div_ceil(PART_S).min(MOST_PARTS), lasted_s),
        };
        let mut time = self.at(began_s);
        let mut day = self.day;
        for part in 1..=parts {
            time = time.seen(began_s.saturating_add(lasted_s / parts * part));
            if day_ml > 0.0 {
                day = day.with(time.passed_s, day_ml / parts as f64);
            }
        }
        Self { time: Some(time), day, vessel_ml: (self.vessel_ml + vessel_ml).max(0.0), ..self }
    }

    /// Returns the volume of the last 24 hours, in mL.
    pub(crate) fn day_ml(&self, now_s: u64) -> f64 {
        self.day.volume_ml(self.at(now_s).passed_s)
    }

    /// Returns the time at which the volumes were cleared that would count for the last 24 hours otherwise, in seconds
    /// since 1970.
    pub(crate) fn cleared_in_day_s(&self, now_s: u64) -> Option<u64> {
        self.cleared_s.filter(|cleared_s| now_s < cleared_s.saturating_add(DAY_S))
    }

    /// Returns how far the clock is behind the latest time on record, in s. 0 if it is not.
    pub(crate) fn behind_s(&self, now_s: u64) -> u64 {
        self.time.map_or(0, |time| time.latest_s.saturating_sub(now_s))
    }

    /// Returns the stand of a pump that would exceed a limit: `day_ml` counts for the day, and `vessel_ml` would go
    /// into the vessel. `None` if the motion stays within the limits.
    pub(crate) fn stand_of(
        &self,
        limits: &SafetyLimits,
        now_s: u64,
        day_ml: f64,
        vessel_ml: f64,
    ) -> Option<Stand> {
        let exceeded = |limit, used_ml: f64, planned_ml: f64, allowed_ml: Option<f64>| {
            let allowed_ml =
                allowed_ml.filter(|allowed_ml| used_ml + planned_ml > allowed_ml + ROUNDING_ML)?;
            let stand = Stand::at_limit(limit, used_ml, planned_ml, allowed_ml, now_s);
            (planned_ml > 0.0).then_some(stand)
        };
        exceeded(SafetyLimit::Day, self.day_ml(now_s), day_ml, limits.max_ml_per_day)
            .or_else(|| exceeded(SafetyLimit::Vessel, self.vessel_ml, vessel_ml, limits.vessel_ml))
    }

    /// Returns the stand of a pump of which one of a series of volumes, each so many s after `now_s`, would exceed a
    /// limit. `None` if all stay within the limits.
    pub(crate) fn stand_of_series(
        &self,
        limits: &SafetyLimits,
        now_s: u64,
        mut series: impl Iterator<Item = (f64, f64)>,
    ) -> Option<Stand> {
        if *limits == SafetyLimits::default() {
            return None;
        }
        let mut account = *self;
        series.find_map(|(after_s, volume_ml)| {
            let at_s = now_s.saturating_add(after_s as u64);
            let stand = account.stand_of(limits, at_s, volume_ml.abs(), volume_ml);
            account = account.pumped(at_s, 0, volume_ml.abs(), volume_ml);
            stand
        })
    }

    /// Returns the limit that leaves the least to a motion, in reverse or not, with what is used of it. `None` without
    /// limits.
    pub(crate) fn nearest(&self, limits: &SafetyLimits, now_s: u64, reverse: bool) -> Option<Stand> {
        let day = self.stand_at(SafetyLimit::Day, limits, now_s);
        let vessel = self.stand_at(SafetyLimit::Vessel, limits, now_s).filter(|_| !reverse);
        let all = [day, vessel].into_iter().flatten();
        all.min_by(|one, other| one.left_ml().total_cmp(&other.left_ml()))
    }

    /// Returns the stand at a limit that has ended a run. `None` without that limit, and for an order, which counts no
    /// volume.
    pub(crate) fn stand_at(&self, limit: SafetyLimit, limits: &SafetyLimits, now_s: u64) -> Option<Stand> {
        let (used_ml, allowed_ml) = match limit {
            SafetyLimit::Day => (self.day_ml(now_s), limits.max_ml_per_day),
            SafetyLimit::Vessel => (self.vessel_ml, limits.vessel_ml),
            SafetyLimit::Ordered => return None,
        };
        Some(Stand::at_limit(limit, used_ml, 0.0, allowed_ml?, now_s))
    }

    /// Returns the account of a pump that stands.
    pub(crate) fn standing(self, stand: Stand) -> Self {
        Self { stand: Some(stand), ..self }
    }

    /// Returns the account once a person has cleared the stand: the day begins anew after the limit of a day,
    /// and counts on after any other. What the vessel holds stays.
    pub(crate) fn cleared(self, now_s: u64) -> Self {
        if self.stand.is_some_and(|stand| stand.limit != SafetyLimit::Day) {
            return Self { stand: None, ..self };
        }
        let (time, day) = (Some(self.at(now_s)), LastDay::default());
        Self { time, day, stand: None, cleared_s: Some(now_s), ..self }
    }

    /// Returns the account once the vessel is empty.
    pub(crate) fn emptied(self) -> Self {
        let stand = self.stand.map(|stand| Stand { is_emptied: stand.limit == SafetyLimit::Vessel, ..stand });
        Self { vessel_ml: 0.0, stand, ..self }
    }

    /// Returns the time of the record once the clock shows `now_s`.
    fn at(&self, now_s: u64) -> PassedTime {
        self.time.map_or(PassedTime::from(now_s), |time| time.seen(now_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DAY: u64 = super::super::DAY_S;
    const HOUR: u64 = 3600;
    const LIMITS: SafetyLimits = SafetyLimits { max_ml_per_day: Some(50.0), vessel_ml: Some(120.0) };

    #[test]
    fn a_dose_that_just_fits_is_allowed_and_the_next_drop_is_not() {
        let account = SafetyAccount::default().pumped(1000, 0, 25.0, 25.0);
        assert_eq!(account.stand_of(&LIMITS, 2000, 25.0, 25.0), None);
        let stand = account.stand_of(&LIMITS, 2000, 25.001, 25.001).unwrap();
        assert_eq!((stand.limit, stand.used_ml, stand.allowed_ml), (SafetyLimit::Day, 25.0, 50.0));
        assert_eq!(account.stand_of(&LIMITS, 1000 + DAY, 50.0, 50.0), None);
    }

    #[test]
    fn a_vessel_counts_what_is_sucked_back_and_forgets_nothing_overnight() {
        let account = SafetyAccount::default().pumped(0, 0, 40.0, 40.0).pumped(DAY, 0, 40.0, 40.0).pumped(
            2 * DAY,
            0,
            0.0,
            -5.0,
        );
        assert_eq!(account.vessel_ml, 75.0);
        let stand = account.stand_of(&LIMITS, 3 * DAY, 46.0, 46.0).unwrap();
        assert_eq!((stand.limit, stand.used_ml), (SafetyLimit::Vessel, 75.0));
        assert_eq!(account.emptied().stand_of(&LIMITS, 3 * DAY, 46.0, 46.0), None);
        // Nothing is in a vessel that was emptied by the pump itself.
        assert_eq!(SafetyAccount::default().pumped(0, 0, 9.0, -9.0).vessel_ml, 0.0);
    }

    #[test]
    fn a_clock_set_back_frees_nothing_and_a_person_begins_the_day_anew() {
        let account = SafetyAccount::default().pumped(10 * DAY, 0, 50.0, 50.0);
        for now_s in [0, 10 * DAY, 11 * DAY - 1] {
            assert!(account.stand_of(&LIMITS, now_s, 0.1, 0.1).is_some(), "{now_s}");
        }
        let (behind, later) = (account.pumped(0, 0, 0.5, 0.5), 10 * DAY + 60);
        assert!(behind.stand_of(&LIMITS, later, 0.1, 0.1).is_some(), "the clock was set right again");
        assert_eq!(account.behind_s(9 * DAY), DAY);
        assert_eq!(account.cleared(later).day_ml(later), 0.0);
    }

    #[test]
    fn a_full_vessel_that_is_cleared_frees_nothing_of_the_day() {
        let account = SafetyAccount::default().pumped(60, 0, 50.0, 50.0);
        for (limit, left_ml) in
            [(SafetyLimit::Day, 0.0), (SafetyLimit::Vessel, 50.0), (SafetyLimit::Ordered, 50.0)]
        {
            let cleared = account.standing(Stand::at_limit(limit, 50.0, 1.0, 50.0, 60)).cleared(60);
            assert_eq!((cleared.day_ml(60), cleared.stand), (left_ml, None), "{limit}");
        }
    }

    #[test]
    fn a_batch_stands_by_its_first_dose_that_would_not_fit() {
        let stand = |count: u64, every_s: f64| {
            let doses = (0..count).map(|number| (number as f64 * every_s, 10.0));
            SafetyAccount::default().stand_of_series(&LIMITS, 0, doses)
        };
        assert_eq!(stand(5, 60.0), None);
        assert_eq!(stand(6, 60.0).map(|stand| (stand.limit, stand.used_ml)), Some((SafetyLimit::Day, 50.0)));
        // Five in any 24 hours fit for ever, and the vessel holds twelve.
        let every_s = DAY as f64 / 5.0;
        assert_eq!(stand(12, every_s), None);
        assert_eq!(
            stand(13, every_s).map(|stand| (stand.limit, stand.used_ml)),
            Some((SafetyLimit::Vessel, 120.0))
        );
    }

    #[test]
    fn nothing_is_zero_and_not_minus_zero() {
        assert!(SafetyAccount::default().day_ml(0).is_sign_positive());
        assert!(SafetyAccount::default().cleared(9).day_ml(9).is_sign_positive());
    }

    #[test]
    fn an_early_record_counts_in_full_as_of_now() {
        let account = SafetyAccount::of_early_record(300.0, 7 * DAY);
        assert_eq!(
            (account.day_ml(7 * DAY), account.day_ml(8 * DAY), account.vessel_ml),
            (300.0, 0.0, 300.0)
        );
    }

    #[test]
    fn a_motion_of_many_hours_counts_for_a_day_from_each_of_its_hours() {
        let account = SafetyAccount::default().pumped(0, 24 * HOUR, 48.0, 48.0);
        // 48 mL in the 24 hours until then, and 2 mL fewer with each hour.
        for hour in 0..24 {
            let left_ml = 48.0 - 2.0 * hour as f64;
            let counted_ml = account.day_ml((24 + hour) * HOUR);
            assert!((counted_ml - left_ml).abs() < 1e-9, "{hour}: {counted_ml}");
        }
        // A motion of two days is not forgotten when it ends.
        let account = SafetyAccount::default().pumped(0, 48 * HOUR, 96.0, 96.0);
        assert!((account.day_ml(48 * HOUR) - 48.0).abs() < 1e-9, "{}", account.day_ml(48 * HOUR));
    }

    #[test]
    fn a_person_who_clears_by_a_wrong_clock_frees_no_later_day() {
        let year = 365 * DAY;
        // The board starts in 1970, a person clears, and the network sets the clock.
        let cleared = SafetyAccount::default().pumped(50 * year, 0, 50.0, 50.0).cleared(60);
        let account = cleared.pumped(120, 0, 50.0, 50.0);
        assert!(account.stand_of(&LIMITS, 50 * year + HOUR, 0.1, 0.1).is_some());
    }
}
