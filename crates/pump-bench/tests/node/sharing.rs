//! Pumps that share a board, one after the other.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use pump_bench::drives::{Disturbance, Drive, DriveError, Node, Opening};
use pump_bench::pump_file::{Axis, DriveTable};
use pump_bench::{Bench, DoseRequest, Session, built_in};
use pump_ctl::plan::{Cruise, Phase};

use crate::rig::{Rig, dose, run};
use crate::world::{Event, SharedWorld};

/// Folder of all records, and the opening of a pump in it.
fn opening(state: &Path, pump: &str) -> Opening {
    let folder = state.join(pump).join("node");
    std::fs::create_dir_all(&folder).unwrap();
    Opening {
        settings_record: Some(folder.join("board-settings.json")),
        boards: Some(state.join("node.boards")),
        ..Opening::default()
    }
}

fn open(world: &SharedWorld, table: &DriveTable, opening: &Opening) -> Result<Node, DriveError> {
    Node::over(Box::new(world.clone()), table, &built_in("three-roller").unwrap().motor, opening)
}

#[test]
fn two_pumps_of_one_board_keep_each_others_state() {
    // A board that knows its number, and one that is known by its port.
    for number in [0xb0a2d, 0] {
        let (world, state) = (SharedWorld::of_board(number), tempfile::tempdir().unwrap());
        let (acid, base) = (opening(state.path(), "acid"), opening(state.path(), "base"));
        let (x, y) = (Rig::table(), Rig::table().with_axis(Axis::Y));
        let (some, more) = (dose(1.0, 4.0, true), dose(-0.5, 1.0, false));
        for (table, opening) in [(&x, &acid), (&y, &base)] {
            let mut drive = open(&world, table, opening).unwrap();
            assert_eq!(drive.disturbed(), Some(Disturbance::Reset), "its axis was never configured");
        }
        let mut counts = [0, 0];
        for _ in 0..3 {
            for (n, (table, opening, plan)) in
                [(&x, &acid, &some), (&y, &base, &more)].into_iter().enumerate()
            {
                let mut drive = open(&world, table, opening).unwrap();
                assert_eq!((drive.disturbed(), drive.count()), (None, Some(counts[n])), "{number}");
                run(&mut drive, plan);
                counts[n] += plan.steps();
            }
        }
        assert_eq!(world.hardware(|hardware| [0, 1].map(|axis| hardware.motors[axis].count)), counts);
        // A reset is seen by both.
        world.plan(0, Event::Reset);
        world.pass(10);
        for (table, opening) in [(&x, &acid), (&y, &base)] {
            let mut drive = open(&world, table, opening).unwrap();
            assert_eq!((drive.disturbed(), drive.count()), (Some(Disturbance::Reset), Some(0)));
        }
    }
}

#[test]
fn a_board_that_another_program_has_through_another_port_is_refused_with_one_message() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let (acid, base) = (opening(state.path(), "acid"), opening(state.path(), "base"));
    drop(open(&world, &Rig::table(), &acid).unwrap());
    let lock = state.path().join("node.boards/00000000000b0a2d.lock");
    // Process 1 is no process of this test.
    std::fs::write(&lock, "process 1 at /dev/ttyACM0\n").unwrap();
    let holding = std::fs::File::open(&lock).unwrap();
    holding.lock().unwrap();
    let other = Rig::table().with_axis(Axis::Y).with_port("/dev/ttyUSB9");
    let refused = open(&world, &other, &base).unwrap_err();
    let device = PathBuf::from("board 00000000000b0a2d at /dev/ttyUSB9");
    assert!(
        matches!(&refused, DriveError::Busy { device: at, holder } if *at == device
            && holder == "process 1 at /dev/ttyACM0"),
        "{refused:?}"
    );
    drop(holding);
    drop(open(&world, &other, &base).unwrap());
}

#[test]
fn two_ports_of_one_process_whose_boards_tell_one_number_are_both_named() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let (acid, base) = (opening(state.path(), "acid"), opening(state.path(), "base"));
    let holding = open(&world, &Rig::table(), &acid).unwrap();
    let other = Rig::table().with_axis(Axis::Y).with_port("/dev/ttyUSB9");
    let refused = pump_bench::report::with_sources(&open(&world, &other, &base).unwrap_err());
    let ports = "the boards at /dev/ttyACM0 and /dev/ttyUSB9 tell one number, 00000000000b0a2d";
    assert!(refused.contains(ports) && !refused.contains("in use"), "{refused}");
    drop(holding);
    drop(open(&world, &other, &base).unwrap());
}

#[test]
fn a_pump_whose_record_is_from_before_boards_had_one_keeps_its_session() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let acid = opening(state.path(), "acid");
    let before = Opening { boards: None, ..acid.clone() };
    drop(open(&world, &Rig::table(), &before).unwrap());
    assert_eq!(open(&world, &Rig::table(), &acid).unwrap().disturbed(), None);
}

/// Connects the pump at this axis, with its own journal, and makes a dose. Returns what is told of the rotor, and the
/// half width of its angle before the dose, in rad.
fn pour_at(world: &SharedWorld, state: &Path, axis: Axis, angle: Option<Phase>) -> (Vec<String>, f64) {
    let mut drive = open(world, &Rig::table().with_axis(axis), &opening(state, "acid")).unwrap();
    let bench = Bench::new(built_in("three-roller").unwrap(), None, &state.join("journal")).unwrap();
    let bench = bench.driven_by(&drive).unwrap().confirming_pump(true);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.connect().unwrap();
    let told = session.notes().into_iter().map(|note| note.text().to_owned());
    let told = told.filter(|text| text.contains("the rollers' angle")).collect();
    if angle.is_some() {
        session.set_angle(angle).unwrap();
    }
    let half_width_rad = session.state().unwrap().half_width_rad;
    let prepared =
        session.prepare(DoseRequest::dose(0.5).with_cruise(Some(Cruise::Flow { ml_s: 1.0 }))).unwrap();
    assert!(session.run(&prepared, |_| ControlFlow::Continue(())).unwrap().completed);
    (told, half_width_rad)
}

#[test]
fn a_pump_that_was_moved_to_another_axis_is_told_so_and_its_angle_is_less_sure() {
    let (world, state) = (SharedWorld::new(), tempfile::tempdir().unwrap());
    let exact = Some(Phase::known(0.3));
    pour_at(&world, state.path(), Axis::Y, exact);
    assert_eq!(pour_at(&world, state.path(), Axis::Y, None), (Vec::new(), 0.0));
    // The axis X was never configured, and Y counts from elsewhere once the pump was at X.
    for axis in [Axis::X, Axis::Y] {
        let (told, half_width_rad) = pour_at(&world, state.path(), axis, None);
        let [told] = told.as_slice() else { panic!("{axis}: {told:?}") };
        assert!(told.starts_with("the motor is at another axis of the board than before"), "{told}");
        assert!(half_width_rad > 0.0, "{axis}");
        assert_eq!(pour_at(&world, state.path(), axis, exact), (Vec::new(), 0.0), "{axis}");
    }
}
