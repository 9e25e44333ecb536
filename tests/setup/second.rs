//! A second pump on the same board: what is known of the first is suggested.

use std::fs;

use crate::course::sees;
use crate::person::Desk;
use crate::simulated::Simulated;
use crate::simulated::options::Options;
use crate::truth::TruePump;

#[test]
fn a_second_pump_takes_what_is_known_of_the_first() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let port = pump.port();
    let first = [
        "setup",
        "acid",
        "--ml-per-rev",
        "0.5mL",
        "--rollers",
        "4",
        "--microsteps",
        "16",
        "--gear",
        "3",
        "--driver",
        "grbl",
        "--port",
        &port,
        "--axis",
        "X",
        "--altitude",
        "1200m",
        "--suction-lift",
        "0.2m",
        "--rate",
        "0.3mL/s",
        "--yes",
        "--no-motion",
    ];
    assert_eq!(desk.types(&first).code, 0);
    // Everything is as suggested, until the motor is asked for.
    let ended = desk.answers(&["setup", "base", "--no-motion"], &mut |_| Some(String::new()));
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("Suggested answers are those of `acid`"), "{}", ended.err);
    for said in
        ["Rollers, counted [4, as of acid]", "acid has the axis X of this board", "turns this pump [Y]"]
    {
        assert!(ended.err.contains(said), "{said}: {}", ended.err);
    }
    let [acid, base] = ["acid", "base"].map(|name| desk.configured(&format!("pumps/{name}.toml")).unwrap());
    assert_eq!(acid.replace("\"acid\"", "\"base\"").replace("axis = \"X\"", "axis = \"Y\""), base);
    let config = desk.configured("config.toml").unwrap();
    assert!(
        config.contains("default_pump = \"acid\"") && config.contains("base = \"pumps/base.toml\""),
        "{config}"
    );
    assert!(ended.asked.len() <= 16, "{:?}", ended.asked);
    // An axis that the first pump has is not taken. The board has another free one.
    let mut is_first = true;
    let taken = desk.answers(&["setup", "salt", "--no-motion"], &mut |question| match question {
        q if q.starts_with("Axis") => std::mem::take(&mut is_first).then(|| "X".to_owned()),
        _ => Some(String::new()),
    });
    assert!(taken.err.contains("X is that of acid; choose another axis"), "{}", taken.err);
    // A pump that differs in its axis alone is said to be like the first.
    let like = desk.types(&["setup", "lime", "--like", "acid", "--axis", "Z", "--no-motion", "--yes"]);
    assert_eq!(like.code, 0, "{}", like.err);
    let lime = desk.configured("pumps/lime.toml").unwrap();
    assert_eq!(acid.replace("\"acid\"", "\"lime\"").replace("axis = \"X\"", "axis = \"Z\""), lime);
    let none = desk.types(&["setup", "plum", "--like", "nobody", "--yes"]);
    assert!(none.code == 2 && none.err.contains("no pump `nobody` was set up"), "{}", none.err);
}

/// Answers of a pump that is set up with its file alone.
fn file_alone(desk: &Desk, name: &str, more: &[&str]) {
    let words =
        ["setup", name, "--ml-per-rev", "0.5mL", "--rollers", "4", "--microsteps", "16", "--driver", "sim"];
    let ended = desk.types(&[&words[..], more, &["--yes", "--no-motion"]].concat());
    assert_eq!(ended.code, 0, "{}", ended.err);
}

#[test]
fn only_a_run_that_came_to_its_end_suggests_and_what_yes_takes_is_listed() {
    let desk = Desk::new();
    file_alone(&desk, "acid", &["--altitude", "1200m", "--suction-lift", "0.2m", "--gear", "3"]);
    // Somebody leaves at the first question, with a height that was said.
    let left = desk.types(&["setup", "left", "--suction-lift", "-1m"]);
    assert!(left.code == 2 && desk.configured("setup/left.toml").is_some(), "{}", left.err);
    let base = ["setup", "base", "--ml-per-rev", "0.5mL", "--rollers", "4", "--driver", "sim", "--no-motion"];
    let taken = desk.types(&[&base[..], &["--yes"]].concat());
    assert_eq!(taken.code, 0, "{}", taken.err);
    for said in [
        "Microsteps per full step: 16 as of acid, taken by --yes",
        "Gear: revolutions of the motor per revolution of the head: 3 as of acid, taken by --yes",
        "Altitude of the place, as 500m, or the air's pressure, as 98.2kPaa: 1200m as of acid, taken by --yes",
        "Height of the pump above the supply's surface, as 0.3m: 0.2m as of acid, taken by --yes",
        "Inner diameter of the outlet's end, or `unknown`: unknown, taken by --yes",
    ] {
        assert!(taken.err.contains(said), "{said}: {}", taken.err);
    }
    assert!(desk.configured("pumps/base.toml").unwrap().contains("lift_mm = 200.0"));
}

#[test]
fn the_pump_that_is_named_is_the_one_whose_answers_are_taken() {
    let desk = Desk::new();
    file_alone(&desk, "acid", &["--altitude", "1200m"]);
    file_alone(&desk, "buffer", &["--altitude", "0m"]);
    let like = desk.types(&["setup", "lime", "--like", "acid", "--no-motion", "--yes"]);
    assert_eq!(like.code, 0, "{}", like.err);
    assert!(like.err.contains("`lime` takes the answers of `acid`, all but its axis"), "{}", like.err);
    assert!(!like.err.contains("buffer"), "{}", like.err);
    assert!(desk.configured("pumps/lime.toml").unwrap().contains("altitude_m = 1200.0"));
}

#[test]
fn answers_that_were_changed_in_the_pump_file_are_suggested_no_more() {
    let desk = Desk::new();
    file_alone(&desk, "acid", &["--altitude", "1200m"]);
    let path = desk.path("config/pump-dose/pumps/acid.toml");
    let text = fs::read_to_string(&path).unwrap();
    // Values that no question asks for may differ.
    fs::write(&path, format!("{text}\n[safety]\nmax_ml_per_day = 50.0\n")).unwrap();
    let base = ["setup", "base", "--no-motion", "--yes"];
    let suggested = desk.types(&[&base[..], &["--driver", "sim"]].concat());
    assert!(suggested.err.contains("1200m as of acid, taken by --yes"), "{}", suggested.err);
    fs::write(&path, text.replace("altitude_m = 1200.0", "altitude_m = 300.0")).unwrap();
    let lime = ["setup", "lime", "--no-motion", "--yes", "--like"];
    let like = desk.types(&[&lime[..], &["acid"]].concat());
    assert!(like.err.contains("Its pump file says something else by now"), "{}", like.err);
    let left = desk.answers(&["setup", "salt", "--no-motion"], &mut |_| Some("quit".to_owned()));
    assert!(!left.err.contains("of `acid`, the pump that was set up last"), "{}", left.err);
}

#[test]
fn an_axis_that_turns_another_pump_is_refused_by_options_too() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let port = pump.port();
    let board = ["--driver", "grbl", "--port", &port, "--altitude", "0m"];
    let words =
        ["setup", "buffer", "--ml-per-rev", "0.5mL", "--rollers", "4", "--microsteps", "16", "--axis", "X"];
    let first = desk.types(&[&words[..], &board, &["--yes", "--no-motion"]].concat());
    assert_eq!(first.code, 0, "{}", first.err);
    let like = ["setup", "acid", "--like", "buffer", "--no-motion", "--yes"];
    let refused = desk.types(&[&like[..], &["--axis", "X"]].concat());
    assert_eq!(refused.code, 2, "{}", refused.err);
    let said = format!("the axis X of {port} turns the pump `buffer` already; choose another axis");
    assert!(refused.err.contains(&said) && refused.err.matches("error:").count() == 1, "{}", refused.err);
    assert_eq!((desk.configured("pumps/acid.toml"), desk.configured("setup/acid.toml")), (None, None));
    // Another name of the device is the same board.
    std::os::unix::fs::symlink(&port, desk.path("board")).unwrap();
    let other = desk.path("board");
    let refused = desk.types(&[&like[..], &["--axis", "X", "--port", other.to_str().unwrap()]].concat());
    assert!(refused.code == 2 && refused.err.contains("turns the pump `buffer` already"), "{}", refused.err);
    // The pump that has the axis goes on with it, and without an axis the next free one is taken.
    assert_eq!(desk.types(&["setup", "buffer", "--no-motion", "--yes"]).code, 0);
    let free = desk.types(&like);
    assert!(free.code == 0 && free.err.contains("turns this pump: Y, taken by --yes"), "{}", free.err);
}

#[test]
fn an_axis_that_the_board_does_not_report_is_not_offered() {
    let desk = Desk::new();
    let options = Options { time_scale: 20.0, patient: true, axes: 1, ..Options::default() };
    let mut pump = TruePump::behind(Simulated::start(options).unwrap(), 0.5, 3200.0, (0.23, 50.0), 0.0);
    let mut axes = ["Y", "X"].iter();
    let first = desk.answers(&["setup", "acid", "--no-motion"], &mut |question| match question {
        q if q.starts_with("Axis") => axes.next().map(ToString::to_string),
        q => Some(sees(&mut pump, q, "16")),
    });
    assert_eq!(first.code, 0, "{}", first.err);
    assert!(first.err.contains("this board has the axis X alone, and not Y"), "{}", first.err);
    // A board whose axes are all taken is named, and another one is asked for.
    let mut ports = 0;
    let second = desk.answers(&["setup", "base", "--no-motion"], &mut |question| {
        ports += usize::from(question.starts_with("Port of the board"));
        if ports == 2 { Some("quit".to_owned()) } else { Some(sees(&mut pump, question, "16")) }
    });
    assert_eq!(second.code, 0, "{}", second.err);
    assert!(second.err.contains("each axis of the board at"), "{}", second.err);
    // Nobody is led there: the port is not suggested.
    let port = second.asked.iter().find(|question| question.starts_with("Port of the board"));
    assert_eq!(port.unwrap(), "Port of the board: ");
    assert!(second.err.contains("name another board, or quit"), "{}", second.err);
    assert!(second.err.contains("`dose setup base` goes on"), "{}", second.err);
    // A script's axis is looked at before its file is written.
    let port = pump.port();
    let words =
        ["setup", "lime", "--ml-per-rev", "0.5mL", "--rollers", "4", "--microsteps", "16", "--axis", "Z"];
    let more = ["--driver", "grbl", "--altitude", "0m", "--turned", "1", "--direction", "forward", "--yes"];
    let scripted = desk.types(&[&words[..], &more, &["--port", &port]].concat());
    assert!(
        scripted.code == 2 && scripted.err.contains("has the axis X alone, and not Z"),
        "{}",
        scripted.err
    );
    assert_eq!(desk.configured("pumps/lime.toml"), None);
    // A person is asked for another axis at once.
    let said = ["setup", "lime", "--driver", "grbl", "--port", &port, "--axis", "Y"];
    let mut asked = false;
    let asked_anew = Desk::new().answers(&said, &mut |question| match question {
        q if q.starts_with("Axis") => {
            asked = true;
            None
        }
        q => Some(sees(&mut pump, q, "16")),
    });
    assert!(asked && asked_anew.err.contains("has the axis X alone, and not Y"), "{}", asked_anew.err);
    assert_eq!(pump.board.rest().steps, 0);
}

#[test]
fn an_axis_that_was_said_before_the_port_turns_no_other_pump() {
    let desk = Desk::new();
    let pump = TruePump::new(0.5, 3200.0, (0.23, 50.0), 0.0);
    let port = pump.port();
    let head = [
        "--ml-per-rev",
        "0.5mL",
        "--rollers",
        "4",
        "--microsteps",
        "16",
        "--altitude",
        "0m",
        "--driver",
        "grbl",
    ];
    let acid =
        [&["setup", "acid", "--port", &port, "--axis", "X", "--yes", "--no-motion"][..], &head].concat();
    assert_eq!(desk.types(&acid).code, 0);
    // The port is that of acid, taken by --yes.
    let four =
        [&["setup", "four", "--axis", "X", "--yes", "--turned", "1", "--direction", "forward"][..], &head]
            .concat();
    for _ in 0..2 {
        let refused = desk.types(&four);
        assert_eq!(refused.code, 2, "{}{}", refused.out, refused.err);
        assert!(refused.err.contains("turns the pump `acid` already"), "{}", refused.err);
    }
    assert_eq!((pump.board.rest().steps, desk.configured("pumps/four.toml")), (0, None));
    // A person is asked for another axis where they stand.
    let five = [&["setup", "five", "--axis", "X", "--no-motion"][..], &head].concat();
    let ended = desk.answers(&five, &mut |question| {
        Some(if question.starts_with("Port") { port.clone() } else { String::new() })
    });
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("the axis X of"), "{}", ended.err);
    assert!(desk.configured("pumps/five.toml").unwrap().contains("axis = \"Y\""));
}

#[test]
fn answers_of_another_pump_are_refused_for_one_that_has_its_own() {
    let desk = Desk::new();
    for (name, volume) in [("acid", "0.5mL"), ("base", "0.3mL")] {
        let words = [
            "setup",
            name,
            "--ml-per-rev",
            volume,
            "--rollers",
            "4",
            "--microsteps",
            "16",
            "--driver",
            "sim",
        ];
        assert_eq!(desk.types(&[&words[..], &["--altitude", "0m", "--yes", "--no-motion"]].concat()).code, 0);
    }
    let refused = desk.types(&["setup", "acid", "--like", "base", "--yes", "--no-motion"]);
    assert!(refused.code == 2 && refused.err.contains("--like has no answer to add"), "{}", refused.err);
    let anew = desk.types(&["setup", "acid", "--like", "base", "--anew", "--yes", "--no-motion"]);
    assert_eq!(anew.code, 0, "{}", anew.err);
    assert!(desk.configured("pumps/acid.toml").unwrap().contains("ml_per_rev = 0.3"));
}

#[test]
fn a_tube_of_another_bore_suggests_its_own_end_and_the_bore_of_the_first_pump_stays_with_its_tube() {
    let desk = Desk::new();
    let place = [
        "--rollers",
        "3",
        "--microsteps",
        "16",
        "--driver",
        "sim",
        "--altitude",
        "0m",
        "--yes",
        "--no-motion",
    ];
    let set_up = |name: &str, head: &[&str]| {
        let ended = desk.types(&[&["setup", name][..], head, &place].concat());
        assert_eq!(ended.code, 0, "{}", ended.err);
        let file = desk.configured(&format!("pumps/{name}.toml")).unwrap();
        file.lines().find(|line| line.starts_with("nozzle_bore_mm")).unwrap_or_default().to_owned()
    };
    assert_eq!(set_up("acid", &["--ml-per-rev", "0.29mL", "--bore", "1.6mm"]), "nozzle_bore_mm = 1.6");
    assert_eq!(set_up("wide", &["--head", "masterflex-ls-17"]), "nozzle_bore_mm = 6.4");
    assert_eq!(
        set_up("wide-too", &["--head", "masterflex-ls-17", "--nozzle-bore", "2mm"]),
        "nozzle_bore_mm = 2.0"
    );
    // A nozzle that was put at a tube of this bore is suggested.
    assert_eq!(set_up("nozzle", &["--head", "masterflex-ls-17"]), "nozzle_bore_mm = 2.0");
    assert_eq!(set_up("thin", &["--ml-per-rev", "0.1mL", "--bore", "0.8mm"]), "nozzle_bore_mm = 0.8");
}
