//! The configuration: pumps by name, the usual pump, and the folder of the record.

use std::fs;

use crate::user::{User, number};

/// Writes the two-roller pump under an id into a file.
fn write_pump(user: &User, file: &str, id: &str) {
    let text = user.types(&["pumps", "show", "two-roller"]).out;
    fs::write(user.path(file), text.replace("id = \"two-roller\"", &format!("id = \"{id}\""))).unwrap();
}

/// Writes the configuration into the user's folder.
fn configure(user: &User, keys: &str) {
    fs::create_dir_all(user.path("config/pump-dose")).unwrap();
    fs::write(user.path("config/pump-dose/config.toml"), format!("schema = \"config/1\"\n{keys}")).unwrap();
}

#[test]
fn a_name_finds_its_file_from_anywhere_and_a_bare_dose_takes_the_default() {
    let user = User::new();
    assert_eq!(user.json(&["5mL", "--dry-run"])["pump"], "three-roller", "without a configuration");
    write_pump(&user, "ph-down.toml", "acid");
    configure(&user, "default_pump = \"ph-down\"\n[pumps]\nph-down = \"../../ph-down.toml\"\n");
    assert_eq!(user.json(&["5mL", "--dry-run"])["pump"], "acid");
    assert_eq!(user.json(&["5mL", "--dry-run", "--pump", "ph-down"])["pump"], "acid");
    assert_eq!(user.json(&["5mL", "--dry-run", "--pump", "three-roller"])["pump"], "three-roller");
    // A path comes first, even where a file of the name lies here.
    fs::write(user.path("ph-down"), "no pump").unwrap();
    assert_eq!(user.json(&["5mL", "--dry-run", "--pump", "ph-down"])["pump"], "acid");
    assert!(user.is_refused(&["5mL", "--pump", "./ph-down"]).contains("pump file ./ph-down"));
    let list = user.types(&["pumps", "list"]).out;
    assert!(list.starts_with("ph-down ") && list.contains(", id acid\nthree-roller"), "{list}");
    let listed = user.json(&["pumps", "list"]);
    assert_eq!(
        (&listed["configured"][0]["name"], &listed["configured"][0]["id"]),
        (&"ph-down".into(), &"acid".into())
    );
    assert!(
        user.types(&["pumps", "check", "ph-down"]).out.starts_with("acid (McIntyre et al., 2 rollers): ok")
    );
    assert!(user.types(&["pumps", "show", "ph-down"]).out.contains("id = \"acid\""));
    // The environment's pump comes before the configuration's.
    let output = user.command(&["5mL", "--dry-run"]).env("DOSE_PUMP", "three-roller").output().unwrap();
    assert!(String::from_utf8(output.stdout).unwrap().contains("three-roller: "));
}

#[test]
fn an_unknown_name_is_told_which_names_there_are() {
    let user = User::new();
    write_pump(&user, "acid.toml", "acid");
    configure(&user, "[pumps]\nacid = \"../../acid.toml\"\n");
    let message = user.is_refused(&["5mL", "--pump", "base"]);
    assert!(message.contains("there is no pump `base`; configured in"), "{message}");
    assert!(message.contains("config.toml: acid; built-in pumps: three-roller,"), "{message}");
}

#[test]
fn a_configuration_that_cannot_be_is_refused_with_the_key_and_what_is_allowed() {
    let user = User::new();
    for (text, parts) in [
        (
            "schema = \"config/1\"\npump = \"x\"",
            &["unknown field `pump`", "expected one of `schema`", "`pumps`"][..],
        ),
        ("schema = \"config/2\"", &["schema is `config/2`; allowed: config/1"]),
        ("", &["missing field `schema`"]),
        (
            "schema = \"config/1\"\ndefault_pump = \"acid\"",
            &["default_pump is `acid`", "allowed:", "three-roller"],
        ),
        (
            "schema = \"config/1\"\n[pumps]\n\"pH down\" = \"x.toml\"",
            &["`pH down`", "1 to 64 of a-z, 0-9, - and _"],
        ),
        ("schema = \"config/1\"\n[pumps]\nthree-roller = \"x.toml\"", &["`three-roller`", "built-in pump"]),
        (
            "schema = \"config/1\"\n[pumps]\nacid = \"~/acid.toml\"",
            &["`~/acid.toml`", "relative to the configuration"],
        ),
        ("schema = \"config/1\"\nstate_dir = \"\"", &["state_dir is ``"]),
        ("schema = \"config/1\"\n[pumps]\nacid = 3", &["invalid type: integer"]),
        (
            "schema = \"config/1\"\n[defaults]\nspeed = \"60rpm\"",
            &["unknown field `speed`", "`rate`", "`max_per_day`"],
        ),
        (
            "schema = \"config/1\"\n[defaults]\nrate = \"5mL\"",
            &["[defaults] rate is `5mL`; allowed: ", "mL/s"],
        ),
        (
            "schema = \"config/1\"\n[defaults]\nramps = \"slow\"",
            &["[defaults] ramps is `slow`; allowed: ", "line"],
        ),
        ("schema = \"config/1\"\n[defaults]\nmax_per_day = 50", &["invalid type: integer"]),
        ("]", &["line 1, column 1"]),
    ] {
        fs::write(user.path("config.toml"), text).unwrap();
        let message = user.is_refused(&["5mL", "--config", "config.toml"]);
        assert!(message.contains("configuration config.toml: "), "{text}: {message}");
        parts.iter().for_each(|part| assert!(message.contains(part), "{text}: {part}: {message}"));
    }
    let message = user.is_refused(&["5mL", "--config", "none.toml"]);
    assert!(message.contains("cannot read the configuration none.toml: No such file"), "{message}");
    assert!(user.is_refused(&["5mL", "--config", ""]).contains("--config"));
    let output =
        user.command(&["5mL", "--format", "json"]).env("DOSE_CONFIG", "config.toml").output().unwrap();
    let error: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!((&error["kind"], &error["code"]), (&"config".into(), &2.into()));
}

#[test]
fn the_options_of_a_dose_that_a_laboratory_sets_once_hold_where_none_is_typed() {
    let user = User::new();
    let rate = |words: &[&str]| {
        let dose = user.json(&[&["20mL", "--dry-run"], words].concat());
        (number(&dose, "cruise_flow_ml_s"), number(&dose, "motion_s"))
    };
    let usual = rate(&[]);
    configure(
        &user,
        "[defaults]\nrate = \"2mL/s\"\nramps = \"fastest\"\nmax_per_day = \"50mL\"\nunfinished = \"accept\"\n",
    );
    assert!((rate(&[]).0 - 2.0).abs() < 1e-9 && usual.0 == 5.0, "{:?} {usual:?}", rate(&[]));
    // The fastest ramps take less time than those that leave the line at rest.
    let fastest = rate(&["--rate", "5mL/s"]);
    assert!(fastest.0 == 5.0 && fastest.1 < usual.1, "{fastest:?} {usual:?}");
    // A typed option wins: a rate, its ramps, and a speed or a time in place of the rate.
    assert_eq!(rate(&["--rate", "5mL/s", "--ramps", "line"]), usual);
    assert!(rate(&["--speed", "60rpm"]).0 > 20.0 && rate(&["--within", "30s"]).0 < 1.0);
    assert_eq!(user.types(&["49mL", "--max-per-day", "60mL"]).code, 0);
    let beyond = user.types(&["2mL"]);
    assert!(beyond.code == 5 && beyond.err.contains("50"), "{}", beyond.err);
    // Other commands have their own words.
    assert_eq!(user.types(&["simulate", "--speed", "60rpm", "--duration", "1s"]).code, 0);
    let shown = user.types(&["config", "show"]).out;
    let said = "defaults       --rate 2mL/s --ramps fastest --max-per-day 50mL --unfinished accept\n";
    assert!(shown.contains(said), "{shown}");
    let defaults = &user.json(&["config", "show"])["defaults"];
    assert_eq!((&defaults["rate"], &defaults["finish"]), (&"2mL/s".into(), &serde_json::Value::Null));
}

#[test]
fn two_names_with_one_id_are_refused_when_one_is_used() {
    let user = User::new();
    write_pump(&user, "one.toml", "acid");
    write_pump(&user, "two.toml", "acid");
    write_pump(&user, "three.toml", "base");
    configure(
        &user,
        "[pumps]\none = \"../../one.toml\"\ntwo = \"../../two.toml\"\nthree = \"../../three.toml\"\n\
         again = \"../../three.toml\"\nmissing = \"none.toml\"\n",
    );
    let message = user.is_refused(&["5mL", "--pump", "one"]);
    assert!(
        message.contains("`one`") && message.contains("`two`") && message.contains("one id, `acid`"),
        "{message}"
    );
    assert!(message.contains("give one of the files another [pump] id"), "{message}");
    assert!(user.is_refused(&["5mL", "--pump", "three"]).contains("keep one of the names"));
    // A path names the file alone, and so does a pump that is built in.
    assert_eq!(user.json(&["5mL", "--dry-run", "--pump", "one.toml"])["pump"], "acid");
    assert_eq!(user.types(&["5mL", "--dry-run"]).code, 0);
    let shown = user.json(&["config", "show"]);
    let errors: Vec<bool> =
        shown["pumps"].as_array().unwrap().iter().map(|pump| !pump["error"].is_null()).collect();
    assert_eq!(errors, [true; 5]);
}

#[test]
fn the_configuration_is_shown_and_its_place_is_told() {
    let user = User::new();
    let place = user.path("config/pump-dose/config.toml");
    assert_eq!(user.types(&["config", "path"]).out, format!("{}\n", place.display()));
    let shown = user.types(&["config", "show"]).out;
    assert!(shown.contains("(no file is there)") && shown.contains("default pump   three-roller"), "{shown}");
    assert_eq!(user.json(&["config", "path"])["exists"], false);
    write_pump(&user, "acid.toml", "acid");
    configure(&user, "state_dir = \"/var/lib/pump-dose\"\n[pumps]\nph-down = \"../../acid.toml\"\n");
    let shown = user.json(&["config", "show"]);
    assert_eq!((&shown["schema"], &shown["exists"]), (&"config/1".into(), &true.into()));
    assert_eq!(shown["path"], place.to_str().unwrap());
    assert_eq!((&shown["pumps"][0]["name"], &shown["pumps"][0]["id"]), (&"ph-down".into(), &"acid".into()));
    // The environment's folder counts before the configuration's.
    assert_eq!(shown["state_dir"], user.path("state").to_str().unwrap());
    let output = user.command(&["config", "show"]).env_remove("DOSE_STATE_DIR").output().unwrap();
    assert!(String::from_utf8(output.stdout).unwrap().contains("records        /var/lib/pump-dose\n"));
    // A file that cannot be used still has a place.
    fs::write(&place, "]").unwrap();
    assert_eq!(user.types(&["config", "path"]).out, format!("{}\n", place.display()));
    assert!(user.is_refused(&["config", "show"]).contains("line 1, column 1"));
}

#[test]
fn another_users_cron_finds_the_same_record_when_told() {
    let user = User::new();
    write_pump(&user, "acid.toml", "acid");
    configure(
        &user,
        "state_dir = \"../../records\"\ndefault_pump = \"acid\"\n[pumps]\nacid = \"../../acid.toml\"\n",
    );
    let place = user.path("config/pump-dose/config.toml");
    let at = |words: &[&str], home: &str| {
        let mut command = user.command(words);
        command.env_remove("DOSE_STATE_DIR").env_remove("XDG_CONFIG_HOME").env_remove("XDG_STATE_HOME");
        command.env("HOME", user.path(home)).env("DOSE_CONFIG", &place).current_dir("/");
        command.output().unwrap()
    };
    let own = at(&["5.0001mL"], "anna");
    assert!(own.status.success(), "{own:?}");
    assert!(user.path("records/acid/sim/journal.jsonl").exists());
    let crons = at(&["status", "--format", "json"], "root");
    let status: serde_json::Value = serde_json::from_slice(&crons.stdout).unwrap();
    assert!(status["carry_ul"].as_f64().or(status["carry_ml"].as_f64()).unwrap() != 0.0, "{status}");
    assert!(!user.path("root").exists() && !user.path("anna").exists());
}

#[test]
fn every_named_pump_has_a_row_also_one_whose_file_is_broken() {
    let user = User::new();
    assert!(user.is_refused(&["status", "--all"]).contains("the configuration names no pumps"));
    write_pump(&user, "acid.toml", "acid");
    write_pump(&user, "base.toml", "base");
    fs::write(user.path("broken.toml"), "schema = \"pump/1\"\n").unwrap();
    let pumps = ["acid", "base", "broken"].map(|name| format!("{name} = \"../../{name}.toml\"\n")).concat();
    configure(&user, &format!("[pumps]\n{pumps}"));
    user.types(&["7mL", "--pump", "base"]);
    let told = user.types(&["status", "--all", "--format", "json"]);
    assert_eq!(told.code, 2, "{}", told.err);
    assert!(told.err.contains("1 of 3 pumps cannot be read: broken"), "{}", told.err);
    let rows: Vec<serde_json::Value> =
        told.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let names: Vec<&str> = rows.iter().map(|row| row["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["acid", "base", "broken"]);
    assert_eq!(
        (&rows[0]["status"]["recorded"], &rows[1]["status"]["recorded"]),
        (&false.into(), &true.into())
    );
    assert_eq!(rows[1]["status"], user.json(&["status", "--pump", "base"]));
    assert!(
        rows[2]["status"].is_null() && rows[2]["error"].as_str().unwrap().contains("broken.toml"),
        "{}",
        rows[2]
    );
    let text = user.types(&["status", "--all"]).out;
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].starts_with("acid    nothing on record; at 0.00° (sim)"), "{text}");
    assert!(lines[1].starts_with("base    ready; at ") && lines[1].contains("tube 7.0 mL"), "{text}");
    assert!(lines[2].starts_with("broken  cannot be read: ") && lines.len() == 3, "{text}");
    let limits = user.types(&["safety", "--all"]);
    let lines: Vec<&str> = limits.out.lines().collect();
    assert_eq!((limits.code, lines.len()), (2, 3), "{}", limits.out);
    assert!(
        lines[1].starts_with("base    no limit of 24 h: 6.998") && lines[1].ends_with("(sim)"),
        "{}",
        limits.out
    );
    assert!(
        user.types(&["safety", "--pump", "base"]).out.starts_with("base (sim)\nno limit of 24 h"),
        "its name"
    );
}

/// The command without a terminal and without a folder of the record that anybody names, as cron runs it.
fn by_cron(user: &User, home: &str, words: &[&str]) -> (i32, String) {
    let mut command = user.command(words);
    command.env_remove("DOSE_STATE_DIR").env_remove("XDG_STATE_HOME").env("HOME", user.path(home));
    let output = command.stdin(std::process::Stdio::null()).output().unwrap();
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_dose_by_cron_in_another_home_does_not_begin_another_record_in_silence() {
    let user = User::new();
    write_pump(&user, "acid.toml", "acid");
    configure(&user, "[pumps]\nacid = \"../../acid.toml\"\n");
    let (code, told) = by_cron(&user, "root", &["1mL", "--pump", "acid"]);
    let folder = user.path("root/.local/state/pump-dose");
    assert_eq!(code, 0, "a simulated motor only warns: {told}");
    for said in ["nothing is on record of acid in", folder.to_str().unwrap(), "--state-dir", "state_dir in"] {
        assert!(told.contains(said), "{said}: {told}");
    }
    let (code, told) = by_cron(&user, "root", &["1mL", "--pump", "acid"]);
    assert_eq!((code, told.as_str()), (0, ""), "the record is there now");
    let real = ["1mL", "--pump", "acid", "--driver", "grbl", "--port", "/dev/null"];
    let (code, told) = by_cron(&user, "cron", &real);
    assert!(code == 2 && told.contains("nothing is on record of acid"), "{told}");
    assert!(!user.path("cron").exists(), "nothing was begun");
    // A folder that somebody names may be new.
    let named = [&real[..], &["--state-dir", "new"]].concat();
    assert!(!by_cron(&user, "cron", &named).1.contains("nothing is on record of acid"));
    configure(&user, "state_dir = \"../../other\"\n[pumps]\nacid = \"../../acid.toml\"\n");
    assert_eq!(by_cron(&user, "cron", &["1mL", "--pump", "acid"]), (0, String::new()));
}

#[test]
fn a_pump_is_removed_with_its_file_and_its_record_stays() {
    let user = User::new();
    fs::create_dir_all(user.path("config/pump-dose/pumps")).unwrap();
    write_pump(&user, "config/pump-dose/pumps/acid.toml", "acid");
    write_pump(&user, "base.toml", "base");
    configure(
        &user,
        "default_pump = \"acid\"\n# mine\n[pumps]\nacid = \"pumps/acid.toml\"\nbase = \"../../base.toml\"\n",
    );
    assert_eq!(user.types(&["1mL"]).code, 0);
    let refused = user.is_refused(&["pumps", "remove", "acid"]);
    assert!(refused.contains("`acid` is the default pump") && refused.contains("--anyway"), "{refused}");
    let refused = user.is_refused(&["pumps", "remove", "three-roller"]);
    assert!(refused.contains("no pump `three-roller`; its pumps: acid, base"), "{refused}");
    let removed = user.types(&["pumps", "remove", "acid", "--anyway"]);
    assert_eq!(removed.code, 0, "{}", removed.err);
    for part in ["acid.toml is deleted", "stays in", "a bare `dose` takes three-roller now"] {
        assert!(removed.out.contains(part), "{part}: {}", removed.out);
    }
    assert!(!user.path("config/pump-dose/pumps/acid.toml").exists());
    assert!(user.path("state/acid/sim/journal.jsonl").exists());
    let config = fs::read_to_string(user.path("config/pump-dose/config.toml")).unwrap();
    assert_eq!(config, "schema = \"config/1\"\n# mine\n[pumps]\nbase = \"../../base.toml\"\n");
    // A file that lies elsewhere is its owner's.
    let removed = user.types(&["pumps", "remove", "base"]);
    assert!(removed.code == 0 && removed.out.contains("base.toml stays"), "{}", removed.out);
    assert!(user.path("base.toml").exists());
}

#[test]
fn a_pump_with_an_unfinished_dose_is_not_removed_unasked() {
    let user = User::new();
    write_pump(&user, "base.toml", "base");
    configure(&user, "[pumps]\nbase = \"../../base.toml\"\nlost = \"lost.toml\"\n");
    // A balance that never rises leaves the dose unfinished.
    let dose = ["5mL", "--pump", "base", "--until-scale", "--scale-command", "echo 1.00 g"];
    assert_eq!(user.types(&dose).code, 1);
    let refused = user.is_refused(&["pumps", "remove", "base"]);
    assert!(refused.contains("a dose of `base` is unfinished"), "{refused}");
    assert!(refused.contains("`dose resume --pump base`"), "{refused}");
    let refused = user.is_refused(&["pumps", "remove", "lost"]);
    assert!(refused.contains("nobody can tell") && refused.contains("lost.toml"), "{refused}");
    for name in ["base", "lost"] {
        assert_eq!(user.types(&["pumps", "remove", name, "--anyway"]).code, 0);
    }
    assert!(user.types(&["pumps", "list"]).out.starts_with("three-roller"));
}
