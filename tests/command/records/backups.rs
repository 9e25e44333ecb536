//! `dose backup` and `dose restore`: records come back whole, and never turn back.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::user::User;

/// Reads all files under a folder but locks.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().is_some_and(|name| name != "lock") {
                found.insert(path.clone(), fs::read(&path).unwrap());
            }
        }
    }
    found
}

#[test]
fn records_come_back_to_the_last_byte_and_doses_go_on() {
    let user = User::new();
    for arguments in [&["5mL"][..], &["3mL", "--pump", "two-roller"], &["1mL"]] {
        assert_eq!(user.types(arguments).code, 0);
    }
    let state = user.path("state");
    let before = files(&state);
    let status = user.json(&["status"]);
    assert_eq!(user.types(&["backup", "all.backup"]).code, 0);
    fs::remove_dir_all(&state).unwrap();
    let answer = user.types(&["restore", "all.backup"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert_eq!(files(&state), before);
    assert_eq!(user.json(&["status"]), status);
    assert_eq!(user.types(&["2mL"]).code, 0);
    // The backup is older now, by one dose.
    let after = files(&state);
    let message = user.is_refused(&["restore", "all.backup"]);
    assert!(message.contains("turn the record of three-roller/sim back"), "{message}");
    assert!(message.contains("dose 3") && message.contains("dose 2"), "both positions: {message}");
    assert_eq!(files(&state), after);
}

#[test]
fn an_older_record_goes_on_and_a_pump_that_the_backup_lacks_stays() {
    let user = User::new();
    user.types(&["5mL"]);
    user.types(&["backup", "old.backup"]);
    user.types(&["5mL"]);
    user.types(&["backup", "new.backup"]);
    let newest = user.record();
    fs::remove_dir_all(user.path("state")).unwrap();
    assert_eq!(user.types(&["restore", "old.backup"]).code, 0);
    user.types(&["1mL", "--pump", "two-roller"]);
    let answer = user.types(&["restore", "new.backup"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert_eq!(user.record(), newest);
    assert!(user.path("state/two-roller/sim/journal.jsonl").exists());
    assert!(user.path("state.before-restore-1/three-roller/sim/journal.jsonl").exists());
}

#[test]
fn another_history_of_the_same_length_is_refused() {
    let user = User::new();
    user.types(&["5mL"]);
    user.types(&["backup", "one.backup"]);
    fs::remove_dir_all(user.path("state")).unwrap();
    user.types(&["4mL"]);
    let text = user.record().unwrap();
    let own: Vec<&str> = text.split_inclusive('\n').collect();
    // As long as the record of the backup, or shorter.
    fs::write(user.path("state/three-roller/sim/journal.jsonl"), own[..2].concat()).unwrap();
    let message = user.is_refused(&["restore", "one.backup"]);
    assert!(message.contains("another history of three-roller/sim"), "{message}");
}

#[test]
fn a_backup_that_is_cut_or_changed_anywhere_is_refused_and_changes_nothing() {
    let user = User::new();
    user.types(&["1mL"]);
    user.types(&["backup", "all.backup"]);
    let whole = fs::read(user.path("all.backup")).unwrap();
    fs::remove_dir_all(user.path("state")).unwrap();
    let step = whole.len() / 12;
    for at in (0..whole.len()).step_by(step) {
        fs::write(user.path("cut.backup"), &whole[..at]).unwrap();
        let message = user.is_refused(&["restore", "cut.backup"]);
        assert!(message.contains("is no whole backup"), "{at}: {message}");
        let mut changed = whole.clone();
        changed[at] ^= 1;
        fs::write(user.path("changed.backup"), &changed).unwrap();
        user.is_refused(&["restore", "changed.backup"]);
    }
    let left: Vec<_> =
        fs::read_dir(user.folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().starts_with(".dose-")), "no litter: {left:?}");
    // A path that leads out of the folder is refused.
    let text = String::from_utf8(whole).unwrap().replacen("three-roller/sim/", "../three-roller/", 1);
    fs::write(user.path("out.backup"), text).unwrap();
    assert!(
        user.is_refused(&["restore", "out.backup"]).contains("no path within"),
        "a path out of the folder"
    );
}
