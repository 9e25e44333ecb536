//! Values that cannot be right: one table of words, each with what the refusal says.

use std::fs;

use crate::user::User;

#[test]
fn values_that_cannot_be_right_are_refused_before_anything_moves() {
    let user = User::new();
    fs::write(user.path("runs.csv"), "speed_rpm,revolutions,volume_ml\n60,3,64\n60,3,64\n60,3,64\n").unwrap();
    let guided = ["calibrate", "run", "--speeds", "60rpm", "--runs", "1"];
    let table = ["calibrate", "run", "--from", "runs.csv"];
    let phase = ["calibrate", "phase", "--from", "runs.csv"];
    let with = |words: &[&'static str], more: &[&'static str]| [words, more].concat();
    for (words, expected) in [
        (with(&guided, &["--scale", "-1g"]), "--scale is -1 g; allowed: more than 0 g, 1000 g at most"),
        (with(&guided, &["--scale", "1e9g"]), "--scale is 1000000000 g; allowed: "),
        (with(&guided, &["--scale", "2000mL"]), "--scale is 2000 mL; allowed: "),
        (with(&guided, &["--temperature", "500degC"]), "is 500; allowed: "),
        (with(&table, &["--scale", "-1g"]), "--scale is -1 g; allowed: "),
        (with(&table, &["--temperature", "500degC"]), "is 500; allowed: "),
        (with(&phase, &["--scale", "1e9g"]), "--scale is 1000000000 g; allowed: "),
        (vec!["25mL", "--temperature", "500degC"], "is 500; allowed: "),
        (vec!["25g", "--temperature=-300degC"], "is -300; allowed: "),
        (vec!["1e300mL"], "volume in mL is 1e300; allowed: up to 100000"),
        (vec!["1e-300mL"], "1e-300 mL"),
        (vec!["25mL", "--rate", "1e300mL/s"], "a rate of 1e300 mL/s"),
        (vec!["25mL", "--speed", "1e300rpm"], "a speed of 1e300 r/min"),
        (vec!["25mL", "--within", "1e-300s"], "within 1e-300 s"),
        (
            vec!["25mL", "--start-angle", "1e300rad"],
            "`1e300rad` is out of range; allowed: an angle within one turn",
        ),
        (
            vec!["25mL", "--start-angle", "400deg"],
            "`400deg` is out of range; allowed: an angle within one turn",
        ),
        (
            vec!["25kg"],
            "`25kg` is out of range; allowed: a mass of 10 kg at most; if more is meant, give the volume",
        ),
        (
            vec!["25mL", "--plot", "/nonexistent/x.svg"],
            "cannot write /nonexistent/x.svg: there is no folder /nonexistent",
        ),
        (vec!["25mL", "--every", "1e300s", "--repeat", "2"], "1e300"),
        (vec!["25mL", "--retract", "1e300mL"], "1e300"),
        (vec!["25mL", "--max-outlet-pressure", "1e300kPaa"], "1e300"),
        (vec!["25mL", "--trace", "t.csv", "--dt", "1e-300s"], "rows"),
        (vec!["home", "--set", "x"], "`x` is not an angle"),
        (
            vec!["home", "--set", "1e300deg"],
            "`1e300deg` is out of range; allowed: an angle within one turn, -360deg to 360deg",
        ),
        (vec!["simulate", "--speed", "60rpm", "--duration", "1e300s"], "1e300"),
    ] {
        let message = user.is_refused(&words);
        assert!(message.contains(expected), "{words:?}: {message}");
        assert!(!message.contains("moving"), "{words:?}: {message}");
        let longest = message.split(|c: char| !c.is_ascii_digit()).map(str::len).max();
        assert!(longest <= Some(20), "{words:?}: {message}");
    }
}

#[test]
fn a_pump_file_is_refused_by_its_check_where_it_cannot_dose() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    let check = |text: &str| {
        fs::write(user.path("p.toml"), text).unwrap();
        user.types(&["pumps", "check", "p.toml"])
    };
    let without = check(&format!("{three}\n[drive]\ndriver = \"grbl\"\n"));
    assert_eq!(without.code, 2, "{}", without.out);
    assert!(without.err.contains("[drive] port is missing; allowed: "), "{}", without.err);
    let empty = check(&format!("{three}\n[drive]\ndriver = \"node\"\nport = \"\"\n"));
    assert_eq!(empty.code, without.code);
    assert!(empty.err.contains("[drive] port is \"\"; allowed: a serial port"), "{}", empty.err);
    assert_eq!(check(&format!("{three}\n[drive]\ndriver = \"grbl\"\nport = \"/dev/ttyUSB0\"\n")).code, 0);
    assert_eq!(check(&format!("{three}\n[drive]\ndriver = \"sim\"\n")).code, 0);
    for (rate, allowed) in [("1e300", "1e-6 or more"), ("1e-12", "1e-6 or more"), ("-1.0", "1e-6 or more")] {
        let text = three.replace("default_rate_ml_s = 5.0", &format!("default_rate_ml_s = {rate}"));
        assert_ne!(text, three);
        let said = check(&text);
        assert_eq!(said.code, 2, "{rate}: {}", said.out);
        assert!(said.err.contains("default_rate_ml_s is ") && said.err.contains(allowed), "{}", said.err);
        assert!(!said.err.contains("00000000000000000000"), "{}", said.err);
    }
}
