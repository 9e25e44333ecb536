//! A trigger group: what triggers it stops its steppers. It expires unless a host puts that off.

/// Trigger group.
#[derive(Debug, Default)]
pub(in super::super) struct Trigger {
    pub(in super::super) can_trigger: bool,
    /// Reason of the trigger, as the host has named it.
    pub(in super::super) reason: u32,
    expire_reason: u32,
    expires: Option<u64>,
    reports: Option<(u64, u64)>,
}

/// Event of a trigger group.
#[derive(Debug, PartialEq, Eq)]
pub(in super::super) enum TriggerEvent {
    /// It expired, with its reason.
    Expired(u32),
    /// The trigger has a state to report.
    Report,
}

impl Trigger {
    /// Makes it ready. It reports from tick `at` on, once in `every` ticks; 0 is never.
    pub(in super::super) fn start(&mut self, at: u64, every: u32, expire_reason: u32) {
        let reports = (every > 0).then(|| (at, u64::from(every)));
        *self = Self { can_trigger: true, reason: 0, expire_reason, expires: None, reports };
    }

    /// Puts its end off to tick `at`.
    pub(in super::super) fn put_off(&mut self, at: u64) {
        if self.can_trigger {
            self.expires = Some(at);
        }
    }

    /// Triggers it. Returns true if it was ready.
    pub(in super::super) fn trigger(&mut self, reason: u32) -> bool {
        let was_ready = self.can_trigger;
        if was_ready {
            (self.can_trigger, self.reason) = (false, reason);
        }
        was_ready
    }

    /// Ends it: it neither expires nor reports.
    pub(in super::super) fn end(&mut self) {
        (self.can_trigger, self.expires, self.reports) = (false, None, None);
    }

    /// Returns the tick at which it expires.
    pub(in super::super) fn expires_at(&self) -> Option<u64> {
        self.expires.filter(|_| self.can_trigger)
    }

    /// Returns the tick of its next event.
    pub(in super::super) fn next(&self) -> Option<u64> {
        let reports = self.reports.map(|(at, _)| at);
        self.expires.into_iter().chain(reports).min()
    }

    /// Returns the event of tick `now`.
    pub(in super::super) fn make(&mut self, now: u64) -> TriggerEvent {
        if self.expires.is_some_and(|at| at <= now) {
            self.expires = None;
            return TriggerEvent::Expired(self.expire_reason);
        }
        if let Some((at, every)) = &mut self.reports {
            *at += *every;
        }
        TriggerEvent::Report
    }
}

#[cfg(test)]
mod tests {
    use super::{Trigger, TriggerEvent};

    #[test]
    fn a_group_reports_and_expires_unless_that_is_put_off() {
        let mut trigger = Trigger::default();
        trigger.put_off(5);
        assert_eq!(trigger.next(), None);
        trigger.start(100, 50, 4);
        trigger.put_off(160);
        assert_eq!((trigger.next(), trigger.make(100)), (Some(100), TriggerEvent::Report));
        trigger.put_off(220);
        assert_eq!((trigger.next(), trigger.make(150)), (Some(150), TriggerEvent::Report));
        assert_eq!((trigger.next(), trigger.make(200)), (Some(200), TriggerEvent::Report));
        assert_eq!((trigger.next(), trigger.make(220)), (Some(220), TriggerEvent::Expired(4)));
        assert!(trigger.trigger(4));
        assert!(!trigger.trigger(1) && trigger.reason == 4);
    }
}
