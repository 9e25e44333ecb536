//! The MQTT broker that `dose serve` talks to, as a configuration names it.

use std::path::{Path, PathBuf};

use serde::Deserialize;

/// Most letters of a topic, and of a broker's address.
const MOST_LETTERS: usize = 200;

/// Table `[service.mqtt]`: the broker, and the names that the service has there.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct MqttTable {
    /// Host and port of the broker, as `localhost:1883`.
    pub broker: String,
    /// User by whose name the service connects. `None` connects without one.
    pub user: Option<String>,
    /// File whose first line is the user's password.
    pub password_file: Option<PathBuf>,
    /// Root of all topics.
    #[serde(default = "usual_topic")]
    pub topic: String,
    /// Prefix of the topics at which Home Assistant discovers devices. `None` tells it nothing.
    pub discovery: Option<String>,
    /// Client id at the broker. `None` lets the service keep one of its own.
    pub id: Option<String>,
}

fn usual_topic() -> String {
    "pump-dose".to_owned()
}

/// Topics that a configuration may name.
pub(super) const TOPICS: &str =
    "words with `/` between them, 200 letters at most, without `+`, `#` and `$`, as pump-dose or lab/pumps";

impl MqttTable {
    /// Returns the broker's host and port.
    pub fn address(&self) -> Option<(&str, u16)> {
        host_and_port(&self.broker)
    }

    /// Returns the first value that is not allowed: key, value, and what is allowed.
    pub(super) fn wrong(&self) -> Option<(&'static str, String, &'static str)> {
        let Self { broker, user, password_file, topic, discovery, id } = self;
        let is_empty = |text: &Option<String>| text.as_ref().is_some_and(|text| text.trim().is_empty());
        let is_id = |id: &str| {
            let letters = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
            (1..=64).contains(&id.len()) && id.chars().all(letters)
        };
        if self.address().is_none() {
            let allowed = "a host and a port without TLS, as localhost:1883 or [::1]:1883";
            return Some(("broker", broker.clone(), allowed));
        }
        if is_empty(user) {
            return Some(("user", String::new(), "a name of the broker's password file, or no key `user`"));
        }
        if let Some(file) = password_file.as_ref().filter(|_| user.is_none()) {
            return Some(("password_file", file.display().to_string(), "a file beside a key `user`"));
        }
        if !is_topic(topic) {
            return Some(("topic", topic.clone(), TOPICS));
        }
        if let Some(prefix) = discovery.as_ref().filter(|prefix| !is_topic(prefix)) {
            return Some(("discovery", prefix.clone(), TOPICS));
        }
        let id = id.as_ref().filter(|id| !is_id(id))?;
        Some(("id", id.clone(), "1 to 64 of a-z, A-Z, 0-9, - and _"))
    }

    /// Returns the table with its paths relative to `folder`.
    pub(super) fn inside(self, folder: &Path) -> Self {
        Self { password_file: self.password_file.map(|path| folder.join(path)), ..self }
    }
}

/// Reads a host and a port with `:` between them.
pub(super) fn host_and_port(text: &str) -> Option<(&str, u16)> {
    let (host, port) = text.rsplit_once(':')?;
    let port = port.parse().ok().filter(|port| *port > 0)?;
    let is_six = host.starts_with('[') && host.ends_with(']');
    let has_colon = host.contains(':') && !is_six;
    let letters = |c: char| c.is_alphanumeric() || "-._:[]%".contains(c);
    let is_host = !host.is_empty() && host.len() <= MOST_LETTERS && host.chars().all(letters);
    (is_host && !has_colon).then_some((host, port))
}

/// Returns true for a topic that names one place.
pub(super) fn is_topic(topic: &str) -> bool {
    let is_level = |level: &str| !level.is_empty() && !level.contains(['+', '#', '$']);
    topic.len() <= MOST_LETTERS && topic.split('/').all(is_level) && !topic.chars().any(char::is_control)
}

#[cfg(test)]
mod tests {
    use super::super::file::Config;

    fn read(keys: &str) -> Result<Config, String> {
        let text = format!("schema = \"config/1\"\n[service.mqtt]\n{keys}\n");
        Config::parse(&text, "/etc/pump-dose/config.toml".as_ref()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_broker_is_a_host_and_a_port() {
        for (broker, host, port) in
            [("localhost:1883", "localhost", 1883), ("[::1]:18", "[::1]", 18), ("10.0.0.2:1", "10.0.0.2", 1)]
        {
            let config = read(&format!("broker = \"{broker}\"")).unwrap();
            assert_eq!(config.service().mqtt.as_ref().unwrap().address(), Some((host, port)));
        }
        for broker in
            ["localhost", "localhost:", ":1883", "mqtts://host:8883", "::1:1883", "a b:1", "a:0", ""]
        {
            let refused = read(&format!("broker = \"{broker}\"")).unwrap_err();
            let words =
                format!("[service.mqtt] broker is `{broker}`; allowed: a host and a port without TLS");
            assert!(refused.contains(&words), "{refused}");
        }
    }

    #[test]
    fn a_topic_names_one_place() {
        for topic in ["", "/a", "a/", "a//b", "a/+", "#", "$SYS/a"] {
            for key in ["topic", "discovery"] {
                let refused = read(&format!("broker = \"a:1\"\n{key} = \"{topic}\"")).unwrap_err();
                assert!(refused.contains(&format!("[service.mqtt] {key} is `{topic}`")), "{refused}");
            }
        }
        let config = read("broker = \"a:1\"\ntopic = \"lab/pumps\"").unwrap();
        assert_eq!(config.service().mqtt.as_ref().unwrap().topic, "lab/pumps");
        assert_eq!(read("broker = \"a:1\"").unwrap().service().mqtt.as_ref().unwrap().topic, "pump-dose");
    }

    #[test]
    fn a_password_has_a_user_and_its_file_is_in_the_folder_of_the_configuration() {
        let refused = read("broker = \"a:1\"\npassword_file = \"word\"").unwrap_err();
        assert!(
            refused.contains("password_file is `word`; allowed: a file beside a key `user`"),
            "{refused}"
        );
        let config = read("broker = \"a:1\"\nuser = \"anna\"\npassword_file = \"word\"").unwrap();
        let file = config.service().mqtt.as_ref().unwrap().password_file.clone().unwrap();
        assert_eq!(file.to_str(), Some("/etc/pump-dose/word"));
        assert!(read("broker = \"a:1\"\nuser = \" \"").unwrap_err().contains("[service.mqtt] user"));
        assert!(read("broker = \"a:1\"\nid = \"a b\"").unwrap_err().contains("[service.mqtt] id is `a b`"));
    }
}
