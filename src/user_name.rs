//! The login name of whoever types a command.

use std::env;
use std::process::Command;

/// Variables of the environment that have the login name.
const VARIABLES: [&str; 3] = ["LOGNAME", "USER", "USERNAME"];

/// Returns the login name, by the environment or else by the system's `whoami`. `None` where nobody knows it.
pub(crate) fn user_name() -> Option<String> {
    let is_name = |name: &String| !name.is_empty() && !name.chars().any(char::is_control);
    let of_environment = VARIABLES.iter().find_map(|name| env::var(name).ok().filter(is_name));
    of_environment.or_else(|| {
        let told = Command::new("whoami").output().ok().filter(|told| told.status.success())?;
        Some(String::from_utf8(told.stdout).ok()?.trim().to_owned()).filter(is_name)
    })
}
