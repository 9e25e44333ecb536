//! The files of a pump's record: links, and folders that others own.

#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::process::Command;

use crate::user::User;

const RECORD: &str = "state/three-roller/sim";

#[test]
fn links_in_the_record_are_refused_by_name_and_a_linked_state_folder_is_used() {
    for name in ["journal.jsonl", "lock", "calibrations", "calibrations/1.json", "calibrations/active"] {
        let user = User::new();
        fs::write(user.path("runs.csv"), "speed_rpm,revolutions,volume_ml\n60,3,64\n60,3,64\n60,3,64\n")
            .unwrap();
        assert_eq!(user.types(&["calibrate", "run", "--from", "runs.csv"]).code, 0);
        user.json(&["1mL"]);
        let (path, other) = (user.path(RECORD).join(name), user.path("other"));
        if path.exists() {
            fs::rename(&path, &other).unwrap();
        } else {
            fs::create_dir(&other).unwrap();
        }
        symlink(&other, &path).unwrap();
        let message = user.is_refused(&["1mL"]);
        assert!(message.contains(name) && message.contains("it is a link"), "{message}");
        assert!(!message.contains("make room"), "{message}");
    }
    // A log that is no plain file costs no dose: the journal has its entries.
    let user = User::new();
    user.json(&["1mL"]);
    let (log, other) = (user.path(RECORD).join("log.jsonl"), user.path("other"));
    fs::rename(&log, &other).unwrap();
    symlink(&other, &log).unwrap();
    let before = fs::read(&other).unwrap();
    let dosed = user.types(&["1mL"]);
    let said = dosed.out + &dosed.err;
    assert!(dosed.code == 0 && said.contains("it is a link"), "{said}");
    assert_eq!(fs::read(&other).unwrap(), before);
    // The folders of a pump and of a driver are the record's own.
    for name in ["three-roller", "three-roller/sim"] {
        let user = User::new();
        user.json(&["1mL"]);
        let (path, other) = (user.path("state").join(name), user.path("other"));
        fs::rename(&path, &other).unwrap();
        symlink(&other, &path).unwrap();
        let before =
            fs::read(other.join(if name.contains('/') { "journal.jsonl" } else { "sim/journal.jsonl" }));
        let message = user.is_refused(&["1mL"]);
        assert!(message.contains(name) && message.contains("it is a link"), "{message}");
        let after =
            fs::read(other.join(if name.contains('/') { "journal.jsonl" } else { "sim/journal.jsonl" }));
        assert_eq!(before.unwrap(), after.unwrap());
    }
    let user = User::new();
    fs::create_dir(user.path("elsewhere")).unwrap();
    symlink(user.path("elsewhere"), user.path("state")).unwrap();
    user.json(&["1mL"]);
    assert!(user.path("elsewhere/three-roller/sim/journal.jsonl").exists());
}

#[test]
fn an_emptied_journal_is_damage_and_no_fresh_pump() {
    for bytes in [vec![], vec![0; 500]] {
        let user = User::new();
        user.json(&["1mL"]);
        fs::write(user.path(RECORD).join("journal.jsonl"), bytes).unwrap();
        let message = user.is_refused(&["1mL"]);
        assert!(message.contains("is damaged") && message.contains("home --set"), "{message}");
        assert_eq!(user.types(&["home", "--set", "30deg"]).code, 0);
        user.json(&["1mL"]);
    }
}

#[test]
fn a_folder_above_the_record_need_not_be_readable() {
    let user = User::new();
    let mode =
        |path: &str, mode: u32| fs::set_permissions(user.path(path), Permissions::from_mode(mode)).unwrap();
    fs::create_dir_all(user.path("home/state")).unwrap();
    fs::copy(env!("CARGO_BIN_EXE_dose"), user.path("dose")).unwrap();
    // A folder that its owner too may only pass through.
    mode("", 0o755);
    mode("home/state", 0o777);
    mode("home", 0o311);
    let id = Command::new("id").arg("-u").output().unwrap();
    let is_root = id.stdout == b"0\n";
    // No folder is closed to root, so the command runs as somebody else.
    let mut command = Command::new(if is_root { "setpriv".into() } else { user.path("dose") });
    if is_root {
        command.args(["--reuid=65534", "--regid=65534", "--clear-groups"]).arg(user.path("dose"));
    }
    command.args(["1mL", "--state-dir"]).arg(user.path("home/state")).env_remove("DOSE_PUMP");
    let output = command.output().unwrap();
    mode("home", 0o755);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(user.path("home/state/three-roller/sim/journal.jsonl").exists());
}
