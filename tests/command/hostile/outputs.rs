//! Outputs that would destroy something: an input, the record, a device.

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;

use crate::user::User;

/// A user with a pump file, tables and a record.
fn user() -> User {
    let user = User::new();
    let pump = user.types(&["pumps", "show", "three-roller"]).out.replace("three-roller", "mine");
    fs::write(user.path("mine.toml"), pump).unwrap();
    fs::write(user.path("runs.csv"), "speed_rpm,revolutions,volume_ml\n60,3,64\n60,3,64\n60,3,64\n").unwrap();
    fs::write(user.path("flow.csv"), "flow_ml_s,drop_kpa\n5,0.8\n10,1.5\n15,2.3\n20,3.0\n").unwrap();
    fs::write(user.path("points.svg"), "angle_deg,volume_ml,run\n").unwrap();
    user.json(&["1mL"]);
    symlink(user.path("mine.toml"), user.path("link.svg")).unwrap();
    fs::hard_link(user.path("mine.toml"), user.path("hard.svg")).unwrap();
    symlink(user.folder.path(), user.path("here")).unwrap();
    user
}

#[test]
fn an_output_never_replaces_an_input_however_it_is_spelled() {
    let user = user();
    let before = fs::read(user.path("mine.toml")).unwrap();
    let absolute = user.path("mine.toml").display().to_string();
    for output in ["mine.toml", "./mine.toml", "here/mine.toml", "link.svg", "hard.svg", &absolute] {
        for option in ["--steps", "--trace"] {
            let said = user.is_refused(&["1mL", "--pump", "mine.toml", option, output]);
            assert!(said.contains(output) && said.contains("is read by this command"), "{said}");
        }
        let simulate = ["simulate", "--speed", "60rpm", "--duration", "1s", "--pump", "mine.toml"];
        user.is_refused(&[&simulate[..], &["--trace", output]].concat());
    }
    user.is_refused(&["1mL", "--pump", "mine.toml", "--plot", "link.svg"]);
    user.is_refused(&["identify", "resistance", "--data", "flow.csv", "--plot", "flow.csv"]);
    for output in ["link.svg", "hard.svg"] {
        let size = ["size", "--flow", "1L/h", "--pump", "mine.toml", "--plot", output];
        for words in [&["pumps", "show", "mine.toml", "--plot", output][..], &size] {
            let said = user.is_refused(words);
            assert!(said.contains(output) && said.contains("is read by this command"), "{said}");
        }
    }
    let drawing = crate::pumps::DRAWING;
    user.is_refused(
        &[&drawing[..], &["--roller-volume-points", "points.svg", "--plot", "points.svg"]].concat(),
    );
    user.is_refused(&[&drawing[..], &["new.svg", "--plot", "new.svg"]].concat());
    assert_eq!(fs::read(user.path("mine.toml")).unwrap(), before);
    assert!(!user.path("new.svg").exists() && !user.path("state/mine").exists(), "nothing moved");
}

#[test]
fn an_output_never_replaces_the_configuration() {
    let user = user();
    let config = "schema = \"config/1\"\n[pumps]\nmine = \"mine.toml\"\n";
    fs::write(user.path("config.toml"), config).unwrap();
    fs::hard_link(user.path("config.toml"), user.path("config.svg")).unwrap();
    symlink(user.path("config.toml"), user.path("config.csv")).unwrap();
    let drawing = crate::pumps::DRAWING;
    let flow = ["--data", "flow.csv", "--plot", "config.svg"];
    for words in [
        &["1mL", "--trace", "config.csv"][..],
        &["1mL", "--steps", "config.toml"],
        &["simulate", "--speed", "60rpm", "--duration", "1s", "--trace", "config.csv"],
        &["backup", "config.csv"],
        &["pumps", "show", "mine", "--plot", "config.svg"],
        &["size", "--flow", "1L/h", "--pump", "mine", "--plot", "config.svg"],
        &[&["identify", "resistance"][..], &flow].concat(),
        &[&drawing[..], &["config.toml"]].concat(),
    ] {
        let said = user.is_refused(&[words, &["--config", "config.toml"]].concat());
        assert!(said.contains("is read by this command"), "{words:?}: {said}");
    }
    assert_eq!(fs::read_to_string(user.path("config.toml")).unwrap(), config);
}

#[test]
fn an_output_never_replaces_a_file_of_the_record() {
    let user = user();
    fs::create_dir_all(user.path("state/three-roller/sim/calibrations")).unwrap();
    fs::create_dir_all(user.path("state/node.boards")).unwrap();
    fs::write(user.path("state/node.boards/e66.json"), "").unwrap();
    // A program has a drive of its own.
    fs::create_dir_all(user.path("state/three-roller/ours")).unwrap();
    fs::write(user.path("state/three-roller/ours/journal.jsonl"), "").unwrap();
    for output in [
        "state/node.boards/e66.json",
        "state/node.boards/new.json",
        "state/three-roller/ours/new.csv",
        "state/three-roller/sim/journal.jsonl",
        "here/state/three-roller/sim/lock",
        "state/three-roller/sim/calibrations/new.csv",
        "state/three-roller/sim/../sim/new.csv",
    ] {
        for words in [
            &["1mL"][..],
            &["1mL", "--pump", "two-roller"],
            &["simulate", "--speed", "60rpm", "--duration", "1s"],
        ] {
            let said = user.is_refused(&[words, &["--trace", output]].concat());
            assert!(said.contains(output) && said.contains("record"), "{said}");
        }
    }
    user.is_refused(&["1mL", "--pump", "two-roller", "--trace", "state/two-roller/sim/journal.jsonl"]);
    // Any other place in the folder is the user's own.
    user.json(&["1mL", "--trace", "state/trace.csv"]);
}

#[test]
fn an_output_is_no_other_name_of_a_file_of_the_record() {
    let user = user();
    let runs = ["calibrate", "run", "--from", "runs.csv"];
    assert_eq!(user.types(&runs).code, 0);
    fs::create_dir_all(user.path("state/node.boards")).unwrap();
    fs::write(user.path("state/node.boards/e66.json"), "").unwrap();
    let pumps =
        ["journal.jsonl", "lock", "calibrations/1.json"].map(|name| format!("three-roller/sim/{name}"));
    for (n, of_record) in pumps.into_iter().chain(["node.boards/e66.json".to_owned()]).enumerate() {
        let (hard, soft) = (format!("hard{n}.csv"), format!("soft{n}.csv"));
        let of_record = user.path("state").join(of_record);
        fs::hard_link(&of_record, user.path(&hard)).unwrap();
        symlink(&of_record, user.path(&soft)).unwrap();
        for output in [hard, soft] {
            // Whichever pump doses, the record of any of them is kept.
            for words in [&["1mL"][..], &["1mL", "--pump", "two-roller"]] {
                for option in ["--trace", "--steps", "--plot"] {
                    let said = user.is_refused(&[words, &[option, output.as_str()]].concat());
                    assert!(said.contains(&output) && said.contains("record"), "{said}");
                }
            }
        }
    }
    // Another name of any other file is the user's own.
    fs::write(user.path("state/old.csv"), "").unwrap();
    fs::hard_link(user.path("state/old.csv"), user.path("new.csv")).unwrap();
    user.json(&["1mL", "--trace", "new.csv"]);
}

#[test]
fn an_output_is_a_plain_file_or_a_stream_of_this_process() {
    let user = user();
    assert!(Command::new("mkfifo").arg(user.path("fifo")).status().unwrap().success());
    fs::create_dir(user.path("folder.svg")).unwrap();
    for output in ["fifo", "folder.svg", "/dev/full", "/dev/tty"] {
        let said = user.is_refused(&["1mL", "--trace", output]);
        assert!(said.contains(output) && said.contains("allowed: a plain file"), "{said}");
    }
    // The name of a stream says that the user wants it there; a file behind it is named itself.
    for output in ["/dev/null", "/dev/stderr"] {
        assert_eq!(user.types(&["1mL", "--trace", output]).code, 0, "{output}");
    }
    assert!(user.types(&["1mL", "--trace", "/dev/stderr"]).err.starts_with("time_s,"));
    let report = fs::File::create(user.path("report.txt")).unwrap();
    let output = user.command(&["1mL", "--trace", "/dev/stdout"]).stdout(report).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("leads to a plain file"));
}

#[test]
fn two_outputs_are_two_files_however_they_are_spelled() {
    let user = user();
    fs::write(user.path("a.csv"), "").unwrap();
    symlink("a.csv", user.path("b.csv")).unwrap();
    for (one, other) in [("a.csv", "b.csv"), ("a.csv", "here/a.csv"), ("new", "here/new")] {
        let said = user.is_refused(&["1mL", "--steps", one, "--trace", other]);
        assert!(said.contains("two outputs"), "{said}");
    }
}
