//! Refusals: their words and their exit codes.

use std::fs;
use std::path::Path;

use pump_bench::pump_file::Reservoir;

use crate::user::{User, number};

#[test]
fn traps_of_the_command_line_are_answered_as_what_they_are() {
    let user = User::new();
    assert!(
        user.is_refused(&["--pump", "x", "status"])
            .contains("there is no pump `x`; built-in pumps: three-roller")
    );
    assert!(user.is_refused(&["25mL", "prime", "5mL"]).contains("a command together"));
    assert!(user.is_refused(&["--dryrun", "25mL"]).contains("--dry-run"));
    assert!(user.is_refused(&["stauts"]).contains("unknown command `stauts`; did you mean `dose status`?"));
    assert!(user.is_refused(&["25mL", "30mL"]).contains("one volume at a time"));
    assert!(user.is_refused(&["primr", "5mL"]).contains("did you mean `dose prime`?"));
    // Two letters of four make another word.
    assert!(user.is_refused(&["five"]).contains("`five` is neither a volume, as 25mL, nor a command: "));
    assert!(user.is_refused(&["pump", "list"]).contains("did you mean `dose pumps`?"));
    assert!(user.is_refused(&["prime"]).contains("how much?"));
    let swapped = user.is_refused(&["show", "pumps"]);
    assert!(swapped.contains("unknown command `show`; did you mean `dose pumps show`?"), "{swapped}");
    let listed = user.is_refused(&["everything", "status"]);
    assert!(listed.contains("`everything` is neither a volume") && listed.contains("calibrate"), "{listed}");
    assert!(user.is_refused(&[]).contains("how much?"));
    assert!(user.is_refused(&["prime", "tube"]).contains("`tube`"));
    assert!(user.is_refused(&["--dry-run", "status"]).contains("`dose status` takes no --dry-run"));
    assert!(
        user.is_refused(&["25mL", "--duration", "3s"])
            .contains("`dose` takes no --duration; it belongs to `dose simulate`")
    );

    assert!(number(&user.json(&["prime", "-5mL"]), "delivered_ml") < -4.99);
    assert!(number(&user.json(&["-5mL"]), "delivered_ml") < -4.99);
    let before = user.record();
    user.json(&["--dry-run", "prime", "5mL"]);
    assert_eq!(user.record(), before, "an option before the command counts too");
}

#[test]
fn counts_that_are_no_whole_number_are_refused_with_their_range() {
    let user = User::new();
    let new = ["pumps", "new", "--ml-per-rev", "0.5mL"];
    for (words, option, value, said) in [
        (&new[..], "--rollers", "2.5", "number of rollers is 2.5; allowed: whole numbers from 1 to 1000"),
        (&new, "--microsteps", "16.5", "number of microsteps is 16.5; allowed: whole numbers from 1 to"),
        (&new, "--full-steps", "200.0", "number of full steps per revolution is 200.0; allowed: whole"),
        (&new, "--steps-per-rev", "3.2e3", "number of steps per revolution is 3.2e3; allowed: whole"),
        (&["size", "--flow", "2L/h"], "--rollers", "x", "number of rollers is x; allowed: whole"),
        (&["setup", "acid"], "--microsteps", "1/16", "number of microsteps is 1/16; allowed: whole"),
        (&["calibrate", "run"], "--runs", "0", "number of runs is 0; allowed: whole numbers from 1 to 100"),
        (
            &["calibrate", "run"],
            "--pitches",
            "1.5",
            "number of pitches is 1.5; allowed: whole numbers from 1",
        ),
        (
            &["calibrate", "verify"],
            "--runs",
            "1",
            "number of doses is 1; allowed: whole numbers from 2 to 1000",
        ),
        (&["5mL"], "--repeat", "2.5", "number of doses is 2.5; allowed: whole numbers from 1 to 1000000"),
    ] {
        let refused = user.is_refused(&[words, &[option, value]].concat());
        assert!(refused.contains(said) && refused.contains(option), "{refused}");
    }
}

#[test]
fn bad_quantities_are_refused_by_name() {
    let user = User::new();
    for (arguments, expected) in [
        (vec!["25"], "`25` has no unit"),
        (vec!["25ML"], "did you mean `mL`"),
        (vec!["25 furlongs"], "unknown volume or mass unit `furlongs`"),
        (vec!["NaNmL"], "not a finite number"),
        (vec!["infmL"], "not a finite number"),
        (vec!["-infmL"], "unexpected argument"),
        (vec!["1e999mL"], "not a finite number"),
        (vec!["0mL"], "is zero"),
        (vec!["-0mL"], "is zero"),
        (vec!["1e9mL"], "volume in mL is 1000000000; allowed: up to 100000"),
        (vec!["1e-9mL"], "less than half a motor step"),
        (vec!["25mL", "--rate", "-5mL/s"], "is negative"),
        (vec!["25mL", "--rate", "0mL/s"], "is zero"),
        (vec!["25mL", "--rate", "NaN"], "not a finite number"),
        (vec!["25mL", "--rate", "5"], "has no unit"),
        (vec!["25mL", "--rate", "100mL/s"], "60.402 mL/s at most"),
        (vec!["25mL", "--speed", "171rpm"], "above the pump's limit of 170.00 r/min"),
        (vec!["25mL", "--within", "0.1s"], "the fastest found takes"),
        (vec!["25mL", "--rate", "1e-12mL/s"], "58 days"),
        (vec!["25mL", "--max-outlet-pressure", "15psi"], "`15psia` (absolute) or `15psig`"),
        (vec!["25mL", "--max-outlet-pressure", "89kPaa"], "above the limit of 89.00 kPa"),
        (vec!["25mL", "--min-inlet-pressure", "88kPaa"], "below the limit of 88.00 kPa"),
        (vec!["25mL", "--start-angle", "30"], "has no unit"),
        (vec!["25mL", "--start-angle", "1e9rad"], "allowed: an angle within one turn, -360deg to 360deg"),
        (vec!["25mL", "--driver", "teleport"], "teleport"),
        (vec!["simulate", "--speed", "100rpm"], "how long?"),
        (vec!["simulate", "--duration", "1s"], "how fast?"),
        (vec!["simulate", "--speed", "1e9rpm", "--duration", "1s"], "speed in rad/s"),
        (vec!["simulate", "--speed", "1rpm", "--duration", "1s", "--dt", "2s"], "dt in s is 2"),
    ] {
        let message = user.is_refused(&arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
}

#[test]
fn a_pump_that_another_process_holds_is_refused_with_exit_code_3() {
    let user = User::new();
    user.json(&["1mL"]);
    let lock = fs::File::options().write(true).open(user.path("state/three-roller/sim/lock")).unwrap();
    lock.lock().unwrap();
    let answer = user.types(&["1mL"]);
    assert_eq!(answer.code, 3, "{}", answer.err);
    assert!(answer.err.contains("pump `three-roller` is in use by process"), "{}", answer.err);
}

#[test]
fn a_pump_file_is_obeyed_and_its_mistakes_are_named() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    let write = |text: &str| fs::write(user.path("my.toml"), text).unwrap();
    write(&three.replace("id = \"three-roller\"", "id = \"mine\"").replace("count = 3", "count = 4"));
    let report = user.json(&["25mL", "--pump", "my.toml"]);
    assert_eq!(report["pump"], "mine");
    assert!(user.path("state/mine/sim/journal.jsonl").exists());
    assert!(user.types(&["pumps", "check", "my.toml"]).out.contains("19.2130 mL per revolution"));

    for (from, to, expected) in [
        ("pump/1", "pump/9", "schema is `pump/9`"),
        ("bore_radius_mm = 5.0", "bore_radius_mm = -5.0", "bore radius in mm is -5"),
        ("bore_radius_mm = 5.0", "bore_radius_mm = nan", "bore radius in mm is NaN"),
        ("bore_radius_mm", "bore_radius_cm", "unknown field `bore_radius_cm`"),
        ("count = 3", "count = 1", "no roller seals"),
        ("count = 3", "count = 14", "it must be positive: use fewer rollers"),
        ("count = 3", "count = \"three\"", "invalid type"),
        ("offset_mm = 40.0", "offset_mm = 43.5", "beyond the backplate radius"),
        ("id = \"three-roller\"", "id = \"../x\"", "[pump] id is `../x`"),
        ("default_rate_ml_s = 5.0", "default_rate_ml_s = 500.0", "default_rate_ml_s is 500"),
        ("steps_per_rev = 12800", "steps_per_rev = 0", "steps_per_rev is 0"),
        ("max_speed_rpm = 170.0", "max_speed_rpm = -1.0", "largest speed"),
        ("density_kg_m3 = 997.0", "density_kg_m3 = 0.997", "density_kg_m3 is 0.997; allowed: 10"),
        ("pressure_kpa = 85.7", "pressure = 85.7", "unknown field `pressure`"),
        ("schema = \"pump/1\"", "schema = ", "TOML parse error"),
    ] {
        let text = three.replace(from, to);
        assert_ne!(text, three, "{from} is in the file");
        write(&text);
        let message = user.is_refused(&["25mL", "--pump", "my.toml"]);
        assert!(message.contains(expected) && message.contains("my.toml"), "{to}: {message}");
    }
    fs::write(user.path("my.toml"), [0xff, 0xfe, 0]).unwrap();
    assert!(user.is_refused(&["25mL", "--pump", "my.toml"]).contains("cannot read pump file my.toml"));
    assert!(user.is_refused(&["25mL", "--pump", "gone.toml"]).contains("cannot read pump file gone.toml"));
    assert!(user.is_refused(&["25mL", "--pump", "."]).contains("cannot read pump file"));
}

#[test]
fn the_example_pump_file_has_the_built_in_pumps_head_and_claims_neither_its_steps_nor_its_place_nor_its_weighing()
 {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/pumps/my-pump.toml");
    let mut example = pump_bench::pump_file::PumpFile::read(&path).unwrap();
    let built_in = pump_bench::built_in("three-roller").unwrap();
    assert_eq!(example.pump.id, "my-pump");
    example.pump.id.clone_from(&built_in.pump.id);
    example.pump.name.clone_from(&built_in.pump.name);
    // sqrt((20² + 10²)/3) and 15/sqrt(3).
    let unsure = &mut example.uncertainty;
    assert_eq!((unsure.model_percent, unsure.speed_percent), (13.0, Some(8.7)));
    (unsure.model_percent, unsure.speed_percent) = (built_in.uncertainty.model_percent, None);
    assert_eq!((example.motor.confirmed, built_in.motor.confirmed), (Some(false), Some(false)));
    assert_eq!((example.inlet.reservoir, example.outlet.line.reservoir), (Reservoir::OPEN, Reservoir::OPEN));
    example.inlet.reservoir = built_in.inlet.reservoir;
    example.outlet.line.reservoir = built_in.outlet.line.reservoir;
    assert_eq!(example.ambient.pressure_kpa, 101.325);
    example.ambient = built_in.ambient;
    assert_eq!(example, built_in);
}

#[test]
fn a_copy_of_the_example_moves_no_real_motor_before_somebody_has_said_its_steps() {
    let user = User::new();
    let text = include_str!("../../../examples/pumps/my-pump.toml");
    fs::write(user.path("my.toml"), text).unwrap();
    let check = user.types(&["pumps", "check", "my.toml"]).out;
    assert!(check.contains("assumed: a real motor does not move until they are said"), "{check}");
    let real = ["5mL", "--driver", "grbl", "--port", "/dev/none"];
    let refused = user.is_refused(&[&real[..], &["--pump", "my.toml"]].concat());
    assert!(refused.contains("filled in 12800 steps"), "{refused}");
    // Without the line the port is the next thing that is missing.
    let said: String =
        text.lines().filter(|line| !line.starts_with("confirmed")).map(|line| format!("{line}\n")).collect();
    fs::write(user.path("said.toml"), said).unwrap();
    let refused = user.is_refused(&[&real[..], &["--pump", "said.toml"]].concat());
    assert!(refused.contains("/dev/none") && !refused.contains("12800"), "{refused}");
}

#[test]
fn help_and_version_succeed_on_standard_output() {
    let user = User::new();
    assert!(user.types(&["--help"]).out.contains("dose [OPTIONS] <VOLUME>"));
    assert!(user.types(&["--version"]).out.starts_with("dose "));
    assert_eq!(user.types(&["--help"]).code, 0);
}

#[test]
fn rust_constants_belong_to_pumps_show() {
    let user = User::new();
    assert!(
        user.types(&["pumps", "show", "two-roller", "--format", "rust"])
            .out
            .contains("pub static PUMP: Pump")
    );
    for command in [&["1mL", "--format", "rust"][..], &["status", "--format", "rust"]] {
        assert!(user.is_refused(command).contains("belongs to `dose pumps show`"));
    }
    assert!(
        user.is_refused(&["pumps", "show", "two-roller", "--format", "json"]).contains("prints a pump file")
    );
}
