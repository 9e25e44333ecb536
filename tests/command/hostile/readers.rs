//! Readers that go away.

use std::io::Read;
use std::process::Stdio;

use crate::user::User;

#[test]
fn a_batch_ends_after_the_dose_under_way_when_nobody_reads_its_reports() {
    let user = User::new();
    let mut child = user
        .command(&["1mL", "--repeat", "1000", "--every", "10ms", "--missed", "now", "--format", "json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut out = child.stdout.take().unwrap();
    let mut first = [0; 1];
    out.read_exact(&mut first).unwrap();
    drop(out);
    let output = child.wait_with_output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("nobody reads") && message.contains("of 1000 doses"), "{message}");
    let doses = user.record().unwrap().matches("\"purpose\":\"dose\"").count();
    assert!((1..100).contains(&doses), "{doses} doses were made");
    let status = user.json(&["status"]);
    assert!(status["unfinished"].is_null(), "{status}");
    // A single dose whose reader went away is done.
    let child = user.command(&["1mL"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(0));
}
