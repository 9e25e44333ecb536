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
fn a_log_whose_journal_was_lost_is_not_turned_back() {
    let user = User::new();
    user.types(&["5mL"]);
    user.types(&["3mL"]);
    assert_eq!(user.types(&["backup", "two.backup"]).code, 0);
    user.types(&["1mL"]);
    assert_eq!(user.types(&["backup", "three.backup"]).code, 0);
    fs::remove_file(user.path("state/three-roller/sim/journal.jsonl")).unwrap();
    let before = files(&user.path("state"));
    let message = user.is_refused(&["restore", "two.backup"]);
    assert!(message.contains("the record stands at dose 3 of the log, without a journal"), "{message}");
    assert!(message.contains("dose 2"), "{message}");
    assert_eq!(files(&user.path("state")), before);
    assert_eq!(user.types(&["restore", "three.backup"]).code, 0);
    assert_eq!(user.types(&["log", "--format", "csv"]).out.lines().count(), 4, "a head and three doses");
}

#[test]
fn a_backup_replaces_a_backup_alone_and_never_lies_among_the_records() {
    let user = User::new();
    user.types(&["5mL"]);
    fs::write(user.path("mix.toml"), "schema = \"rack/1\"\n").unwrap();
    let message = user.is_refused(&["backup", "mix.toml"]);
    assert!(message.contains("there is a file that is no backup"), "{message}");
    assert_eq!(fs::read_to_string(user.path("mix.toml")).unwrap(), "schema = \"rack/1\"\n");
    for inside in ["state/all.backup", "state/three-roller/all.backup"] {
        let message = user.is_refused(&["backup", inside]);
        assert!(message.contains("it would lie in the folder of the records"), "{message}");
    }
    for _ in 0..2 {
        assert_eq!(user.types(&["backup", "all.backup"]).code, 0);
    }
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

/// Files of a folder by their names within it.
fn named(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let within = |(path, bytes): (PathBuf, Vec<u8>)| (path.strip_prefix(folder).unwrap().to_owned(), bytes);
    files(folder).into_iter().map(within).collect()
}

/// Puts the old records back in place, alone.
fn reset(user: &User, old: &BTreeMap<PathBuf, Vec<u8>>) {
    for entry in fs::read_dir(user.folder.path()).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            fs::remove_dir_all(path).unwrap();
        }
    }
    for (name, bytes) in old {
        let path = user.path("state").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_restore_that_is_killed_at_any_write_leaves_the_old_records_or_the_new_ones_whole() {
    use std::process::{Command, Stdio};
    use std::thread::sleep;
    use std::time::{Duration, Instant};

    let user = User::new();
    user.types(&["5mL"]);
    user.types(&["1mL", "--pump", "two-roller"]);
    let old = named(&user.path("state"));
    user.types(&["5mL"]);
    user.types(&["3mL"]);
    user.types(&["backup", "new.backup"]);
    let new = named(&user.path("state"));
    assert_ne!(old, new);
    let (mut olds, mut news) = (0, 0);
    let mut check = |how: &str| {
        let found = named(&user.path("state"));
        assert!(found == old || found == new, "{how}: {:?}", found.keys());
        if found == old {
            olds += 1;
        } else {
            news += 1;
        }
        // The records go on as if nothing had been.
        assert_eq!(user.types(&["status"]).code, 0, "{how}");
        reset(&user, &old);
    };
    reset(&user, &old);
    // A process cannot write beyond a limit of file size. Each length of a file, and one byte less, is a limit, so that
    // each write is one that fails.
    let lengths =
        new.values().map(|bytes| bytes.len() as u64).flat_map(|length| [length.saturating_sub(1), length]);
    let mut limits: Vec<u64> = lengths.chain([0, 1, 100]).collect();
    limits.sort_unstable();
    limits.dedup();
    for limit in limits {
        let command = user.command(&["restore", "new.backup"]);
        let mut limited = Command::new("bash");
        let script = "ulimit -c 0; prlimit --fsize=$0 --pid $$; exec \"$@\"";
        limited.args(["-c", script, &limit.to_string()]).arg(command.get_program()).args(command.get_args());
        limited.current_dir(user.folder.path()).env_remove("DOSE_PUMP").env_remove("DOSE_CONFIG");
        limited.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
        let ended = limited.stdout(Stdio::null()).stderr(Stdio::null()).status().unwrap();
        assert!([Some(0), Some(2)].contains(&ended.code()), "{limit} bytes: {ended}");
        check(&format!("a write beyond {limit} bytes"));
    }
    // Syncs and renames are met by kills over the time that a whole restore takes.
    let began = Instant::now();
    assert_eq!(user.types(&["restore", "new.backup"]).code, 0);
    let whole = began.elapsed();
    check("a whole restore");
    const KILLS: u32 = 60;
    for kill in 0..KILLS {
        let mut child = user.command(&["restore", "new.backup"]);
        let mut child = child.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        sleep(whole.mul_f64(1.2 * f64::from(kill) / f64::from(KILLS)).max(Duration::from_micros(50)));
        child.kill().unwrap();
        child.wait().unwrap();
        check(&format!("kill {kill}"));
    }
    assert!(olds > 10 && news > 0, "{olds} found the old records, {news} the new ones");
}
