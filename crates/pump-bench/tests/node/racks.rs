//! Axes of one board in a rack.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use pump_bench::drives::{Drive, Node, NodeBoard, Opening, StopRequest};
use pump_bench::pump_file::Axis;
use pump_bench::rack::{Rack, RackEnd, RackFile, RackReport};
use pump_bench::{Bench, Session, built_in};
use pump_ctl::plan::Phase;

use crate::rig::Rig;
use crate::world::{Event, SharedWorld};

/// Two equal pumps, one after the other's half, and both together.
const MIX: &str = r#"
schema = "rack/1"
[pumps]
acid = "acid"
base = "base"
[[step]]
ratio = { acid = 1, base = 1 }
volume = "3mL"
rate = "6mL/s"
[[step]]
pump = "base"
volume = "1mL"
"#;

/// Runs the rack with the axes X and Y of a board. `stopped` is true once somebody has asked for a stop. `heard` is
/// called with each progress.
fn mix(
    world: &SharedWorld,
    state: &Path,
    stopped: &'static AtomicBool,
    heard: &(dyn Fn() + Sync),
) -> RackReport {
    let board = NodeBoard::over(Box::new(world.clone()));
    let mut drives: Vec<Node> = Vec::new();
    let mut benches: Vec<Bench> = Vec::new();
    for (name, axis) in [("acid", Axis::X), ("base", Axis::Y)] {
        let mut file = built_in("three-roller").unwrap();
        file.pump.id = name.to_owned();
        file.drive = Some(Rig::table().with_axis(axis));
        let folder = state.join(name);
        std::fs::create_dir_all(&folder).unwrap();
        let settings_record = Some(folder.join("board-settings.json"));
        let opening =
            Opening { settings_record, boards: Some(state.join("node.boards")), ..Opening::default() };
        let table = Rig::table().with_axis(axis);
        let mut drive = board.axis(&table, &file.motor, &opening).unwrap();
        let bench = Bench::new(file, None, state).unwrap();
        let bench = bench.driven_by(&drive).unwrap().at_port(table.port).confirming_pump(true);
        let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
        session.connect().unwrap();
        session.set_angle(Some(Phase::known(0.3))).unwrap();
        drop(session);
        drives.push(drive);
        benches.push(bench);
    }
    let file = RackFile::parse(MIX, Path::new("mix.toml")).unwrap();
    let asked = StopRequest::new(|| stopped.load(Ordering::SeqCst));
    let rack = Rack::new(file, benches).unwrap().stopping_on(asked);
    let drives = drives.iter_mut().map(|drive| Some(Box::new(drive) as Box<dyn Drive>)).collect();
    rack.run_with(drives, |_| heard()).unwrap()
}

fn rises(world: &SharedWorld, axis: usize) -> Vec<u64> {
    world.hardware(|hardware| hardware.motors[axis].rises.clone())
}

#[test]
fn axes_of_one_node_that_a_rack_begins_at_one_time_begin_at_one_tick() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let report = mix(&world, state.path(), &STOPPED, &|| {});
    assert!(report.completed, "{}", report.json());
    let delivered: Vec<f64> = report.pumps.iter().map(|pump| pump.delivered_ml).collect();
    assert!((delivered[0] - 1.5).abs() < 2e-3 && (delivered[1] - 2.5).abs() < 2e-3, "{delivered:?}");
    // The pumps are equal, so the steps that they make together are due at the same times.
    let (acid, base) = (rises(&world, 0), rises(&world, 1));
    assert!(acid.len() > 100 && base.len() > acid.len(), "{} and {}", acid.len(), base.len());
    let apart = acid.iter().zip(&base).map(|(one, other)| one.abs_diff(*other)).max().unwrap();
    assert!(apart <= 1, "{apart} us");
}

#[test]
fn a_stop_before_the_common_begin_is_a_stop_of_all_and_no_fault() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let report = mix(&world, state.path(), &STOPPED, &|| STOPPED.store(true, Ordering::SeqCst));
    assert_eq!(report.end, RackEnd::Stopped, "{}", report.json());
    assert_eq!((rises(&world, 0).len(), rises(&world, 1).len()), (0, 0));
}

#[test]
fn a_fault_before_the_common_begin_is_no_end_of_a_rack_that_is_complete() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    // The emergency stop is pressed before a move is on the board, and while it waits for the other.
    for in_ms in [0, 2, 4, 8, 12] {
        let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
        let once = AtomicBool::new(true);
        let report = mix(&world, state.path(), &STOPPED, &|| {
            if once.swap(false, Ordering::SeqCst) {
                world.plan(in_ms, Event::Estop);
            } else if world.rises().is_empty() {
                // The other axis is late, and this one waits for it.
                std::thread::sleep(Duration::from_millis(20));
            }
        });
        assert!(report.end == RackEnd::Fault && !report.completed, "{in_ms} ms: {}", report.json());
        let reasons: Vec<&str> = report.pumps.iter().filter_map(|pump| pump.error.as_deref()).collect();
        // Before its move the board has let go of the motor; after it the stop itself is told.
        let is_told =
            |told: &&str| told.contains("emergency stop") || told.contains("has let go of the motor");
        assert!(reasons.iter().any(is_told), "{in_ms} ms: {reasons:?}");
    }
}
