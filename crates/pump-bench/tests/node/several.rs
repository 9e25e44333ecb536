//! Sessions of several pumps that share one board, each in a thread of its own with its own journal.

use std::cell::RefCell;
use std::fmt::Debug;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use pump_bench::drives::{
    BeginPlace, CommonBegin, CommonBeginError, DriveError, Node, NodeBoard, NodeError, Opening,
};
use pump_bench::pump_file::{Axis, DriveTable};
use pump_bench::{Bench, Delivered, DoseError, DoseRequest, Session, built_in};
use pump_ctl::plan::{Cruise, Phase, Plan};

use crate::rig::{Rig, times, worst};
use crate::world::{Event, SharedWorld};

const ALL: [Axis; 4] = [Axis::X, Axis::Y, Axis::Z, Axis::A];

/// Time for which motions wait for each other on the computer's clock. A computer under load is not in time.
pub(crate) const PATIENT: Duration = Duration::from_secs(300);

/// Dose of an axis: volume and rate.
type Dose = (f64, f64);

fn opening(state: &Path, axis: usize) -> Opening {
    let folder = state.join(format!("pump{axis}"));
    std::fs::create_dir_all(&folder).unwrap();
    let settings_record = Some(folder.join("board-settings.json"));
    Opening { settings_record, boards: Some(state.join("node.boards")), ..Opening::default() }
}

fn table(axis: usize) -> DriveTable {
    Rig::table().with_axis(ALL[axis])
}

fn drive(board: &NodeBoard, table: &DriveTable, state: &Path, axis: usize) -> Result<Node, DriveError> {
    board.axis(table, &built_in("three-roller").unwrap().motor, &opening(state, axis))
}

fn bench(state: &Path, axis: usize, drive: &Node) -> Bench {
    let folder = state.join(format!("pump{axis}"));
    let bench = Bench::new(built_in("three-roller").unwrap(), None, &folder).unwrap();
    bench.driven_by(drive).unwrap().confirming_pump(true)
}

fn request((volume_ml, ml_s): Dose) -> DoseRequest {
    DoseRequest::dose(volume_ml).with_cruise(Some(Cruise::Flow { ml_s })).with_smooth(true)
}

/// Result of a session that shares the board.
#[derive(Debug)]
pub(crate) struct Shared {
    made: Result<Delivered, DoseError>,
    /// Plan, if it was made.
    plan: Option<Plan>,
    /// Steps of the unfinished dose, and the count on record.
    pub(crate) part: Option<(i64, i64)>,
    pub(crate) count: Option<i64>,
}

/// Runs the dose of one axis with its own session and journal.
pub(crate) fn pour(
    board: &NodeBoard,
    state: &Path,
    (axis, dose): (usize, Dose),
    place: Option<BeginPlace>,
    watch: impl FnMut(u64) -> ControlFlow<()>,
) -> Shared {
    let mut drive = drive(board, &table(axis), state, axis).unwrap();
    let bench = bench(state, axis, &drive);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.connect().unwrap();
    if session.state().is_none_or(|state| state.unfinished.is_none()) {
        session.set_angle(Some(Phase::known(0.3))).unwrap();
    }
    if let Some(place) = place {
        session.begin_with(place).unwrap();
    }
    let prepared = session.prepare(request(dose));
    let (made, plan) = match prepared {
        Ok(prepared) => (session.run(&prepared, watch), Some(prepared.plan)),
        Err(error) => (Err(error), None),
    };
    let state = session.state().unwrap();
    let part = state.unfinished.map(|part| (part.made_least, part.made_most));
    Shared { made, plan, part, count: state.count }
}

/// Runs doses on the axes from X on, each in a thread of its own. They begin together if `limit` is given.
fn pour_all(
    world: &SharedWorld,
    state: &Path,
    doses: &[Dose],
    limit: Option<Duration>,
    watch: &(dyn Fn(usize, u64) -> ControlFlow<()> + Sync),
) -> Vec<Shared> {
    let board = NodeBoard::over(Box::new(world.clone()));
    let mut places = limit.map(|limit| CommonBegin::places(doses.len(), limit)).unwrap_or_default();
    thread::scope(|scope| {
        let threads: Vec<_> = (0..)
            .zip(doses)
            .map(|(axis, dose)| {
                let (board, place) = (&board, places.pop());
                scope.spawn(move || pour(board, state, (axis, *dose), place, |made| watch(axis, made)))
            })
            .collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}

fn go(_axis: usize, _made: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub(crate) fn counts(world: &SharedWorld) -> [i64; 4] {
    world.hardware(|hardware| [0, 1, 2, 3].map(|axis| hardware.motors[axis].count))
}

fn rises(world: &SharedWorld, axis: usize) -> Vec<u64> {
    world.hardware(|hardware| hardware.motors[axis].rises.clone())
}

/// Returns the drive's own error.
fn of_node(error: &DoseError) -> &NodeError {
    let (DoseError::Connection(DriveError::Device(error) | DriveError::Refused(error))
    | DoseError::Drive { error: DriveError::Device(error), .. }) = error
    else {
        panic!("{error:?}")
    };
    error.downcast_ref().unwrap()
}

#[test]
fn sessions_of_four_pumps_begin_at_one_tick_each_by_its_own_plan_and_journal() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let doses = [(3.0, 4.0), (-2.0, 2.0), (1.0, 1.0), (3.0, 3.0)];
    let all = pour_all(&world, state.path(), &doses, Some(PATIENT), &go);
    let mut begins = Vec::new();
    for (axis, one) in all.iter().enumerate() {
        let plan = one.plan.as_ref().unwrap();
        assert!(one.made.as_ref().unwrap().completed, "{axis}: {one:?}");
        assert_eq!((counts(&world)[axis], one.count), (plan.steps(), Some(plan.steps())));
        let rises = rises(&world, axis);
        let worst = worst(&rises, plan);
        assert!(worst <= 2.0, "axis {axis}: {worst} us");
        begins.push(rises[0] as f64 - times(plan)[0]);
    }
    let (least, most) =
        begins.iter().fold((f64::MAX, f64::MIN), |(least, most), at| (at.min(least), at.max(most)));
    assert!(most - least <= 1.0, "{begins:?}");
}

#[test]
fn sessions_begin_one_after_another_too_and_a_stop_of_one_leaves_the_others_alone() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let stop = |axis, made| if axis == 1 && made > 700 { ControlFlow::Break(()) } else { go(axis, made) };
    let all = pour_all(&world, state.path(), &[(6.0, 4.0); 3], None, &stop);
    for (axis, one) in all.iter().enumerate() {
        let (made, count) = (one.made.as_ref().unwrap(), counts(&world)[axis]);
        assert_eq!(made.completed, axis != 1, "{axis}: {one:?}");
        assert_eq!((made.made as i64, one.count), (count, Some(count)));
        assert_eq!(one.part, (axis == 1).then_some((count, count)));
        if axis != 1 {
            assert!(worst(&rises(&world, axis), one.plan.as_ref().unwrap()) <= 2.0);
        }
    }
}

#[test]
fn none_begins_if_one_is_stopped_or_fails_before_or_does_not_come() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let stop = |axis, made| if axis == 1 { ControlFlow::Break(()) } else { go(axis, made) };
    let all = pour_all(&world, state.path(), &[(1.0, 4.0); 3], Some(PATIENT), &stop);
    for axis in [0, 2] {
        let error = all[axis].made.as_ref().unwrap_err();
        let another = NodeError::Common(CommonBeginError::Another);
        assert_eq!(of_node(error).to_string(), another.to_string(), "{error:?}");
        assert_eq!(all[axis].part, None, "nothing is left to make");
    }
    // A dose that cannot be planned gives its place up.
    let (other, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let all = pour_all(&other, state.path(), &[(1.0, 4.0), (1.0, 1e6)], Some(PATIENT), &go);
    assert!(all[1].plan.is_none());
    assert!(matches!(
        of_node(all[0].made.as_ref().unwrap_err()),
        NodeError::Common(CommonBeginError::Another)
    ));
    assert_eq!([counts(&world), counts(&other)], [[0; 4]; 2]);

    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let board = NodeBoard::over(Box::new(world.clone()));
    let mut places = CommonBegin::places(2, Duration::from_millis(50));
    let alone = pour(&board, state.path(), (0, (1.0, 4.0)), places.pop(), |_| ControlFlow::Continue(()));
    let late = of_node(alone.made.as_ref().unwrap_err());
    assert!(matches!(late, NodeError::Common(CommonBeginError::Late { .. })), "{late:?}");
    assert_eq!((counts(&world), alone.part), ([0; 4], None));
    drop(places);
    // The dose is made at the next attempt.
    let made = pour(&board, state.path(), (0, (1.0, 4.0)), None, |_| ControlFlow::Continue(())).made;
    assert!(made.unwrap().completed);
}

#[test]
fn axes_that_need_more_steps_together_than_the_board_makes_do_not_begin_and_leave_nothing_unfinished() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    // Each makes 29,000 steps/s at most, so two of them have room.
    let all = pour_all(&world, state.path(), &[(30.0, 7.0); 4], Some(PATIENT), &go);
    let errors: Vec<&NodeError> = all.iter().map(|one| of_node(one.made.as_ref().unwrap_err())).collect();
    let is_refused = |error: &&NodeError| matches!(error, NodeError::StepsTaken { .. });
    let is_of_another = |error: &&NodeError| matches!(error, NodeError::Common(CommonBeginError::Another));
    assert!(errors.iter().any(is_refused), "{errors:?}");
    assert!(errors.iter().all(|error| is_refused(error) || is_of_another(error)), "{errors:?}");
    assert!(all.iter().all(|one| one.part.is_none()), "{all:?}");
    assert_eq!(counts(&world), [0; 4]);
}

#[test]
fn a_common_begin_that_fails_on_a_line_that_breaks_has_moved_nothing_by_its_record() {
    for mends_in_ms in [None, Some(1_000)] {
        let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
        let board = NodeBoard::over(Box::new(world.clone()));
        let mut places = CommonBegin::places(2, PATIENT);
        let (place, other) = (places.pop(), RefCell::new(places.pop()));
        let begin_us = world.now_us();
        let one = pour(&board, state.path(), (0, (10.0, 4.0)), place, |_| {
            // The move is on the board and waits for the other.
            if world.now_us() > begin_us + 1_500_000 && other.take().is_some() {
                world.plan(0, Event::Cut);
                mends_in_ms.inspect(|in_ms| world.plan(*in_ms, Event::Mend));
            }
            ControlFlow::Continue(())
        });
        let error = of_node(one.made.as_ref().unwrap_err());
        // A board that is found again says itself why it did not begin.
        let is_told = match mends_in_ms {
            None => matches!(error, NodeError::Common(CommonBeginError::Another)),
            Some(_) => matches!(error, NodeError::DeadMan { .. }),
        };
        assert!(is_told, "{error:?}");
        assert!(other.into_inner().is_none(), "the other axis has not given up");
        assert_eq!((one.part, one.count, counts(&world)), (None, Some(0), [0; 4]), "{mends_in_ms:?}");
    }
}

#[test]
fn a_reset_of_the_board_stops_all_axes_within_their_stated_bounds() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let is_reset = AtomicBool::new(false);
    let reset = |axis: usize, made: u64| {
        if axis == 0 && made > 800 && !is_reset.swap(true, Ordering::Relaxed) {
            world.plan(3, Event::Reset);
        }
        go(axis, made)
    };
    let all = pour_all(&world, state.path(), &[(8.0, 4.0), (8.0, 2.0), (-8.0, 3.0)], Some(PATIENT), &reset);
    for (axis, one) in all.iter().enumerate() {
        assert!(matches!(of_node(one.made.as_ref().unwrap_err()), NodeError::Reset), "{one:?}");
        let (least, most) = one.part.unwrap();
        assert!((least..=most).contains(&counts(&world)[axis].abs()), "{axis}: {:?} {one:?}", counts(&world));
    }
}

#[test]
fn a_cable_that_is_pulled_stops_all_axes_and_each_count_is_recovered() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let is_cut = AtomicBool::new(false);
    let cut = |axis: usize, made: u64| {
        if axis == 2 && made > 300 && !is_cut.swap(true, Ordering::Relaxed) {
            world.plan(3, Event::Cut);
        }
        go(axis, made)
    };
    let doses = [(12.0, 4.0), (12.0, 2.0), (-12.0, 3.0), (12.0, 1.0)];
    let all = pour_all(&world, state.path(), &doses, Some(PATIENT), &cut);
    assert!(all.iter().all(|one| matches!(of_node(one.made.as_ref().unwrap_err()), NodeError::Quiet { .. })));
    world.pass(2_000);
    world.plan(0, Event::Mend);
    world.pass(1);
    recovered(&world, state.path(), 4);
}

/// Holds the counts that sessions find against the motors.
fn recovered(world: &SharedWorld, state: &Path, axes: usize) {
    let board = NodeBoard::over(Box::new(world.clone()));
    for axis in 0..axes {
        let count = counts(world)[axis];
        let mut drive = drive(&board, &table(axis), state, axis).unwrap();
        let bench = bench(state, axis, &drive);
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        session.connect().unwrap();
        let found = session.state().unwrap();
        let part = found.unfinished.map(|part| (part.made_least, part.made_most));
        assert_eq!((part, found.count), (Some((count.abs(), count.abs())), Some(count)), "axis {axis}");
        let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
        assert!(session.run(&rest, |_| ControlFlow::Continue(())).unwrap().completed);
    }
}

#[test]
fn a_process_that_is_killed_with_three_axes_moving_leaves_exact_counts() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let is_over = AtomicBool::new(false);
    let board = NodeBoard::over(Box::new(world.clone()));
    let mut places = CommonBegin::places(3, PATIENT);
    thread::scope(|scope| {
        for axis in 0..3 {
            let (board, state, place) = (&board, state.path(), places.pop());
            let is_over = &is_over;
            scope.spawn(move || {
                let killed = catch_unwind(AssertUnwindSafe(|| {
                    pour(board, state, (axis, (8.0, 2.0)), place, |made| {
                        is_over.fetch_or(made > 500, Ordering::Relaxed);
                        assert!(!is_over.load(Ordering::Relaxed), "killed");
                        ControlFlow::Continue(())
                    })
                }));
                assert!(killed.is_err());
            });
        }
    });
    drop(board);
    world.pass(2_000);
    recovered(&world, state.path(), 3);
}

#[test]
fn a_plan_that_the_line_does_not_carry_beside_the_others_is_refused_with_the_figure() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let board = NodeBoard::over(Box::new(world.clone()));
    let slow = |axis: usize| table(axis).with_baud(2_400);
    let refused = thread::scope(|scope| {
        let threads: Vec<_> = (0..4)
            .map(|axis| {
                let (board, state) = (&board, state.path());
                scope.spawn(move || {
                    let mut drive = drive(board, &slow(axis), state, axis).unwrap();
                    let plan = crate::rig::dose(30.0, 1.5, true);
                    pump_bench::drives::Drive::run(&mut drive, &plan, &mut crate::rig::go)
                })
            })
            .collect();
        threads.into_iter().filter_map(|thread| thread.join().unwrap().err()).collect::<Vec<_>>()
    });
    assert!(!refused.is_empty());
    for fault in refused {
        let NodeError::LineFull { needed_bytes_s, free_bytes_s, all_bytes_s } =
            *crate::rig::node_error(&fault.error)
        else {
            panic!("{fault:?}")
        };
        assert!(needed_bytes_s > free_bytes_s && free_bytes_s < all_bytes_s, "{fault:?}");
        assert_eq!((fault.made_least, fault.made_most, all_bytes_s), (0, 0, 192));
    }
}

#[test]
fn an_axis_that_another_drive_has_is_refused_and_free_again_after_it() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let board = NodeBoard::over(Box::new(world.clone()));
    let first = drive(&board, &table(0), state.path(), 0).unwrap();
    let twice = drive(&board, &table(0), state.path(), 1).unwrap_err();
    assert!(matches!(crate::rig::node_error(&twice), NodeError::Twice { axis: Axis::X }), "{twice:?}");
    drop(first);
    drop(drive(&board, &table(0), state.path(), 0).unwrap());
}
