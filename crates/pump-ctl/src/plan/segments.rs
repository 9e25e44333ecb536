//! The steps of a plan as runs of integers for the executor.

use libm::floor;

use super::Plan;
use super::profile::{Along, Profile};
use crate::step::{Direction, Feed, Segment, TickRate};

/// Largest distance of a step's time from the plan's before it is rounded to a tick, ticks. With the rounding
/// the distance is less than one tick.
const FIT_TICKS: f64 = 0.25;

/// Number of steps over which the last digits of interval and add do not count. Beyond, the end shows them.
const MANY: u32 = 1 << 12;

/// Fractions of the executor in a tick, 2^32.
const FRACTIONS: f64 = 4_294_967_296.0;

/// The [`Segment`]s of a plan in order, computed one by one. No memory is needed for each step.
///
/// The step times of a segment are a parabola in the step's number, the step times of a ramp a root. Each
/// segment is as long as a parabola stays within a quarter of a tick of the plan. A segment starts where the
/// last one ended, in whole fractions, so errors do not add up.
#[derive(Debug, Clone)]
pub struct Segments {
    profile: Profile,
    tick_rate: TickRate,
    tick_hz: f64,
    step_rad: f64,
    direction: Direction,
    /// Steps of the whole plan.
    steps: u64,
    /// Steps up to the end of the leg under way.
    leg_steps: u64,
    /// Leg under way, if it follows an envelope.
    along: Option<Along>,
    made: u64,
    /// Time at which the last step made is due, 2^-32 tick since the start.
    at: i128,
    /// Number of steps that the next segment tries to hold.
    guess: u64,
}

impl Plan {
    /// Returns the segments for a timer of this rate.
    ///
    /// Every step comes within one tick of [`Self::each_step`], in a dose of up to 2^50 ticks (35 years at 1 MHz,
    /// 77 days at 168 MHz). A timer slower than the steps gives segments that [`crate::step::Stepper::push`]
    /// refuses.
    pub fn segments(&self, tick_rate: TickRate) -> Segments {
        Segments {
            profile: self.profile,
            tick_rate,
            tick_hz: f64::from(tick_rate.hz()),
            step_rad: self.step_rad,
            direction: self.direction(),
            steps: self.steps.unsigned_abs(),
            leg_steps: 0,
            along: None,
            made: 0,
            at: 0,
            guess: 0,
        }
    }
}

impl Segments {
    /// Returns the rate of the timer that the segments are made for.
    pub fn tick_rate(&self) -> TickRate {
        self.tick_rate
    }

    /// Returns the segments of the steps after the first `made`, or those that are left if more are made.
    ///
    /// They begin at the time at which the plan makes step `made`, and are cut anew from there.
    ///
    /// ```
    /// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
    /// use pump_ctl::step::{Segment, TickRate};
    ///
    /// let pump = pump_model::Pump::three_roller();
    /// let limits = Limits::new(Motor::new(12_800.0, 17.8, 500.0));
    /// let request = Request::new(20.0, Cruise::Flow { ml_s: 4.0 }).with_smooth(true);
    /// let plan = Doser::new(&pump, limits)?.plan(Phase::known(0.3), &request)?;
    /// let segments = plan.segments(TickRate::from_hz(1_000_000).ok_or("no rate")?);
    /// let steps = |segments: pump_ctl::plan::Segments| -> u64 { segments.map(|part| part.steps() as u64).sum() };
    /// assert_eq!(steps(segments.clone().after(5_000)), steps(segments) - 5_000);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn after(mut self, made: u64) -> Self {
        let made = made.min(self.steps);
        if made > self.made {
            self.along = None;
            let due_s = self.profile.time_of(made as f64 * self.step_rad);
            self.at = (due_s * self.tick_hz * FRACTIONS) as i128;
            // The next segment enters the leg of its first step.
            (self.made, self.leg_steps) = (made, made);
        }
        self
    }

    /// Returns the segments as a feed for the executor, which keeps their tick rate.
    ///
    /// The feed knows how many steps are to come, so the executor never goes beyond the plan.
    pub fn feed(self) -> Feed<Self> {
        let steps = i64::try_from(self.steps.saturating_sub(self.made)).unwrap_or(i64::MAX);
        let steps = i64::from(self.direction.sign()) * steps;
        Feed::new(self.tick_rate, self).with_steps(steps)
    }

    /// Counts the steps of the segments not yet taken that are due by tick `since_start`. Ticks count from a
    /// start at tick 0.
    ///
    /// [`crate::step::Stepper::position_at`] gives this count for a move that was not stopped, but not as far
    /// back.
    pub fn steps_by(self, since_start: u64) -> u64 {
        // The executor rounds to whole ticks.
        let by = (i128::from(since_start) << 32) + (1 << 31) - 1;
        let (before, mut at) = (self.made, self.at);
        let mut steps = before;
        for segment in self {
            let due = segment.steps_within(by - at, segment.steps());
            steps += u64::from(due);
            if due < segment.steps() {
                break;
            }
            at += segment.span(segment.steps());
        }
        steps - before
    }

    /// Returns the time at which step `number` of the plan is due, ticks since the start.
    fn due(&self, number: u64) -> f64 {
        let turned_rad = number as f64 * self.step_rad;
        let due_s = match &self.along {
            Some(along) => along.time_of(turned_rad),
            None => self.profile.time_of(turned_rad),
        };
        due_s * self.tick_hz
    }

    /// Goes on to the next leg that has steps.
    fn enter_leg(&mut self) {
        let next = self.made + 1;
        let next_rad = next as f64 * self.step_rad;
        self.along = self.profile.along_at(next_rad);
        let corner_rad = self.profile.corner_from(next_rad);
        self.leg_steps = (floor(corner_rad / self.step_rad) as u64).clamp(next, self.steps.max(next));
        self.guess = u64::MAX;
    }

    /// Returns the number of steps, up to `most`, over which a parabola stays near a leg along an envelope, or none
    /// where single precision cannot tell.
    ///
    /// Seven digits suffice to compare times of 2^16 ticks after one step with each other. Single precision is in a
    /// microcontroller's hardware. The last step made may lie on the leg before.
    fn steps_along(&self, along: &Along, most: u32) -> Option<u32> {
        /// Longest time that is told to a fiftieth of a tick, ticks.
        const REACH: f32 = 65_536.0;
        /// Largest distance of a step's time from the plan's, ticks. Single precision adds a fiftieth.
        const NEAR: f32 = FIT_TICKS as f32;
        /// Number of steps of which every one is looked at.
        const FEW: u32 = 8;
        let next_rad = (self.made + 1) as f64 * self.step_rad;
        let next = (along.time_of(next_rad) * self.tick_hz - self.at as f64 / FRACTIONS) as f32;
        let after = along.times_after(next_rad, self.step_rad, self.tick_hz);
        let due = |n: f32| next + after(n - 1.0);
        let mut count = most.min(MANY);
        loop {
            count = if count < 2 { 1 } else { count & !1 };
            let (half, end) = ((count / 2) as f32, due(count as f32));
            // It is not a number where the rotor stands.
            if end.is_nan() || end > REACH {
                return None;
            }
            if count == 1 {
                return Some(1);
            }
            let middle = due(half);
            let add = (end - 2.0 * middle) / (half * half);
            let interval = middle / half - 0.5 * add * (half - 1.0);
            let near = |k: u32| {
                let k = k as f32;
                (k * (interval + 0.5 * add * (k - 1.0)) - due(k)).abs() <= NEAR
            };
            let look = |n: u32| if count > FEW { n * count / FEW } else { n };
            if (1..count.min(FEW)).all(|n| near(look(n))) && near(1) && near(count - 1) {
                return Some(count);
            }
            count /= 2;
        }
    }

    /// Fits a parabola through the last step made, the middle and the end of `count` steps. `count` is even
    /// or 1.
    fn fit(&self, count: u32) -> Segment {
        let half = f64::from(count / 2);
        let elapsed = |k: u32| self.due(self.made + u64::from(k)) - self.at as f64 / FRACTIONS;
        let (interval, add) = if count < 2 {
            (elapsed(1), 0.0)
        } else {
            let (middle, end) = (elapsed(count / 2), elapsed(count));
            let add = (end - 2.0 * middle) / (half * half);
            (middle / half - 0.5 * add * (half - 1.0), add)
        };
        let fixed = (interval * FRACTIONS + 0.5) as i128;
        Segment {
            count: i32::try_from(count).unwrap_or(i32::MAX),
            interval: (fixed >> 32) as u64,
            frac: fixed as u32,
            add: floor(add * FRACTIONS + 0.5) as i64,
        }
    }

    /// Returns true if the steps of the segment are due within a quarter of a tick of the plan.
    ///
    /// A parabola through a root errs most a quarter of the way from the ends, or nearer to them where the
    /// root bends. The check looks there, and at every step of a short segment.
    fn holds(&self, segment: &Segment) -> bool {
        let count = segment.steps();
        let near = |k: u32| {
            let due = (self.at + segment.span(k)) as f64 / FRACTIONS;
            // Times are known to some parts in 2^52 only. After 2^50 ticks that is more than a quarter of a
            // tick.
            (due - self.due(self.made + u64::from(k))).abs() <= FIT_TICKS.max(2.0 * f64::EPSILON * due)
        };
        if count <= 8 {
            // The parabola passes through the middle and the end.
            return (1..count).filter(|k| 2 * k != count).all(near);
        }
        let eighth = count / 8;
        [1, 2, count - 1].into_iter().all(near)
            && (1..8).all(|n| near(n * eighth))
            && (count <= MANY || near(count))
    }
}

impl Iterator for Segments {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        if self.made >= self.steps {
            return None;
        }
        if self.made >= self.leg_steps {
            self.enter_leg();
        }
        let most = self.guess.min(self.leg_steps - self.made).min(1 << 30);
        let mut count = u32::try_from(most).unwrap_or(1);
        let along = self.along.as_ref().and_then(|along| self.steps_along(along, count));
        let mut segment = loop {
            count = along.unwrap_or(if count < 2 { 1 } else { count & !1 });
            let segment = self.fit(count);
            if along.is_some() || count == 1 || self.holds(&segment) {
                break segment;
            }
            count /= 2;
        };
        self.guess = 2 * u64::from(count);
        self.made += u64::from(count);
        self.at += segment.span(count);
        if self.direction == Direction::Reverse {
            segment.count = -segment.count;
        }
        Some(segment)
    }
}
