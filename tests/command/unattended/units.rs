//! The systemd units of docs/unattended.md, by systemd's own check.
#![allow(clippy::print_stderr, reason = "a test that is skipped says why")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::user::User;

/// Page with the units.
const PAGE: &str = include_str!("../../../docs/unattended.md");

/// Variable that makes a machine without systemd-analyze a failure.
const NEEDED: &str = "SYSTEMD_NEEDED";

/// Returns the units of the page, each with its name and its text.
fn units() -> Vec<(&'static str, &'static str)> {
    let blocks = PAGE.split("```ini\n# /etc/systemd/system/").skip(1);
    blocks.map(|block| block.split_once("```").unwrap().0.split_once('\n').unwrap()).collect()
}

/// Returns what systemd says against a unit. Nothing if it is in order.
fn complaints(unit: &Path) -> String {
    let output = Command::new("systemd-analyze").arg("verify").arg(unit).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() || !said.is_empty(), "{output:?}");
    said
}

#[test]
fn systemd_takes_the_units_of_the_page_and_the_command_takes_their_words() {
    let units = units();
    let names: Vec<&str> = units.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["ph-down.service", "ph-down.timer"]);
    let user = User::new();
    let (_, service) = units[0];
    let line = service.lines().find_map(|line| line.strip_prefix("ExecStart=")).unwrap();
    let words = line.strip_prefix("/usr/local/bin/dose ").unwrap().replace("ph-down", "three-roller");
    // The shell parts the words at quotes as systemd does.
    let script = format!("exec \"$0\" {words} --dry-run");
    let mut shell = Command::new("sh");
    shell.args(["-c", &script, env!("CARGO_BIN_EXE_dose")]).env_remove("DOSE_PUMP").env_remove("DOSE_CONFIG");
    shell.envs(user.command(&[]).get_envs().filter_map(|(name, value)| Some((name, value?))));
    let ran = shell.output().unwrap();
    assert!(ran.status.success(), "{ran:?}");

    let has = Command::new("systemd-analyze").arg("--version").stdout(Stdio::null()).status();
    if has.is_err() {
        assert!(std::env::var_os(NEEDED).is_none(), "this machine has no systemd, and {NEEDED} asks for it");
        eprintln!("skipped: this machine has no systemd-analyze; {NEEDED}=1 makes that a failure");
        return;
    }
    let write = |name: &str, text: &str| {
        let text = text.replace("/usr/local/bin/dose", env!("CARGO_BIN_EXE_dose"));
        fs::write(user.path(name), text).unwrap();
    };
    units.iter().for_each(|(name, text)| write(name, text));
    for name in &names {
        assert_eq!(complaints(&user.path(name)), "", "{name}");
    }
    // The check sees a word that systemd does not know.
    write(names[1], &units[1].1.replace("Persistent", "Persistant"));
    assert!(complaints(&user.path(names[1])).contains("Persistant"));
}
