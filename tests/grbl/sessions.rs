//! Claims about the record of a board that resets, is switched off and on, or lets go of its motor.

use std::fs::File;
use std::io;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use pump_bench::drives::{DriveError, StopRequest};
use pump_bench::pump_file::{DriveTable, DriverName, PumpFile};
use pump_bench::record::{PumpState, Purpose, Storage};
use pump_bench::report::{Explain, Remedy};
use pump_bench::{Bench, DoseError, DoseRequest, Session, built_in};
use pump_ctl::plan::Phase;

use crate::rig::{defective, each, plug, plug_defective, port, start};
use crate::simulated::Simulated;
use crate::simulated::options::{Defects, Options, Sensor};
use crate::virtual_time::session::VirtualDrive;

/// Angle of two full steps of 200 a revolution, rad.
const FALL_RAD: f64 = 2.0 * std::f64::consts::TAU / 200.0;

fn go(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Makes a bench with this board.
fn bench(folder: &Path, board: &Simulated) -> Bench {
    let mut file = built_in("three-roller").unwrap();
    file.drive = Some(DriveTable::of(DriverName::Grbl).with_index_angle_deg(40.0));
    file.motor.confirmed = None;
    Bench::new(file, None, folder).unwrap().at_port(Some(board.path().to_owned()))
}

/// Makes a bench with a drive in virtual time.
fn virtual_bench(file: PumpFile, folder: &Path, drive: &VirtualDrive) -> Bench {
    Bench::new(file, None, folder).unwrap().driven_by(drive).unwrap().confirming_pump(true)
}

fn close(one: f64, two: f64) -> bool {
    (one - two).abs() < 1e-9
}

#[test]
fn a_board_that_was_switched_off_and_on_unseen_makes_the_angle_wider_and_its_count_proves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let state = {
        let board = plug(Options::default());
        let bench = bench(folder.path(), &board);
        let mut session = bench.session().unwrap();
        session.set_angle(Some(Phase::known(0.5))).unwrap();
        let prepared = session.prepare(DoseRequest::dose(1.0)).unwrap();
        session.run(&prepared, go).unwrap();
        *session.state().unwrap()
    };
    assert!(state.count.is_some_and(|count| count != 0));
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    let mut session = bench.session().unwrap();
    session.connect().unwrap();
    let met = *session.state().unwrap();
    assert!(close(met.half_width_rad, FALL_RAD) && met.disturbances == 1, "{met:?}");
    assert!(session.notes().iter().any(|note| note.text().contains("the device was reset")));
}

#[test]
fn a_dose_cut_off_with_the_boards_power_keeps_its_bounds() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("three-roller/grbl/journal.jsonl");
    let made = {
        let board = plug(Options::default());
        let bench = bench(folder.path(), &board);
        let mut session = bench.session().unwrap();
        session.set_angle(Some(Phase::known(0.5))).unwrap();
        let prepared = session.prepare(DoseRequest::dose(3.0)).unwrap();
        // A kill leaves the journal as it is early in the motion.
        let mut early = Vec::new();
        session
            .run(&prepared, |made| {
                if early.is_empty() && made > 0 {
                    early = std::fs::read(&journal).unwrap();
                }
                go(made)
            })
            .unwrap();
        std::fs::write(&journal, early).unwrap();
        board.rest().steps
    };
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    let before = bench.story().unwrap().state.unwrap().unfinished.unwrap();
    assert!(before.made_least < before.made_most && made > before.made_least);
    let mut session = bench.session().unwrap();
    session.connect().unwrap();
    let met = *session.state().unwrap();
    let unfinished = met.unfinished.unwrap();
    assert_eq!((unfinished.made_least, unfinished.made_most), (before.made_least, before.made_most));
    assert_eq!(met.disturbances, 1);
}

#[test]
fn a_retraction_goes_on_from_an_angle_that_a_reset_has_widened() {
    let folder = tempfile::tempdir().unwrap();
    let board = start(Options::default());
    let mut drive = VirtualDrive::new(&board);
    let mut file = built_in("three-roller").unwrap();
    // The line settles for seconds.
    file.outlet = pump_model::Line { inertance_kpa_s2_ml: 0.1, ..pump_model::Line::PUBLISHED }.into();
    let bench = virtual_bench(file, folder.path(), &drive);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let request = DoseRequest::dose(1.0).with_retraction(0.3);
    let prepared = session.prepare(request).unwrap();
    assert!(
        prepared.prediction.settle_s > 0.8,
        "long enough to be reset in: {}",
        prepared.prediction.settle_s
    );
    let (mut stands, mut is_reset) = (None, false);
    let delivered = session.run(&prepared, |made| {
        if made == prepared.plan.steps().unsigned_abs() && !board.truth().moving && !is_reset {
            let since = *stands.get_or_insert(board.now());
            is_reset = board.now() - since > Duration::from_millis(300);
            if is_reset {
                board.send(&[0x18]);
            }
        }
        go(made)
    });
    assert!(is_reset, "nobody asked while the line settled");
    let state = *session.state().unwrap();
    assert!(state.disturbances >= 1 && state.half_width_rad >= FALL_RAD - 1e-9, "{state:?}");
    match delivered {
        Ok(delivered) => assert!(delivered.completed && delivered.sucked_back),
        // The session may meet the reset board before the way back. The error then says that the dose is
        // delivered.
        Err(DoseError::Retraction { delivered_ml, .. }) => assert!((delivered_ml - 1.0).abs() < 0.01),
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn an_index_found_by_a_board_that_lets_go_of_its_motor_is_known_less_well() {
    let seek = |settings: Vec<(u16, f32)>| -> PumpState {
        let folder = tempfile::tempdir().unwrap();
        let sensor = Some(Sensor { at: 4000, width: 128, every: 12_800 });
        let board = plug(Options { settings, time_scale: 4.0, sensor, ..Options::default() });
        let bench = bench(folder.path(), &board);
        let mut session = bench.session().unwrap();
        session.seek_index(go).unwrap().unwrap()
    };
    let (held, freed) = (seek(vec![(1, 255.0)]), seek(vec![(1, 25.0)]));
    assert_eq!((held.disturbances, freed.disturbances), (0, 1));
    assert!(close(freed.half_width_rad, held.half_width_rad + FALL_RAD));
}

#[test]
fn alarms_that_nobody_knows_leave_the_angle_unknown() {
    each([1, 10, 17], |code| {
        let folder = tempfile::tempdir().unwrap();
        let board = plug_defective(Defects { alarm: Some((700, code)), ..Defects::default() });
        let bench = bench(folder.path(), &board);
        let mut session = bench.session().unwrap();
        session.set_angle(Some(Phase::known(0.0))).unwrap();
        let prepared = session.prepare(DoseRequest::dose(3.0)).unwrap();
        let error = session.run(&prepared, go).unwrap_err();
        assert_eq!(error.remedies(), [Remedy::SeeStatusThenFinish], "{error}");
        assert!(!session.state().unwrap().phase().is_known(bench.model().pitch_rad()), "{code}");
    });
}

#[test]
fn a_fault_on_the_way_back_or_in_a_turn_says_what_was_made_of_it_and_nothing_to_resume() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug_defective(Defects { alarm: Some((1300, 2)), ..Defects::default() });
    let bench = bench(folder.path(), &board);
    let mut session = bench.session().unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let request = DoseRequest::dose(1.0).with_retraction(1.0);
    let prepared = session.prepare(request).unwrap();
    assert!(prepared.plan.steps() < 1300, "the alarm comes on the way back");
    let error = session.run(&prepared, go).unwrap_err();
    let DoseError::Retraction { delivered_ml, source } = &error else { panic!("{error}") };
    assert!((delivered_ml - 1.0).abs() < 0.01);
    let DoseError::Drive { least_ml, most_ml, unfinished, .. } = **source else { panic!("{source}") };
    assert!(!unfinished && -2.0 < least_ml && least_ml <= most_ml && most_ml < 0.0, "{error}");
    assert_eq!(error.remedies(), [Remedy::SeeStatus], "{error}");
    let owed_ml = session.state().unwrap().carry_ml;
    assert!(
        (owed_ml + 0.5 * (least_ml + most_ml)).abs() < 0.01,
        "the volume sucked back is carried: {owed_ml}"
    );
}

#[test]
fn a_smooth_dose_is_refused_before_the_board_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    let mut session = bench.session().unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let smooth = DoseRequest::dose(1.0).with_smooth(true);
    for refused in [session.prepare(smooth), bench.prepare(smooth)] {
        let error = refused.unwrap_err();
        assert_eq!(error.remedies(), [Remedy::LeaveSmoothOut], "{error}");
    }
}

#[test]
fn a_motor_that_was_let_go_on_purpose_is_disturbed_once() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    let mut session = bench.session().unwrap();
    session.set_angle(Some(Phase::known(1.0))).unwrap();
    let released = session.release().unwrap();
    assert!(close(released.half_width_rad, FALL_RAD));
    session.connect().unwrap();
    let met = *session.state().unwrap();
    assert!(close(met.half_width_rad, FALL_RAD) && met.disturbances == 1, "{met:?}");
}

/// Sends bytes to a board as another program does, and waits until the board rests.
fn other_program(board: &Simulated, bytes: &[u8]) {
    std::fs::write(board.path(), bytes).unwrap();
    board.rest();
}

#[test]
fn a_released_rotor_that_another_program_turned_is_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    {
        let mut session = bench.session().unwrap();
        session.set_angle(Some(Phase::known(1.0))).unwrap();
        assert!(session.release().unwrap().phase().is_known(bench.model().pitch_rad()));
    }
    other_program(&board, b"\x18$X\n$J=G91X20F6000\n");
    assert_eq!(board.rest().steps, 5_000);
    let mut session = bench.session().unwrap();
    session.connect().unwrap();
    assert!(!session.state().unwrap().phase().is_known(bench.model().pitch_rad()));
    assert!(session.notes().iter().any(|note| note.text().contains("something else has moved it")));
}

#[test]
fn a_released_rotor_whose_board_counts_anew_is_unknown() {
    let folder = tempfile::tempdir().unwrap();
    {
        let board = plug(Options::default());
        let bench = bench(folder.path(), &board);
        let mut session = bench.session().unwrap();
        session.set_angle(Some(Phase::known(1.0))).unwrap();
        let prepared = session.prepare(DoseRequest::dose(0.5)).unwrap();
        session.run(&prepared, go).unwrap();
        session.release().unwrap();
    }
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    let mut session = bench.session().unwrap();
    session.connect().unwrap();
    assert!(!session.state().unwrap().phase().is_known(bench.model().pitch_rad()));
}

#[test]
fn a_release_that_cannot_be_recorded_is_no_release_and_no_disturbance() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    bench.session().unwrap().set_angle(Some(Phase::known(1.0))).unwrap();
    let mut session = bench.session().unwrap();
    session.connect().unwrap();
    let (journal, aside) = (bench.folder().path().join("journal.jsonl"), folder.path().join("aside"));
    std::fs::rename(&journal, &aside).unwrap();
    std::fs::create_dir(&journal).unwrap();
    for _ in 0..3 {
        assert!(session.release().is_err());
        let state = session.state().unwrap();
        assert_eq!((state.disturbances, state.half_width_rad, state.released), (0, 0.0, false));
    }
    assert!(!board.truth().lines.iter().any(|line| line == "$SLP"));
    std::fs::remove_dir(&journal).unwrap();
    std::fs::rename(&aside, &journal).unwrap();
    assert_eq!(session.release().unwrap().disturbances, 1);
}

#[test]
fn a_release_that_is_due_and_cannot_be_recorded_is_tried_once_in_each_timeout() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let mut file = built_in("three-roller").unwrap();
    file.drive = Some(port(&board).with_hold_timeout_s(3.0));
    file.motor.confirmed = None;
    let bench = Bench::new(file, None, folder.path()).unwrap();
    bench.session().unwrap().set_angle(Some(Phase::known(1.0))).unwrap();
    let mut session = bench.session().unwrap();
    session.connect().unwrap();
    let (journal, aside) = (bench.folder().path().join("journal.jsonl"), folder.path().join("aside"));
    std::fs::rename(&journal, &aside).unwrap();
    std::fs::create_dir(&journal).unwrap();
    let mut failed = Vec::new();
    let since = std::time::Instant::now();
    while failed.len() < 2 {
        assert!(since.elapsed() < Duration::from_secs(60), "{} releases were tried", failed.len());
        if session.release_when_due().is_err() {
            failed.push(since.elapsed());
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(failed[1] - failed[0] >= Duration::from_secs(3), "{failed:?}");
    let state = session.state().unwrap();
    assert_eq!((state.disturbances, state.half_width_rad, state.released), (0, 0.0, false));
    assert!(!board.truth().lines.iter().any(|line| line == "$SLP"));
    std::fs::remove_dir(&journal).unwrap();
    std::fs::rename(&aside, &journal).unwrap();
}

/// Makes a dose, and leaves the record as a kill late in its motion does. Returns the steps of the dose.
fn killed_late(bench: &Bench, request: DoseRequest) -> i64 {
    let journal = bench.folder().path().join("journal.jsonl");
    let mut session = bench.session().unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(request).unwrap();
    let (mut late, mut is_made) = (Vec::new(), false);
    session
        .run(&prepared, |made| {
            is_made |= made == prepared.plan.steps().unsigned_abs();
            if !is_made {
                late = std::fs::read(&journal).unwrap();
                return ControlFlow::Continue(());
            }
            // Nothing is sucked back.
            ControlFlow::Break(())
        })
        .unwrap();
    std::fs::write(&journal, late).unwrap();
    prepared.plan.steps()
}

/// Disk that takes nothing any more.
#[derive(Debug)]
struct FullDisk;

impl Storage for FullDisk {
    fn sync(&mut self, _file: &File) -> io::Result<()> {
        Err(io::ErrorKind::StorageFull.into())
    }
}

#[test]
fn a_release_that_cannot_be_recorded_leaves_what_is_to_be_sucked_back() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    let steps = killed_late(&bench, DoseRequest::dose(1.0).with_retraction(0.3));
    assert_eq!(board.rest().steps, steps, "nothing was sucked back");
    let mut session = bench.session().unwrap();
    session.connect().unwrap();
    assert!(session.state().unwrap().unfinished.is_none(), "the board has finished the dose");
    session.store_by(Box::new(FullDisk));
    session.release().unwrap_err();
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    assert!(rest.plan.steps() < 0 && rest.request.volume_ml == -0.3, "{:?}", rest.request);
}

#[test]
fn a_stop_while_the_board_is_asked_leaves_the_old_tube() {
    let folder = tempfile::tempdir().unwrap();
    let board = plug(Options::default());
    let bench = bench(folder.path(), &board);
    let request = DoseRequest::new(Purpose::Calibrate, 1.0);
    killed_late(&bench, request);
    let worn_ml = bench.stands().unwrap().wear.volume_ml;
    assert!(worn_ml > 0.0);
    let stopped = bench.clone().stopping_on(StopRequest::new(|| true));
    let error = stopped.session().unwrap().new_tube().unwrap_err();
    assert!(matches!(error, DoseError::Connection(DriveError::Interrupted)), "{error}");
    assert_eq!(bench.stands().unwrap().wear.volume_ml, worn_ml);
    bench.session().unwrap().new_tube().unwrap();
    assert_eq!(bench.stands().unwrap().wear.volume_ml, 0.0);
}

#[test]
fn the_steps_of_a_turn_that_failed_are_none_of_the_dose_on_record() {
    let folder = tempfile::tempdir().unwrap();
    {
        let board = plug_defective(Defects { alarm: Some((700, 1)), ..Defects::default() });
        let bench = bench(folder.path(), &board);
        let mut session = bench.session().unwrap();
        session.set_angle(Some(Phase::known(0.0))).unwrap();
        let prepared = session.prepare(DoseRequest::dose(3.0)).unwrap();
        session.run(&prepared, go).unwrap_err();
    }
    let board = plug_defective(Defects { unplugged: Some(200), ..Defects::default() });
    let bench = bench(folder.path(), &board).homing_unfinished(true);
    let mut session = bench.session().unwrap();
    session.connect().unwrap();
    let before = *session.state().unwrap();
    assert!(before.unfinished.is_some() && before.count.is_some(), "{before:?}");
    session.jog(2_000, 1.0, go).unwrap_err();
    let after = *session.state().unwrap();
    assert!(after.count.is_none(), "the board is out of reach: {after:?}");
    let (before, after) = (before.unfinished.unwrap(), after.unfinished.unwrap());
    assert_eq!((after.made_least, after.made_most), (before.made_least, before.made_most));
}

#[test]
fn a_hold_leaves_a_rest_that_is_resumed_to_the_dose() {
    let folder = tempfile::tempdir().unwrap();
    let defects = Defects { pressed: Some((900, b'!')), ..Defects::default() };
    let board = defective(defects);
    let mut drive = VirtualDrive::new(&board);
    let bench = virtual_bench(built_in("three-roller").unwrap(), folder.path(), &drive);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(3.0)).unwrap();
    let error = session.run(&prepared, go).unwrap_err();
    let DoseError::Drive { least_ml, most_ml, unfinished: true, .. } = error else { panic!("{error}") };
    assert!(least_ml == most_ml && (0.5..2.5).contains(&least_ml), "{error}");
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    session.run(&rest, go).unwrap();
    assert_eq!(board.rest().steps, prepared.plan.steps());
    let state = session.state().unwrap();
    assert!(state.unfinished.is_none() && state.half_width_rad == 0.0, "{state:?}");
}

#[test]
fn a_dose_that_went_too_far_has_no_rest() {
    let folder = tempfile::tempdir().unwrap();
    let board = defective(Defects { foreign: Some((300, 30.0)), ..Defects::default() });
    let mut drive = VirtualDrive::new(&board);
    let bench = virtual_bench(built_in("three-roller").unwrap(), folder.path(), &drive);
    let mut session = Session::with_drive(&bench, Box::new(&mut drive)).unwrap();
    session.set_angle(Some(Phase::known(0.0))).unwrap();
    let prepared = session.prepare(DoseRequest::dose(1.0)).unwrap();
    let error = session.run(&prepared, go).unwrap_err();
    let DoseError::Drive { most_ml, unfinished: true, .. } = error else { panic!("{error}") };
    assert!(board.rest().steps > prepared.plan.steps() && most_ml > 1.0, "{error}");
    let error = session.prepare_rest(DoseRequest::dose(0.0)).unwrap_err();
    assert!(matches!(error, DoseError::NoRest { .. }), "{error}");
    session.discard().unwrap();
}
