//! The broker and the names that the service has there.

use std::fmt::{self, Debug, Formatter};
use std::time::Duration;

use pump_bench::config::MqttTable;
use rumqttc::v5::MqttOptions;
use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::LastWill;

use super::error::MqttError;
use super::topics::Topics;
use crate::history::History;
use crate::order::random_hex;

/// Word of the history that keeps the client id.
const ID: &str = "mqtt client";

/// Time without a message after which the link is tried.
const KEEP_ALIVE: Duration = Duration::from_secs(10);

/// Largest packet that the broker may send, in bytes. It keeps larger ones to itself.
const LARGEST: u32 = 64 << 10;

/// Messages on their way that the broker has not acknowledged.
const IN_FLIGHT: u16 = 20;

/// Payloads of the status topic.
pub(super) const ONLINE: &str = "online";
pub(super) const OFFLINE: &str = "offline";

/// The broker, and the names that the service has there.
#[derive(Clone)]
pub struct Settings {
    host: String,
    port: u16,
    login: Option<(String, String)>,
    id: String,
    pub(super) topics: Topics,
    /// Prefix of Home Assistant's topics.
    pub(super) discovery: Option<String>,
}

impl Settings {
    /// Takes the table of a configuration with the password of its user. The history keeps a client id where the table
    /// has none.
    ///
    /// # Errors
    ///
    /// [`MqttError`] if the address is none, or the client id cannot be kept.
    pub fn new(table: &MqttTable, password: Option<String>, history: &History) -> Result<Self, MqttError> {
        let address = table.address().ok_or_else(|| MqttError::Broker(table.broker.clone()))?;
        let id = match &table.id {
            Some(id) => id.clone(),
            None => kept_id(history)?,
        };
        Ok(Self {
            host: address.0.to_owned(),
            port: address.1,
            login: table.user.clone().map(|user| (user, password.unwrap_or_default())),
            id,
            topics: Topics::below(&table.topic),
            discovery: table.discovery.clone(),
        })
    }

    /// Returns the address in words.
    pub(super) fn address(&self) -> String {
        format!("{}:{}", self.host, self.port)
    }

    /// Returns the options of a connection. Its session ends with it, so that nothing waits at the broker.
    pub(super) fn options(&self) -> MqttOptions {
        let mut options = MqttOptions::new(&self.id, &self.host, self.port);
        options.set_clean_start(true).set_keep_alive(KEEP_ALIVE).set_max_packet_size(Some(LARGEST));
        options.set_outgoing_inflight_upper_limit(IN_FLIGHT);
        let status = self.topics.status();
        options.set_last_will(LastWill::new(status, OFFLINE, QoS::AtLeastOnce, true, None));
        if let Some((user, password)) = &self.login {
            options.set_credentials(user, password);
        }
        options
    }
}

impl Debug for Settings {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        // The password is nobody's business.
        to.debug_struct("Settings")
            .field("id", &self.id)
            .field("topics", &self.topics)
            .finish_non_exhaustive()
    }
}

fn kept_id(history: &History) -> Result<String, MqttError> {
    if let Some(id) = history.word(ID)? {
        return Ok(id);
    }
    let id = format!("pump-dose-{}", random_hex::<4>()?);
    history.keep_word(ID, &id)?;
    Ok(id)
}
