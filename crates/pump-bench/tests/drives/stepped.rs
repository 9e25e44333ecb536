//! Claims about a motor that makes one step at a time, with a motor that writes its steps down and a clock of the test.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use pump_bench::drives::{Drive, DriveError, DriveFault, IndexSearch, Leave, Stepped};
use pump_bench::report::with_sources;
use pump_bench::{Bench, DoseError, DoseRequest, Session, built_in};
use pump_ctl::drive::{Clock, Fault, StepMotor};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Ramps, Request};
use pump_ctl::step::{Direction, TickRate};

const TICK_HZ: u32 = 1_000_000;

/// Time that passes for the motor with each question to the gate, in ticks.
const LEASE: u64 = 20_000;

/// Clock of the test. Each look at it takes a tick, up to the time that the test has set.
#[derive(Debug, Clone, Default)]
struct TestClock {
    now: Arc<AtomicU64>,
    until: Arc<AtomicU64>,
}

impl TestClock {
    fn lets_pass(&self, ticks: u64) {
        self.until.fetch_add(ticks, Ordering::Relaxed);
    }
}

impl Clock for TestClock {
    fn now(&mut self) -> u64 {
        let now = self.now.load(Ordering::Relaxed);
        if now >= self.until.load(Ordering::Relaxed) {
            std::thread::yield_now();
            return now;
        }
        self.now.store(now + 1, Ordering::Relaxed);
        now + 1
    }
}

/// Burnt coil of the motor.
#[derive(Debug, PartialEq)]
struct Burnt;

/// Motor that writes down the time and the direction of each step.
#[derive(Debug, Clone, Default)]
struct Recorder {
    clock: TestClock,
    steps: Arc<Mutex<Vec<(u64, Direction)>>>,
    /// Step that fails.
    fails_at: Option<usize>,
    /// Step that takes 50 ms.
    hangs_at: Option<usize>,
    /// Step from which on the index sensor answers.
    index_at: Option<usize>,
}

impl Recorder {
    fn made(&self) -> usize {
        self.steps.lock().unwrap().len()
    }

    fn times(&self) -> Vec<u64> {
        self.steps.lock().unwrap().iter().map(|(time, _)| *time).collect()
    }
}

impl StepMotor for Recorder {
    type Error = Burnt;

    fn step(&mut self, direction: Direction) -> Result<(), Burnt> {
        let number = self.made() + 1;
        if self.fails_at == Some(number) {
            return Err(Burnt);
        }
        let time = self.clock.now.load(Ordering::Relaxed);
        self.steps.lock().unwrap().push((time, direction));
        if self.hangs_at == Some(number) {
            self.clock.now.fetch_add(50_000, Ordering::Relaxed);
            self.clock.lets_pass(50_000);
        }
        Ok(())
    }

    fn index(&mut self) -> Result<Option<bool>, Burnt> {
        Ok(self.index_at.map(|at| self.made() >= at))
    }
}

fn drive(motor: &Recorder) -> Stepped<Recorder, TestClock> {
    let tick_rate = TickRate::from_hz(TICK_HZ).unwrap();
    Stepped::new("pins", motor.clone(), motor.clock.clone(), tick_rate).unwrap()
}

/// Plans a dose that reaches its cruise of 14 r/min in many steps.
fn dose(volume_ml: f64, smooth: bool) -> Plan {
    let file = built_in("three-roller").unwrap();
    let mut limits = file.limits();
    limits.motor.max_acceleration_rad_s2 = if smooth { 500.0 } else { 10.0 };
    let request =
        Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 }).with_smooth(smooth).with_ramps(Ramps::Fastest);
    let pump = file.model().unwrap();
    Doser::new(&pump, limits).unwrap().plan(Phase::known(0.3), &request).unwrap()
}

/// Lets the clock go on and grants all.
fn grant(motor: &Recorder) -> impl FnMut(u64, u64) -> Leave {
    let clock = motor.clock.clone();
    move |_, _| {
        clock.lets_pass(LEASE);
        Leave::Go
    }
}

/// Returns the largest acceleration of steps at these times, in steps per second². Speeds are those over 20 steps,
/// since times are whole ticks.
fn steepest(times: &[u64]) -> f64 {
    let speeds: Vec<f64> = times.windows(21).map(|part| 20e6 / (part[20] - part[0]) as f64).collect();
    let middle = |number: usize| (times[number] + times[number + 20]) as f64 / 2e6;
    let change =
        |number: usize| (speeds[number + 20] - speeds[number]) / (middle(number + 20) - middle(number));
    (0..speeds.len() - 20).map(|number| change(number).abs()).fold(0.0, f64::max)
}

#[test]
fn every_step_comes_at_its_time_in_its_direction() {
    for (volume_ml, smooth) in [(0.5, false), (-0.4, false), (1.5, true)] {
        let (motor, plan) = (Recorder::default(), dose(volume_ml, smooth));
        let made = drive(&motor).run(&plan, &mut grant(&motor)).unwrap();
        let steps = motor.steps.lock().unwrap();
        let planned: Vec<_> = plan.each_step().collect();
        assert_eq!((made as usize, steps.len()), (planned.len(), planned.len()));
        let began = steps[0].0 as f64 - 1e6 * planned[0].time_s;
        for (step, (time, direction)) in planned.iter().zip(&*steps) {
            let off = (*time as f64 - began - 1e6 * step.time_s).abs();
            assert!(off < 3.0 && *direction == step.direction, "step {}: off by {off} ticks", step.number);
        }
    }
}

#[test]
fn a_stop_decelerates_as_the_plan_may() {
    let (motor, plan) = (Recorder::default(), dose(2.0, false));
    let mut grant = grant(&motor);
    let mut told = None;
    let made = drive(&motor)
        .run(&plan, &mut |made, about_to| match grant(made, about_to) {
            _ if made < 600 => Leave::Go,
            _ => {
                told.get_or_insert(made);
                Leave::Stop
            }
        })
        .unwrap();
    let all = plan.each_step().count() as u64;
    assert_eq!(made as usize, motor.made());
    assert!(told.unwrap() + 100 < made && made < all, "{told:?}, {made} of {all} steps");
    let limit = 10.0 / plan.step_rad();
    let steepest = steepest(&motor.times());
    assert!((0.9..1.1).contains(&(steepest / limit)), "{steepest} steps/s2, and {limit} are allowed");
}

#[test]
fn steps_without_leave_are_not_made_and_the_motor_goes_on_when_they_have_it() {
    let (motor, plan) = (Recorder::default(), dose(3.0, false));
    let mut grant = grant(&motor);
    let (granted, mut waits) = (700, 0);
    let made = drive(&motor)
        .run(&plan, &mut |made, about_to| {
            let go = grant(made, about_to);
            if about_to <= granted || waits >= 60 {
                return go;
            }
            waits += 1;
            assert!(motor.made() as u64 <= granted, "{} steps made", motor.made());
            Leave::Wait
        })
        .unwrap();
    assert_eq!((made as usize, motor.made()), (plan.each_step().count(), plan.each_step().count()));
    let times = motor.times();
    let rest = (1..times.len()).max_by_key(|number| times[*number] - times[number - 1]).unwrap();
    let (longest, limit) = (times[rest] - times[rest - 1], 10.0 / plan.step_rad());
    // From rest the first step takes as long as the acceleration allows.
    assert!((longest as f64 - 1e6 * (2.0 / limit).sqrt()).abs() < 5.0, "{longest} ticks");
    assert!((300..=granted as usize).contains(&rest), "the motor stood after step {rest}");
    for part in [&times[..rest], &times[rest..]] {
        let steepest = steepest(part);
        assert!(steepest < 1.1 * limit, "{steepest} steps/s2, and {limit} are allowed");
    }
}

fn fault(motor: &Recorder) -> DriveFault {
    drive(motor).run(&dose(3.0, false), &mut grant(motor)).unwrap_err()
}

fn cause(fault: &DriveFault) -> &Fault<Burnt> {
    let DriveError::Device(error) = &fault.error else { panic!("{fault}") };
    error.downcast_ref().unwrap()
}

#[test]
fn a_motor_that_fails_tells_how_many_steps_it_has_made() {
    let motor = Recorder { fails_at: Some(321), ..Recorder::default() };
    let fault = fault(&motor);
    assert_eq!((fault.made_least, fault.made_most, fault.lost, motor.made()), (320, 320, false, 320));
    assert_eq!(cause(&fault), &Fault::Motor { error: Burnt, position: 320 });
}

#[test]
fn a_step_that_is_too_late_ends_the_motion_at_rest_with_the_steps_counted() {
    let motor = Recorder { hangs_at: Some(500), ..Recorder::default() };
    let fault = fault(&motor);
    assert!(matches!(cause(&fault), Fault::Late { .. }), "{fault}");
    assert_eq!((fault.made_least, fault.made_most), (motor.made() as i64, motor.made() as i64));
    assert!(motor.made() > 550, "the motor was decelerated: {} steps", motor.made());
}

/// Runs `plan` with leave for `granted` steps, on a motor whose step `hangs_at` takes 50 ms. Returns the fault, the
/// steps made and the last step that had leave.
fn late(plan: &Plan, granted: u64, hangs_at: usize) -> (DriveFault, u64, u64) {
    let motor = Recorder { hangs_at: Some(hangs_at), ..Recorder::default() };
    let mut grant = grant(&motor);
    let (mut left, mut waits) = (0, 0);
    let ended = drive(&motor).run(plan, &mut |made, about_to| {
        let go = grant(made, about_to);
        if about_to <= granted {
            left = left.max(about_to);
            return go;
        }
        waits += 1;
        if waits > 1000 { Leave::Stop } else { Leave::Wait }
    });
    let fault = ended.expect_err(&format!("step {hangs_at} is late"));
    (fault, motor.made() as u64, left)
}

#[test]
fn a_late_step_leads_beyond_the_leave_nowhere() {
    let plan = dose(3.0, false);
    let all = plan.each_step().count() as u64;
    // The motor slows down before the end of its leave in the first case, and to the end of the plan in the second.
    for (granted, places) in
        [(700, (10..650).step_by(16)), (all, (all as usize - 600..all as usize - 20).step_by(16))]
    {
        for hangs_at in places {
            let (fault, made, left) = late(&plan, granted, hangs_at);
            assert!(matches!(cause(&fault), Fault::Late { .. }), "{fault}");
            assert!(made <= left, "step {hangs_at} is late: {made} steps made and {left} have leave");
            assert_eq!((fault.made_least, fault.made_most), (made as i64, made as i64));
        }
    }
}

#[test]
fn a_search_ends_after_the_index() {
    let motor = Recorder { index_at: Some(250), ..Recorder::default() };
    let mut pins = drive(&motor);
    assert!(pins.abilities().index && !drive(&Recorder::default()).abilities().index);
    let IndexSearch { made, beyond } = pins.seek(&dose(1.0, false), &mut grant(&motor)).unwrap();
    assert_eq!((made, beyond), (motor.made() as u64, Some(made - 250)));
    assert!((250..600).contains(&made), "{made} steps");
    let none = Recorder::default();
    let refused = drive(&none).seek(&dose(1.0, false), &mut grant(&none)).unwrap_err();
    assert!(with_sources(&refused).contains("no index sensor") && none.made() == 0, "{refused}");
}

#[test]
fn a_timer_slower_than_the_steps_is_refused_before_anything_moves() {
    let motor = Recorder::default();
    let slow = TickRate::from_hz(1000).unwrap();
    let mut pins = Stepped::new("pins", motor.clone(), motor.clock.clone(), slow).unwrap();
    let refused = with_sources(&pins.check(&dose(1.0, false)).unwrap_err());
    assert!(refused.contains("1000 ticks a second"), "{refused}");
}

#[test]
fn a_gate_that_panics_leaves_the_motor_at_rest() {
    // Far longer than the leave ahead of the motor: the motor makes all steps that have leave if the gate's thread
    // waits for the processor before it panics.
    let (motor, plan) = (Recorder::default(), dose(20.0, false));
    let mut grant = grant(&motor);
    let mut pins = drive(&motor);
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        pins.run(&plan, &mut |made, about_to| {
            if made > 300 {
                // The motor needs the time to come to rest.
                motor.clock.lets_pass(100 * LEASE);
                std::panic::resume_unwind(Box::new(()));
            }
            grant(made, about_to)
        })
    }));
    assert!(caught.is_err() && motor.made() < plan.each_step().count(), "{} steps", motor.made());
}

#[test]
fn a_dose_on_pins_is_recorded_stopped_and_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let motor = Recorder::default();
    let mut pins = drive(&motor);
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder.path()).unwrap();
    let bench = bench.driven_by(&pins).unwrap().confirming_pump(true);
    let mut session = Session::with_drive(&bench, Box::new(&mut pins)).unwrap();
    session.set_angle(Some(Phase::known(0.3))).unwrap();
    // The first step comes within the first lease.
    let (cruise, ramps) = (Some(Cruise::Flow { ml_s: 5.0 }), Some(Ramps::Fastest));
    let request = DoseRequest::dose(0.5).with_cruise(cruise).with_ramps(ramps);
    let prepared = session.prepare(request).unwrap();
    let all = prepared.plan.each_step().count();
    // The clock stands while the motor waits for its first leave.
    let pass = |made| {
        if made > 0 {
            motor.clock.lets_pass(LEASE);
        }
    };
    motor.clock.lets_pass(LEASE);
    let stopped = session
        .run(&prepared, |made| {
            pass(made);
            if made > 200 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap();
    assert!(!stopped.completed && stopped.made as usize == motor.made() && motor.made() < all);
    let part = session.state().unwrap().unfinished.unwrap();
    assert_eq!((part.made_least, part.made_most), (motor.made() as i64, motor.made() as i64));
    assert!(matches!(session.prepare(request), Err(DoseError::Unfinished { .. })));
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    motor.clock.lets_pass(LEASE);
    let ended = session
        .run(&rest, |made| {
            pass(made);
            ControlFlow::Continue(())
        })
        .unwrap();
    assert!(ended.completed && motor.made() == all, "{} of {all} steps", motor.made());
}
