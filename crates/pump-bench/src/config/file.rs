//! The configuration file itself: its keys, its text and its checks.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::defaults::DoseDefaults;
use super::error::ConfigError;
use super::inputs::InputTable;
use super::mqtt::MqttTable;
use super::place::{default_path, named_path};
use super::pumps::{DEFAULT_PUMP, built_in_names, is_built_in};
use super::service::ServiceTable;
use crate::files::{MOST_PUMP_FILE_BYTES, read_text};
use crate::record::{FolderError, default_state_dir};

/// Schema of configuration files.
const SCHEMA: &str = "config/1";

/// The configuration of a user. Without a file everything is as built in.
///
/// ```
/// use pump_bench::config::Config;
///
/// let text = r#"
/// schema = "config/1"
/// default_pump = "ph-down"
/// [pumps]
/// ph-down = "pumps/ph-down.toml"
/// "#;
/// let config = Config::parse(text, "/etc/pump-dose/config.toml".as_ref())?;
/// assert_eq!(config.default_pump(), "ph-down");
/// assert_eq!(config.pumps()["ph-down"].to_str(), Some("/etc/pump-dose/pumps/ph-down.toml"));
///
/// let refused = Config::parse(&text.replace("default_pump", "pump"), "config.toml".as_ref()).unwrap_err();
/// assert!(refused.to_string().contains("unknown field `pump`, expected one of `schema`, `default_pump`"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Config {
    /// Path of the file, or the path at which there is none. `None` if the environment has no place for it.
    path: Option<PathBuf>,
    /// True if there is a file.
    exists: bool,
    pub(super) default_pump: Option<String>,
    state_dir: Option<PathBuf>,
    on_fail: Option<String>,
    defaults: DoseDefaults,
    pub(super) pumps: BTreeMap<String, PathBuf>,
    pub(super) racks: BTreeMap<String, PathBuf>,
    service: ServiceTable,
}

/// Keys of the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ConfigKeys {
    schema: String,
    default_pump: Option<String>,
    state_dir: Option<PathBuf>,
    on_fail: Option<String>,
    #[serde(default)]
    defaults: DoseDefaults,
    #[serde(default)]
    pumps: BTreeMap<String, PathBuf>,
    #[serde(default)]
    racks: BTreeMap<String, PathBuf>,
    #[serde(default)]
    service: ServiceTable,
}

impl Config {
    /// Reads the configuration at `named`, otherwise that of `DOSE_CONFIG`, otherwise that in the user's folder. A file
    /// that is named must be there; the user's folder may have none.
    ///
    /// # Errors
    /// [`ConfigError::Read`] if a file cannot be read. Otherwise as [`Config::parse`].
    pub fn of_user(named: Option<&Path>) -> Result<Self, ConfigError> {
        if let Some(path) = named.map(Path::to_owned).or_else(named_path) {
            return Self::read(&path);
        }
        match default_path() {
            Some(path) if path.symlink_metadata().is_ok() => Self::read(&path),
            path => Ok(Self { path, ..Self::default() }),
        }
    }

    /// Reads and checks a configuration file.
    ///
    /// # Errors
    /// [`ConfigError::Read`] if the file cannot be read. Otherwise as [`Config::parse`].
    pub fn read(path: &Path) -> Result<Self, ConfigError> {
        let text = read_text(path, MOST_PUMP_FILE_BYTES)
            .map_err(|source| ConfigError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, path)
    }

    /// Parses and checks the text of the configuration at `path`. Paths in it are relative to its folder.
    ///
    /// # Errors
    /// [`ConfigError::Syntax`] if the text is not the TOML of a configuration. [`ConfigError::Value`] for a value that
    /// is not allowed.
    pub fn parse(text: &str, path: &Path) -> Result<Self, ConfigError> {
        let keys: ConfigKeys = toml::from_str(text).map_err(|error| ConfigError::Syntax {
            path: path.to_owned(),
            message: error.to_string().trim_end().to_owned(),
        })?;
        keys.check().map_err(|wrong| wrong.at(path))?;
        let folder = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let folder = folder.parent().unwrap_or(Path::new(""));
        Ok(Self {
            path: Some(path.to_owned()),
            exists: true,
            default_pump: keys.default_pump,
            state_dir: keys.state_dir.map(|dir| folder.join(dir)),
            on_fail: keys.on_fail,
            defaults: keys.defaults,
            pumps: keys.pumps.into_iter().map(|(name, file)| (name, folder.join(file))).collect(),
            racks: keys.racks.into_iter().map(|(name, file)| (name, folder.join(file))).collect(),
            service: keys.service.inside(folder),
        })
    }

    /// Returns the path of the file, or the path at which there is none. `None` if the environment has no place for it.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Returns true if there is a file.
    pub fn exists(&self) -> bool {
        self.exists
    }

    /// Returns the pump files by their names.
    pub fn pumps(&self) -> &BTreeMap<String, PathBuf> {
        &self.pumps
    }

    /// Returns the files of racks by their names.
    pub fn racks(&self) -> &BTreeMap<String, PathBuf> {
        &self.racks
    }

    /// Returns the folder of the records that the file names, or `None` if it names none.
    pub fn named_state_dir(&self) -> Option<&Path> {
        self.state_dir.as_deref()
    }

    /// Returns the shell's command that the file has run once a dose fails. `None` if it names none.
    pub fn on_fail(&self) -> Option<&str> {
        self.on_fail.as_deref()
    }

    /// Returns the options of a dose that the file sets.
    pub fn defaults(&self) -> &DoseDefaults {
        &self.defaults
    }

    /// Returns what the file says of the service.
    pub fn service(&self) -> &ServiceTable {
        &self.service
    }

    /// Returns the folder of the records: that of the file, or else that of the user.
    ///
    /// # Errors
    /// [`FolderError::NoFolder`] if neither is known.
    pub fn state_dir(&self) -> Result<PathBuf, FolderError> {
        self.state_dir.clone().map_or_else(default_state_dir, Ok)
    }
}

/// A value that a configuration must not hold.
struct WrongValue {
    key: String,
    value: String,
    allowed: String,
}

impl WrongValue {
    fn new(key: &str, value: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self { key: key.to_owned(), value: value.into(), allowed: allowed.into() }
    }

    fn at(self, path: &Path) -> ConfigError {
        let Self { key, value, allowed } = self;
        ConfigError::Value { path: path.to_owned(), key, value, allowed }
    }
}

impl ConfigKeys {
    /// Refuses the first value that is wrong by itself or beside others.
    fn check(&self) -> Result<(), WrongValue> {
        if self.schema != SCHEMA {
            return Err(WrongValue::new("schema", self.schema.as_str(), SCHEMA));
        }
        self.pumps.keys().try_for_each(|name| check_name(name))?;
        if let Some((_, file)) = self.pumps.iter().find(|(_, file)| !is_plain(file)) {
            return Err(WrongValue::new("a file of [pumps]", file.display().to_string(), PLAIN));
        }
        if let Some(name) = self.racks.keys().find(|name| !is_name(name)) {
            return Err(WrongValue::new("a name of [racks]", name, NAMES));
        }
        if let Some((_, file)) = self.racks.iter().find(|(_, file)| !is_plain(file)) {
            return Err(WrongValue::new("a file of [racks]", file.display().to_string(), PLAIN));
        }
        if let Some(command) = self.on_fail.as_ref().filter(|command| command.trim().is_empty()) {
            return Err(WrongValue::new("on_fail", command, "a command of the shell"));
        }
        if let Some(dir) = self.state_dir.as_ref().filter(|dir| !is_plain(dir)) {
            return Err(WrongValue::new("state_dir", dir.display().to_string(), PLAIN));
        }
        if let Some((key, value, reason)) = self.defaults.wrong() {
            return Err(WrongValue {
                key: format!("[defaults] {key}"),
                ..WrongValue::new(key, value, reason)
            });
        }
        if let Some((value, allowed)) = self.service.wrong_url() {
            return Err(WrongValue::new("[service] url", value, allowed));
        }
        if let Some((key, value, allowed)) = self.service.mqtt.as_ref().and_then(MqttTable::wrong) {
            return Err(WrongValue::new(&format!("[service.mqtt] {key}"), value, allowed));
        }
        let names: Vec<&str> = self.pumps.keys().map(String::as_str).collect();
        self.check_inputs(&names)?;
        match &self.default_pump {
            Some(name) if !names.contains(&name.as_str()) && !is_built_in(name) => {
                let allowed = [&names[..], &[&built_in_names()]].concat().join(", ");
                Err(WrongValue::new(
                    "default_pump",
                    name.as_str(),
                    format!("a name of [pumps] or a built-in pump: {allowed}"),
                ))
            }
            _ => Ok(()),
        }
    }
}

impl ConfigKeys {
    /// Refuses the first input of the service that is wrong. A configuration without pumps has its usual one.
    fn check_inputs(&self, names: &[&str]) -> Result<(), WrongValue> {
        let usual = [self.default_pump.as_deref().unwrap_or(DEFAULT_PUMP)];
        let pumps = if names.is_empty() { &usual[..] } else { names };
        let inputs = &self.service.inputs;
        let mqtt = self.service.mqtt.as_ref();
        let wrong = inputs.iter().find_map(|input| input.wrong(pumps, mqtt, is_name));
        if let Some([key, value, allowed]) = wrong {
            return Err(WrongValue { key, value, allowed });
        }
        let repeats = |(number, input): &(usize, &InputTable)| {
            inputs[..*number].iter().any(|earlier| earlier.name == input.name)
        };
        match inputs.iter().enumerate().find(repeats) {
            Some((_, input)) => Err(WrongValue::new(
                "the name of a [[service.input]]",
                input.name.as_str(),
                "a name that no other input has",
            )),
            None => Ok(()),
        }
    }
}

/// Names that a configuration may hold.
const NAMES: &str = "1 to 64 of a-z, 0-9, - and _";

/// Paths that a configuration may hold.
const PLAIN: &str =
    "a path, relative to the configuration's folder or from the root; `~` means nothing in it";

/// Returns true for a path that is not empty and does not count on a shell.
fn is_plain(path: &Path) -> bool {
    !path.as_os_str().is_empty() && !path.starts_with("~")
}

/// Returns true for a name of 1 to 64 letters a-z, digits, `-` and `_`, which is no path.
pub(crate) fn is_name(name: &str) -> bool {
    let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    (1..=64).contains(&name.len()) && name.chars().all(letters)
}

/// Refuses a name that cannot be told from a path or a built-in pump.
fn check_name(name: &str) -> Result<(), WrongValue> {
    if !is_name(name) {
        return Err(WrongValue::new("a name of [pumps]", name, NAMES));
    }
    if is_built_in(name) {
        return Err(WrongValue::new(
            "a name of [pumps]",
            name,
            "another name: this one is that of a built-in pump",
        ));
    }
    Ok(())
}
