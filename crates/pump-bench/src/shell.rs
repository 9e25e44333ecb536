//! A command of the user that the system's shell runs, and its end.

use std::process::{Child, Command};

/// Returns the shell with a command, in a group of its own, so that what it starts can be ended with it.
pub fn shell_command(command: &str) -> Command {
    let (shell, flag) = if cfg!(windows) { ("cmd", "/C") } else { ("sh", "-c") };
    let mut shell = Command::new(shell);
    shell.args([flag, command]);
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut shell, 0);
    shell
}

/// Asks a process that this one has started, and has not waited for yet, to end: SIGTERM. Windows has no such signal.
pub fn ask_to_end(process: u32) {
    #[cfg(unix)]
    if let Some(process) = i32::try_from(process).ok().and_then(rustix::process::Pid::from_raw) {
        // One that has ended meanwhile hears nothing.
        let _ = rustix::process::kill_process(process, rustix::process::Signal::TERM);
    }
    #[cfg(not(unix))]
    let _ = process;
}

/// Ends a command of [`shell_command`] and all that it has started in its group: they are this process's own.
pub fn end_with_its_group(child: &mut Child) {
    #[cfg(unix)]
    if let Some(group) = i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
    let _ = child.kill().and_then(|()| child.wait().map(drop));
}
