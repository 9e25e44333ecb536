//! The course on a node: from nothing to a dose that is calibrated, in real time.

use std::process::Stdio;
use std::time::Duration;

use crate::course::{doses_within_its_interval, sees};
use crate::person::Desk;
use crate::simulated::Simulated;
use crate::simulated::options::Options;
use crate::simulated_node::{Character, SimulatedNode};
use crate::truth::TruePump;

/// Options that set a pump up without a question or a motion.
pub(crate) const OPTIONS: [&str; 16] = [
    "--ml-per-rev",
    "0.5mL",
    "--rollers",
    "4",
    "--microsteps",
    "16",
    "--altitude",
    "500m",
    "--driver",
    "node",
    "--rate",
    "0.6mL/s",
    "--direction",
    "forward",
    "--no-motion",
    "--yes",
];

#[test]
fn two_commands_that_use_one_board_get_one_clear_message() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let port = board.path().display().to_string();
    for (name, axis) in [("acid", "X"), ("base", "Y")] {
        let words = ["setup", name, "--port", &port, "--axis", axis];
        let ended = desk.types(&[&words[..], &OPTIONS].concat());
        assert_eq!(ended.code, 0, "{}", ended.err);
    }
    let mut long = desk.command(&["3mL", "--pump", "acid"]);
    let mut long = long.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while !board.truth().moving {
        assert!(long.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(10));
    }
    let refused = desk.types(&["0.2mL", "--pump", "base"]);
    assert_eq!(refused.code, 3, "{}", refused.err);
    let holder = format!("is in use by process {}", long.id());
    assert!(refused.err.contains(&holder) && refused.err.matches("error:").count() == 1, "{}", refused.err);
    assert!(long.wait().unwrap().success());
    let steps = board.truth().steps;
    assert!(steps[0] > 0 && steps[1] == 0, "{steps:?}");
    // One after the other they keep their places.
    let based = desk.json(&["0.2mL", "--pump", "base"]);
    let again = desk.json(&["0.2mL", "--pump", "acid"]);
    assert!(based["completed"] == true && again["completed"] == true);
    assert!(!again.to_string().contains("was reset") && !again.to_string().contains("moved it"), "{again}");
    assert_eq!(board.truth().steps[0], steps[0] + again["steps"].as_i64().unwrap());
}

#[test]
fn the_board_that_setup_saw_and_its_axis_are_on_record_before_anything_moves() {
    let desk = Desk::new();
    let (board, other) = (SimulatedNode::start(7).unwrap(), SimulatedNode::start(8).unwrap());
    let [port, other_port] = [&board, &other].map(|board| board.path().display().to_string());
    let set_up = |name: &str| {
        let ended = desk.types(&[&["setup", name, "--port", &port][..], &OPTIONS].concat());
        assert_eq!(ended.code, 0, "{}", ended.err);
        ended
    };
    let acid = set_up("acid");
    assert!(acid.err.contains("axis X, board 0000000000000007"), "{}", acid.err);
    let refused = desk.types(&["0.2mL", "--pump", "acid", "--port", &other_port]);
    assert_eq!(refused.code, 2, "{}", refused.err);
    let numbers = ["is number 0000000000000008", "is of number 0000000000000007"];
    assert!(numbers.iter().all(|number| refused.err.contains(number)), "{}", refused.err);
    // A pump whose file is no more has its record, and the next one is offered another axis.
    assert_eq!(desk.types(&["pumps", "remove", "acid", "--anyway"]).code, 0);
    let base = set_up("base");
    assert!(base.err.contains("acid has the axis X of this board by its record"), "{}", base.err);
    assert!(base.err.contains("axis Y, board"), "{}", base.err);
    // Whoever names the axis has the pump in its place.
    let ended = desk.types(&[&["setup", "new", "--port", &port, "--axis", "X"][..], &OPTIONS].concat());
    assert!(
        ended.err.contains("turned the pump `acid` by the record: `new` takes its place"),
        "{}",
        ended.err
    );
    assert_eq!((ended.code, board.truth().steps, other.truth().steps), (0, [0; 4], [0; 4]));
}

#[test]
fn an_emergency_stop_in_motion_and_a_fault_of_the_stepper_driver_end_a_dose_until_they_are_over() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let port = board.path().display().to_string();
    let set_up = desk.types(&[&["setup", "acid", "--port", &port][..], &OPTIONS].concat());
    assert_eq!(set_up.code, 0, "{}", set_up.err);
    let with_fault = desk.configured("pumps/acid.toml").unwrap() + "\n[drive.pins]\ndriver_fault = true\n";
    std::fs::write(desk.path("acid.toml"), with_fault).unwrap();
    let dose = |words: &[&str]| desk.types(&[words, &["--pump", "acid.toml"]].concat());
    for (hand, other, said) in [
        ("estop", "release", "the emergency stop is pressed"),
        ("fault X", "mend X", "the stepper driver reported a fault"),
    ] {
        let mut running = desk.command(&["3mL", "--pump", "acid.toml"]);
        let running = running.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        while !board.truth().moving {
            std::thread::sleep(Duration::from_millis(10));
        }
        board.touch(hand).unwrap();
        let ended = running.wait_with_output().unwrap();
        let err = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{err}");
        assert!(err.contains(said) && err.contains("`dose status"), "{err}");
        let refused = dose(&["resume"]);
        assert_eq!(refused.code, 2, "{hand}: {}", refused.err);
        board.touch(other).unwrap();
        assert_eq!(dose(&["accept"]).code, 0);
    }
    assert!(!board.truth().moving && board.truth().stray == 0);
    assert!(board.touch("fault Q").is_err());
}

#[test]
fn the_bounds_of_a_killed_dose_are_those_of_the_angle_once_the_board_has_told_its_count() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let on = ["--confirm-pump", "--driver", "node", "--port", board.path().to_str().unwrap()];
    let mut killed = desk.command(&[&["3mL"], &on[..]].concat());
    let mut killed = killed.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while board.truth().steps[0] < 500 {
        assert!(killed.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(10));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    while board.truth().moving {
        std::thread::sleep(Duration::from_millis(10));
    }
    let status = ["status", "--driver", "node"];
    let exact = "(the steps are exact: the bounds are those of the rollers' angle)";
    let before = desk.types(&status).out;
    assert!(before.contains("were delivered") && !before.contains(exact), "{before}");
    assert!(before.contains("a board that was not reset since knows the exact steps"), "{before}");
    let refused = desk.types(&[&["0.2mL"], &on[..]].concat());
    assert_ne!(refused.code, 0, "{}", refused.out);
    let after = desk.types(&status).out;
    assert!(after.contains("of which between ") && after.contains(exact), "{after}");
    let unfinished = desk.json(&status)["unfinished"].clone();
    for count in ["steps_made_least", "steps_made_most"] {
        assert_eq!(unfinished[count], board.truth().steps[0], "{unfinished}");
    }
}

#[test]
fn a_pump_at_a_node_gets_from_nothing_to_a_calibrated_dose() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let mut pump = TruePump::behind(board, 0.55, 3200.0, (0.3, 60.0), 0.4);
    let ended = desk.answers(&["setup", "acid"], &mut |question| {
        Some(match question {
            q if q.starts_with("Driver") => "node".to_owned(),
            q if q.starts_with("Volume that fills") => "0.2mL".to_owned(),
            // The board is asked in its own time.
            q if q.starts_with("Rate") => "0.6mL/s".to_owned(),
            q => sees(&mut pump, q, "16"),
        })
    });
    assert_eq!(ended.code, 0, "{}{}", ended.out, ended.err);
    assert!(ended.out.contains("a dose of 5 mL lies between"), "{}", ended.out);
    assert!(ended.err.contains("the board answers, and makes what the pump needs"), "{}", ended.err);
    let file = desk.configured("pumps/acid.toml").unwrap();
    for line in ["driver = \"node\"", "axis = \"X\"", "confirmed = true"] {
        assert!(file.contains(line), "{line}: {file}");
    }
    doses_within_its_interval(&desk, &mut pump);
    let truth = pump.board.truth();
    assert_eq!((truth.stray, truth.steps[1]), (0, 0));
    // A second pump takes the next axis, and leaves the first its place.
    let before = pump.board.truth().steps[0];
    let port = pump.port();
    let words = ["--axis", "Y", "--turned", "1", "--direction", "forward", "--no-motion"];
    let base = desk.types(&[&["setup", "base", "--like", "acid", "--yes"][..], &words].concat());
    assert_eq!(base.code, 0, "{}", base.err);
    let dosed = desk.json(&["0.2mL", "--pump", "base", "--rate", "0.6mL/s"]);
    assert_eq!(dosed["completed"], true, "{dosed}");
    let truth = pump.board.truth();
    assert!(truth.steps[1] > 0 && truth.steps[0] == before, "{truth:?} at {port}");
    let homed = desk.types(&["home", "--set", "30deg+-1deg", "--pump", "acid"]);
    assert_eq!(homed.code, 0, "{}", homed.err);
    let state = desk.json(&["0.2mL", "--pump", "acid", "--smooth", "--rate", "0.6mL/s"]);
    assert!(!state.to_string().contains("was reset"), "{state}");
    let lime = desk.types(&["setup", "lime", "--like", "acid", "--axis", "Z", "--no-motion", "--yes"]);
    assert_eq!(lime.code, 0, "{}", lime.err);
    let unseen = desk.types(&["0.2mL", "--pump", "lime"]);
    assert!(unseen.code == 2 && unseen.err.contains("forward as axis Z counts up"), "{}", unseen.err);
    // Step 4 of the first steps on docs/node.md: no dose before setup has seen the direction.
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/node.md")).unwrap();
    assert!(page.contains("Do not dose before: nobody has seen yet which way the pump"));
    let dosed = desk.json(&["0.2mL", "--pump", "lime", "--confirm-pump", "--rate", "0.6mL/s"]);
    assert_eq!(dosed["completed"], true, "{dosed}");
    assert_eq!(desk.types(&["home", "--unknown", "--pump", "lime"]).code, 0);
    let configured = desk.types(&["0.2mL", "--pump", "lime", "--configure"]);
    assert!(
        configured.code == 2 && configured.err.contains("--configure writes the settings of a grbl board")
    );
}

#[test]
fn a_script_that_writes_the_file_alone_asks_the_board_too() {
    let desk = Desk::new();
    let (node, grbl) = (SimulatedNode::start(7).unwrap(), Simulated::start(Options::default()).unwrap());
    let ends = |port: &str, axis, driver| {
        let options = OPTIONS.map(|word| if word == "node" { driver } else { word });
        desk.types(&[&["setup", "acid", "--port", port, "--axis", axis][..], &options].concat())
    };
    let (node_port, grbl_port) = (node.path().display().to_string(), grbl.path().display().to_string());
    let missing = desk.path("no-such-port").display().to_string();
    for (port, axis, driver, told) in [
        (&node_port, "B", "node", "axis is B; allowed: X, Y, Z or A beside driver"),
        (&missing, "B", "node", "axis is B; allowed: X, Y, Z or A beside driver"),
        (&node_port, "X", "grbl", "and --driver is grbl; say --driver node"),
        (&grbl_port, "X", "node", "and --driver is node; say --driver grbl"),
    ] {
        let refused = ends(port, axis, driver);
        assert!(refused.code == 2 && refused.err.contains(told), "{port} {axis} {driver}: {}", refused.err);
        assert_eq!(desk.configured("pumps/acid.toml"), None);
    }
    let unplugged = ends(&missing, "X", "node");
    assert_eq!(unplugged.code, 0, "{}", unplugged.err);
    assert!(
        unplugged.err.contains(&format!("warning: no board answers at {missing}: ")),
        "{}",
        unplugged.err
    );
}

#[test]
fn an_axis_that_no_node_has_is_refused_where_it_is_asked() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let mut pump = TruePump::behind(board, 0.55, 3200.0, (0.3, 60.0), 0.4);
    let mut is_first = true;
    let ended = desk.answers(&["setup", "acid", "--no-motion"], &mut |question| {
        Some(match question {
            q if q.starts_with("Driver") => "node".to_owned(),
            q if q.starts_with("Axis") && std::mem::take(&mut is_first) => "B".to_owned(),
            q => sees(&mut pump, q, "16"),
        })
    });
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("a node has the axes X, Y, Z and A, and not B"), "{}", ended.err);
    assert_eq!(pump.board.truth().steps, [0; 4]);
}

#[test]
fn a_script_that_names_the_driver_of_another_board_is_refused_and_writes_no_file() {
    let desk = Desk::new();
    let (node, grbl) = (SimulatedNode::start(7).unwrap(), Simulated::start(Options::default()).unwrap());
    for (port, named, driver) in [(node.path(), "grbl", "node"), (grbl.path(), "node", "grbl")] {
        let port = port.display().to_string();
        let words = ["setup", "acid", "--port", &port, "--axis", "X", "--turned", "1", "--yes"];
        let options = OPTIONS.iter().filter(|word| !["--no-motion", "--yes"].contains(*word));
        let options: Vec<&str> = options.map(|word| if *word == "node" { named } else { *word }).collect();
        let refused = desk.types(&[&words[..], &options].concat());
        let told = format!("is at {port}, and --driver is {named}; say --driver {driver}");
        assert!(refused.code == 2 && refused.err.contains(&told), "{}", refused.err);
        assert_eq!(desk.configured("pumps/acid.toml"), None);
    }
    assert_eq!((node.truth().steps, grbl.rest().steps), ([0; 4], 0));
}

#[test]
fn a_dose_by_the_driver_of_another_board_is_told_which_board_is_there() {
    let desk = Desk::new();
    let (node, grbl) = (SimulatedNode::start(7).unwrap(), Simulated::start(Options::default()).unwrap());
    for (port, named, found, driver) in [
        (node.path(), "grbl", "a node 0000000000000007, firmware ", "node"),
        (grbl.path(), "node", "a grbl board, Idle", "grbl"),
    ] {
        let port = port.display().to_string();
        let words = ["1mL", "--pump", "three-roller", "--confirm-pump", "--driver", named, "--port", &port];
        let refused = desk.types(&words);
        let (found, instead) = (
            format!("the board at {port} is {found}"),
            format!("; name the driver `{driver}` for it, and not `{named}`"),
        );
        let is_told = refused.err.contains(&found) && refused.err.contains(&instead);
        assert!(refused.code == 2 && is_told, "{}", refused.err);
    }
    assert_eq!((node.truth().steps, grbl.rest().steps), ([0; 4], 0));
}

#[test]
fn an_axis_that_there_is_nowhere_is_refused_with_those_of_a_node_too() {
    let desk = Desk::new();
    let refused = desk.types(&["setup", "acid", "--driver", "node", "--axis", "Q"]);
    assert!(refused.code == 2 && refused.err.contains("a node has X, Y, Z and A alone"), "{}", refused.err);
}

#[test]
fn a_pressed_stop_is_waited_for_at_the_port_that_was_said() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let port = board.path().display().to_string();
    board.touch("estop").unwrap();
    let words = ["setup", "acid", "--port", &port, "--axis", "X"];
    // The last two options move nothing and ask nothing.
    let ended = desk.answers(&[&words[..], &OPTIONS[..OPTIONS.len() - 2]].concat(), &mut |question| {
        Some(match question {
            q if q.starts_with("Is the cause removed") => {
                board.touch("release").unwrap();
                "yes".to_owned()
            }
            q if q.starts_with("May the motor move") => "quit".to_owned(),
            _ => String::new(),
        })
    });
    let asked = |start: &str| ended.asked.iter().filter(|question| question.starts_with(start)).count();
    assert_eq!((asked("Is the cause removed"), asked("May the motor move")), (1, 1), "{}", ended.err);
    assert_eq!(asked("Port"), 0, "{}", ended.err);
    assert!(ended.err.contains("the emergency stop is pressed"), "{}", ended.err);
    assert_eq!(board.truth().steps, [0; 4]);
}

#[test]
fn pins_that_a_pump_like_another_does_not_take_are_said() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let port = board.path().display().to_string();
    let set_up = desk.types(&[&["setup", "acid", "--port", &port, "--axis", "X"][..], &OPTIONS].concat());
    assert_eq!(set_up.code, 0, "{}", set_up.err);
    let words = ["--like", "acid", "--direction", "forward", "--no-motion", "--yes"];
    let silent = desk.types(&[&["setup", "base", "--axis", "Y"][..], &words].concat());
    assert!(silent.code == 0 && !silent.err.contains("[drive.pins]"), "{}", silent.err);
    let path = desk.path("config/pump-dose/pumps/acid.toml");
    let text = std::fs::read_to_string(&path).unwrap() + "\n[drive.pins]\nenable_active_low = false\n";
    std::fs::write(path, text).unwrap();
    let told = desk.types(&[&["setup", "lime", "--axis", "Z"][..], &words].concat());
    assert!(told.code == 0 && told.err.contains("has [drive.pins], which are not"), "{}", told.err);
}

#[test]
fn a_board_of_an_older_version_answers() {
    let desk = Desk::new();
    let board = SimulatedNode::start_as(Character { protocol: Some(1), ..Character::default() }).unwrap();
    let port = board.path().display().to_string();
    // The answers end once the port is asked for again.
    let mut ports = std::iter::once(port);
    let ended = desk.answers(&["setup", "acid", "--no-motion"], &mut |question| match question {
        q if q.starts_with("Port") => ports.next(),
        q if q.starts_with("Driver") => Some("node".to_owned()),
        q if q.starts_with("Head:") => Some("0.5mL".to_owned()),
        q if q.starts_with("Rollers") => Some("4".to_owned()),
        q if q.starts_with("Microsteps") => Some("16".to_owned()),
        _ => Some(String::new()),
    });
    let remedy = "the firmware is the older; build the firmware of this version (make firmware), hold the board's \
                  button BOOTSEL";
    assert!(ended.err.contains("speaks version 1") && ended.err.contains(remedy), "{}", ended.err);
    assert!(!ended.err.contains("no board answers"), "{}", ended.err);
    // The file alone is written, and the warning has the remedy too.
    let port = board.path().display().to_string();
    let file =
        desk.types(&[&["setup", "acid", "--anew", "--port", &port, "--axis", "X"][..], &OPTIONS].concat());
    assert!(file.code == 0 && file.err.contains("warning: ") && file.err.contains(remedy), "{}", file.err);
}

#[test]
fn a_pulled_cable_ends_a_dose_and_the_board_that_ran_on_knows_its_steps() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let port = board.path().display().to_string();
    let set_up = desk.types(&[&["setup", "acid", "--port", &port, "--axis", "X"][..], &OPTIONS].concat());
    assert_eq!(set_up.code, 0, "{}", set_up.err);
    let mut running = desk.command(&["3mL", "--pump", "acid"]);
    let running = running.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !board.truth().moving {
        std::thread::sleep(Duration::from_millis(10));
    }
    board.touch("pull").unwrap();
    let ended = running.wait_with_output().unwrap();
    let err = String::from_utf8(ended.stderr).unwrap();
    assert!(ended.status.code() == Some(1) && err.contains("has not answered for"), "{err}");
    assert!(!board.truth().moving, "the dead-man time has stopped it");
    let steps = board.truth().steps[0];
    let refused = desk.types(&["resume", "--pump", "acid"]);
    assert!(refused.code == 2 && refused.err.contains("no board answers at"), "{}", refused.err);
    // A refused rest tells nothing of its plan.
    assert!(!refused.err.contains("warning:"), "{}", refused.err);
    board.touch("plug").unwrap();
    let rest = desk.json(&["resume", "--pump", "acid"]);
    assert!(rest["completed"] == true && !rest.to_string().contains("was reset"), "{rest}");
    assert_eq!(board.truth().steps[0], steps + rest["steps"].as_i64().unwrap());
}

#[test]
fn a_smooth_flow_that_is_expected_to_be_rougher_is_warned_of_on_a_real_motor() {
    let desk = Desk::new();
    let board = SimulatedNode::start(7).unwrap();
    let port = board.path().display().to_string();
    let set_up = desk.types(&[&["setup", "acid", "--port", &port, "--axis", "X"][..], &OPTIONS].concat());
    assert_eq!(set_up.code, 0, "{}", set_up.err);
    assert_eq!(desk.types(&["home", "--set", "30deg+-1deg", "--pump", "acid"]).code, 0);
    let warned = "is not known well enough for a smooth flow: the ripple";
    for (words, times) in [(&["--smooth"][..], 1), (&[], 0)] {
        let dose = ["0.2mL", "--rate", "0.4mL/s", "--pump", "acid", "--confirm-pump"];
        let ended = desk.types(&[&dose[..], words].concat());
        assert_eq!((ended.code, ended.err.matches(warned).count()), (0, times), "{}", ended.err);
        assert!(!ended.out.contains(warned), "{}", ended.out);
    }
}
