//! Axes of one board that begin together.

use pump_bench::built_in;
use pump_bench::drives::{AxisRun, DriveError, Gate, Leave, NodeAxes, NodeAxis, NodeError, Opening};
use pump_bench::pump_file::{Axis, DriveTable};
use pump_ctl::plan::Plan;

use crate::rig::{Rig, dose, go, node_error, times, worst};
use crate::world::SharedWorld;

const ALL: [Axis; 4] = [Axis::X, Axis::Y, Axis::Z, Axis::A];

fn open(world: &SharedWorld) -> NodeAxes {
    let (motor, opening) = (built_in("three-roller").unwrap().motor, Opening::default());
    let tables = ALL.map(|axis| Rig::table().with_axis(axis));
    let axes = tables.each_ref().map(|table| NodeAxis::new(table, &motor, &opening));
    NodeAxes::over(Box::new(world.clone()), &axes).unwrap()
}

fn rises(world: &SharedWorld, axis: usize) -> Vec<u64> {
    world.hardware(|hardware| hardware.motors[axis].rises.clone())
}

/// Makes the plans on the axes from X on.
fn run(axes: &mut NodeAxes, plans: &[Plan], gates: &mut [&mut Gate<'_>]) -> Vec<Result<u64, NodeError>> {
    let runs = plans.iter().zip(gates).enumerate();
    let mut runs: Vec<_> = runs.map(|(place, (plan, gate))| AxisRun::new(place, plan, &mut **gate)).collect();
    let made = axes.run(&mut runs).unwrap();
    made.into_iter()
        .map(|made| {
            made.map_err(|fault| match fault.error {
                DriveError::Device(error) | DriveError::Refused(error) => *error.downcast().unwrap(),
                error => panic!("{error:?}"),
            })
        })
        .collect()
}

#[test]
fn four_pumps_begin_within_a_tick_and_each_keeps_to_its_plan() {
    let world = SharedWorld::new();
    let mut axes = open(&world);
    let plans = [dose(6.0, 4.0, true), dose(-3.0, 2.0, false), dose(2.0, 1.0, true), dose(5.0, 3.0, false)];
    let [mut a, mut b, mut c, mut d] = [go; 4];
    let made = run(&mut axes, &plans, &mut [&mut a, &mut b, &mut c, &mut d]);
    let mut begins = Vec::new();
    for (n, (plan, made)) in plans.iter().zip(made).enumerate() {
        assert_eq!(made.unwrap(), plan.steps().unsigned_abs());
        assert_eq!(world.hardware(|hardware| hardware.motors[n].count), plan.steps());
        let rises = rises(&world, n);
        let worst = worst(&rises, plan);
        // Steps of several axes at one tick are made one after the other.
        assert!(worst <= 2.0, "axis {n}: {worst} us");
        begins.push(rises[0] as f64 - times(plan)[0]);
        let least_us = world.0.lock().unwrap().onlooker.queues[n].least;
        assert!(least_us >= 200_000, "axis {n}: {least_us} us");
    }
    let (least, most) =
        begins.iter().fold((f64::MAX, f64::MIN), |(least, most), at| (at.min(least), at.max(most)));
    assert!(most - least <= 1.0, "{begins:?}");
    // Each axis is a drive of its own, too.
    let drive = axes.drive(2).unwrap();
    assert_eq!(crate::rig::run(drive, &plans[2]), plans[2].steps().unsigned_abs());
}

#[test]
fn a_stop_of_one_pump_leaves_the_others_alone() {
    let world = SharedWorld::new();
    let mut axes = open(&world);
    let plans = [dose(12.0, 4.0, true), dose(12.0, 4.0, true)];
    let begin_us = world.now_us();
    let mut stops =
        |_: u64, _: u64| if world.now_us() < begin_us + 1_000_000 { Leave::Go } else { Leave::Stop };
    let made = run(&mut axes, &plans, &mut [&mut go, &mut stops]);
    let made: Vec<u64> = made.into_iter().map(Result::unwrap).collect();
    assert_eq!(made[0], plans[0].steps().unsigned_abs());
    assert!(made[1] > 0 && made[1] < made[0] / 2, "{made:?}");
    assert_eq!(world.hardware(|hardware| hardware.motors[1].count), made[1] as i64);
    assert!(worst(&rises(&world, 0), &plans[0]) <= 1.0);
}

#[test]
fn pumps_that_cannot_begin_together_do_not_begin() {
    let world = SharedWorld::new();
    let mut axes = open(&world);
    // Somebody else has turned axis Y since it was met: the board refuses its move.
    let plans = [dose(2.0, 4.0, true), dose(2.0, 4.0, true)];
    let mut stops = |_: u64, _: u64| Leave::Stop;
    let made = run(&mut axes, &plans, &mut [&mut go, &mut stops]);
    assert!(made.into_iter().all(|made| made.unwrap() == 0));
    assert!(rises(&world, 0).is_empty() && rises(&world, 1).is_empty());
    // They begin at the next attempt.
    let made = run(&mut axes, &plans, &mut [&mut go, &mut go]);
    assert!(made.into_iter().zip(&plans).all(|(made, plan)| made.unwrap() == plan.steps().unsigned_abs()));
}

#[test]
fn axes_that_are_no_axes_of_one_board_are_refused() {
    let world = SharedWorld::new();
    let (motor, opening) = (built_in("three-roller").unwrap().motor, Opening::default());
    let refused = |tables: &[DriveTable]| {
        let axes: Vec<_> = tables.iter().map(|table| NodeAxis::new(table, &motor, &opening)).collect();
        NodeAxes::over(Box::new(world.clone()), &axes).unwrap_err()
    };
    let twice = refused(&[Rig::table(), Rig::table()]);
    assert!(matches!(node_error(&twice), NodeError::Twice { axis: Axis::X }), "{twice:?}");
    let elsewhere = refused(&[Rig::table(), Rig::table().with_axis(Axis::Y).with_port("/dev/ttyUSB9")]);
    assert!(matches!(node_error(&elsewhere), NodeError::Elsewhere { axis: Axis::Y, .. }), "{elsewhere:?}");
    let plan = dose(1.0, 4.0, true);
    let mut axes = open(&world);
    let [mut one, mut two] = [go; 2];
    let mut runs = [AxisRun::new(0, &plan, &mut one), AxisRun::new(0, &plan, &mut two)];
    let twice = axes.run(&mut runs).unwrap_err();
    assert!(matches!(node_error(&twice), NodeError::Place { place: 0, axes: 4 }), "{twice:?}");
    assert!(rises(&world, 0).is_empty());
}
