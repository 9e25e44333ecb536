//! Claims about boards that are told apart, by the names that their ports keep and by the texts that they were given.

use std::fs;
use std::ops::ControlFlow;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

use pump_bench::drives::{Disturbance, Drive, DriveError, Grbl, GrblError, Opening};
use pump_bench::notice::Remedy;
use pump_bench::pump_file::{DriveTable, DriverName};
use pump_bench::report::{Explain, with_sources};
use pump_bench::{Bench, DoseError, DoseRequest, built_in};

use crate::board_words;
use crate::rig::{grbl_error, motor, plug};
use crate::simulated::Simulated;
use crate::simulated::options::Options;

const LEFT: &str = "usb-1a86_USB_Serial_left-if00-port0";
const RIGHT: &str = "usb-1a86_USB_Serial_right-if00-port0";

/// Folders of a computer: its devices, the names that they keep, and the record of a pump.
struct Computer {
    folder: tempfile::TempDir,
}

impl Computer {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("serial/by-id")).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Connects a board: as `device`, and under the name that its port keeps.
    fn plug(&self, board: &Simulated, device: &str, name: &str) {
        for place in [self.path(device), self.path("serial/by-id").join(name)] {
            let _ = fs::remove_file(&place);
            symlink(Path::new(board.path()), place).unwrap();
        }
    }

    fn opening(&self) -> Opening {
        let (settings, names) = (self.path("board-settings.json"), self.path("serial/by-id"));
        Opening { settings_record: Some(settings), port_names: Some(names), ..Opening::default() }
    }

    fn accepting(&self) -> Opening {
        Opening { accept_settings: true, ..self.opening() }
    }

    fn open(&self, device: &str, opening: &Opening) -> Result<Grbl, DriveError> {
        let table = DriveTable::of(DriverName::Grbl).with_port(self.path(device));
        Grbl::open(&table, &motor(), opening)
    }
}

#[test]
fn a_board_is_refused_after_two_ports_have_changed_places() {
    let computer = Computer::new();
    let (left, right) = (plug(Options::default()), plug(Options::default()));
    computer.plug(&left, "ttyUSB0", LEFT);
    computer.plug(&right, "ttyUSB1", RIGHT);
    computer.open("ttyUSB0", &computer.opening()).unwrap();
    computer.open("ttyUSB0", &computer.opening()).unwrap();
    // The computer was started anew.
    computer.plug(&left, "ttyUSB1", LEFT);
    computer.plug(&right, "ttyUSB0", RIGHT);
    let heard = right.truth().lines.len();
    let refused = computer.open("ttyUSB0", &computer.opening()).unwrap_err();
    assert_eq!(refused.remedies(), [Remedy::AcceptBoard]);
    let error = grbl_error(refused);
    let said = error.to_string();
    assert!(
        matches!(error, GrblError::OtherBoard { .. }) && said.contains(LEFT) && said.contains(RIGHT),
        "{said}"
    );
    assert_eq!(right.truth().lines.len(), heard, "nothing is said to the other board");
    // The board is where the message sends the user.
    computer.open("ttyUSB1", &computer.opening()).unwrap();
    computer.open(&format!("serial/by-id/{LEFT}"), &computer.opening()).unwrap();
    assert_eq!((left.truth().steps, right.truth().steps), (0, 0));
}

#[test]
fn another_board_is_accepted_once_and_counts_as_reset() {
    let computer = Computer::new();
    let (left, right) = (plug(Options::default()), plug(Options::default()));
    computer.plug(&left, "ttyUSB0", LEFT);
    computer.open("ttyUSB0", &computer.opening()).unwrap();
    let mut same = computer.open("ttyUSB0", &computer.opening()).unwrap();
    assert_eq!(same.disturbed(), None);
    drop(same);
    computer.plug(&right, "ttyUSB0", RIGHT);
    assert!(computer.open("ttyUSB0", &computer.opening()).is_err());
    let mut accepted = computer.open("ttyUSB0", &computer.accepting()).unwrap();
    assert_eq!(accepted.disturbed(), Some(Disturbance::Reset), "its counter says nothing about the rotor");
    assert!(accepted.notes().iter().any(|note| note.text().contains(LEFT)));
    drop(accepted);
    let mut same = computer.open("ttyUSB0", &computer.opening()).unwrap();
    assert_eq!(same.disturbed(), None);
}

#[test]
fn boards_whose_ports_share_a_name_are_told_apart_by_their_texts() {
    let computer = Computer::new();
    let named = |text| plug(Options { text, ..Options::default() });
    let (left, right) = (named("left pump"), named("right pump"));
    computer.plug(&left, "ttyUSB0", LEFT);
    computer.open("ttyUSB0", &computer.opening()).unwrap();
    computer.plug(&right, "ttyUSB0", LEFT);
    let said = grbl_error(computer.open("ttyUSB0", &computer.opening()).unwrap_err()).to_string();
    assert!(said.contains("\"left pump\"") && said.contains("\"right pump\""), "{said}");
    computer.plug(&left, "ttyUSB0", LEFT);
    computer.open("ttyUSB0", &computer.opening()).unwrap();
}

#[test]
fn an_axis_that_turns_another_pump_by_its_record_is_refused_where_boards_have_marks() {
    let computer = Computer::new();
    let (named, plain) =
        (plug(Options { text: "left pump", ..Options::default() }), plug(Options::default()));
    computer.plug(&named, "ttyUSB0", LEFT);
    let open = |pump: &str, device: &str, accept_settings: bool| {
        let terms = Opening::of_pump(pump, DriverName::Grbl, &computer.path("state"));
        fs::create_dir_all(terms.settings_record.as_ref().unwrap().parent().unwrap()).unwrap();
        let port_names = Some(computer.path("serial/by-id"));
        computer.open(device, &Opening { port_names, accept_settings, ..terms })
    };
    drop(open("acid", "ttyUSB0", false).unwrap());
    let refused = open("base", "ttyUSB0", false).unwrap_err();
    let (remedies, said) = (refused.remedies(), grbl_error(refused).to_string());
    assert!(
        said.contains("belongs to pump `acid` by the record; name another one in the file of pump `base`"),
        "{said}"
    );
    assert_eq!(remedies, [Remedy::TakePlace]);
    drop(open("base", "ttyUSB0", true).unwrap());
    assert!(open("acid", "ttyUSB0", false).is_err());
    // Boards without a mark cannot be told apart, and none is refused.
    symlink(Path::new(plain.path()), computer.path("ttyUSB1")).unwrap();
    drop(open("one", "ttyUSB1", false).unwrap());
    drop(open("other", "ttyUSB1", false).unwrap());
}

#[test]
fn the_text_that_a_word_gives_the_simulated_board_is_told_by_the_command_that_refuses_another() {
    let computer = Computer::new();
    let named = |text: &str| {
        let mut options = Options::default();
        assert!(board_words::set(&mut options, "--info", &mut || Ok(text.to_owned())).unwrap());
        plug(options)
    };
    let (left, right) = (named("left pump"), named("right pump"));
    let dose = |board: &Simulated| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
        command.args(["0.2mL", "--confirm-pump", "--driver", "grbl", "--port"]).arg(board.path());
        command
            .env_remove("DOSE_PUMP")
            .env_remove("DOSE_CONFIG")
            .env("XDG_CONFIG_HOME", computer.path("config"));
        let ended = command.env("DOSE_STATE_DIR", computer.path("state")).output().unwrap();
        (ended.status.code(), String::from_utf8(ended.stderr).unwrap())
    };
    assert_eq!(dose(&left).0, Some(0));
    let (code, said) = dose(&right);
    assert_eq!(code, Some(2), "{said}");
    for text in ["calls itself \"left pump\"", "calls itself \"right pump\""] {
        assert!(said.contains(text), "{said}");
    }
    assert_eq!(right.rest().steps, 0);
}

#[test]
fn a_port_that_has_lost_its_name_is_another_port() {
    let computer = Computer::new();
    let board = plug(Options::default());
    computer.plug(&board, "ttyUSB0", LEFT);
    computer.open("ttyUSB0", &computer.opening()).unwrap();
    fs::remove_dir_all(computer.path("serial")).unwrap();
    let error = grbl_error(computer.open("ttyUSB0", &computer.opening()).unwrap_err());
    assert!(matches!(error, GrblError::OtherBoard { .. }), "{error}");
    // Who tells no ports apart has no such check.
    let opening = Opening { port_names: None, settings_record: None, ..computer.opening() };
    computer.open("ttyUSB0", &opening).unwrap();
}

#[test]
fn a_damaged_record_of_the_board_is_refused_and_written_anew_on_request() {
    let computer = Computer::new();
    let board = plug(Options::default());
    computer.plug(&board, "ttyUSB0", LEFT);
    computer.open("ttyUSB0", &computer.opening()).unwrap();
    for text in ["{", r#"{"schema":"pump-board/9","number":null,"port_name":null,"text":null}"#] {
        fs::write(computer.path("board.json"), text).unwrap();
        let refused = computer.open("ttyUSB0", &computer.opening()).unwrap_err();
        assert_eq!(refused.remedies(), [Remedy::WriteSettingsAnew]);
        assert!(matches!(grbl_error(refused), GrblError::BoardRecord { action: "read", .. }));
        computer.open("ttyUSB0", &computer.accepting()).unwrap();
        computer.open("ttyUSB0", &computer.opening()).unwrap();
    }
}

#[test]
fn a_dose_of_a_bench_is_refused_before_motion_after_a_reboot() {
    let computer = Computer::new();
    let boards = [(); 2].map(|()| plug(Options::default()));
    let dose = || {
        let table = DriveTable::of(DriverName::Grbl).with_port(computer.path("ttyUSB0"));
        let mut file = built_in("three-roller").unwrap();
        (file.drive, file.motor.confirmed) = (Some(table), None);
        let bench = Bench::new(file, None, computer.folder.path()).unwrap();
        let bench = bench.naming_ports_in(computer.path("serial/by-id"));
        let mut session = bench.session()?;
        let prepared = session.prepare(DoseRequest::dose(0.2))?;
        session.run(&prepared, |_| ControlFlow::Continue(()))
    };
    computer.plug(&boards[0], "ttyUSB0", LEFT);
    assert!(dose().unwrap().completed);
    let made = boards[0].rest().steps;
    computer.plug(&boards[1], "ttyUSB0", RIGHT);
    let refused = dose().unwrap_err();
    assert!(matches!(refused, DoseError::Connection(_)), "{refused}");
    let said = with_sources(&refused);
    assert!(said.contains(LEFT) && said.contains(RIGHT), "{said}");
    assert!(made != 0 && boards[0].rest().steps == made && boards[1].rest().steps == 0);
}

#[test]
fn what_is_known_of_a_board_is_never_read_or_written_through_a_link() {
    for name in ["board.json", "board-settings.json"] {
        let computer = Computer::new();
        let board = plug(Options { text: "left pump", ..Options::default() });
        computer.plug(&board, "ttyUSB0", LEFT);
        computer.open("ttyUSB0", &computer.opening()).unwrap();
        let (record, other) = (computer.path(name), computer.path("other"));
        fs::rename(&record, &other).unwrap();
        symlink(&other, &record).unwrap();
        let before = fs::read(&other).unwrap();
        let said = with_sources(&grbl_error(computer.open("ttyUSB0", &computer.opening()).unwrap_err()));
        assert!(said.contains(name) && said.contains("it is a link"), "{said}");
        // A record that is not there yet.
        fs::remove_file(&other).unwrap();
        assert!(computer.open("ttyUSB0", &computer.opening()).is_err());
        assert!(!other.exists() && !before.is_empty());
        assert_eq!(board.truth().steps, 0);
    }
}
