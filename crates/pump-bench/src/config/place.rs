//! The place of the configuration file.

use std::path::PathBuf;

/// Variable of the environment that names the configuration file.
const VARIABLE: &str = "DOSE_CONFIG";

/// Returns the path of the configuration file: that of the environment variable `DOSE_CONFIG`, or else the usual
/// place. `None` if the environment names neither.
pub fn config_path() -> Option<PathBuf> {
    named_path().or_else(default_path)
}

/// Returns the configuration file that the environment variable `DOSE_CONFIG` names, if it names one.
pub(super) fn named_path() -> Option<PathBuf> {
    set(VARIABLE)
}

/// Returns the usual place of the configuration file: `pump-dose/config.toml` in the platform's folder. `None` if the
/// environment names no such folder.
///
/// The folder is `$XDG_CONFIG_HOME`, otherwise `~/.config` (XDG Base Directory 0.8), `~/Library/Application Support` on
/// macOS (Apple, File System Programming Guide) and `%APPDATA%` on Windows (FOLDERID_RoamingAppData). A relative
/// XDG_CONFIG_HOME is ignored, as its specification asks for.
pub(super) fn default_path() -> Option<PathBuf> {
    let home = || set("HOME");
    let folder = set("XDG_CONFIG_HOME").filter(|path| path.is_absolute()).or_else(|| {
        if cfg!(windows) {
            set("APPDATA")
        } else if cfg!(target_os = "macos") {
            home().map(|home| home.join("Library").join("Application Support"))
        } else {
            home().map(|home| home.join(".config"))
        }
    })?;
    Some(folder.join("pump-dose").join("config.toml"))
}

/// Returns the path in a variable of the environment, unless it is empty.
fn set(name: &str) -> Option<PathBuf> {
    std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from)
}
