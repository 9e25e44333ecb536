//! The configuration of a user: pumps by their names, the usual pump, and the folder of the records.

mod defaults;
mod entry;
mod error;
mod file;
mod inputs;
mod mqtt;
mod place;
mod pumps;
mod racks;
mod service;

pub use defaults::DoseDefaults;
pub use error::ConfigError;
pub use file::Config;
pub(crate) use file::is_name;
pub use inputs::InputTable;
pub use mqtt::MqttTable;
pub use place::config_path;
pub use pumps::{DEFAULT_PUMP, PumpPlace};
pub use service::ServiceTable;
