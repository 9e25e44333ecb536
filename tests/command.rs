//! The command as a user types it: exit codes, messages, files, and that nothing moves when it refuses.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// A bench of its own for each test.
struct User {
    folder: tempfile::TempDir,
}

struct Answer {
    code: i32,
    out: String,
    err: String,
}

impl User {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
        command.args(arguments).current_dir(self.folder.path()).env_remove("DOSE_PUMP");
        command.env("DOSE_STATE_DIR", self.path("state"));
        command
    }

    fn types(&self, arguments: &[&str]) -> Answer {
        let Output { status, stdout, stderr } = self.command(arguments).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Answer { code: status.code().unwrap(), out: text(stdout), err: text(stderr) }
    }

    fn json(&self, arguments: &[&str]) -> Value {
        let answer = self.types(&[arguments, &["--format", "json"]].concat());
        assert_eq!(answer.code, 0, "{arguments:?}: {}", answer.err);
        serde_json::from_str(&answer.out).unwrap()
    }

    /// Refused with exit code 2, one message, no panic, nothing on standard output and nothing on record.
    fn is_refused(&self, arguments: &[&str]) -> String {
        let before = self.record();
        let answer = self.types(arguments);
        assert_eq!(answer.code, 2, "{arguments:?}: {}{}", answer.out, answer.err);
        assert_eq!(answer.out, "", "{arguments:?}");
        assert!(!answer.err.contains("panicked"), "{arguments:?}: {}", answer.err);
        assert_eq!(self.record(), before, "{arguments:?} changed the record");
        answer.err
    }

    fn record(&self) -> Option<String> {
        fs::read_to_string(self.path("state/three-roller/sim/record.json")).ok()
    }
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}"))
}

fn rows(path: &Path) -> (String, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_owned();
    (header, lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect())
}

#[test]
fn a_dose_says_first_that_no_motor_moved() {
    let answer = User::new().types(&["25mL"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert_eq!(answer.out.lines().next(), Some("SIMULATED: no motor moved"));
    assert!(answer.out.contains("25.0 mL ± 1.2 mL delivered, 25 mL asked"), "{}", answer.out);
    assert!(answer.out.contains("not checked  outlet pressure, inlet pressure, torque"), "{}", answer.out);
}

#[test]
fn the_report_has_every_field_of_the_contract() {
    let report = User::new().json(&["25mL"]);
    for key in [
        "schema",
        "pump",
        "driver",
        "simulated",
        "requested_ml",
        "carry_in_ml",
        "planned_ml",
        "delivered_ml",
        "volume_basis",
        "expanded_uncertainty_ml",
        "uncertainty_budget",
        "phase",
        "start_angle_deg",
        "end_angle_deg",
        "steps",
        "steps_per_rev",
        "carry_ml",
        "cruise_speed_rpm",
        "cruise_flow_ml_s",
        "mean_flow_ml_s",
        "motion_s",
        "settle_s",
        "inlet_min_kpa",
        "inlet_max_kpa",
        "outlet_min_kpa",
        "outlet_max_kpa",
        "ambient_kpa",
        "limited_by",
        "limits_not_checked",
        "warnings",
        "completed",
    ] {
        assert!(!report[key].is_null(), "{key} in {report}");
    }
    assert_eq!(report["schema"], "dose/1");
    assert_eq!(report["phase"]["known"], true);
    assert_eq!(report["phase"]["source"], "home");
    assert_eq!(report["completed"], true);
    assert_eq!(report["steps"], 15_480);
    assert!((number(&report, "delivered_ml") - number(&report, "planned_ml")).abs() < 1e-3);
    let turned = number(&report, "end_angle_deg") - number(&report, "start_angle_deg");
    assert!((turned - 15_480.0 * 360.0 / 12_800.0).abs() < 1e-9);
}

#[test]
fn angle_and_carry_pass_from_dose_to_dose_and_add_up() {
    let user = User::new();
    let (mut end_deg, mut carry_ml, mut planned_ml) = (0.0, 0.0, 0.0);
    for volume in ["1mL", "250uL", "-2mL", "7 mL", "0.1mL"] {
        let report = user.json(&[volume]);
        assert!((number(&report, "start_angle_deg") - end_deg).abs() < 1e-9, "{volume}");
        assert_eq!(number(&report, "carry_in_ml"), carry_ml, "{volume}");
        end_deg = number(&report, "end_angle_deg").rem_euclid(360.0);
        carry_ml = number(&report, "carry_ml");
        planned_ml += number(&report, "planned_ml");
    }
    assert!((planned_ml + carry_ml - 6.35).abs() < 1e-12);
    let status = user.json(&["status"]);
    assert!((number(&status, "angle_deg") - end_deg).abs() < 1e-9);
    assert_eq!(number(&status, "carry_ml"), carry_ml);
}

#[test]
fn a_prime_moves_the_rollers_and_leaves_the_carry() {
    let user = User::new();
    let owed = number(&user.json(&["1mL"]), "carry_ml");
    let prime = user.json(&["prime", "20mL"]);
    assert_eq!(number(&prime, "carry_in_ml"), 0.0);
    assert_eq!(number(&prime, "carry_ml"), owed, "what the next dose owes has not changed");
    let status = user.json(&["status"]);
    assert_eq!(number(&status, "carry_ml"), owed);
    assert!((number(&status, "angle_deg") - number(&prime, "end_angle_deg").rem_euclid(360.0)).abs() < 1e-9);
}

#[test]
fn a_dry_run_reads_the_record_and_writes_nothing() {
    let user = User::new();
    let report = user.json(&["25mL", "--dry-run"]);
    assert!(report["delivered_ml"].is_null());
    assert_eq!(report["completed"], false);
    assert!(!user.path("state").exists());
    user.json(&["1mL"]);
    let before = user.record();
    assert_eq!(user.json(&["1mL", "--dry-run"])["phase"]["source"], "recorded");
    assert_eq!(user.record(), before);
}

#[test]
fn reverse_is_the_same_as_a_negative_volume() {
    let reverse = |arguments: &[&str]| User::new().json(arguments);
    let (flag, minus) = (reverse(&["5mL", "--reverse"]), reverse(&["-5mL"]));
    assert_eq!(flag, minus);
    assert!(minus["steps"].as_i64().unwrap() < 0);
    assert!((number(&minus, "delivered_ml") + 5.0).abs() < 0.002);
    assert!(User::new().is_refused(&["--reverse", "-5mL"]).contains("both mean reverse"));
}

#[test]
fn every_way_to_say_how_fast_is_obeyed() {
    let user = User::new();
    let dry = |arguments: &[&str]| user.json(&[&["25mL", "--dry-run"], arguments].concat());
    assert!((number(&dry(&[]), "cruise_flow_ml_s") - 5.0).abs() < 1e-9);
    assert!((number(&dry(&["--rate", "600 mL/min"]), "cruise_flow_ml_s") - 10.0).abs() < 1e-9);
    assert!((number(&dry(&["--speed", "100rpm"]), "cruise_speed_rpm") - 100.0).abs() < 1e-9);
    let within = dry(&["--within", "4s"]);
    let total = number(&within, "motion_s") + number(&within, "settle_s");
    assert!(total <= 4.0 && total > 3.9, "{total}");
    assert!(
        user.is_refused(&["25mL", "--rate", "5mL/s", "--speed", "100rpm"]).contains("exclude each other")
    );
}

#[test]
fn a_mass_is_dosed_by_the_fluids_density() {
    let report = User::new().json(&["25g", "--dry-run"]);
    assert!((number(&report, "requested_ml") - 25.0 / 0.997).abs() < 1e-9);
}

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
    assert!(user.is_refused(&["25", "mL"]).contains("did you mean 25mL"));
    assert!(user.is_refused(&["25mL", "30mL"]).contains("one volume at a time"));
    assert!(user.is_refused(&["primr", "5mL"]).contains("did you mean `dose prime`?"));
    assert!(user.is_refused(&["pump", "list"]).contains("did you mean `dose pumps`?"));
    assert!(user.is_refused(&["prime"]).contains("how much?"));
    assert!(user.is_refused(&[]).contains("how much?"));
    assert!(user.is_refused(&["--dry-run", "status"]).contains("--dry-run means nothing to `dose status`"));
    assert!(user.is_refused(&["25mL", "--duration", "3s"]).contains("--duration means nothing to `dose`"));

    assert!(number(&user.json(&["prime", "-5mL"]), "delivered_ml") < -4.99);
    assert!(number(&user.json(&["-5mL"]), "delivered_ml") < -4.99);
    let before = user.record();
    user.json(&["--dry-run", "prime", "5mL"]);
    assert_eq!(user.record(), before, "an option before the command counts too");
}

#[test]
fn bad_quantities_are_refused_by_name() {
    let user = User::new();
    for (arguments, expected) in [
        (vec!["25"], "`25` has no unit"),
        (vec!["25ML"], "did you mean `mL`"),
        (vec!["25 furlongs"], "unknown volume unit `furlongs`"),
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
        (vec!["25mL", "--start-angle", "1e9rad"], "start angle in rad is 1000000000"),
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
fn steps_and_trace_are_what_the_report_says() {
    let user = User::new();
    let arguments = ["3mL", "--start-angle", "100deg", "--dry-run", "--steps", "s.csv", "--trace", "t.csv"];
    let report = user.json(&arguments);
    let (header, steps) = rows(&user.path("s.csv"));
    assert_eq!(header, "step,time_s,direction,angle_rad");
    assert_eq!(steps.len() as i64, report["steps"].as_i64().unwrap());
    assert_eq!(steps[0][0], 1.0);
    let last = steps.last().unwrap();
    assert_eq!(last[1], number(&report, "motion_s"));
    assert!((last[3].to_degrees() - number(&report, "end_angle_deg")).abs() < 1e-9);
    assert!(steps.iter().all(|step| step[2] == 1.0));

    let (header, trace) = rows(&user.path("t.csv"));
    assert_eq!(header, "time_s,angle_rad,speed_rad_s,q_in_ml_s,q_out_ml_s,p_in_kpa,p_out_kpa,delivered_ml");
    assert!(trace.iter().any(|row| row[0] == number(&report, "motion_s")));
    assert!((trace[1][0] - 1e-3).abs() < 1e-15);
    let end = trace.last().unwrap();
    assert_eq!(end[0], number(&report, "motion_s") + number(&report, "settle_s"));
    assert!((end[7] - number(&report, "planned_ml")).abs() < 1.01e-3, "less than 1 uL is undelivered");
    let highest = trace.iter().map(|row| row[6]).fold(f64::NEG_INFINITY, f64::max);
    let reported = number(&report, "outlet_max_kpa");
    assert!(highest <= reported + 1e-3 && highest > reported - 0.05, "{highest} for {reported}");
}

#[test]
fn a_plot_is_written_whole() {
    let user = User::new();
    user.json(&["25mL", "--plot", "dose.svg"]);
    let svg = fs::read_to_string(user.path("dose.svg")).unwrap();
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    for text in
        ["flow at the rollers, mL/s", "pressure, kPa absolute", "speed, r/min", "delivered, mL", "time, s"]
    {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn unwritable_outputs_are_refused_before_anything_moves() {
    let user = User::new();
    fs::create_dir(user.path("folder")).unwrap();
    for option in ["--steps", "--trace", "--plot"] {
        for target in ["no/such/folder/file", "folder"] {
            let message = user.is_refused(&["25mL", option, target]);
            assert!(message.contains("cannot write") && message.contains(target), "{message}");
        }
    }
    user.is_refused(&["25mL", "--steps", "steps.csv", "--plot", "no/such/folder/file"]);
    assert!(!user.path("steps.csv").exists(), "all outputs or none");
    assert!(user.is_refused(&["25mL", "--steps", "x", "--trace", "x"]).contains("two outputs"));
    assert!(user.is_refused(&["25mL", "--steps", "./x", "--trace", "x"]).contains("two outputs"));
    assert!(user.is_refused(&["25mL", "--steps", "-"]).contains("no file"));
    assert!(user.is_refused(&["25mL", "--dt", "1s"]).contains("--trace"));
    let left: Vec<_> =
        fs::read_dir(user.folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| name == "folder" || name == "state"), "{left:?}");
    assert!(user.is_refused(&["25mL", "--state-dir", "/dev/null/x"]).contains("--state-dir"));
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
    assert!(user.path("state/mine/sim/record.json").exists());
    assert!(user.types(&["pumps", "check", "my.toml"]).out.contains("19.2130 mL per revolution"));

    for (from, to, expected) in [
        ("pump/1", "pump/9", "schema is `pump/9`"),
        ("bore_radius_mm = 5.0", "bore_radius_mm = -5.0", "bore radius in mm is -5"),
        ("bore_radius_mm = 5.0", "bore_radius_mm = nan", "bore radius in mm is NaN"),
        ("bore_radius_mm", "bore_radius_cm", "unknown field `bore_radius_cm`"),
        ("count = 3", "count = 1", "no roller seals"),
        ("count = 3", "count = 13", "must stay positive"),
        ("count = 3", "count = \"three\"", "invalid type"),
        ("offset_mm = 40.0", "offset_mm = 43.5", "beyond the backplate radius"),
        ("id = \"three-roller\"", "id = \"../x\"", "[pump] id is `../x`"),
        ("default_rate_ml_s = 5.0", "default_rate_ml_s = 500.0", "default_rate_ml_s is 500"),
        ("steps_per_rev = 12800", "steps_per_rev = 0", "steps_per_rev is 0"),
        ("max_speed_rpm = 170.0", "max_speed_rpm = -1.0", "largest speed"),
        ("density_kg_m3 = 997.0", "density_kg_m3 = 0.997", "density_kg_m3 is 0.997; allowed: 10"),
        ("[ambient]\npressure_kpa = 85.7", "", "missing field `ambient`"),
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
fn a_damaged_record_stops_a_dose_until_the_angle_is_given() {
    let user = User::new();
    user.json(&["1mL"]);
    fs::write(user.path("state/three-roller/sim/record.json"), "{").unwrap();
    assert!(user.is_refused(&["1mL"]).contains("say where it stands with --start-angle"));
    let report = user.json(&["1mL", "--start-angle", "0deg"]);
    assert!(report["warnings"][0].as_str().unwrap().contains("what earlier doses owed is lost"));
    assert_eq!(user.json(&["1mL"])["phase"]["source"], "recorded");
}

#[test]
fn simulate_reports_the_steady_state_and_samples_both_ends() {
    let user = User::new();
    let report = user.json(&["simulate", "--speed", "100rpm", "--duration", "10s", "--trace", "run.csv"]);
    assert_eq!(report["schema"], "simulation/1");
    assert!((number(&report["steady"], "outlet_max_kpa") - 104.5105).abs() < 2e-3);
    assert!((number(&report["steady"], "inlet_mean_kpa") - 84.7002).abs() < 2e-3);
    assert!((number(&report["steady"], "mean_flow_ml_s") - 35.5308).abs() < 1e-3);
    let (_, trace) = rows(&user.path("run.csv"));
    assert_eq!(trace.len(), 10_001);
    assert_eq!(trace.last().unwrap()[0], 10.0);
    let lowest = trace.iter().map(|row| row[5]).fold(f64::INFINITY, f64::min);
    assert!((lowest - 71.725).abs() < 0.02, "start-up reaches {lowest}");
}

#[test]
fn help_and_version_succeed_on_standard_output() {
    let user = User::new();
    assert!(user.types(&["--help"]).out.contains("dose [OPTIONS] <VOLUME>"));
    assert!(user.types(&["--version"]).out.starts_with("dose "));
    assert_eq!(user.types(&["--help"]).code, 0);
}

#[test]
fn the_example_pump_file_is_the_built_in_pump_under_another_name() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/pumps/my-pump.toml");
    let mut example = pump_dose::pump_file::PumpFile::read(&path).unwrap();
    let built_in = pump_dose::built_in("three-roller").unwrap();
    assert_eq!(example.pump.id, "my-pump");
    example.pump.id.clone_from(&built_in.pump.id);
    example.pump.name.clone_from(&built_in.pump.name);
    assert_eq!(example, built_in);
}

#[test]
fn slow_doses_predict_small_pressures_and_keep_limits_close_to_rest() {
    let user = User::new();
    let slow = [
        "25mL",
        "--rate",
        "0.01mL/s",
        "--max-outlet-pressure",
        "88.8kPaa",
        "--min-inlet-pressure",
        "88.5kPaa",
    ];
    let report = user.json(&[&slow[..], &["--dry-run"]].concat());
    for (key, rest_kpa) in [("inlet_min_kpa", 88.637), ("inlet_max_kpa", 88.637), ("outlet_max_kpa", 88.637)]
    {
        assert!((number(&report, key) - rest_kpa).abs() < 0.02, "{key} in {report}");
    }
}

#[test]
fn the_simulated_vessel_receives_everything_at_any_rate() {
    for rate in ["0.02mL/s", "0.3mL/s", "60mL/s"] {
        let report = User::new().json(&["2mL", "--rate", rate]);
        let missing = number(&report, "planned_ml") - number(&report, "delivered_ml");
        assert!(missing.abs() < 2e-6, "{rate}: {missing} mL missing");
    }
}

#[test]
fn a_small_dose_says_what_a_step_makes_of_it() {
    let user = User::new();
    let report = user.json(&["1.2uL"]);
    assert!(report["warnings"].to_string().contains("a motor step is coarse for this dose"), "{report}");
    let message = user.is_refused(&["1.5uL"]);
    assert!(
        message.contains("0.0015 mL with -0.000") && message.contains("the smallest dose here is 0.00"),
        "{message}"
    );
}

#[test]
fn pressures_that_no_liquid_can_have_are_said_to_be_so() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    fs::write(
        user.path("long.toml"),
        three.replace("resistance_kpa_s_ml = 0.1108", "resistance_kpa_s_ml = 10.0"),
    )
    .unwrap();
    let dose = user.json(&["25mL", "--pump", "long.toml", "--rate", "20mL/s", "--dry-run"]);
    assert!(dose["warnings"][0].as_str().unwrap().contains("no liquid can"), "{dose}");
    let run = ["simulate", "--pump", "long.toml", "--speed", "200rpm", "--duration", "1s"];
    let run = user.json(&run);
    assert!(run["warnings"][0].as_str().unwrap().contains("above the pump's limit of 170 r/min"), "{run}");
    assert!(run["warnings"][1].as_str().unwrap().contains("no liquid can"), "{run}");
}

#[test]
fn both_methods_of_simulate_agree() {
    let user = User::new();
    let run = |method: &str, file: &str| {
        let arguments =
            ["simulate", "--speed", "100rpm", "--duration", "2s", "--method", method, "--trace", file];
        assert_eq!(user.json(&arguments)["method"], method);
        rows(&user.path(file)).1
    };
    let (exact, integrated) = (run("exact", "a.csv"), run("rodas5p", "b.csv"));
    assert_eq!(exact.len(), 2001);
    for (a, b) in exact.iter().zip(&integrated) {
        for (column, bound) in [(0, 0.0), (1, 0.0), (3, 0.0), (4, 0.0), (5, 1e-4), (6, 1e-4), (7, 1e-5)] {
            assert!((a[column] - b[column]).abs() <= bound, "column {column} at {} s: {a:?} {b:?}", a[0]);
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_report_that_cannot_be_printed_does_not_hide_the_dose() {
    let user = User::new();
    let full = || fs::File::options().write(true).open("/dev/full").unwrap();
    let output = user.command(&["5mL"]).stdout(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("mL were delivered and recorded"), "{message}");
    assert!(user.record().is_some());
    let output = user.command(&["5mL", "--dry-run"]).stdout(full()).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "nothing moved");
}
