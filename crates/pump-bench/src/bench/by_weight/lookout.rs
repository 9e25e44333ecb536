//! The lookout on a balance while the pump turns: it says when the motor must stop, and why.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::aim::Aim;
use super::angles::Angles;
use super::course::Course;
use super::readings::Readings;
use crate::dosing::WeightFault;

/// Longest time for which a balance may be listened to without a reading while the pump turns, in s.
pub(super) const QUIET_S: f64 = 2.0;

/// Longest time without a reading while the pump turns, whatever the cause, in s. A busy computer may take some of it.
const UNREAD_S: f64 = 15.0;

/// Time after which the balance must have seen what the pump turned for. A balance's filter, the fall of drops and the
/// line's settling take less.
const SEEN_AFTER: Duration = Duration::from_secs(3);

/// Time between two notes of how far the pump has turned.
const NOTED: Duration = Duration::from_millis(20);

/// Longest time for which the notes are kept, beyond what the readings lag behind.
const KEPT: Duration = Duration::from_secs(5);

/// Reason to stop the motor.
#[derive(Debug)]
pub(super) enum Stop {
    /// The mass on the balance and the flow that still arrives make up the dose.
    Enough,
    /// The dose cannot go on.
    Fault(WeightFault),
}

/// Lookout on the balance during one stretch.
#[derive(Debug)]
pub(super) struct Lookout<'a> {
    pub(super) aim: &'a Aim,
    pub(super) angles: &'a Angles,
    /// Turn since the start of the dose before the stretch, in rad.
    pub(super) from_rad: f64,
    pub(super) readings: &'a Readings,
    /// Reading before the dose, in g.
    pub(super) tare_g: f64,
    /// Reading before the stretch, in g.
    pub(super) begun_g: f64,
    pub(super) z_ml_g: f64,
    /// Time by which a reading lags behind the pump: what it turned for since then still arrives.
    pub(super) lag: Duration,
    /// Factor of the pump's volumes.
    pub(super) factor: f64,
    began: Instant,
    most_g: f64,
    /// Turns since the start of the dose, in rad, and when.
    turned: VecDeque<(Instant, f64)>,
    judged: Option<Instant>,
}

impl<'a> Lookout<'a> {
    /// Begins to look out on a stretch of `course`.
    pub(super) fn new(course: &'a Course<'_>, readings: &'a Readings) -> Self {
        let (began, most_g) = (Instant::now(), course.shown_g);
        Self {
            aim: &course.aim,
            angles: &course.angles,
            from_rad: course.turned_rad(),
            readings,
            tare_g: course.tare_g,
            begun_g: course.shown_g,
            z_ml_g: course.prepared.z_ml_g,
            lag: Duration::from_secs_f64(course.reckoned().0),
            factor: course.factor(),
            began,
            most_g,
            turned: VecDeque::new(),
            judged: None,
        }
    }

    /// Returns the reason to stop the motor, once the stretch has turned by `made_rad`. `stop_rad` gives the turn in
    /// which the motor stops.
    pub(super) fn look(&mut self, made_rad: f64, stop_rad: impl FnOnce() -> f64) -> Option<Stop> {
        let (now, turned_rad) = (Instant::now(), self.from_rad + made_rad);
        if let Some(error) = self.readings.take_fault() {
            return Some(Stop::Fault(WeightFault::Balance(error)));
        }
        self.note(now, turned_rad);
        let last = self.readings.last();
        let silent_s = self.readings.silent().as_secs_f64();
        if silent_s >= QUIET_S {
            return Some(Stop::Fault(WeightFault::Quiet { for_s: silent_s, allowed_s: QUIET_S }));
        }
        let unread =
            now.saturating_duration_since(last.map_or(self.began, |sample| sample.at.max(self.began)));
        if unread.as_secs_f64() > UNREAD_S {
            let (for_s, allowed_s) = (unread.as_secs_f64(), UNREAD_S);
            return Some(Stop::Fault(WeightFault::Unread { for_s, allowed_s }));
        }
        let sample = last.filter(|sample| self.judged != Some(sample.at))?;
        self.judged = Some(sample.at);
        let mass_g = sample.reading.mass_g;
        self.most_g = self.most_g.max(mass_g);
        if let Some(fault) = self.fault_of(sample.at, mass_g) {
            return Some(Stop::Fault(fault));
        }
        let weighed_ml = (mass_g - self.tare_g) * self.z_ml_g;
        let seen_rad = self.turned_until(sample.at.checked_sub(self.lag));
        let (_, under_way_ml) = self.angles.range_ml((seen_rad, turned_rad + stop_rad()));
        let enough = weighed_ml + self.factor * under_way_ml >= self.aim.enough_ml();
        enough.then_some(Stop::Enough)
    }

    /// Notes how far the pump has turned, and forgets what is long ago.
    fn note(&mut self, now: Instant, turned_rad: f64) {
        if self.turned.back().is_none_or(|(at, _)| now - *at >= NOTED) {
            self.turned.push_back((now, turned_rad));
        }
        while self.turned.get(1).is_some_and(|(at, _)| now - *at >= KEPT + self.lag) {
            self.turned.pop_front();
        }
    }

    /// Returns the turn since the start of the dose at an instant, in rad: that before the stretch before its first
    /// note.
    fn turned_until(&self, at: Option<Instant>) -> f64 {
        let note = self.turned.iter().rev().find(|(noted, _)| at.is_some_and(|at| *noted <= at));
        note.map_or(self.from_rad, |(_, turned_rad)| *turned_rad)
    }

    /// Returns the notes of how far the pump had turned since the start of the dose, in rad, and when.
    pub(super) fn notes(self) -> VecDeque<(Instant, f64)> {
        self.turned
    }

    /// Returns the fault that a reading of the instant `at` shows.
    fn fault_of(&self, at: Instant, mass_g: f64) -> Option<WeightFault> {
        let fallen_ml = (self.most_g - mass_g) * self.z_ml_g;
        // A stream that lands presses on the vessel, and its end takes that away again: 5 mL/s from 0.3 m are 1.2 g.
        if fallen_ml > 2.0 + self.aim.drop_ml + 10.0 * self.aim.digit_ml {
            return Some(WeightFault::Fell { from_g: self.most_g, to_g: mass_g });
        }
        let long_ago_rad = self.turned_until(at.checked_sub(SEEN_AFTER.max(2 * self.lag)));
        let (long_ago_ml, _) = self.angles.range_ml((self.from_rad, long_ago_rad));
        // A mass that rose and fell has left the balance, and was judged above.
        let rose_g = self.most_g - self.begun_g;
        (rose_g * self.z_ml_g < self.aim.least_rise_ml(long_ago_ml))
            .then_some(WeightFault::NotRising { rose_g, turned_ml: long_ago_ml })
    }
}
