//! The service at an MQTT broker: states and progress go out, commands come in, and Home Assistant may discover the
//! pumps.
//!
//! A message can come later, twice or again after a restart. So a retained command of a motion is never carried out,
//! the session is a clean one, and a key of a command doses once.

mod asked;
mod discovery;
mod error;
mod hearer;
mod kept;
mod link;
mod settings;
mod teller;
mod topics;
mod view;

pub use self::error::MqttError;
pub use self::link::Link;
pub use self::settings::Settings;
