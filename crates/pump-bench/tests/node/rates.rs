//! Step rates near the most that a board makes, with one axis and with several.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use pump_bench::drives::{Drive, Leave, Node, NodeBoard, NodeError, Opening};
use pump_bench::pump_file::{Axis, DriveTable, PinsTable};
use pump_bench::{Bench, DoseError, DoseRequest, PumpFile, Session, built_in};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request};

use crate::rig::{Rig, dose, go, node_error, run, worst};
use crate::world::SharedWorld;

/// Most steps a second of a plan that the board makes with one axis: 10 ticks of 1 us, and a quarter.
const MOST_S: u32 = 97_560;

/// Returns a pump of many steps, which makes thousands of them a second at a slow speed.
fn pump() -> PumpFile {
    let mut file = built_in("three-roller").unwrap();
    file.motor.steps_per_rev *= 32;
    file
}

/// Plans a dose at a constant speed of so many steps a second.
fn plan(volume_ml: f64, steps_s: f64, smooth: bool) -> Plan {
    let file = pump();
    let step_rad = TAU / f64::from(file.motor.steps_per_rev);
    let request = Request::new(volume_ml, Cruise::Speed { rad_s: steps_s * step_rad }).with_smooth(smooth);
    Doser::new(&file.model().unwrap(), file.limits()).unwrap().plan(Phase::known(0.3), &request).unwrap()
}

fn open(world: &SharedWorld, table: &DriveTable, opening: &Opening) -> Node {
    Node::over(Box::new(world.clone()), table, &pump().motor, opening).unwrap()
}

#[test]
fn a_rate_near_the_most_is_made_or_refused_before_anything_moves() {
    for (thousands, smooth) in (93..=102).map(|thousands| (thousands, thousands % 2 == 0)) {
        let rig = Rig::new();
        let plan = plan(0.4, 1e3 * f64::from(thousands) - 100.0, smooth);
        let peak_steps_s = plan.profile().peak_rad_s() / plan.step_rad();
        let mut drive = open(&rig.world, &Rig::table(), &rig.opening());
        match drive.check(&plan) {
            Ok(()) => {
                assert!(peak_steps_s <= f64::from(MOST_S) + 1.0, "{peak_steps_s}");
                assert_eq!(drive.run(&plan, &mut go).unwrap(), plan.steps().unsigned_abs());
                let worst = worst(&rig.world.rises(), &plan);
                assert!(worst <= 1.0, "{peak_steps_s}: {worst} us");
            }
            Err(refused) => {
                let NodeError::Fast { steps_s, most_s: MOST_S } = *node_error(&refused) else {
                    panic!("{refused:?}")
                };
                assert!(steps_s > f64::from(MOST_S), "{steps_s}");
                assert!(rig.world.rises().is_empty());
            }
        }
    }
}

#[test]
fn a_fast_motor_that_waited_for_the_disk_goes_on_no_faster_than_the_board_was_told() {
    let rig = Rig::new();
    let plan = plan(10.0, f64::from(MOST_S) - 100.0, false);
    let mut drive = open(&rig.world, &Rig::table(), &rig.opening());
    drive.check(&plan).unwrap();
    let begin_us = rig.world.now_us();
    let mut waited = 0;
    let made = drive.run(&plan, &mut |_, _| {
        let waits = (500_000..3_500_000).contains(&(rig.world.now_us() - begin_us));
        waited += u32::from(waits);
        if waits { Leave::Wait } else { Leave::Go }
    });
    assert_eq!(made.unwrap(), plan.steps().unsigned_abs());
    let rises = rig.world.rises();
    assert!(
        waited > 0 && rises.windows(2).any(|pair| pair[1] - pair[0] > 100_000),
        "the motor has not rested"
    );
}

#[test]
fn a_rate_that_the_pulses_do_not_allow_is_refused_before_anything_moves() {
    let rig = Rig::new();
    let mut pins = PinsTable::default();
    (pins.step_pulse_us, pins.step_pause_us) = (Some(100.0), Some(100.0));
    let mut drive = open(&rig.world, &Rig::table().with_pins(pins), &rig.opening());
    let refused = drive.check(&plan(0.1, 5_000.0, false)).unwrap_err();
    // Two pulses of 101 ticks, and a quarter of a tick.
    let NodeError::Pulse { steps_s, most_s: 4_944 } = *node_error(&refused) else { panic!("{refused:?}") };
    assert!((steps_s - 5_000.0).abs() < 1.0, "{steps_s}");
    assert!(rig.world.rises().is_empty());
    drive.connect().unwrap();
    let slower = plan(0.1, 4_940.0, false);
    assert_eq!(run(&mut drive, &slower), slower.steps().unsigned_abs());
}

#[test]
fn a_plan_has_its_share_of_the_steps_from_its_check_until_it_ends_or_is_forgotten() {
    let (world, folder) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let board = NodeBoard::over(Box::new(world.clone()));
    let [mut one, mut other] = [Axis::X, Axis::Y].map(|axis| {
        let record = folder.path().join(format!("{axis}.json"));
        let opening = Opening { settings_record: Some(record), ..Opening::default() };
        board.axis(&Rig::table().with_axis(axis), &pump().motor, &opening).unwrap()
    });
    let fast = plan(0.2, 60_000.0, false);
    one.check(&fast).unwrap();
    let refused = other.check(&fast).unwrap_err();
    // 1 MHz over 16 ticks, which the board counts for the first, leave 37,500 steps/s: 27 ticks, and a quarter.
    let NodeError::StepsTaken { steps_s, free_s: 36_697, all_s: MOST_S } = *node_error(&refused) else {
        panic!("{refused:?}")
    };
    assert!((steps_s - 60_000.0).abs() < 10.0, "{steps_s}");
    other.connect().unwrap();
    other.check(&plan(0.2, 36_600.0, false)).unwrap();
    other.forget_plan();
    // A check again takes no second share, and a plan that was made leaves its own.
    assert_eq!(run(&mut one, &fast), fast.steps().unsigned_abs());
    assert_eq!(run(&mut other, &fast), fast.steps().unsigned_abs());
    one.check(&fast).unwrap();
    one.forget_plan();
    other.check(&fast).unwrap();
}

#[test]
fn the_fastest_dose_is_the_fastest_that_the_board_makes() {
    for smooth in [false, true] {
        let (rig, folder) = (Rig::new(), tempfile::tempdir().unwrap());
        let mut drive = open(&rig.world, &Rig::table().with_baud(1_000_000), &rig.opening());
        let bench = Bench::new(pump(), None, folder.path()).unwrap().driven_by(&drive).unwrap();
        let bench = bench.confirming_pump(true);
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        session.connect().unwrap();
        session.set_angle(Some(Phase::known(0.3))).unwrap();
        let request = DoseRequest::dose(1.0).with_cruise(Some(Cruise::Fastest)).with_smooth(smooth);
        let prepared = session.prepare(request).unwrap();
        let steps_s = prepared.plan.profile().peak_rad_s() / prepared.plan.step_rad();
        assert!((0.95..1.0 + 1e-9).contains(&(steps_s / f64::from(MOST_S))), "{steps_s}");
        assert!(session.run(&prepared, |_| ControlFlow::Continue(())).unwrap().completed);
        assert_eq!(rig.world.rises().len() as u64, prepared.plan.steps().unsigned_abs());
    }
}

#[test]
fn a_dry_run_refuses_what_the_pulses_of_the_pump_file_do_not_allow() {
    let (rig, folder) = (Rig::new(), tempfile::tempdir().unwrap());
    let mut file = pump();
    let mut pins = PinsTable::default();
    (pins.step_pulse_us, pins.step_pause_us) = (Some(100.0), Some(100.0));
    file.drive = Some(Rig::table().with_pins(pins));
    let rad_s = |steps_s: f64| steps_s * TAU / f64::from(file.motor.steps_per_rev);
    let drive = open(&rig.world, &Rig::table(), &rig.opening());
    let bench = Bench::new(file.clone(), None, folder.path()).unwrap().driven_by(&drive).unwrap();
    let planned = |steps_s: f64| {
        bench.prepare(DoseRequest::dose(0.1).with_cruise(Some(Cruise::Speed { rad_s: rad_s(steps_s) })))
    };
    let refused = planned(5_010.0).unwrap_err();
    let DoseError::DeviceSpeed { most_steps_s, .. } = refused else { panic!("{refused:?}") };
    assert!((most_steps_s - 5_000.0).abs() < 1e-6, "{most_steps_s}");
    assert!(refused.to_string().contains("[drive.pins]"), "{refused}");
    planned(4_990.0).unwrap();
}

#[test]
fn a_long_smooth_plan_is_checked_by_a_few_of_its_turns() {
    let drive = Rig::new().open();
    let share = |volume_ml: f64| {
        let plan = dose(volume_ml, 4.0, true);
        drive.board_share((&plan).into()).unwrap().unwrap()
    };
    // The first is walked through whole.
    let (short, long) = (share(40.0), share(1_000.0));
    assert!(long.steps_s.abs_diff(short.steps_s) <= short.steps_s / 10, "{short:?} {long:?}");
    assert!(long.bytes_s >= short.bytes_s, "{short:?} {long:?}");
    assert!(long.bytes_s - short.bytes_s <= short.all_bytes_s / 16, "{short:?} {long:?}");
    // A walk through all of its million parts took 15 s, and heard nobody.
    let began = std::time::Instant::now();
    share(90_000.0);
    assert!(began.elapsed().as_secs_f64() < 5.0, "{:?}", began.elapsed());
}
