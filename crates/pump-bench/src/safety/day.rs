//! The volumes of the last 24 hours, in a room of fixed size.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Length of the day that a volume counts for, in s. The day rolls: it has no midnight.
pub const DAY_S: u64 = 86_400;

/// Length of the slots in which volumes are added up once their number is large, in s.
const SLOT_S: u64 = 3600;

/// Most volumes that are kept one by one. 24 hours touch 25 slots of an hour, so another one always finds room.
const MOST: usize = 26;

/// Volumes of the last 24 hours, each with the time at which its motion began.
///
/// Up to 25 motions a day count to the second. Those of one hour are added up if there are more, and count until the
/// last of them is a day old: up to an hour longer.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct LastDay {
    /// Time in s and volume in mL of each motion, oldest first.
    kept: [(u64, f64); MOST],
    count: usize,
}

impl LastDay {
    /// Returns the volumes of the last 24 hours at the time `at_s`, in mL.
    pub(super) fn volume_ml(&self, at_s: u64) -> f64 {
        self.volumes()
            .iter()
            .filter(|(time_s, _)| counts(*time_s, at_s))
            // The sum of no volumes is 0, and not the -0 of `Iterator::sum`.
            .fold(0.0, |sum_ml, (_, volume_ml)| sum_ml + volume_ml)
    }

    /// Returns the volumes with one more, of a motion that began at `at_s`. Those that are a day old go.
    pub(super) fn with(self, at_s: u64, volume_ml: f64) -> Self {
        let mut day = Self::default();
        for (time_s, volume_ml) in self.volumes().iter().filter(|(time_s, _)| counts(*time_s, at_s)) {
            day.push(*time_s, *volume_ml);
        }
        day.push(at_s, volume_ml);
        day
    }

    /// Returns the times and the volumes, oldest first.
    fn volumes(&self) -> &[(u64, f64)] {
        &self.kept[..self.count.min(MOST)]
    }

    /// Adds a volume that is no older than the others.
    fn push(&mut self, time_s: u64, volume_ml: f64) {
        if self.count >= MOST - 1 {
            self.merge();
        }
        if self.count < MOST {
            self.kept[self.count] = (time_s, volume_ml);
            self.count += 1;
        } else {
            // No room is left only for times that are not those of one day: the last one takes it all.
            let (last_s, last_ml) = self.kept[MOST - 1];
            self.kept[MOST - 1] = (last_s.max(time_s), last_ml + volume_ml);
        }
    }

    /// Adds the oldest two volumes of one slot up. They count until the later one is a day old.
    fn merge(&mut self) {
        let volumes = self.volumes();
        let same_slot = |pair: &[(u64, f64)]| pair[0].0 / SLOT_S == pair[1].0 / SLOT_S;
        let Some(first) = volumes.windows(2).position(same_slot) else { return };
        let (earlier_ml, (later_s, later_ml)) = (self.kept[first].1, self.kept[first + 1]);
        self.kept[first + 1] = (later_s, earlier_ml + later_ml);
        self.kept.copy_within(first + 1..self.count, first);
        self.count -= 1;
    }
}

/// Returns true if a volume of `time_s` counts at `at_s`.
fn counts(time_s: u64, at_s: u64) -> bool {
    at_s.saturating_sub(time_s) < DAY_S
}

impl Serialize for LastDay {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.volumes().serialize(to)
    }
}

impl<'de> Deserialize<'de> for LastDay {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let mut day = Self::default();
        for (time_s, volume_ml) in Vec::<(u64, f64)>::deserialize(from)? {
            day.push(time_s, volume_ml);
        }
        Ok(day)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_volume_counts_for_a_day_to_the_second() {
        let day = LastDay::default().with(100, 7.0);
        assert_eq!(
            [day.volume_ml(100), day.volume_ml(100 + DAY_S - 1), day.volume_ml(100 + DAY_S)],
            [7.0, 7.0, 0.0]
        );
    }

    #[test]
    fn a_day_comes_back_from_its_text() {
        let day = (0..300).fold(LastDay::default(), |day, n| day.with(977 * n, 0.1 * n as f64));
        let text = serde_json::to_string(&day).unwrap();
        assert_eq!(serde_json::from_str::<LastDay>(&text).unwrap(), day);
        assert!(text.len() < 1000, "{text}");
    }

    proptest! {
        #[test]
        fn no_volume_of_the_last_day_is_missed_and_none_counts_for_more_than_25_hours(
            gaps in prop::collection::vec(0_u64..9000, 1..400),
            later_s in 0..2 * DAY_S,
        ) {
            let (mut day, mut at_s, mut all) = (LastDay::default(), 0, Vec::new());
            for gap_s in &gaps {
                at_s += gap_s;
                day = day.with(at_s, 1.0);
                all.push(at_s);
                let within = |age_s: u64| all.iter().filter(|time_s| at_s - **time_s < age_s).count() as f64;
                prop_assert!((within(DAY_S)..=within(DAY_S + SLOT_S)).contains(&day.volume_ml(at_s)));
                if within(DAY_S) <= 25.0 && gaps.len() <= 25 {
                    prop_assert_eq!(day.volume_ml(at_s), within(DAY_S));
                }
            }
            let now_s = at_s + later_s;
            let within = |age_s: u64| all.iter().filter(|time_s| now_s - **time_s < age_s).count() as f64;
            prop_assert!((within(DAY_S)..=within(DAY_S + SLOT_S)).contains(&day.volume_ml(now_s)));
        }
    }
}
