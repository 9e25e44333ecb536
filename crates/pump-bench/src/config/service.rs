//! The service `dose serve`, as a configuration describes it.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::inputs::InputTable;
use super::mqtt::MqttTable;

/// Table `[service]`: where the service is, and who may use it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct ServiceTable {
    /// Address and port at which the service listens, as `127.0.0.1:8737`.
    pub listen: Option<String>,
    /// File with the token that other computers need.
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

impl ServiceTable {
    /// Returns the table with its paths relative to `folder`.
    pub(super) fn inside(self, folder: &Path) -> Self {
        let at = |path: Option<PathBuf>| path.map(|path| folder.join(path));
        let mqtt = self.mqtt.map(|table| table.inside(folder));
        Self { token_file: at(self.token_file), schedule: at(self.schedule), mqtt, ..self }
    }
}
