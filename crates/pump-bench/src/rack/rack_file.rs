//! The file of a rack: its pumps and its steps.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::error::RackError;
use super::step::RackStep;
use super::step_keys::{StepKeys, WrongKey};
use crate::config::{Config, ConfigError, is_name};
use crate::files::{MOST_PUMP_FILE_BYTES, read_text};
use crate::pump_file::PumpFile;

/// Schema of the files of racks.
pub(super) const SCHEMA: &str = "rack/1";

/// Most pumps of a rack: each has a thread.
const MOST_PUMPS: usize = 64;

/// Most steps of a rack.
const MOST_STEPS: usize = 10_000;

/// File of a rack.
///
/// ```
/// use pump_bench::rack::RackFile;
///
/// let text = r#"
/// schema = "rack/1"
/// [pumps]
/// acid = "three-roller"
/// base = "two-roller"
/// [[step]]
/// ratio = { acid = 2, base = 1 }
/// rate = "3mL/s"
/// for = "10s"
/// "#;
/// let rack = RackFile::parse(text, "mix.toml".as_ref())?;
/// let flows = &rack.steps()[0].flows;
/// assert_eq!((flows[0].volume_ml, flows[0].rate_ml_s), (20.0, Some(2.0)));
/// assert_eq!((flows[1].volume_ml, flows[1].rate_ml_s), (10.0, Some(1.0)));
///
/// let refused = RackFile::parse(&text.replace("base = 1", "base = 0"), "mix.toml".as_ref()).unwrap_err();
/// assert!(refused.to_string().contains("step 1, ratio of base is `0`"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RackFile {
    path: PathBuf,
    /// Names in the rack, each with the name or the path of its pump.
    pumps: Vec<(String, String)>,
    steps: Vec<RackStep>,
}

/// Keys of the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RackKeys {
    schema: String,
    #[serde(default)]
    pumps: BTreeMap<String, String>,
    #[serde(default)]
    step: Vec<StepKeys>,
}

impl RackFile {
    /// Reads and checks the file of a rack.
    ///
    /// # Errors
    ///
    /// [`RackError::Read`] if the file cannot be read. Otherwise as [`RackFile::parse`].
    pub fn read(path: &Path) -> Result<Self, RackError> {
        let text = read_text(path, MOST_PUMP_FILE_BYTES)
            .map_err(|source| RackError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, path)
    }

    /// Parses and checks the text of the rack at `path`. Paths in it are relative to its folder.
    ///
    /// # Errors
    ///
    /// [`RackError::Syntax`] if the text is not the TOML of a rack. [`RackError::Value`] and [`RackError::Quantity`]
    /// for a value that is not allowed.
    pub fn parse(text: &str, path: &Path) -> Result<Self, RackError> {
        let keys: RackKeys = toml::from_str(text).map_err(|error| RackError::Syntax {
            path: path.to_owned(),
            message: error.to_string().trim_end().to_owned(),
        })?;
        keys.check().map_err(|wrong| wrong.at(path))?;
        let names: Vec<&str> = keys.pumps.keys().map(String::as_str).collect();
        let steps = keys.step.iter().enumerate().map(|(place, step)| step.read(place + 1, &names));
        let steps = steps.collect::<Result<_, _>>().map_err(|wrong| wrong.at(path))?;
        Ok(Self { path: path.to_owned(), steps, pumps: keys.pumps.into_iter().collect() })
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the name of the rack: that of its file without `.toml`.
    pub fn name(&self) -> String {
        self.path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned())
    }

    /// Returns the names of the pumps in the rack.
    pub fn pump_names(&self) -> impl Iterator<Item = &str> {
        self.pumps.iter().map(|(name, _)| name.as_str())
    }

    /// Returns the pump of each name of [`RackFile::pump_names`] as a user of this process types it: a name, or the
    /// path of a pump file.
    pub fn pump_places(&self) -> impl Iterator<Item = String> {
        self.pumps.iter().map(|(_, pump)| self.place(pump))
    }

    /// Returns the steps.
    pub fn steps(&self) -> &[RackStep] {
        &self.steps
    }

    /// Reads the pump files of the rack, in the order of its names. A pump is a name of `config`, a built-in pump, or
    /// a file, relative to the folder of the rack.
    ///
    /// # Errors
    ///
    /// [`RackError::Pump`] for a pump that cannot be found or used.
    pub fn pump_files(&self, config: &Config) -> Result<Vec<PumpFile>, RackError> {
        let read = |(name, pump): &(String, String)| {
            let file: Result<PumpFile, ConfigError> = config.pump(&self.place(pump));
            file.map_err(|source| RackError::Pump { pump: name.clone(), source: Box::new(source) })
        };
        self.pumps.iter().map(read).collect()
    }

    /// Returns the name of a pump, or its path as this process sees it.
    fn place(&self, pump: &str) -> String {
        if !pump.contains(['/', '\\']) && !pump.ends_with(".toml") {
            return pump.to_owned();
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        folder.join(pump).to_string_lossy().into_owned()
    }
}

impl RackKeys {
    /// Refuses the first value that is wrong beside the steps.
    fn check(&self) -> Result<(), WrongKey> {
        if self.schema != SCHEMA {
            return Err(WrongKey::value("schema", &self.schema, SCHEMA));
        }
        if self.pumps.is_empty() || self.pumps.len() > MOST_PUMPS {
            let allowed = format!("1 to {MOST_PUMPS} pumps, each as NAME = \"PUMP\"");
            return Err(WrongKey::value("[pumps]", &format!("{} pumps", self.pumps.len()), &allowed));
        }
        if let Some(name) = self.pumps.keys().find(|name| !is_name(name)) {
            return Err(WrongKey::value("a name of [pumps]", name, "1 to 64 of a-z, 0-9, - and _"));
        }
        let is_plain = |pump: &str| !pump.trim().is_empty() && !pump.starts_with('~');
        if let Some((name, pump)) = self.pumps.iter().find(|(_, pump)| !is_plain(pump)) {
            let allowed =
                "a name of the configuration, a built-in pump or a pump file; `~` means nothing here";
            return Err(WrongKey::value(&format!("[pumps] {name}"), pump, allowed));
        }
        if self.step.is_empty() || self.step.len() > MOST_STEPS {
            let (found, allowed) =
                (format!("{} steps", self.step.len()), format!("1 to {MOST_STEPS} tables [[step]]"));
            return Err(WrongKey::value("[[step]]", &found, &allowed));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str =
        "schema = \"rack/1\"\n[pumps]\nacid = \"three-roller\"\nbase = \"two-roller\"\n[[step]]\n";

    fn refused(step: &str) -> String {
        let error = RackFile::parse(&format!("{HEAD}{step}"), Path::new("mix.toml")).unwrap_err();
        let text = crate::report::with_sources(&error);
        assert!(text.starts_with("rack mix.toml: "), "{text}");
        text
    }

    fn over_time(keys: &str) -> String {
        format!("rate = \"2mL/s\"\nfor = \"10s\"\n{keys}")
    }

    #[test]
    fn each_wrong_step_has_one_message_that_names_the_value() {
        for (step, told) in [
            ("volume = \"1mL\"", "step 1 is `neither pump nor ratio nor gradient`"),
            ("pump = \"acid\"\nratio = { acid = 1, base = 1 }", "step 1 is `pump and ratio`"),
            ("pump = \"salt\"\nvolume = \"1mL\"", "step 1, pump is `salt`; allowed: acid, base"),
            ("pump = \"acid\"", "step 1 is `no volume`"),
            ("pump = \"acid\"\nvolume = \"0mL\"", "step 1, volume: `0mL` is zero"),
            ("pump = \"acid\"\nvolume = \"nanmL\"", "step 1, volume"),
            ("pump = \"acid\"\nvolume = \"1\"", "step 1, volume"),
            (
                "pump = \"acid\"\nvolume = \"1mL\"\nrate = \"1mL/s\"\nfor = \"1s\"",
                "step 1 is `volume, rate and for`",
            ),
            (
                "ratio = { acid = 1, base = 0 }\nvolume = \"1mL\"\nrate = \"1mL/s\"",
                "step 1, ratio of base is `0`",
            ),
            (
                "ratio = { acid = nan, base = 1 }\nvolume = \"1mL\"\nrate = \"1mL/s\"",
                "ratio of acid is `NaN`",
            ),
            ("ratio = { acid = -1, base = 1 }\nvolume = \"1mL\"\nrate = \"1mL/s\"", "ratio of acid is `-1`"),
            ("ratio = { acid = 1 }\nvolume = \"1mL\"\nrate = \"1mL/s\"", "step 1, ratio is `1 pump`"),
            ("ratio = { acid = 1, salt = 1 }\nvolume = \"1mL\"\nrate = \"1mL/s\"", "step 1, ratio is `salt`"),
            ("ratio = { acid = 1, base = 1 }\nvolume = \"1mL\"", "step 1 is `a ratio without rate`"),
            ("at = \"-1s\"\npump = \"acid\"\nvolume = \"1mL\"", "step 1, at: `-1s`"),
            ("at = \"1s\"\nafter = \"1s\"\npump = \"acid\"\nvolume = \"1mL\"", "step 1 is `at and after`"),
            (
                "at = \"1e300s\"\npump = \"acid\"\nvolume = \"1mL\"",
                "step 1, at is `1e300s`; allowed: 5e6 s (58 days) at most",
            ),
            (
                "after = \"6e6s\"\npump = \"acid\"\nvolume = \"1mL\"",
                "step 1, after is `6e6s`; allowed: 5e6 s",
            ),
            (
                "ratio = { acid = 1e300, base = 1 }\nvolume = \"1mL\"\nrate = \"1mL/s\"",
                "ratio of acid is `1e300`; allowed",
            ),
            ("speed = 1", "unknown field `speed`"),
            (
                &over_time("gradient = { acid = [1, 0], base = [nan, 1] }"),
                "step 1, gradient of base is `NaN`",
            ),
            (&over_time("gradient = { acid = [1, 0], base = [0, 0] }"), "step 1, gradient of base is `0`"),
            (
                &over_time("gradient = { acid = [1, 0], base = [1, 0] }"),
                "step 1, gradient is `nothing flows`",
            ),
            (
                &over_time("gradient = { acid = [1, 0], base = [0, 1] }\nramp = \"6s\""),
                "step 1, ramp is `6 s`",
            ),
            (
                &over_time("gradient = { acid = [1, 0], base = [0, 1] }\nvolume = \"1mL\""),
                "is `a flow over time`",
            ),
        ] {
            let text = refused(step);
            assert!(text.contains(told), "{text}\nwanted: {told}");
        }
    }

    #[test]
    fn each_wrong_table_has_one_message_that_names_the_value() {
        let step = "[[step]]\npump = \"acid\"\nvolume = \"1mL\"\n";
        for (text, told) in [
            (format!("schema = \"rack/2\"\n[pumps]\nacid = \"two-roller\"\n{step}"), "schema is `rack/2`"),
            (format!("schema = \"rack/1\"\n{step}"), "[pumps] is `0 pumps`"),
            ("schema = \"rack/1\"\n[pumps]\nacid = \"two-roller\"\n".to_owned(), "[[step]] is `0 steps`"),
            (format!("schema = \"rack/1\"\n[pumps]\n\"../a\" = \"two-roller\"\n{step}"), "[pumps] is `../a`"),
            (
                format!("schema = \"rack/1\"\n[pumps]\nacid = \"~/a.toml\"\n{step}"),
                "[pumps] acid is `~/a.toml`",
            ),
            (format!("schema = \"rack/1\"\n[pumps]\nacid = \"a\"\nacid = \"b\"\n{step}"), "duplicate key"),
        ] {
            let error = RackFile::parse(&text, Path::new("mix.toml")).unwrap_err().to_string();
            assert!(error.contains(told), "{error}\nwanted: {told}");
        }
    }
}
