//! Racks with Klipper boards, one pump or several at each. They begin together.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use pump_bench::Bench;
use pump_bench::pump_file::{DriverName, PumpFile};

use crate::rig::{Rig, ended};
use crate::simulated_klipper::Character;

/// Rack of two pumps that begin together.
pub(crate) const RACK: &str = "schema = \"rack/1\"\n[pumps]\nred = \"red.toml\"\nblue = \"blue.toml\"\n\
                    [[step]]\nratio = { red = 1, blue = 1 }\nvolume = \"2mL\"\nrate = \"2mL/s\"\n";

/// Runs the rack with a pump at each of these ports, the second at other pins. Returns the exit code and what was said.
fn runs(rig: &Rig, red: &Path, blue: &Path) -> (Option<i32>, String) {
    let folder = rig.folder.path();
    let text = fs::read_to_string(rig.pump()).unwrap();
    let at = |port: &Path| {
        text.replace("driver = \"klipper\"", &format!("driver = \"klipper\"\nport = \"{}\"", port.display()))
    };
    let blue = at(blue).replace("id = \"red\"", "id = \"blue\"").replace("PB13", "PB10");
    fs::write(folder.join("red.toml"), at(red)).unwrap();
    fs::write(folder.join("blue.toml"), blue.replace("PB12", "PB2").replace("PB14", "PB11")).unwrap();
    fs::write(folder.join("rack.toml"), RACK).unwrap();
    runs_rack(rig)
}

/// Runs the rack as its files are. Returns the exit code and what was said.
pub(crate) fn runs_rack(rig: &Rig) -> (Option<i32>, String) {
    ended(command(rig).arg("--confirm-pump").spawn().unwrap())
}

/// Runs a rack of the pumps that are there, as [`runs_rack`] does, with a pump that nobody has confirmed.
fn runs_unconfirmed(rig: &Rig) -> (Option<i32>, String) {
    let folder = rig.folder.path();
    for path in [rig.pump(), folder.join("blue.toml")] {
        let text = fs::read_to_string(&path).unwrap();
        let port = format!("driver = \"klipper\"\nport = \"{}\"", rig.board.path().display());
        fs::write(path, text.replace("driver = \"klipper\"", &port)).unwrap();
    }
    fs::write(folder.join("rack.toml"), RACK).unwrap();
    ended(command(rig).spawn().unwrap())
}

/// Returns the command that runs the rack.
fn command(rig: &Rig) -> Command {
    let folder = rig.folder.path();
    let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
    for name in ["DOSE_PUMP", "DOSE_CONFIG"] {
        command.env_remove(name);
    }
    command.env("XDG_CONFIG_HOME", folder).env("DOSE_STATE_DIR", folder.join("state")).current_dir(folder);
    command.args(["run", "rack.toml"]);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

#[test]
fn two_pumps_at_one_board_begin_at_one_tick_and_find_it_as_they_left_it() {
    let rig = Rig::new(Character { drift_ppm: 60.0, ..Character::default() });
    let (code, said) = runs(&rig, rig.board.path(), rig.board.path());
    assert_eq!(code, Some(0), "{said}");
    assert!(!said.contains("late"), "{said}");
    let truth = rig.board.truth();
    assert!(truth.steps[0] > 500 && truth.steps[1].abs_diff(truth.steps[0]) < 20, "{truth:?}");
    assert_eq!((truth.stray, truth.shutdown), (0, None));
    let first = |socket| rig.steps_of(socket)[0].0;
    // Each is within 2 us of its own plan, and both plans begin at one tick.
    assert!(first("X").abs_diff(first("Y")) <= 4 * 72, "{} {}", first("X"), first("Y"));
    // The board is met again with the counts and the angles of both: nothing was reset.
    let (code, said) = runs_rack(&rig);
    assert_eq!(code, Some(0), "{said}");
    assert!(!said.contains("reset") && !said.contains("angle is known less well"), "{said}");
    for pump in ["red", "blue"] {
        let mut command = crate::rig::command(
            rig.folder.path(),
            &rig.folder.path().join(format!("{pump}.toml")),
            rig.board.path(),
            &["0.5mL"],
        );
        let (code, said) = ended(command.spawn().unwrap());
        assert!(code == Some(0) && !said.contains("reset"), "{said}");
    }
}

#[test]
fn a_dose_of_a_new_pump_that_is_refused_resets_no_neighbour() {
    let rig = Rig::new(Character::default());
    let (code, said) = rig.runs(&["home", "--set", "30deg"]);
    assert_eq!(code, Some(0), "{said}");
    let (code, said) = rig.runs(&["2mL", "--confirm-pump"]);
    assert_eq!(code, Some(0), "{said}");
    let red = fs::read_to_string(rig.pump()).unwrap();
    let blue = red.replace("id = \"red\"", "id = \"blue\"").replace("PB13", "PB10");
    let blue = blue.replace("PB12", "PB2").replace("PB14", "PB11");
    let path = rig.folder.path().join("blue.toml");
    fs::write(&path, blue).unwrap();
    let types = |arguments: &[&str]| {
        let mut command = crate::rig::command(rig.folder.path(), &path, rig.board.path(), arguments);
        ended(command.spawn().unwrap())
    };
    for refused in [["--rate", "900mL/s"], ["--finish", "low-flow"]] {
        let (code, said) = types(&[&["2mL", "--confirm-pump"][..], &refused].concat());
        assert_eq!(code, Some(2), "{said}");
    }
    let (code, said) = runs_unconfirmed(&rig);
    assert!(code == Some(2) && said.contains("nobody has confirmed"), "{code:?}: {said}");
    let (code, said) = rig.runs(&["1mL"]);
    assert!(code == Some(0) && !said.contains("reset"), "{said}");
}

/// Returns the instant of the first step that the board of a rig has made at a socket.
fn first_step(rig: &Rig, socket: &str) -> Instant {
    rig.board.instant_of(rig.steps_of(socket)[0].0).unwrap()
}

/// Runs the rack with boards whose ports have this rate, 0 for USB, and whose clocks drift. Returns the time between
/// the begins.
fn spread(baud: u32) -> Duration {
    let fast = Character { baud, drift_ppm: 100.0, first_tick: 4_000_000_000, ..Character::default() };
    let slow = Character { baud, drift_ppm: -80.0, ..Character::default() };
    let (rig, other) = (Rig::new(fast), Rig::new(slow));
    let (code, said) = runs(&rig, rig.board.path(), other.board.path());
    assert_eq!(code, Some(0), "{said}");
    let (red, blue) = (rig.board.truth().steps, other.board.truth().steps);
    assert!(red[0] > 500 && blue[1].abs_diff(red[0]) < 20, "{red:?} {blue:?}");
    let begins = [first_step(&rig, "X"), first_step(&other, "Y")];
    begins[0].max(begins[1]) - begins[0].min(begins[1])
}

#[test]
fn two_boards_at_usb_ports_begin_within_50_us_and_pour_side_by_side() {
    let spread = spread(0);
    assert!(spread < Duration::from_micros(50), "{spread:?}");
}

#[test]
fn two_boards_at_uarts_begin_within_the_time_that_a_question_takes() {
    let spread = spread(250_000);
    assert!(spread < Duration::from_micros(800), "{spread:?}");
}

#[test]
fn two_pumps_at_one_step_pin_are_refused_with_its_name() {
    let rig = Rig::new(Character::default());
    let other = Rig::new(Character::default());
    let (_, said) = runs(&rig, rig.board.path(), other.board.path());
    assert!(!said.contains("both by"), "{said}");
    let red = fs::read_to_string(rig.folder.path().join("red.toml")).unwrap();
    let steps = rig.board.truth().steps;
    let blue = rig.folder.path().join("blue.toml");
    fs::write(&blue, red.replace("id = \"red\"", "id = \"blue\"")).unwrap();
    let (code, said) = runs_rack(&rig);
    assert!(code != Some(0) && said.contains("and both by the pin PB13;"), "{said}");
    assert!(said.contains("red") && said.contains("blue"), "{said}");
    assert_eq!(rig.board.truth().steps, steps);
}

#[test]
fn a_board_that_is_out_of_reach_stops_the_pumps_at_other_boards_within_seconds() {
    let (rig, far) = (Rig::new(Character::default()), Rig::new(Character::default()));
    let (code, said) = runs(&rig, rig.board.path(), far.board.path());
    assert_eq!(code, Some(0), "{said}");
    let folder = rig.folder.path();
    fs::write(folder.join("rack.toml"), RACK.replace("2mL\"\nrate", "40mL\"\nrate")).unwrap();
    let before = [&rig, &far].map(|rig| rig.board.truth().steps.iter().sum::<i64>());
    let made = || {
        let now = [&rig, &far].map(|rig| rig.board.truth().steps.iter().sum::<i64>());
        [now[0] - before[0], now[1] - before[1]]
    };
    let (code, said) = std::thread::scope(|scope| {
        scope.spawn(|| {
            let until = Instant::now() + Duration::from_secs(20);
            while made()[1] < 300 && Instant::now() < until {
                std::thread::sleep(Duration::from_millis(2));
            }
            far.board.touch("pull").unwrap();
        });
        runs_rack(&rig)
    });
    assert!(code == Some(1) && said.contains("out of reach") || said.contains("confirmed nothing"), "{said}");
    // 20 mL at 1 mL/s each are 12,000 steps in 20 s.
    let made = made();
    assert!(made[0] < 3500, "{made:?}: {said}");
    // The next command asks the board, and the log has its count.
    far.board.touch("plug").unwrap();
    let blue = folder.join("blue.toml");
    let accept = crate::rig::command(folder, &blue, far.board.path(), &["accept"]).spawn().unwrap();
    let (code, said) = ended(accept);
    assert_eq!(code, Some(0), "{said}");
    let file = PumpFile::read(&blue).unwrap();
    let bench = Bench::new(file, Some(DriverName::Klipper), &folder.join("state")).unwrap();
    let last = bench.last_logged().unwrap().unwrap();
    assert_eq!((last.steps, last.delivered_range_ml), (Some(made[1]), None), "{said}");
}
