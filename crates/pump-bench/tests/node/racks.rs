//! Axes of one board in a rack.

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use pump_bench::drives::{Drive, Node, NodeBoard, Opening, StopRequest};
use pump_bench::pump_file::{Axis, DriveTable};
use pump_bench::rack::{Rack, RackEnd, RackError, RackFile, RackReport};
use pump_bench::{Bench, DoseError, DoseRequest, PumpFile, Session, built_in};
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

/// A gradient of two equal pumps, and a step of each that begins while the other one's is under way.
const GRADIENT: &str = r#"
schema = "rack/1"
[pumps]
acid = "acid"
base = "base"
[[step]]
gradient = { acid = [1, 0], base = [0, 1] }
rate = "2mL/s"
for = "3s"
ramp = "1s"
[[step]]
at = "4s"
pump = "acid"
volume = "1mL"
rate = "2mL/s"
[[step]]
at = "6s"
pump = "base"
volume = "1mL"
rate = "2mL/s"
"#;

/// Runs the rack [`MIX`], as [`run`] does.
fn mix(
    world: &SharedWorld,
    state: &Path,
    stopped: &'static AtomicBool,
    heard: &(dyn Fn() + Sync),
) -> RackReport {
    run(MIX, world, state, stopped, heard)
}

/// Runs a rack with the axes X and Y of a board. `stopped` is true once somebody has asked for a stop. `heard` is
/// called with each progress.
fn run(
    rack: &str,
    world: &SharedWorld,
    state: &Path,
    stopped: &'static AtomicBool,
    heard: &(dyn Fn() + Sync),
) -> RackReport {
    let (benches, mut drives) = pumps(built_in("three-roller").unwrap(), world, state);
    ran(rack, benches, &mut drives, stopped, heard).unwrap()
}

/// Returns two pumps of the file, at the axes X and Y of a board, whose angles are known.
fn pumps(pump: PumpFile, world: &SharedWorld, state: &Path) -> (Vec<Bench>, Vec<Node>) {
    pumps_by(&Rig::table(), pump, world, state)
}

/// Returns pumps as [`pumps`] does, at a line as `line` has it.
fn pumps_by(line: &DriveTable, pump: PumpFile, world: &SharedWorld, state: &Path) -> (Vec<Bench>, Vec<Node>) {
    let (benches, mut drives) = unmet(line, pump, world, state);
    for (bench, drive) in benches.iter().zip(&mut drives) {
        let mut session = Session::with_drive(bench, Box::new(drive)).unwrap();
        session.connect().unwrap();
        session.set_angle(Some(Phase::known(0.3))).unwrap();
    }
    (benches, drives)
}

/// Returns pumps as [`pumps_by`] does, before a session has met their axes.
fn unmet(line: &DriveTable, pump: PumpFile, world: &SharedWorld, state: &Path) -> (Vec<Bench>, Vec<Node>) {
    let board = NodeBoard::over(Box::new(world.clone()));
    let mut drives: Vec<Node> = Vec::new();
    let mut benches: Vec<Bench> = Vec::new();
    for (name, axis) in [("acid", Axis::X), ("base", Axis::Y)] {
        let mut file = pump.clone();
        file.pump.id = name.to_owned();
        file.drive = Some(Rig::table().with_axis(axis));
        let folder = state.join(name);
        std::fs::create_dir_all(&folder).unwrap();
        let settings_record = Some(folder.join("board-settings.json"));
        let opening =
            Opening { settings_record, boards: Some(state.join("node.boards")), ..Opening::default() };
        let table = line.clone().with_axis(axis);
        let drive = board.axis(&table, &file.motor, &opening).unwrap();
        let bench = Bench::new(file, None, state).unwrap();
        let bench = bench.driven_by(&drive).unwrap().at_port(table.port).confirming_pump(true);
        drives.push(drive);
        benches.push(bench);
    }
    (benches, drives)
}

fn ran(
    rack: &str,
    benches: Vec<Bench>,
    drives: &mut [Node],
    stopped: &'static AtomicBool,
    heard: &(dyn Fn() + Sync),
) -> Result<RackReport, RackError> {
    let file = RackFile::parse(rack, Path::new("mix.toml")).unwrap();
    let asked = StopRequest::new(|| stopped.load(Ordering::SeqCst));
    let rack = Rack::new(file, benches).unwrap().stopping_on(asked);
    let drives = drives.iter_mut().map(|drive| Some(Box::new(drive) as Box<dyn Drive>)).collect();
    rack.run_with(drives, |_| heard())
}

/// Returns a pump of many steps, and its flow at so many steps a second, in mL/s.
fn fine_pump(steps_s: f64) -> (PumpFile, f64) {
    let mut file = built_in("three-roller").unwrap();
    file.motor.steps_per_rev *= 32;
    let step_rad = TAU / f64::from(file.motor.steps_per_rev);
    let ml_s = file.model().unwrap().average_flow_ml_s(steps_s * step_rad);
    (file, ml_s)
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
fn axes_of_one_node_follow_a_gradient_and_begin_at_times_of_their_own() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let report = run(GRADIENT, &world, state.path(), &STOPPED, &|| {});
    assert!(report.completed, "{}", report.json());
    // 2 mL/s for 3 s with a ramp of 1 s at either end are 4 mL, of which each equal pump has the half.
    let delivered: Vec<f64> = report.pumps.iter().map(|pump| pump.delivered_ml).collect();
    assert!((delivered[0] - 3.0).abs() < 5e-3 && (delivered[1] - 3.0).abs() < 5e-3, "{delivered:?}");
    let (acid, base) = (rises(&world, 0), rises(&world, 1));
    let [acid_steps, base_steps] =
        [0, 1].map(|pump| report.pumps[pump].doses[0].dose.steps_made.unwrap().unsigned_abs() as usize);
    // In the gradient the one is ahead at first, and the other catches up: by the flows that were asked for, a third of
    // the steps of the falling flow are made before the rising flow has made a tenth of its own.
    let at = |rises: &[u64], step: usize| rises[step] - acid[0].min(base[0]);
    assert!(at(&acid, acid_steps / 3) < at(&base, base_steps / 3), "the flows do not cross");
    assert!(at(&acid, acid_steps - 1) < at(&base, base_steps - 1) + 1_000_000);
    // The second steps begin 2 s apart: appointments are kept by this computer's clock, which a busy machine may serve
    // late, so no more is claimed than their order.
    assert!(base[base_steps] > acid[acid_steps], "{} and {}", base[base_steps], acid[acid_steps]);
    assert!(report.pumps[1].doses[1].begin_s >= 6.0, "{}", report.json());
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
        // Before its move the board has released the motor; after it the stop itself is told.
        let is_told =
            |told: &&str| told.contains("emergency stop") || told.contains("has released the motor");
        assert!(reasons.iter().any(is_told), "{in_ms} ms: {reasons:?}");
        // One reason of several pumps is told once.
        if matches!(reasons.as_slice(), [first, second] if first == second) {
            assert!(report.text().contains(" failed too, for the reason of "), "{}", report.text());
        }
    }
}

#[test]
fn a_later_step_of_more_steps_a_second_than_the_board_makes_is_refused_before_the_rack_moves() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let (file, ml_s) = fine_pump(98_000.0);
    let rack = format!(
        "schema = 'rack/1'\n[pumps]\nacid = 'acid'\nbase = 'base'\n\
         [[step]]\npump = 'acid'\nvolume = '0.1mL'\nrate = '0.5mL/s'\n\
         [[step]]\npump = 'base'\nvolume = '0.2mL'\nrate = '{ml_s}mL/s'\n"
    );
    let (benches, mut drives) = pumps(file, &world, state.path());
    let refused = ran(&rack, benches, &mut drives, &STOPPED, &|| {}).unwrap_err();
    let told = pump_bench::report::with_sources(&refused);
    assert!(told.contains("pump `base` of the rack, step 2"), "{told}");
    assert!(told.contains("the node driver makes 96385 steps/s at most"), "{told}");
    assert_eq!((rises(&world, 0).len(), rises(&world, 1).len()), (0, 0));
}

/// Head of a rack of two equal pumps.
const TWO: &str = "schema = 'rack/1'\n[pumps]\nacid = 'acid'\nbase = 'base'\n";

#[test]
fn axes_that_together_exceed_the_board_are_refused_with_the_sum_before_anything_is_on_record() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let (file, ml_s) = fine_pump(60_000.0);
    let together = format!(
        "{TWO}[[step]]\nratio = {{ acid = 1, base = 1 }}\nvolume = '0.4mL'\nrate = '{}mL/s'\n",
        2.0 * ml_s
    );
    let alone = |at: &str, pump: &str| {
        format!("[[step]]\n{at}\npump = '{pump}'\nvolume = '0.4mL'\nrate = '{ml_s}mL/s'\n")
    };
    // Each step is given to the board before it begins, so it needs its part of the board from then on.
    let meeting = [TWO, &alone("at = '0s'", "acid"), &alone("at = '0.1s'", "base")].concat();
    for (rack, base) in [(together, "`base` in step 1 62500"), (meeting, "`base` in step 2 62500")] {
        let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
        let (benches, mut drives) = pumps(file.clone(), &world, state.path());
        let journals = || {
            let of = |pump: &str| state.path().join(pump).join("node/journal.jsonl");
            ["acid", "base"].map(|pump| std::fs::read(of(pump)).unwrap())
        };
        let before = journals();
        let refused = ran(&rack, benches.clone(), &mut drives, &STOPPED, &|| {}).unwrap_err();
        let told = refused.to_string();
        assert!(told.contains("add up to 125000 steps/s, and the board at"), "{told}");
        assert!(told.contains("has 100000 for all its axes: `acid` in step 1 62500"), "{told}");
        assert!(told.contains(base) && told.contains("or one after another"), "{told}");
        assert_eq!((rises(&world, 0).len(), rises(&world, 1).len()), (0, 0));
        assert_eq!(journals(), before);
    }
}

#[test]
fn a_rack_that_is_refused_after_a_kill_tells_the_exact_count_of_each_pump_that_waits() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let file = built_in("three-roller").unwrap();
    let (benches, mut drives) = pumps(file.clone(), &world, state.path());
    for (bench, drive) in benches.iter().zip(&mut drives) {
        let mut session = Session::with_drive(bench, Box::new(drive)).unwrap();
        let prepared = session.prepare(DoseRequest::dose(8.0)).unwrap();
        let killed = catch_unwind(AssertUnwindSafe(|| {
            session.run(&prepared, |made| {
                assert!(made < 500, "killed");
                ControlFlow::Continue(())
            })
        }));
        assert!(killed.is_err());
    }
    drop((benches, drives));
    world.pass(2_000);
    let (benches, mut drives) = unmet(&Rig::table(), file, &world, state.path());
    let refused = ran(MIX, benches, &mut drives, &STOPPED, &|| {}).unwrap_err();
    let told: Vec<_> = refused.each().map(|error| (error.pump(), of_unfinished(error))).collect();
    let [acid, base] = [0, 1].map(|axis| rises(&world, axis).len() as f64);
    let Some([(Some("acid"), acid_ml), (Some("base"), base_ml)]) = told.first_chunk() else {
        panic!("{told:?}")
    };
    assert!(acid_ml[0] > 0.0 && acid_ml[0] == acid_ml[1] && base_ml[0] == base_ml[1], "{told:?}");
    assert!((acid_ml[0] / base_ml[0] - acid / base).abs() < 0.05, "{told:?}, {acid} and {base} steps");
}

/// Returns the bounds of what an unfinished dose has delivered, in mL.
fn of_unfinished(error: &RackError) -> [f64; 2] {
    let RackError::Dose { source, .. } = error else { panic!("{error:?}") };
    let DoseError::Unfinished { least_ml, most_ml, .. } = **source else { panic!("{source:?}") };
    [least_ml, most_ml]
}

#[test]
fn axes_that_together_exceed_the_board_run_one_after_another() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let (file, ml_s) = fine_pump(60_000.0);
    let step = |pump: &str| format!("[[step]]\npump = '{pump}'\nvolume = '0.4mL'\nrate = '{ml_s}mL/s'\n");
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let (benches, mut drives) = pumps(file, &world, state.path());
    let rack = [TWO, &step("acid"), &step("base")].concat();
    let report = ran(&rack, benches, &mut drives, &STOPPED, &|| {}).unwrap();
    assert!(report.completed, "{}", report.json());
}

#[test]
fn axes_that_together_exceed_the_line_are_refused_before_anything_moves() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let slow = Rig::table().with_baud(2_400);
    let pump = built_in("three-roller").unwrap();
    let (benches, mut drives) = pumps_by(&slow, pump, &world, state.path());
    let rack = format!(
        "{TWO}[[step]]\nratio = {{ acid = 1, base = 1 }}\nvolume = '30mL'\nrate = '3.6mL/s'\nsmooth = true\n"
    );
    let refused = ran(&rack, benches, &mut drives, &STOPPED, &|| {}).unwrap_err();
    let told = pump_bench::report::with_sources(&refused);
    assert!(told.contains(" bytes/s of the line, and the board at"), "{told}");
    assert_eq!((rises(&world, 0).len(), rises(&world, 1).len()), (0, 0));
}
