//! A pump that comes into a configuration or leaves it: its line alone changes, and the rest of the text stays.

use std::path::{Path, PathBuf};

use super::error::ConfigError;
use super::file::Config;

/// Text of a configuration that has no file yet.
const EMPTY: &str = "schema = \"config/1\"\n";

impl Config {
    /// Returns the text of a configuration that has no file yet and keeps its records in `state_dir`.
    pub(crate) fn first_text(state_dir: &Path) -> String {
        format!("{EMPTY}state_dir = {}\n", quoted(state_dir))
    }

    /// Returns `text`, the text of the configuration at `path`, with the pump file `file` under `name`. The pump
    /// becomes the usual one if the text names none. `None` stands for a configuration without a file.
    ///
    /// Remarks and the order of the lines stay. A name that leads to this file already changes nothing.
    ///
    /// ```
    /// use pump_bench::config::Config;
    ///
    /// let text = Config::with_pump(None, "/c/config.toml".as_ref(), "acid", "pumps/acid.toml".as_ref())?;
    /// let config = Config::parse(&text, "/c/config.toml".as_ref())?;
    /// assert_eq!(config.default_pump(), "acid");
    /// assert_eq!(config.pumps()["acid"].to_str(), Some("/c/pumps/acid.toml"));
    /// # Ok::<(), pump_bench::config::ConfigError>(())
    /// ```
    ///
    /// # Errors
    /// Errors of [`Config::parse`]. [`ConfigError::Taken`] if the name leads to another file. [`ConfigError::NoRoom`]
    /// if the text has no place for a line, as where `[pumps]` is an inline table.
    pub fn with_pump(
        text: Option<&str>,
        path: &Path,
        name: &str,
        file: &Path,
    ) -> Result<String, ConfigError> {
        let text = text.unwrap_or(EMPTY);
        let before = Self::parse(text, path)?;
        let wanted = before.resolved(path, file);
        if let Some(other) = before.pumps.get(name) {
            return if *other == wanted {
                Ok(text.to_owned())
            } else {
                Err(ConfigError::Taken { name: name.to_owned(), file: other.clone() })
            };
        }
        let line = format!("{name} = {}\n", quoted(file));
        let mut lines: Vec<String> = text.split_inclusive('\n').map(str::to_owned).collect();
        if let Some(last) = lines.last_mut().filter(|last| !last.ends_with('\n')) {
            last.push('\n');
        }
        match lines.iter().position(|line| is_header(line, "pumps")) {
            Some(at) => lines.insert(at + 1, line.clone()),
            None => lines.push(format!("\n[pumps]\n{line}")),
        }
        if before.default_pump.is_none() {
            let at = lines.iter().position(|line| line.trim_start().starts_with("schema"));
            lines.insert(at.map_or(0, |at| at + 1), format!("default_pump = \"{name}\"\n"));
        }
        let text = lines.concat();
        // The file written must mean the pumps that were there, and the new one.
        let after = Self::parse(&text, path).ok().filter(|after| {
            let mut pumps = before.pumps.clone();
            pumps.insert(name.to_owned(), wanted);
            let usual = before.default_pump.clone().or(Some(name.to_owned()));
            after.pumps == pumps
                && after.racks == before.racks
                && after.defaults() == before.defaults()
                && after.default_pump == usual
                && after.same_folder(&before)
        });
        match after {
            Some(_) => Ok(text),
            None => Err(ConfigError::NoRoom { path: path.to_owned(), line: line.trim_end().to_owned() }),
        }
    }

    /// Returns `text`, the text of the configuration at `path`, without the pump `name`. If the pump is the usual one,
    /// that line goes too. Remarks and all other lines stay.
    ///
    /// # Errors
    /// Errors of [`Config::parse`]. [`ConfigError::NoLine`] if the text has no line that is the pump's alone.
    pub fn without_pump(text: &str, path: &Path, name: &str) -> Result<String, ConfigError> {
        let before = Self::parse(text, path)?;
        let is_usual = before.default_pump.as_deref() == Some(name);
        let mut table = String::new();
        let kept = text.split_inclusive('\n').filter(|line| {
            let bare = line.split('#').next().unwrap_or_default().trim();
            if bare.starts_with('[') {
                table = bare.trim_matches(['[', ']', ' ']).to_owned();
            }
            let key = bare.split('=').next().unwrap_or_default().trim().trim_matches(['"', '\'']);
            let is_pump = table == "pumps" && key == name && bare.contains('=');
            let is_usual_line = is_usual && table.is_empty() && key == "default_pump";
            !(is_pump || is_usual_line)
        });
        let kept: String = kept.collect();
        // The text that is left must mean all that was there, but this pump.
        let after = Self::parse(&kept, path).ok().filter(|after| {
            let mut pumps = before.pumps.clone();
            pumps.remove(name);
            let usual = before.default_pump.clone().filter(|_| !is_usual);
            after.pumps == pumps && after.default_pump == usual && after.same_folder(&before)
        });
        let no_line = || ConfigError::NoLine { path: path.to_owned(), name: name.to_owned() };
        after.map(|_| kept).ok_or_else(no_line)
    }

    /// Returns a path of the file as the file at `path` means it.
    fn resolved(&self, path: &Path, file: &Path) -> PathBuf {
        let folder = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        folder.parent().unwrap_or(Path::new("")).join(file)
    }

    /// Returns true if both configurations keep the records in one folder.
    fn same_folder(&self, other: &Self) -> bool {
        self.named_state_dir() == other.named_state_dir()
    }
}

/// Returns a path as a text of TOML.
fn quoted(path: &Path) -> String {
    toml::Value::String(path.to_string_lossy().into_owned()).to_string()
}

/// Returns true for the header of a table.
fn is_header(line: &str, table: &str) -> bool {
    let bare = line.split('#').next().unwrap_or_default().trim();
    bare.strip_prefix('[')
        .and_then(|rest| rest.strip_suffix(']'))
        .is_some_and(|inside| inside.trim() == table)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn added(text: &str) -> Result<String, ConfigError> {
        Config::with_pump(Some(text), Path::new("/c/config.toml"), "acid", Path::new("pumps/acid.toml"))
    }

    #[test]
    fn the_lines_of_a_person_stay() {
        let text =
            "# mine\nschema = \"config/1\"\nstate_dir = \"/r\" # here\n\n[pumps] # all\nbase = \"b.toml\"";
        assert_eq!(
            added(text).unwrap(),
            "# mine\nschema = \"config/1\"\ndefault_pump = \"acid\"\nstate_dir = \"/r\" # here\n\n[pumps] # \
             all\nacid = \"pumps/acid.toml\"\nbase = \"b.toml\"\n"
        );
        // A usual pump that somebody chose stays the usual one, and a name that is there is not written twice.
        let text = "schema = \"config/1\"\ndefault_pump = \"two-roller\"\n";
        let once = added(text).unwrap();
        assert!(once.contains("default_pump = \"two-roller\"\n\n[pumps]\nacid"), "{once}");
        assert_eq!(added(&once).unwrap(), once);
    }

    #[test]
    fn a_pump_leaves_and_the_other_lines_stay() {
        let without = |text: &str| Config::without_pump(text, Path::new("/c/config.toml"), "acid");
        let text = "# mine\nschema = \"config/1\"\ndefault_pump = \"acid\" # usual\n[pumps]\n\"acid\" = \"a.toml\"\n\
                    base = \"b.toml\" # acid = no\n";
        assert_eq!(
            without(text).unwrap(),
            "# mine\nschema = \"config/1\"\n[pumps]\nbase = \"b.toml\" # acid = no\n"
        );
        // An addition leaves no trace but the table.
        let bare = "schema = \"config/1\"\n";
        assert_eq!(without(&added(bare).unwrap()).unwrap(), format!("{bare}\n[pumps]\n"));
        let inline = without("schema = \"config/1\"\npumps = { acid = \"b.toml\" }\n").unwrap_err();
        assert!(inline.to_string().contains("delete its line"), "{inline}");
    }

    #[test]
    fn a_name_that_is_taken_and_a_text_without_room_are_refused() {
        let taken = added("schema = \"config/1\"\n[pumps]\nacid = \"other.toml\"\n").unwrap_err();
        assert!(taken.to_string().contains("/c/other.toml"), "{taken}");
        let inline = added("schema = \"config/1\"\npumps = { base = \"b.toml\" }\n").unwrap_err();
        assert!(inline.to_string().contains("acid = \"pumps/acid.toml\""), "{inline}");
    }
}
