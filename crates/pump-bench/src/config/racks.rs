//! The racks that a name may mean: a path, or a configured name.

use std::path::{Path, PathBuf};

use super::error::ConfigError;
use super::file::Config;

impl Config {
    /// Finds the file of a rack: a path, then a configured name, then a file in this folder.
    ///
    /// A name is a path if it has a `/` or a `\`, or ends in `.toml`.
    ///
    /// # Errors
    /// [`ConfigError::UnknownRack`] for another name.
    pub fn find_rack(&self, name: &str) -> Result<PathBuf, ConfigError> {
        let path = Path::new(name);
        if name.contains(['/', '\\']) || name.ends_with(".toml") {
            return Ok(path.to_owned());
        }
        match self.racks.get(name) {
            Some(file) => Ok(file.clone()),
            None if path.is_file() => Ok(path.to_owned()),
            None => Err(ConfigError::UnknownRack {
                name: name.to_owned(),
                configured: self.racks.keys().cloned().collect::<Vec<_>>().join(", "),
            }),
        }
    }
}
