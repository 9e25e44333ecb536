//! Racks as a user types them: names, refusals with their exit codes, and a stop that prints the report.

#[cfg(unix)]
mod advice;
#[cfg(unix)]
mod unattended;
mod waits;

use std::fs;

use serde_json::Value;

use crate::user::User;

const MIX: &str = "schema = \"rack/1\"\n[pumps]\nacid = \"three-roller\"\nbase = \"two-roller\"\n[[step]]\nratio = { \
                   acid = 2, base = 1 }\nvolume = \"6mL\"\nrate = \"6mL/s\"\n";

fn desk(rack: &str) -> User {
    let user = User::new();
    fs::write(user.path("mix.toml"), rack).unwrap();
    user
}

#[test]
fn a_rack_of_the_configuration_runs_and_is_shown_by_its_name() {
    let user = desk(MIX);
    fs::create_dir_all(user.path("config/pump-dose")).unwrap();
    let keys = "schema = \"config/1\"\n[racks]\nmix = \"../../mix.toml\"\n";
    fs::write(user.path("config/pump-dose/config.toml"), keys).unwrap();
    let report = user.json(&["run", "mix", "--pace", "fast"]);
    assert_eq!((&report["schema"], &report["end"]), (&"rack/1".into(), &"completed".into()));
    assert!((report["total"]["delivered_ml"].as_f64().unwrap() - 6.0).abs() < 0.002);
    let shown = user.json(&["config", "show"]);
    assert_eq!(shown["racks"][0]["name"], "mix");
    assert!(user.types(&["config", "show"]).out.contains("mix.toml, a rack\n"));
    let status = user.types(&["status", "--rack", "mix"]);
    let names: Vec<_> = status.out.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!((status.code, names), (0, vec!["acid", "base"]), "{}", status.err);
    let unknown = user.is_refused(&["run", "mox"]);
    assert!(
        unknown.contains("there is no rack `mox`; configured: mix; or name the file of a rack"),
        "{unknown}"
    );
    let path = user.path("config/pump-dose/config.toml");
    fs::write(path, keys.replace("mix =", "\"../mix\" =")).unwrap();
    let refused = user.is_refused(&["run", "mix"]);
    assert!(refused.contains("a name of [racks] is `../mix`; allowed: 1 to 64 of a-z"), "{refused}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_rack_whose_report_cannot_be_printed_says_what_it_has_delivered() {
    for format in ["text", "json"] {
        let user = desk(MIX);
        let mut command = user.command(&["run", "mix.toml", "--pace", "fast", "--format", format]);
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = command.stdout(full).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        let told =
            " mL were delivered and recorded, but the report could not be printed: No space left on device";
        let (before, _) = said.split_once(told).unwrap_or_else(|| panic!("{said}"));
        let total_ml: f64 = before.rsplit([' ', '"']).next().unwrap().parse().unwrap();
        let logged = ["three-roller", "two-roller"].map(|pump| {
            let log = user.types(&["log", "--pump", pump, "--format", "json"]).out;
            serde_json::from_str::<Value>(log.lines().next().unwrap()).unwrap()
        });
        let logged_ml: f64 = logged.iter().map(|dose| dose["delivered_ml"].as_f64().unwrap()).sum();
        assert!((total_ml - 6.0).abs() < 0.002 && (total_ml - logged_ml).abs() < 1e-4, "{said}{logged:?}");
    }
}

#[test]
fn a_rack_is_refused_with_one_message_and_nothing_moves() {
    let user = desk(MIX);
    for (words, told) in [
        (&["run", "mix.toml", "--rate", "3mL/s"][..], "'--rate <FLOW>' cannot be used with '[RACK]'"),
        (
            &["run", "mix.toml", "--pump", "two-roller"],
            "--pump two-roller and the rack mix.toml both name pumps",
        ),
        (&["run", "none.toml"], "cannot read the rack none.toml"),
        (
            &["run", "--rate", "2mL/s", "--pace", "fast"],
            "--pace fast takes no time, and a run until it is stopped ends by time",
        ),
    ] {
        let refused = user.is_refused(words);
        assert!(refused.contains(told), "{words:?}: {refused}");
    }
    for (from, to, told) in [
        (
            "two-roller",
            "three-roller",
            "the pumps `acid` and `base` of the rack are one pump, `three-roller`",
        ),
        ("base = 1 }", "base = 0 }", "step 1, ratio of base is `0`"),
        ("6mL\"", "6\"", "step 1, volume: "),
        ("two-roller", "none.toml", "pump `base` of the rack: cannot read pump file none.toml"),
    ] {
        fs::write(user.path("mix.toml"), MIX.replace(from, to)).unwrap();
        let refused = user.is_refused(&["run", "mix.toml"]);
        assert!(refused.starts_with("error: ") && refused.contains(told), "{refused}");
    }
}

#[test]
fn a_rack_beyond_the_day_of_one_pump_ends_with_5_and_no_pump_moves() {
    let user = desk(&MIX.replace("two-roller", "base.toml"));
    let pump =
        user.types(&["pumps", "show", "two-roller"]).out.replace("id = \"two-roller\"", "id = \"base\"");
    fs::write(user.path("base.toml"), format!("{pump}\n[safety]\nmax_ml_per_day = 1.5\n")).unwrap();
    let answer = user.types(&["run", "mix.toml", "--format", "json"]);
    let error: Value = serde_json::from_str(&answer.err).unwrap();
    assert_eq!((answer.code, answer.out.as_str()), (5, ""));
    assert_eq!((&error["kind"], &error["moved"]), (&"safety".into(), &false.into()));
    let told = error["message"].as_str().unwrap();
    assert!(told.starts_with("pump `base` of the rack: ") && told.contains("dose safety clear"), "{told}");
    for pump in ["three-roller", "base.toml"] {
        assert_eq!(user.json(&["status", "--pump", pump])["tube_ml"].as_f64().unwrap_or(0.0), 0.0);
    }
}

#[test]
fn the_limit_of_a_day_of_the_command_line_is_that_of_each_pump_and_widens_none() {
    let user = desk(&MIX.replace("two-roller", "base.toml"));
    let pump =
        user.types(&["pumps", "show", "two-roller"]).out.replace("id = \"two-roller\"", "id = \"base\"");
    fs::write(user.path("base.toml"), format!("{pump}\n[safety]\nmax_ml_per_day = 9.0\n")).unwrap();
    let run = |limit| user.types(&["run", "mix.toml", "--pace", "fast", "--max-per-day", limit]);
    let wide = run("20mL");
    assert!(
        wide.code == 2 && wide.err.contains("pump base of the rack: --max-per-day is 20 mL"),
        "{}",
        wide.err
    );
    assert_eq!(run("8mL").code, 0);
    // Acid has made 4 mL and base 2 mL. Acid has no room for 4 mL more.
    let narrow = run("7mL");
    assert!(narrow.code == 5 && narrow.err.contains("pump `acid` of the rack"), "{}", narrow.err);
    assert_eq!(user.types(&["safety", "clear", "three-roller", "--reason", "a test"]).code, 0);
    assert_eq!(run("4.5mL").code, 0, "the day of acid began anew, and base has room");
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_every_pump_and_the_report_is_printed() {
    use std::process::{Command, Stdio};

    // A minute and a half, of which a moment is waited for.
    let user = desk(&MIX.replace("6mL\"\nrate = \"6mL/s", "90mL\"\nrate = \"1mL/s"));
    let mut command = user.command(&["run", "mix.toml", "--format", "json"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    user.until_moved("three-roller");
    user.until_moved("two-roller");
    let signalled = Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
    assert!(signalled.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&report["end"], &report["completed"]), (&"stopped".into(), &false.into()));
    for row in report["pumps"].as_array().unwrap() {
        assert_eq!(row["unfinished"], true, "{row}");
        let delivered_ml = row["delivered_ml"].as_f64().unwrap();
        assert!(delivered_ml > 0.0 && delivered_ml < 30.0, "{delivered_ml}");
    }
    // A busy computer warns of a late begin before.
    let said = String::from_utf8(output.stderr).unwrap();
    let error: Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
    assert_eq!((&error["code"], &error["kind"]), (&130.into(), &"stopped".into()));
    assert!(user.json(&["status", "--pump", "two-roller"])["unfinished"].is_object());
    assert_eq!(user.types(&["run", "mix.toml"]).code, 4);
}
