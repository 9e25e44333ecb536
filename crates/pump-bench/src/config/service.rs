//! The service `dose serve`, as a configuration describes it.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::inputs::InputTable;
use super::mqtt::{MqttTable, host_and_port};

/// Table `[service]`: where the service is, and who may use it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct ServiceTable {
    /// Address and port at which the service listens, as `127.0.0.1:8737`.
    pub listen: Option<String>,
    /// Address by which commands find the service where no `serve.json` beside the records tells it, as
    /// `http://127.0.0.1:8737`.
    pub url: Option<String>,
    /// File with the token that other computers need, and that commands send to `url`.
    pub token_file: Option<PathBuf>,
    /// Further names by which the service may be called, as that of a proxy.
    #[serde(default)]
    pub hosts: Vec<String>,
    /// Schedule of the doses that come by the clock.
    pub schedule: Option<PathBuf>,
    /// Broker of MQTT messages. `None` uses none.
    pub mqtt: Option<MqttTable>,
    /// Inputs that must be alive.
    #[serde(default, rename = "input")]
    pub inputs: Vec<InputTable>,
}

/// Addresses that commands may ask.
const URLS: &str =
    "http://, a host and a port, as http://127.0.0.1:8737; a tunnel leads to a service elsewhere";

impl ServiceTable {
    /// Returns the url without the `/` at its end.
    pub fn url(&self) -> Option<&str> {
        self.url.as_deref().map(|url| url.strip_suffix('/').unwrap_or(url))
    }

    /// Returns a url that is none, and what is allowed.
    pub(super) fn wrong_url(&self) -> Option<(String, &'static str)> {
        let place = self.url()?.strip_prefix("http://").unwrap_or_default();
        host_and_port(place).is_none().then(|| (self.url.clone().unwrap_or_default(), URLS))
    }

    /// Returns the table with its paths relative to `folder`.
    pub(super) fn inside(self, folder: &Path) -> Self {
        let at = |path: Option<PathBuf>| path.map(|path| folder.join(path));
        let mqtt = self.mqtt.map(|table| table.inside(folder));
        Self { token_file: at(self.token_file), schedule: at(self.schedule), mqtt, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::super::file::Config;

    fn url(text: &str) -> Result<Option<String>, String> {
        let text = format!("schema = \"config/1\"\n[service]\nurl = \"{text}\"\n");
        let config = Config::parse(&text, "config.toml".as_ref()).map_err(|error| error.to_string())?;
        Ok(config.service().url().map(str::to_owned))
    }

    #[test]
    fn a_url_is_a_host_and_a_port_without_tls() {
        for (text, read) in [
            ("http://127.0.0.1:8737", "http://127.0.0.1:8737"),
            ("http://[::1]:8737/", "http://[::1]:8737"),
            ("http://pumps.local:80", "http://pumps.local:80"),
        ] {
            assert_eq!(url(text), Ok(Some(read.to_owned())));
        }
        for text in
            ["", "127.0.0.1:8737", "https://a:1", "http://a", "http://a:1/b", "http://u:p@a:1", "http://a:0"]
        {
            let refused = url(text).unwrap_err();
            assert!(
                refused.contains(&format!("[service] url is `{text}`; allowed: http://, a host")),
                "{refused}"
            );
        }
    }
}
