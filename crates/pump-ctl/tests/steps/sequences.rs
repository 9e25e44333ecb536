//! Random sequences of everything that a caller may do, with plans longer than the queue. A model beside the executor
//! knows only the plan: where each of its runs ends.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::LazyLock;

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Ramps, Request};
use pump_ctl::step::{Action, Brake, Direction, Feed, PushError, Segment, Stepper, StopPlan, TickRate};
use pump_model::Pump;

const MEGAHERTZ: TickRate = TickRate::from_hz(1_000_000).unwrap();

/// Sequences that are drawn.
const SEQUENCES: u64 = 100_000;

/// Random numbers: SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }

    fn one_in(&mut self, bound: u64) -> bool {
        self.below(bound) == 0
    }
}

/// Motors with their brakes, from strong to so weak that a ramp has more segments than a queue.
static MOTORS: LazyLock<Vec<(Motor, Brake)>> = LazyLock::new(|| {
    let motors = [(3200.0, 17.8, 500.0), (3200.0, 12.0, 20.0), (12_800.0, 6.0, 1.0), (400.0, 3.0, 0.5)];
    let with_brake = |(steps, speed, acceleration)| {
        let motor = Motor::new(steps, speed, acceleration);
        (motor, motor.brake(MEGAHERTZ).unwrap())
    };
    motors.into_iter().map(with_brake).collect()
});

/// Plans of each motor, forward and in reverse, as segments.
static PLANS: LazyLock<Vec<Vec<Vec<Segment>>>> = LazyLock::new(|| {
    let pump = Pump::three_roller();
    let plans = |(motor, _): &(Motor, Brake)| {
        let doser = Doser::new(&pump, Limits::new(*motor)).unwrap();
        let plan = |(volume_ml, part, ramps)| {
            let speed = Cruise::Speed { rad_s: part * motor.max_speed_rad_s };
            let request = Request::new(volume_ml, speed).with_ramps(ramps);
            doser.plan(Phase::known(0.3), &request).unwrap().segments(MEGAHERTZ).collect()
        };
        [
            (20.0, 1.0, Ramps::Fastest),
            (-8.0, 0.7, Ramps::Fastest),
            (4.0, 0.2, Ramps::LineAware),
            (-0.5, 1.0, Ramps::Fastest),
        ]
        .map(plan)
        .into()
    };
    MOTORS.iter().map(plans).collect()
});

/// Steps of segments, signed.
fn steps(segments: &[Segment]) -> i64 {
    segments.iter().map(|segment| i64::from(segment.count)).sum()
}

/// Occasions on which something could have gone wrong.
#[derive(Debug, Default)]
struct Occasions {
    steps: u64,
    stopped: u64,
    starved: u64,
    complete: u64,
    changed: u64,
    turned: u64,
    /// Stops and queues that ran dry, after which the motor came to rest exactly at the end that was told.
    to_the_end: u64,
}

/// The executor, what the caller still has to push, and what must be so.
struct Sequence<'a, const Q: usize> {
    random: Random,
    motor: usize,
    stepper: Stepper<Q>,
    /// Segments of the plan that are not pushed, the last one first, each with the end of its run.
    to_push: Vec<(Segment, i64)>,
    /// True if the caller tells the executor where the plan ends.
    tells: bool,
    /// Ends of the runs that are not over, the present run first. None if the plan has no end that anybody told.
    ends: Option<Vec<i64>>,
    /// Position after the segments of a changed plan whose end the caller forgot to tell.
    forgot: Option<i64>,
    /// End that was told last.
    told: Option<i64>,
    direction: Option<Direction>,
    promise: Option<StopPlan>,
    /// Steps made, and the time at which the last one was due.
    made: u64,
    last_due: u64,
    occasions: &'a mut Occasions,
}

impl<'a, const Q: usize> Sequence<'a, Q> {
    fn new(seed: u64, occasions: &'a mut Occasions) -> Self {
        let mut random = Random(seed);
        let motor = random.below(MOTORS.len() as u64) as usize;
        let stepper = Stepper::new(MOTORS[motor].1);
        Self {
            random,
            motor,
            stepper,
            to_push: Vec::new(),
            tells: true,
            ends: None,
            forgot: None,
            told: None,
            direction: None,
            promise: None,
            made: 0,
            last_due: 0,
            occasions,
        }
    }

    /// Draws a plan, or segments that nobody would plan: they may end at full speed.
    fn any_run(&mut self, direction: Option<Direction>) -> Vec<Segment> {
        let plans = &PLANS[self.motor];
        let mut run = if self.random.one_in(3) {
            let mut interval = 40 + self.random.below(3000);
            let count = 1 + self.random.below(30);
            let mut segments = Vec::new();
            for _ in 0..count {
                interval = (interval * (700 + self.random.below(600)) / 1000).max(20);
                let count = 1 + self.random.below(60) as i32;
                segments.push(Segment { count, interval, add: 0, frac: self.random.next() as u32 });
            }
            segments
        } else {
            plans[self.random.below(plans.len() as u64) as usize].clone()
        };
        let wanted = direction.unwrap_or(Direction::of(self.random.below(2) as i64 - 1));
        if Direction::of(steps(&run)) != wanted {
            run.iter_mut().for_each(|segment| segment.count = -segment.count);
        }
        run
    }

    /// Draws a new plan from `start` on. The motor stands there.
    fn plan(&mut self, start: i64) {
        let runs = if self.random.one_in(4) { 1 + self.random.below(3) } else { 1 };
        // Nobody can know where a plan turns round of which no end is told.
        self.tells = runs > 1 || !self.random.one_in(5);
        (self.to_push, self.promise, self.direction, self.forgot) = (Vec::new(), None, None, None);
        let (mut ends, mut from, mut direction) = (Vec::new(), start, None);
        for _ in 0..runs {
            let run = self.any_run(direction);
            let end = from + steps(&run);
            self.to_push.extend(run.iter().map(|segment| (*segment, end)));
            ends.push(end);
            (from, direction) = (end, Some(Direction::of(steps(&run)).reversed()));
        }
        self.to_push.reverse();
        self.ends = self.tells.then_some(ends);
    }

    /// Pushes one segment as a plan's sender does.
    fn push(&mut self) -> Result<(), PushError> {
        let Some((segment, end)) = self.to_push.last().copied() else { return Ok(()) };
        if self.tells {
            self.stepper.set_end(end)?;
            self.told = Some(end);
        }
        self.stepper.push(segment, MEGAHERTZ)?;
        self.to_push.pop();
        Ok(())
    }

    /// Fills the queue from a feed, as far as the present run goes.
    fn fill(&mut self) {
        let Some((_, end)) = self.to_push.last().copied() else { return };
        if !self.tells || self.to_push.iter().any(|(_, other)| *other != end) {
            return;
        }
        let rest: Vec<_> = self.to_push.iter().rev().map(|(segment, _)| *segment).collect();
        let mut feed = Feed::new(MEGAHERTZ, rest.iter().copied()).with_steps(steps(&rest));
        let filled = self.stepper.fill(&mut feed);
        assert!(self.promise.is_none() || filled.is_err());
        let left = feed.count();
        self.to_push.truncate(left);
    }

    /// Counts the steps that were pushed and are not made, and returns the position after them.
    fn pushed_to(&self) -> i64 {
        let left: i64 = self.to_push.iter().map(|(segment, _)| i64::from(segment.count)).sum();
        let last = self.to_push.first().map(|(_, end)| *end);
        last.map_or_else(|| self.ends.as_ref().and_then(|ends| ends.last().copied()), |end| Some(end - left))
            .unwrap_or(i64::MAX)
    }

    /// Says that the plan ends with what was pushed.
    fn finish(&mut self) {
        let moves = self.stepper.is_moving() || self.stepper.room() < Q;
        // An empty segment is refused, by a motor that stops for another reason.
        let stops = self.stepper.push(Segment::default(), MEGAHERTZ) == Err(PushError::Stopped);
        self.stepper.finish();
        if stops || !moves || !self.tells {
            return;
        }
        if let Some(to) = self.forgot {
            self.ends = Some(vec![to]);
            return;
        }
        let to = self.pushed_to();
        let run = self.to_push.last().map(|(_, end)| *end);
        if let (Some(ends), Some(run)) = (&mut self.ends, run) {
            let kept = ends.iter().position(|end| *end == run).unwrap_or(ends.len());
            ends.truncate(kept);
            if ends.last() != Some(&to) {
                ends.push(to);
            }
            self.to_push.clear();
        }
    }

    /// Makes up to `count` steps, each at its time or late. Returns the end of the move.
    fn go_on(&mut self, count: u64) -> Option<Action> {
        for _ in 0..count {
            let due = self.stepper.next_deadline().unwrap_or(self.last_due);
            let late = if self.random.one_in(50) { self.random.below(3000) } else { 0 };
            let before = self.stepper.position();
            match self.stepper.on_deadline(due + late) {
                Action::Step { direction, .. } => {
                    self.made += 1;
                    self.occasions.steps += 1;
                    assert_eq!(self.stepper.position(), before + i64::from(direction.sign()));
                    assert!(due >= self.last_due, "a step at {due} after one at {}", self.last_due);
                    self.last_due = due;
                    self.check_step(before, direction);
                }
                Action::Wait => panic!("the motor waits at its own deadline"),
                ended => return Some(ended),
            }
        }
        None
    }

    /// Holds a step against the runs of the plan.
    fn check_step(&mut self, before: i64, direction: Direction) {
        let turns = self.direction.is_some_and(|last| last != direction);
        match &mut self.ends {
            None => assert!(!turns, "the motor turns round by itself at {before}"),
            Some(ends) => {
                if ends.first() == Some(&before) {
                    assert!(self.promise.is_none(), "a step beyond the run's end {before} after a stop");
                    ends.remove(0);
                }
                let end = *ends.first().unwrap_or_else(|| panic!("a step beyond the plan's end {before}"));
                assert_eq!(direction, Direction::of(end - before), "from {before}, to the end {end}");
            }
        }
        self.occasions.turned += u64::from(turns);
        self.direction = Some(direction);
    }

    fn stop(&mut self) {
        let due = self.stepper.next_deadline().unwrap_or(self.last_due);
        let now =
            if self.random.one_in(4) { due + self.random.below(100_000) } else { due.saturating_sub(1) };
        let promise = self.stepper.stop(now);
        if let Some(before) = self.promise {
            assert_eq!(promise, before, "a second stop answers otherwise");
        }
        self.promise = Some(promise);
        // The promise lies on the present run, or on the next one where the motor is about to turn round.
        let at = self.stepper.position();
        if let Some(ends) = &self.ends {
            let reach = ends.iter().take(2).chain([&at]);
            let (low, high) = (reach.clone().min().copied(), reach.max().copied());
            assert!(
                low <= Some(promise.final_count) && Some(promise.final_count) <= high,
                "{promise:?} {ends:?}"
            );
        }
    }

    /// Replaces the rest of a plan of one run while the motor turns.
    fn change(&mut self) {
        if self.direction.is_none() || self.ends.as_ref().is_some_and(|ends| ends.len() > 1) {
            return;
        }
        let not_before = self.last_due + self.random.below(200_000);
        let Some(junction) = self.stepper.junction(not_before) else { return };
        assert_eq!(self.stepper.retarget(junction.at), Some(junction));
        self.occasions.changed += 1;
        let run = self.any_run(self.direction);
        let end = junction.position + steps(&run);
        self.to_push = run.iter().rev().map(|segment| (*segment, end)).collect();
        let forgets = self.tells && self.random.one_in(4);
        if self.tells && !forgets {
            self.stepper.set_end(end).unwrap();
            self.ends = Some(vec![end]);
            self.forgot = None;
        } else if forgets {
            // The old end holds, whatever is pushed.
            let mut to = junction.position;
            while let Some((segment, _)) = self.to_push.pop() {
                let pushed = self.stepper.push(segment, MEGAHERTZ);
                assert!(
                    matches!(pushed, Ok(()) | Err(PushError::Beyond { .. } | PushError::Full)),
                    "{pushed:?}"
                );
                if pushed.is_err() {
                    break;
                }
                to += i64::from(segment.count);
            }
            self.forgot = Some(to);
            self.to_push.clear();
        }
    }

    /// Checks where the motor stands, and clears the way for the next plan.
    fn rest(&mut self, ended: Action, made_before_stop: u64) {
        assert!(!self.stepper.is_moving());
        let at = self.stepper.position();
        match ended {
            Action::Starved => self.occasions.starved += 1,
            _ if self.promise.is_some() => self.occasions.stopped += 1,
            _ => self.occasions.complete += 1,
        }
        let early = ended == Action::Starved || self.promise.is_some();
        let at_end = self.ends.as_ref().is_some_and(|ends| ends.first() == Some(&at));
        self.occasions.to_the_end += u64::from(early && at_end);
        if let Some(promise) = self.promise {
            assert_eq!(at, promise.final_count);
            if self.made > made_before_stop {
                assert_eq!(self.last_due, promise.last_step_at);
            }
        } else if ended == Action::Done && self.tells {
            // A run is the last one as long as no other end is told.
            let ends = self.ends.as_deref().unwrap_or_default();
            let complete = ends == [at] || (ends.first() == Some(&at) && self.told == Some(at));
            assert!(complete, "complete at {at} before the ends {ends:?}");
        }
        assert!(ended != Action::Starved || self.stepper.start(0).is_err());
    }

    fn run(&mut self) {
        for _ in 0..1 + self.random.below(3) {
            if self.random.one_in(5) {
                let position = self.random.below(1 << 40) as i64 - (1 << 39);
                assert!(self.stepper.set_position(position));
            }
            self.plan(self.stepper.position());
            let ahead = 1 + self.random.below(2 * Q as u64);
            for _ in 0..ahead {
                if self.push().is_err() {
                    break;
                }
            }
            if self.random.one_in(10) {
                self.stop();
                assert!(self.stepper.start(self.last_due).is_err());
            }
            let started = self.stepper.start(self.last_due + self.random.below(1000)).is_ok();
            assert_eq!(started, self.promise.is_none());
            self.until_it_stands();
            assert!(self.stepper.clear());
        }
    }

    /// Does anything until the motor stands.
    fn until_it_stands(&mut self) {
        let starves = self.random.one_in(3);
        let mut made_before_stop = self.made;
        loop {
            let count = match self.random.below(4) {
                0 => self.random.below(4),
                1 => self.random.below(50),
                _ => self.random.below(3000),
            };
            if let Some(ended) = self.go_on(count) {
                return self.rest(ended, made_before_stop);
            }
            match self.random.below(24) {
                0 => {
                    made_before_stop = if self.promise.is_some() { made_before_stop } else { self.made };
                    self.stop();
                }
                1 => self.finish(),
                2 => self.change(),
                3 if self.stepper.is_moving() => assert!(!self.stepper.clear()),
                4..=12 => self.fill(),
                _ if starves && self.random.one_in(3) => {}
                _ => {
                    for _ in 0..=self.random.below(2 * Q as u64) {
                        if self.push().is_err() {
                            break;
                        }
                    }
                }
            }
            assert!(self.promise.is_none() || self.push().is_err() || self.to_push.is_empty());
        }
    }
}

#[test]
fn no_sequence_leads_beyond_the_plan_or_turns_round_by_itself() {
    let mut occasions = Occasions::default();
    for seed in 0..SEQUENCES {
        let ran = catch_unwind(AssertUnwindSafe(|| match seed % 3 {
            0 => Sequence::<2>::new(seed, &mut occasions).run(),
            1 => Sequence::<5>::new(seed, &mut occasions).run(),
            _ => Sequence::<32>::new(seed, &mut occasions).run(),
        }));
        assert!(ran.is_ok(), "sequence {seed}");
    }
    // The draw is worth something only if these came about often.
    let Occasions { steps, stopped, starved, complete, changed, turned, to_the_end } = occasions;
    assert!(steps > 100 * SEQUENCES, "{occasions:?}");
    let often = SEQUENCES / 50;
    assert!(
        [stopped, starved, complete, changed, turned, to_the_end].iter().all(|n| *n > often),
        "{occasions:?}"
    );
}
