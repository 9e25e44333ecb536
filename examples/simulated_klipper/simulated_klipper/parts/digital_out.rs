//! A digital output, whose changes come at their ticks, and which may not be away from its default for long.

use std::collections::VecDeque;

use super::super::dictionary::Reason;
use super::stepper::widened;

/// Digital output.
#[derive(Debug)]
pub(in super::super) struct DigitalOut {
    pub(in super::super) pin: u32,
    pub(in super::super) default: bool,
    /// Most ticks away from the default without a further change. 0 is no limit.
    most: u64,
    queue: VecDeque<(u64, bool)>,
    /// Tick by which the next change must come.
    end: Option<u64>,
}

impl DigitalOut {
    pub(in super::super) fn new(pin: u32, value: bool, default: bool, most: u32, now: u64) -> Self {
        let most = u64::from(most);
        let mut output = Self { pin, default, most, queue: VecDeque::new(), end: None };
        output.watch(value, now);
        output
    }

    /// Sets the tick by which the next change must come, once the output has this value.
    fn watch(&mut self, value: bool, now: u64) {
        self.end = (value != self.default && self.most > 0).then(|| now + self.most);
    }

    /// Takes a change for a later tick. It occupies a slot.
    pub(in super::super) fn queue(&mut self, clock: u32, value: bool, now: u64) -> Result<(), Reason> {
        let at = widened(clock, now);
        if at < now {
            return Err(Reason::TooClose);
        }
        if self.queue.is_empty() && self.end.is_some_and(|end| at > end) {
            return Err(Reason::LatePin);
        }
        self.queue.push_back((at, value));
        Ok(())
    }

    /// Changes the output at once.
    pub(in super::super) fn update(&mut self, value: bool, now: u64) -> Result<(), Reason> {
        if !self.queue.is_empty() {
            return Err(Reason::MixedPin);
        }
        self.watch(value, now);
        Ok(())
    }

    /// Returns the tick of the next change, or that by which it must come.
    pub(in super::super) fn next(&self) -> Option<u64> {
        self.queue.front().map(|(at, _)| *at).or(self.end)
    }

    /// Makes the change of tick `now`, which frees a slot. Returns the value.
    pub(in super::super) fn make(&mut self, now: u64) -> Result<bool, Reason> {
        let Some((_, value)) = self.queue.pop_front() else { return Err(Reason::MissedPin) };
        self.watch(value, now);
        match (self.queue.front(), self.end) {
            (Some((at, _)), Some(end)) if *at > end => Err(Reason::LatePin),
            _ => Ok(value),
        }
    }

    /// Forgets all changes, at a shutdown.
    pub(in super::super) fn forget(&mut self) {
        self.queue.clear();
        self.end = None;
    }
}

#[cfg(test)]
mod tests {
    use super::{DigitalOut, Reason};

    #[test]
    fn an_output_may_be_away_from_its_default_only_as_long_as_was_said() {
        // docs/MCU_Commands.md, config_digital_out: default_value 0, max_duration 16000.
        let mut output = DigitalOut::new(3, false, false, 16_000, 0);
        assert_eq!(output.next(), None);
        output.queue(1000, true, 0).unwrap();
        assert_eq!(output.make(1000), Ok(true));
        assert_eq!(output.next(), Some(17_000));
        assert_eq!(output.queue(17_001, false, 2000), Err(Reason::LatePin));
        output.queue(17_000, true, 2000).unwrap();
        assert_eq!(output.make(17_000), Ok(true));
        assert_eq!(output.make(33_000), Err(Reason::MissedPin));
    }

    #[test]
    fn late_changes_and_an_update_between_changes_are_refused() {
        let mut output = DigitalOut::new(3, true, true, 0, 0);
        assert_eq!(output.queue(99, false, 100), Err(Reason::TooClose));
        output.queue(200, false, 100).unwrap();
        assert_eq!(output.update(true, 150), Err(Reason::MixedPin));
        assert_eq!(output.make(200), Ok(false));
        // Without a limit it stays as it is.
        assert_eq!(output.next(), None);
        output.update(true, 300).unwrap();
    }
}
