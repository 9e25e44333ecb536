//! An input that triggers a group once it has a value for some samples.

/// Search for the value.
#[derive(Debug, Clone, Copy)]
struct Search {
    at: u64,
    value: bool,
    sample: u64,
    count: u32,
    rest: u64,
    /// Samples that are left, and the tick at which a fresh try begins.
    left: u32,
    again: u64,
    group: usize,
    reason: u32,
}

/// Input.
#[derive(Debug)]
pub(in super::super) struct Endstop {
    pub(in super::super) pin: u32,
    /// True if a resistor pulls the input up.
    pub(in super::super) is_pulled: bool,
    search: Option<Search>,
    /// Tick that the board tells as `next_clock`: where a fresh try would have begun.
    pub(in super::super) told: u64,
    pub(in super::super) is_homing: bool,
}

/// Numbers of `endstop_home`.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Homing {
    pub(in super::super) at: u64,
    pub(in super::super) sample: u32,
    pub(in super::super) count: u32,
    pub(in super::super) rest: u32,
    pub(in super::super) value: bool,
    pub(in super::super) group: usize,
    pub(in super::super) reason: u32,
}

impl Endstop {
    pub(in super::super) fn new(pin: u32, is_pulled: bool) -> Self {
        Self { pin, is_pulled, search: None, told: 0, is_homing: false }
    }

    /// Begins a search, or ends it if there is no sample to take.
    pub(in super::super) fn home(&mut self, homing: Homing) {
        let Homing { at, sample, count, rest, value, group, reason } = homing;
        let (sample, rest) = (u64::from(sample), u64::from(rest));
        self.is_homing = count > 0;
        let search = Search { at, value, sample, count, rest, left: count, again: at, group, reason };
        self.search = self.is_homing.then_some(search);
    }

    /// Returns the tick of the next sample.
    pub(in super::super) fn next(&self) -> Option<u64> {
        self.search.map(|search| search.at)
    }

    /// Takes the sample of tick `now`. Returns the group to trigger and its reason once the value was there often
    /// enough.
    pub(in super::super) fn sample(&mut self, value: bool, now: u64) -> Option<(usize, u32)> {
        let search = self.search.as_mut()?;
        if search.left == search.count {
            search.again = now + search.rest;
        }
        if value != search.value {
            (search.left, search.at) = (search.count, search.again);
            return None;
        }
        self.told = search.again;
        search.left -= 1;
        search.at = now + search.sample;
        let found = (search.left == 0).then_some((search.group, search.reason));
        if found.is_some() {
            self.search = None;
        }
        found
    }

    /// Forgets the search, at a shutdown.
    pub(in super::super) fn forget(&mut self) {
        (self.search, self.is_homing) = (None, false);
    }
}

#[cfg(test)]
mod tests {
    use super::{Endstop, Homing};

    #[test]
    fn a_value_triggers_once_it_was_there_for_all_samples() {
        let mut endstop = Endstop::new(3, true);
        endstop.home(Homing { at: 100, sample: 2, count: 3, rest: 50, value: true, group: 7, reason: 1 });
        assert_eq!((endstop.next(), endstop.sample(false, 100)), (Some(100), None));
        assert_eq!((endstop.next(), endstop.sample(true, 150)), (Some(150), None));
        assert_eq!((endstop.next(), endstop.sample(false, 152)), (Some(152), None));
        for at in [200, 202] {
            assert_eq!((endstop.next(), endstop.sample(true, at)), (Some(at), None));
        }
        assert_eq!((endstop.next(), endstop.sample(true, 204)), (Some(204), Some((7, 1))));
        assert_eq!((endstop.next(), endstop.told), (None, 250));
    }
}
