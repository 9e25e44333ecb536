//! Claims about pumps on one grbl board that a rack moves as one line of constant ratio.

mod pair;
mod speeds;

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use pump_bench::drives::{Disturbance, Drive, Opening};
use pump_bench::pump_file::Axis;
use pump_bench::rack::RackEnd;
use pump_bench::{DoseRequest, built_in};

use self::pair::{NAMES, Pair};
use crate::rig::table;
use crate::simulated::options::{Defects, Options};

/// Twice as much of the one as of the other, together.
const RATIO: &str = "[[step]]\nratio = { acid = 2, base = 1 }\nvolume = \"9mL\"\nrate = \"6mL/s\"\n";

/// The first pump by itself.
const ALONE: &str = "[[step]]\npump = \"acid\"\nvolume = \"1mL\"\n";

/// Two doses of one time that begin together.
const TOGETHER: &str = r#"
[[step]]
at = "0s"
pump = "acid"
volume = "4mL"
rate = "4mL/s"
[[step]]
at = "0s"
pump = "base"
volume = "4mL"
rate = "4mL/s"
reverse = true
"#;

static NEVER: AtomicBool = AtomicBool::new(false);

/// Returns the distance of the second axis from the straight line of the first, in steps, where both end at `ends`.
fn off_line([x, y]: [i64; 2], ends: [i64; 2]) -> f64 {
    (y as f64 - x as f64 * ends[1] as f64 / ends[0] as f64).abs()
}

#[test]
fn pumps_on_one_board_keep_the_ratio_of_their_steps_at_every_moment_and_each_has_its_own_record() {
    let pair = Pair::new(Options::default());
    let places = Mutex::new(Vec::new());
    let report = pair.run(&[RATIO, ALONE].concat(), &NEVER, &|_| places.lock().unwrap().push(pair.places()));
    assert!(report.completed, "{}", report.json());
    let delivered: Vec<f64> = report.pumps.iter().map(|pump| pump.delivered_ml).collect();
    assert!((delivered[0] - 7.0).abs() < 2e-3 && (delivered[1] - 3.0).abs() < 2e-3, "{delivered:?}");
    let states = pair.states();
    assert_eq!([0, 1].map(|pump| states[pump].count.unwrap()), pair.places());
    // Every jog of the first step names both axes, and none of the second does.
    let jogs = pair.jogs();
    let both = jogs.iter().filter(|line| line.contains('X') && line.contains('Y')).count();
    assert!(both > 5 && both < jogs.len() && jogs[..both].iter().all(|line| line.contains('Y')), "{jogs:?}");
    let ends = pair.ends_of_line(&jogs[..both]);
    let places = places.into_inner().unwrap();
    let on_way: Vec<_> = places.iter().filter(|[x, _]| (1..ends[0]).contains(x)).collect();
    assert!(on_way.len() > 10, "{}", on_way.len());
    let off = on_way.iter().map(|place| off_line(**place, ends)).fold(0.0, f64::max);
    assert!(off <= 1.5, "{off} steps off the line");
}

#[test]
fn doses_of_one_time_that_begin_together_are_a_line_even_in_opposite_directions() {
    let pair = Pair::new(Options::default());
    let report = pair.run(TOGETHER, &NEVER, &|_| {});
    assert!(report.completed, "{}", report.json());
    let [acid, base] = pair.places();
    assert!(acid > 1000 && base < -1000, "{acid} and {base}");
    assert!(pair.jogs().iter().all(|line| line.contains('X') && line.contains('Y')));
}

#[test]
fn no_axis_of_a_line_is_faster_than_its_own_settings_allow() {
    // The second axis has a third of the rate of the first.
    let slow = Options { settings: vec![(111, 2000.0)], ..Options::default() };
    let pair = Pair::new(slow);
    let equal = "[[step]]\nratio = { acid = 1, base = 1 }\nvolume = \"4mL\"\nrate = \"2mL/s\"\n";
    let report = pair.run(equal, &NEVER, &|_| {});
    assert!(report.completed, "{}", report.json());
    let most = 2000.0 * 250.0 / 60.0;
    assert!(pair.board.truth().peak_steps_s <= most * 1.001, "{}", pair.board.truth().peak_steps_s);
}

#[test]
fn a_stop_decelerates_both_axes_on_the_line_and_each_record_has_its_share_and_its_rest() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let pair = Pair::new(Options::default());
    let report = pair.run(RATIO, &STOPPED, &|told| {
        if told.made * 3 > told.steps {
            STOPPED.store(true, Ordering::SeqCst);
        }
    });
    assert_eq!(report.end, RackEnd::Stopped, "{}", report.json());
    let places = pair.places();
    let ends = pair.states().map(|state| {
        let unfinished = state.unfinished.unwrap();
        assert_eq!((unfinished.made_least, state.count), (unfinished.made_most, Some(unfinished.made_least)));
        unfinished.intent.steps
    });
    assert_eq!(pair.states().map(|state| state.count.unwrap()), places);
    assert!(off_line(places, ends) <= 1.5 && places[0] < ends[0], "{places:?} of {ends:?}");
    // The rest of each is a dose of its own.
    for pump in [0, 1] {
        pair.with_session(pump, |session| {
            let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
            assert!(rest.plan.steps() > 0);
        });
    }
}

#[test]
fn a_stop_before_the_line_begins_moves_no_axis() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let pair = Pair::new(Options::default());
    let report = pair.run(RATIO, &STOPPED, &|_| STOPPED.store(true, Ordering::SeqCst));
    assert_eq!((report.end, pair.places()), (RackEnd::Stopped, [0, 0]), "{}", report.json());
}

#[test]
fn a_kill_on_the_line_leaves_each_record_to_be_completed_by_the_boards_count() {
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let pair = Pair::new(Options::default());
    let early = Mutex::new(None);
    pair.run(RATIO, &STOPPED, &|told| {
        if told.made * 2 > told.steps && !STOPPED.swap(true, Ordering::SeqCst) {
            // A kill leaves the journals as they are now, and the board at rest within the jogs that it has.
            *early.lock().unwrap() = Some(NAMES.map(|name| fs::read(pair.journal(name)).unwrap()));
        }
    });
    let early = early.into_inner().unwrap().unwrap();
    for (name, journal) in NAMES.iter().zip(early) {
        fs::write(pair.journal(name), journal).unwrap();
    }
    let places = pair.places();
    for pump in [0, 1] {
        let (least, most) = pair.with_session(pump, |session| {
            session.connect().unwrap();
            let dose = session.state().unwrap().unfinished.unwrap();
            (dose.made_least, dose.made_most)
        });
        assert_eq!((least, most), (places[pump], places[pump]), "{}", NAMES[pump]);
    }
}

#[test]
fn a_fault_of_the_board_stops_both_pumps_within_the_bounds_on_record() {
    let defects = |place| {
        [
            Defects { alarm: Some((place, 1)), ..Defects::default() },
            Defects { unplugged: Some(place), ..Defects::default() },
            Defects { silent: Some(place), ..Defects::default() },
            Defects { stalls: Some(place), ..Defects::default() },
            Defects { resets: Some(place), ..Defects::default() },
            Defects { pressed: Some((place, 0x85)), ..Defects::default() },
            Defects { refuses: Some((4, 15)), ..Defects::default() },
            Defects { miscounts: Some((place, 40)), ..Defects::default() },
        ]
    };
    for (number, defects) in defects(3000).into_iter().enumerate() {
        let pair = Pair::new(Options { defects, ..Options::default() });
        let report = pair.run(RATIO, &NEVER, &|_| {});
        assert_eq!(report.end, RackEnd::Fault, "defect {number}: {}", report.json());
        pair.board.rest();
        for (pump, (state, made)) in pair.states().into_iter().zip(pair.places()).enumerate() {
            let dose = state.unfinished.unwrap();
            let (least, most) = (dose.made_least, dose.made_most);
            assert!(
                least <= made && made <= most,
                "defect {number}, pump {pump}: {made} made, {least} to {most} on record: {:?}",
                report.pumps[pump].error
            );
        }
    }
}

#[test]
fn a_counter_of_one_axis_that_jumps_loses_the_angles_of_both_pumps() {
    let pair = Pair::new(Options::default());
    let report = pair.run(RATIO, &NEVER, &|told| {
        if told.made * 2 > told.steps {
            pair.board.meddle(|board| (board.astray_mm, board.astray_axis) = (1.0, 1));
        }
    });
    assert_eq!(report.end, RackEnd::Fault, "{}", report.json());
    let reasons: Vec<&str> = report.pumps.iter().filter_map(|pump| pump.error.as_deref()).collect();
    assert!(
        reasons.len() == 2 && reasons.iter().all(|told| told.contains("angle is unknown")),
        "{reasons:?}"
    );
}

#[test]
fn a_reset_is_heard_once_by_an_axis_that_is_opened_anew_while_another_keeps_the_port() {
    let (pair, folder) = (Pair::new(Options::default()), tempfile::tempdir().unwrap());
    let shared = pair.board.shared();
    let open = |axis, record: &str| {
        let opening = Opening { settings_record: Some(folder.path().join(record)), ..Opening::default() };
        let table = table().with_port(Path::new("/dev/ttyUSB7")).with_axis(axis);
        shared.axis(&table, &built_in("three-roller").unwrap().motor, &opening).unwrap()
    };
    let mut keeps = open(Axis::X, "acid");
    let mut told_before = open(Axis::Y, "base");
    assert_eq!((keeps.disturbed(), told_before.disturbed()), (None, None));
    pair.board.send(&[0x18]);
    pair.board.pass(Duration::from_secs(1));
    assert_eq!(told_before.disturbed(), Some(Disturbance::Reset));
    drop(told_before);
    // The disk was full: a reset that is told and not on record is told again.
    let mut told_before = open(Axis::Y, "base");
    assert_eq!(told_before.disturbed(), Some(Disturbance::Reset), "no record has it");
    told_before.recorded();
    drop(told_before);
    assert_eq!(open(Axis::Y, "base").disturbed(), None, "it was told before");
    assert_eq!(open(Axis::Y, "other").disturbed(), Some(Disturbance::Reset), "a record that was not told");
    assert_eq!(keeps.disturbed(), Some(Disturbance::Reset));
    // A disturbance that nobody asked for stays for the next drive.
    pair.board.send(&[0x18]);
    pair.board.pass(Duration::from_secs(1));
    drop(open(Axis::Y, "base"));
    assert_eq!(open(Axis::Y, "base").disturbed(), Some(Disturbance::Reset));
}

#[test]
fn axes_of_one_board_take_turns_outside_a_line() {
    let pair = Pair::new(Options::default());
    let (mut drives, benches) = pair.drives();
    let mut ends = [0, 0];
    for axis in [1, 0, 1] {
        let drive = Box::new(&mut drives[axis]);
        let mut session = pump_bench::Session::with_drive(&benches[axis], drive).unwrap();
        let prepared = session.prepare(DoseRequest::dose(1.0)).unwrap();
        assert!(session.run(&prepared, |_| ControlFlow::Continue(())).unwrap().completed);
        ends[axis] += prepared.plan.steps();
        assert_eq!(pair.places(), ends);
    }
}
