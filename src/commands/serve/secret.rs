//! Tokens and passwords in files of their own.

use std::fs;
use std::path::Path;

use crate::failure::Failure;
#[cfg(unix)]
use crate::terminal::warn;

/// The token or the password of a file: its first line.
pub(crate) fn read(what: &str, path: &Path) -> Result<String, Failure> {
    let text = fs::read_to_string(path).map_err(|error| Failure::unread(path, &error))?;
    warn_of_readers(what, path);
    Ok(text.lines().next().unwrap_or_default().trim().to_owned())
}

/// Warns of a secret that other users can read.
#[cfg(unix)]
fn warn_of_readers(what: &str, path: &Path) {
    use std::os::unix::fs::PermissionsExt;
    if path.metadata().is_ok_and(|file| file.permissions().mode() & 0o077 != 0) {
        let path = path.display();
        warn(&[format!("other users of this computer can read the {what}; `chmod 600 {path}` keeps it")]);
    }
}

#[cfg(not(unix))]
fn warn_of_readers(_: &str, _: &Path) {}
