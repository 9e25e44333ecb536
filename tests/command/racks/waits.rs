//! Two commands on one pump: the second one waits, says for whom, and hears Ctrl-C.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStderr, Command, Stdio};

use pump_bench::{Bench, built_in};

use crate::user::User;

/// A command that waits for the pump, once it has said so.
fn waiting(user: &User, words: &[&str]) -> (Child, BufReader<ChildStderr>) {
    let mut command = user.command(words);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let expected = format!("waiting for pump `three-roller`, in use by process {}, ", std::process::id());
    assert!(line.starts_with(&expected) && line.ends_with(" s at most\n"), "{line}");
    (child, said)
}

fn bench(user: &User) -> Bench {
    Bench::new(built_in("three-roller").unwrap(), None, &user.path("state")).unwrap()
}

#[test]
fn a_dose_waits_for_a_pump_that_another_command_has_and_then_runs() {
    let user = User::new();
    let bench = bench(&user);
    let session = bench.session().unwrap();
    assert_eq!(user.types(&["5mL"]).code, 3, "at once without --wait");
    let late = user.types(&["5mL", "--wait", "50ms"]);
    assert!(
        late.code == 3 && late.err.contains("error: pump `three-roller` is in use by process"),
        "{}",
        late.err
    );
    let (child, _) = waiting(&user, &["5mL", "--wait", "600s"]);
    drop(session);
    let output = child.wait_with_output().unwrap();
    let out = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && out.contains("mL delivered, 5 mL requested"), "{out}");
}

#[cfg(unix)]
#[test]
fn a_wait_hears_ctrl_c_and_nothing_moves() {
    let user = User::new();
    let bench = bench(&user);
    let _session = bench.session().unwrap();
    let (child, mut said) = waiting(&user, &["5mL", "--wait", "600s", "--format", "json"]);
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-s", "INT", &id]).status().unwrap().success());
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    let mut error = String::new();
    said.read_to_string(&mut error).unwrap();
    let error: serde_json::Value = serde_json::from_str(&error).unwrap();
    assert_eq!((&error["kind"], &error["moved"]), (&"stopped".into(), &false.into()));
}
