//! Random plans through the refit, held against the times of their steps, and what it refuses.
//!
//! `KLIPPER_PLANS` is the number of random plans; `make long` draws 10,000.
#![allow(clippy::print_stdout, reason = "the figures are for whoever runs the test")]

use std::f64::consts::TAU;

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, Request};
use pump_ctl::step::TickRate;
use pump_model::{Geometry, Line, Pump, RollerVolume, Variant};

use super::refit::{Refit, StepRun};
use super::{RefitError, StepCommand, StepTimer};

/// Plans that are drawn, unless KLIPPER_PLANS says how many.
const PLANS: u32 = 500;

/// Clocks of boards, MHz: AVR, SAM, LPC, RP2040, STM32.
const CLOCKS_MHZ: [u32; 13] = [8, 12, 16, 20, 64, 72, 84, 120, 125, 168, 180, 400, 520];

/// Shortest interval of the boards here, in us.
const SHORTEST_US: f64 = 2.0;

fn timer(mhz: u32) -> StepTimer {
    StepTimer::new(mhz * 1_000_000, (SHORTEST_US * f64::from(mhz)) as u32).unwrap()
}

/// Plays a run as a board does: it waits, makes a step, and adds to the interval. Returns the ticks of the steps.
fn played(run: &StepRun) -> Vec<u64> {
    let StepCommand { interval, count, add } = run.command;
    let (mut at, mut interval) = (run.from, i64::from(interval));
    let mut ticks = Vec::new();
    for _ in 0..count {
        assert!(u32::try_from(interval).is_ok(), "{run:?} has an interval of {interval}");
        at += interval.cast_unsigned();
        interval += i64::from(add);
        ticks.push(at);
    }
    ticks
}

fn runs(times_s: impl Iterator<Item = f64>, timer: StepTimer) -> Result<Vec<StepRun>, RefitError> {
    let mut refit = Refit::new(times_s, timer);
    let mut runs = Vec::new();
    while let Some(run) = refit.next(u64::MAX)? {
        runs.push(run);
    }
    Ok(runs)
}

/// Most by which the interval changes from step to step within a command, in ticks: an i16, less the rounding.
const MOST_ADD: f64 = 32_000.0;

/// Figures of the plans on one clock.
#[derive(Debug, Default)]
struct Figures {
    worst_us: f64,
    /// Sum of the squares of the distances, us², and the number of steps.
    squares: (f64, u64),
    /// Commands and segments of smooth plans.
    commands: usize,
    segments: usize,
    /// Commands that end where the intervals change by more than an addition can say.
    forced: usize,
    /// Most commands, less those and 1.5 for each segment, of a smooth plan.
    excess: f64,
    /// Steps and commands of plans at a constant speed.
    constant: (u64, usize),
}

impl Figures {
    /// Refits a plan, and holds every step against the plan.
    fn take(&mut self, plan: &Plan, is_smooth: bool, segments: usize, mhz: u32) {
        let hz = f64::from(mhz) * 1e6;
        let times_s: Vec<f64> = plan.each_step().map(|step| step.time_s).collect();
        let runs = runs(times_s.iter().copied(), timer(mhz)).unwrap();
        let ticks: Vec<u64> = runs.iter().flat_map(played).collect();
        assert_eq!(ticks.len() as u64, plan.steps().unsigned_abs());
        for (tick, time_s) in ticks.iter().zip(&times_s) {
            let off_us = (*tick as f64 / hz - time_s).abs() * 1e6;
            self.worst_us = self.worst_us.max(off_us);
            self.squares.0 += off_us * off_us;
        }
        self.squares.1 += plan.steps().unsigned_abs();
        let shortest = runs.iter().map(|run| run.command.shortest_interval()).min().unwrap_or(0);
        assert!(shortest as f64 >= SHORTEST_US * f64::from(mhz) - 1.0, "{shortest}");
        for pair in runs.windows(2) {
            assert!(pair[1].reset.is_some() || pair[1].from == pair[0].end(), "{pair:?}");
        }
        if !is_smooth {
            self.constant.0 += plan.steps().unsigned_abs();
            self.constant.1 += runs.len();
            return;
        }
        let mut made = 0;
        let is_forced = |made: &mut usize, run: &StepRun| {
            *made += usize::from(run.command.count);
            let time_s = |step: usize| if step == 0 { Some(0.0) } else { times_s.get(step - 1).copied() };
            let change_s = time_s(*made + 1).zip(time_s(*made)).zip(time_s(*made - 1));
            change_s.is_some_and(|((after, at), before)| (after - 2.0 * at + before).abs() * hz > MOST_ADD)
        };
        let forced = runs.iter().filter(|run| is_forced(&mut made, run)).count();
        self.commands += runs.len();
        self.segments += segments;
        self.forced += forced;
        self.excess = self.excess.max((runs.len() - forced) as f64 - 1.5 * segments as f64);
    }
}

/// Draws a plan; `None` if a limit refuses it.
fn planned(draw: &Draw) -> Option<Plan> {
    let geometry = Geometry::published(draw.rollers, Variant::Measured);
    let pump = Pump::new(geometry, RollerVolume::measured().ok()?, Line::PUBLISHED, Line::PUBLISHED).ok()?;
    let motor = Motor::new(draw.steps_per_rev, draw.most_rpm * TAU / 60.0, draw.acceleration);
    let cruise = Cruise::Speed { rad_s: draw.part * motor.max_speed_rad_s };
    let sign = if draw.is_reverse { -1.0 } else { 1.0 };
    let request = Request::new(sign * draw.volume_ml, cruise).with_smooth(draw.is_smooth);
    Doser::new(&pump, Limits::new(motor)).ok()?.plan(Phase::known(draw.start_rad), &request).ok()
}

/// Plan to be drawn.
#[derive(Debug, Clone)]
struct Draw {
    rollers: u32,
    steps_per_rev: f64,
    most_rpm: f64,
    acceleration: f64,
    part: f64,
    volume_ml: f64,
    start_rad: f64,
    is_smooth: bool,
    is_reverse: bool,
}

/// Draws plans of 2 to 7 rollers, from 0.4 % of the motor's speed to 70 %, of 0.05 to 5 mL.
fn draws() -> impl Strategy<Value = Draw> {
    let motor = (
        prop::sample::select(vec![3200.0, 6400.0, 12_800.0, 51_200.0]),
        prop::sample::select(vec![60.0, 170.0, 300.0]),
        prop::sample::select(vec![20.0, 100.0, 500.0]),
    );
    let dose = (0.0..1.0_f64, 0.0..1.0_f64, 0.0..TAU, 0.0..1.0_f64, any::<bool>());
    (2..=7_u32, motor, dose).prop_map(|(rollers, motor, dose)| Draw {
        rollers,
        steps_per_rev: motor.0,
        most_rpm: motor.1,
        acceleration: motor.2,
        part: 0.7 * 0.005_f64.powf(dose.0),
        volume_ml: 0.05 * 100_f64.powf(dose.1),
        start_rad: dose.2,
        is_smooth: dose.3 < 0.7,
        is_reverse: dose.4,
    })
}

#[test]
fn random_plans_are_made_within_2_us_on_any_clock_by_few_commands() {
    let wanted = std::env::var("KLIPPER_PLANS").map_or(PLANS, |number| number.parse().unwrap());
    let mut runner =
        TestRunner::new_with_rng(Config::default(), TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let mut figures: Vec<Figures> = CLOCKS_MHZ.iter().map(|_| Figures::default()).collect();
    let (mut drawn, mut reverse, mut steps) = (0, 0, 0);
    while drawn < wanted {
        let draw = draws().new_tree(&mut runner).unwrap().current();
        let Some(plan) = planned(&draw) else { continue };
        let segments = plan.segments(TickRate::from_hz(1_000_000).unwrap()).count();
        for (figures, mhz) in figures.iter_mut().zip(CLOCKS_MHZ) {
            figures.take(&plan, draw.is_smooth, segments, mhz);
        }
        drawn += 1;
        reverse += u32::from(plan.steps() < 0);
        steps += plan.steps().unsigned_abs();
    }
    println!("{drawn} plans, {reverse} in reverse, {steps} steps");
    for (figures, mhz) in figures.iter().zip(CLOCKS_MHZ) {
        let Figures { worst_us, squares, commands, segments, forced, excess, constant } = figures;
        let rms_us = (squares.0 / squares.1 as f64).sqrt();
        let ratio = *commands as f64 / *segments as f64;
        let forced = 100.0 * *forced as f64 / *commands as f64;
        let constant = constant.0 as f64 / constant.1 as f64;
        println!(
            "{mhz} MHz: {worst_us:.3} us, RMS {rms_us:.3} us; smooth: {ratio:.3} commands a segment, {forced:.1} % of \
             them for an addition beyond an i16, the others at most {excess:.1} above 1.5 a segment in one plan; \
             constant: {constant:.0} steps a command"
        );
        assert!(*worst_us <= 1.95, "{mhz} MHz: {worst_us} us");
        assert!(ratio <= 1.0, "{mhz} MHz: {ratio}");
        // A smooth plan at a nearly constant speed has segments of many steps, thanks to their fractions.
        let most = if mhz < 64 { 150.0 } else { 12.0 };
        assert!(*excess <= most, "{mhz} MHz: {excess}");
    }
    assert!(reverse > drawn / 4 && reverse < drawn * 3 / 4);
}

#[test]
fn a_constant_speed_of_whole_ticks_is_one_command_of_many_steps() {
    let runs = runs((1..=5000).map(|step| f64::from(step) * 1e-4), timer(16)).unwrap();
    assert!(runs.len() <= 12, "{}", runs.len());
    let last = runs.last().unwrap();
    assert!(last.command == StepCommand { add: 0, interval: 1600, ..last.command });
    assert_eq!(last.end(), 8_000_000);
}

#[test]
fn a_cut_leaves_the_time_of_every_step_as_it_is() {
    let times_s = || (1..=3000).map(|step: u32| 0.02 * f64::from(step).sqrt());
    let whole: Vec<u64> = runs(times_s(), timer(72)).unwrap().iter().flat_map(played).collect();
    for most in [1, 2, 7, 100, 70_000] {
        let mut refit = Refit::new(times_s(), timer(72));
        let mut ticks = Vec::new();
        while let Some(run) = refit.next(most).unwrap() {
            assert!(u64::from(run.command.count) <= most);
            ticks.extend(played(&run));
        }
        assert_eq!(ticks, whole, "{most}");
    }
    assert_eq!(Refit::new(times_s(), timer(72)).next(0), Ok(None));
}

#[test]
fn an_interval_beyond_the_boards_reach_becomes_a_reset_of_its_clock() {
    // A step every 3 s is 2.9 times 2^29 ticks of 520 MHz: more than 2^30. A pause of 100 s follows, then fast steps.
    let slow = (1..=4).map(|step| 3.0 * f64::from(step));
    let fast = (0..100).map(|step| 112.0 + 1e-3 * f64::from(step));
    let runs = runs(slow.chain(fast), timer(520)).unwrap();
    let resets: Vec<u64> = runs.iter().filter_map(|run| run.reset).collect();
    assert_eq!(resets.len(), 5, "{runs:?}");
    let ticks: Vec<u64> = runs.iter().flat_map(played).collect();
    assert_eq!(ticks.len(), 104);
    assert_eq!((ticks[0], ticks[3], ticks[4]), (1_560_000_000, 6_240_000_000, 58_240_000_000));
    for (run, before) in runs.iter().skip(1).zip(&runs) {
        assert!(run.reset.is_none_or(|reset| reset == run.from && reset > before.end()), "{run:?}");
    }
    // The steps after the pause are in the command of its end.
    let after = runs.iter().find(|run| run.reset.is_some_and(|reset| reset > 50_000_000_000)).unwrap();
    assert!(after.command.count > 50 && after.command.interval == 520_000, "{after:?}");
    // A step every 3 s is well within the reach of a slow clock.
    let slow = (1..=4).map(|step| 3.0 * f64::from(step));
    assert!(super::tests::runs(slow, timer(16)).unwrap().iter().all(|run| run.reset.is_none()));
}

#[test]
fn no_more_steps_are_looked_at_than_a_command_holds() {
    let looked = std::cell::Cell::new(0_u64);
    let times_s = (1..=1_000_000_u32).map(|step| {
        looked.set(looked.get() + 1);
        1e-4 * f64::from(step)
    });
    let mut refit = Refit::new(times_s, timer(16));
    let mut made = 0;
    while let Some(run) = refit.next(u64::MAX).unwrap() {
        made += u64::from(run.command.count);
        assert!(looked.get() <= made + 1024, "{} {made}", looked.get());
    }
    assert_eq!(made, 1_000_000);
}

#[test]
fn steps_that_are_too_close_and_times_that_fall_are_refused() {
    let steps = |interval_s: f64| (1..=1000_u32).map(move |step| interval_s * f64::from(step));
    assert!(runs(steps(2.001e-6), timer(16)).is_ok());
    let error = runs(steps(1.5e-6), timer(16)).unwrap_err();
    assert!(matches!(error, RefitError::Fast { shortest: 32, .. }), "{error}");
    for times_s in [[0.1, 0.05], [0.1, f64::NAN], [0.1, f64::INFINITY], [-0.1, 0.2], [0.1, 1e9]] {
        let error = runs(times_s.into_iter(), timer(520)).unwrap_err();
        assert!(matches!(error, RefitError::Time { step: 1 | 2, .. }), "{error}");
    }
    assert!(matches!(StepTimer::new(999_999, 1), Err(RefitError::Clock { hz: 999_999, .. })));
    assert!(matches!(StepTimer::new(16_000_000, 0), Err(RefitError::Shortest { ticks: 0, .. })));
    assert!(matches!(StepTimer::new(16_000_000, u32::MAX), Err(RefitError::Shortest { .. })));
}

#[test]
fn an_error_stays() {
    let mut refit = Refit::new([0.1, 0.05].into_iter(), timer(16));
    let error = refit.next(u64::MAX).unwrap_err();
    assert_eq!(refit.next(u64::MAX), Err(error));
}

proptest! {
    #[test]
    fn any_times_that_rise_are_made_or_refused(
        intervals_us in prop::collection::vec(0.0..20_000.0_f64, 1..200),
        scale in prop::sample::select(vec![1e-3, 1.0, 1e3]),
        mhz in prop::sample::select(CLOCKS_MHZ.to_vec()),
    ) {
        let mut at_s = 0.0;
        let times_s: Vec<f64> = intervals_us.iter().map(|us| { at_s += us * scale * 1e-6; at_s }).collect();
        match runs(times_s.iter().copied(), timer(mhz)) {
            Ok(runs) => {
                let ticks: Vec<u64> = runs.iter().flat_map(played).collect();
                prop_assert_eq!(ticks.len(), times_s.len());
                for (tick, time_s) in ticks.iter().zip(&times_s) {
                    prop_assert!((*tick as f64 / f64::from(mhz) - time_s * 1e6).abs() < 1.95);
                }
            }
            Err(RefitError::Fast { ticks, shortest, .. }) => prop_assert!(ticks < f64::from(shortest)),
            Err(error) => prop_assert!(false, "{}", error),
        }
    }
}
