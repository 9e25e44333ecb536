//! Inputs that are no plain file, or far too large.

use std::fs::File;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::user::User;

/// The commands that read a file, without its name.
fn readers() -> Vec<Vec<&'static str>> {
    vec![
        vec!["1mL", "--pump"],
        vec!["pumps", "check"],
        vec!["pumps", "show"],
        vec!["calibrate", "run", "--from"],
        vec!["calibrate", "phase", "--from"],
        vec!["calibrate", "verify", "--volume", "10mL", "--from"],
        vec!["identify", "resistance", "--data"],
        vec!["identify", "line", "--speed", "60rpm", "--data"],
        [&crate::pumps::DRAWING[..], &["--roller-volume-points"]].concat(),
    ]
}

/// Runs a command that must end by itself soon, with little memory and 10 s of the processor. Returns its exit code
/// and message.
fn ends(user: &User, arguments: &[&str]) -> (i32, String) {
    let script = "ulimit -v 1000000; ulimit -t 10; exec \"$0\" \"$@\"";
    let mut command = user.command(arguments);
    let program = command.get_program().to_owned();
    let mut limited = Command::new("sh");
    limited.args(["-c", script]).arg(program).args(arguments).current_dir(user.folder.path());
    limited.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    let _ = command.stdin(Stdio::null());
    let mut child =
        limited.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(120);
    while child.try_wait().unwrap().is_none() {
        if Instant::now() > deadline {
            child.kill().unwrap();
            panic!("{arguments:?} does not end");
        }
        sleep(Duration::from_millis(2));
    }
    let output = child.wait_with_output().unwrap();
    (output.status.code().unwrap_or(-1), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn only_plain_files_of_a_sane_size_are_read() {
    let user = User::new();
    assert!(Command::new("mkfifo").arg(user.path("fifo")).status().unwrap().success());
    File::create(user.path("huge")).unwrap().set_len(10_000_000_000).unwrap();
    for command in readers() {
        for (file, why) in [
            ("/dev/zero", "only plain files are read"),
            ("./fifo", "only plain files are read"),
            ("./huge", "it has 10000000000 bytes; allowed: "),
            ("./", "Is a directory"),
        ] {
            let arguments = [&command[..], &[file]].concat();
            let (code, said) = ends(&user, &arguments);
            assert_eq!(code, 2, "{arguments:?}: {said}");
            assert!(said.contains(file) && said.contains(why), "{arguments:?}: {said}");
        }
    }
    assert!(user.record().is_none());
}
