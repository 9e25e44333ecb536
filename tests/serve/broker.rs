//! A mosquitto of the test's own, and another client of it.
#![allow(clippy::print_stderr, reason = "a test that is left out says why")]

use std::env;
use std::fs;
use std::net::TcpListener;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use rumqttc::{Client, Event, MqttOptions, Packet, QoS};
use serde_json::Value;
use tempfile::TempDir;

use crate::laboratory::wait_for;

/// Clients so far: each has a name of its own at the broker.
static EARS: AtomicU32 = AtomicU32::new(0);

/// A broker with a folder and a port of its own. It keeps retained messages over a restart.
pub(crate) struct Broker {
    folder: TempDir,
    pub(crate) port: u16,
    child: Option<Child>,
}

/// A client of the broker that hears every topic.
pub(crate) struct Ear {
    client: Client,
    heard: Arc<Mutex<Vec<Message>>>,
}

/// A message that was heard.
#[derive(Debug, Clone)]
pub(crate) struct Message {
    pub(crate) topic: String,
    pub(crate) text: String,
    pub(crate) is_retained: bool,
}

impl Message {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.text).unwrap()
    }
}

/// The program, or a printed reason why the test is left out.
fn mosquitto() -> Option<String> {
    let beside = env::var("PATH").unwrap_or_default() + ":/usr/sbin";
    let path = env::split_paths(&beside).map(|folder| folder.join("mosquitto")).find(|path| path.is_file());
    if path.is_none() {
        assert!(env::var_os("MQTT_NEEDED").is_none(), "MQTT_NEEDED is set, and there is no mosquitto");
        eprintln!("left out: there is no mosquitto; `make mqtt` installs it");
    }
    Some(path?.display().to_string())
}

impl Broker {
    /// A broker that does not run yet; none without mosquitto.
    pub(crate) fn new() -> Option<Self> {
        mosquitto()?;
        let folder = TempDir::new().unwrap();
        // The port is free once this listener is dropped.
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let place = folder.path().display();
        // Mosquitto that is started by root would become a user that cannot write here.
        let text = format!(
            "user root\n\
             listener {port} 127.0.0.1\nallow_anonymous true\npersistence true\npersistence_location {place}/\n\
             autosave_on_changes true\nautosave_interval 1\n"
        );
        fs::write(folder.path().join("mosquitto.conf"), text).unwrap();
        Some(Self { folder, port, child: None })
    }

    /// Changes the configuration. FOLDER is the broker's.
    pub(crate) fn configure(&self, from: &str, to: &str) {
        let path = self.folder.path().join("mosquitto.conf");
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from));
        fs::write(
            &path,
            text.replace(from, &to.replace("FOLDER", &self.folder.path().display().to_string())),
        )
        .unwrap();
    }

    /// Gives the broker a user.
    pub(crate) fn password(&self, user: &str, password: &str) {
        let file = self.folder.path().join("users");
        let words = ["-b", "-c", &file.display().to_string(), user, password];
        assert!(Command::new("mosquitto_passwd").args(words).status().unwrap().success());
        self.configure("allow_anonymous true", "allow_anonymous false\npassword_file FOLDER/users");
    }

    pub(crate) fn begin(&mut self) {
        let config = self.folder.path().join("mosquitto.conf");
        let mut command = Command::new(mosquitto().unwrap());
        command.arg("-c").arg(config).stdout(Stdio::null()).stderr(Stdio::null());
        self.child = Some(command.spawn().unwrap());
        wait_for("the broker to listen", || std::net::TcpStream::connect(("127.0.0.1", self.port)).ok());
    }

    /// Ends the broker in order: it keeps its retained messages.
    pub(crate) fn end(&mut self) {
        let mut child = self.child.take().unwrap();
        crate::laboratory::signal(child.id(), "TERM");
        child.wait().unwrap();
    }

    /// Lines of a configuration that name this broker.
    pub(crate) fn table(&self) -> String {
        format!("[service.mqtt]\nbroker = \"127.0.0.1:{}\"\n", self.port)
    }

    /// A client that hears every topic, once it does.
    pub(crate) fn ear(&self) -> Ear {
        self.ear_of(None)
    }

    /// A client with a user and a password.
    pub(crate) fn ear_of(&self, login: Option<(&str, &str)>) -> Ear {
        let id = format!("ear{}-{}", std::process::id(), EARS.fetch_add(1, Ordering::Relaxed));
        let mut options = MqttOptions::new(id, "127.0.0.1", self.port);
        options.set_keep_alive(Duration::from_secs(30)).set_max_packet_size(1 << 20, 1 << 20);
        if let Some((user, password)) = login {
            options.set_credentials(user, password);
        }
        let (client, mut connection) = Client::new(options, 64);
        client.subscribe("#", QoS::AtLeastOnce).unwrap();
        let heard = Arc::new(Mutex::new(Vec::new()));
        let (hears, is_there) = (heard.clone(), Arc::new(Mutex::new(false)));
        let there = is_there.clone();
        thread::spawn(move || {
            for event in connection.iter() {
                match event {
                    Ok(Event::Incoming(Packet::Publish(message))) => hears.lock().unwrap().push(Message {
                        topic: message.topic,
                        text: String::from_utf8_lossy(&message.payload).into_owned(),
                        is_retained: message.retain,
                    }),
                    Ok(Event::Incoming(Packet::SubAck(_))) => *there.lock().unwrap() = true,
                    Ok(_) => {}
                    // The broker has ended, or the client was dropped.
                    Err(_) => return,
                }
            }
        });
        wait_for("the client to hear", || is_there.lock().unwrap().then_some(()));
        Ear { client, heard }
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child {
            child.kill().unwrap();
            child.wait().unwrap();
        }
    }
}

impl Ear {
    /// Sends a message.
    pub(crate) fn send(&self, topic: &str, text: &str) {
        self.client.publish(topic, QoS::AtLeastOnce, false, text).unwrap();
    }

    /// Sends a message that the broker keeps.
    pub(crate) fn retain(&self, topic: &str, text: &str) {
        self.client.publish(topic, QoS::AtLeastOnce, true, text).unwrap();
    }

    /// All messages at a topic until now.
    pub(crate) fn at(&self, topic: &str) -> Vec<Message> {
        self.heard.lock().unwrap().iter().filter(|message| message.topic == topic).cloned().collect()
    }

    /// All messages until now.
    pub(crate) fn all(&self) -> Vec<Message> {
        self.heard.lock().unwrap().clone()
    }

    /// Waits for a message at a topic of which `is_it` is true.
    pub(crate) fn hears(&self, topic: &str, is_it: impl Fn(&Message) -> bool) -> Message {
        wait_for(&format!("a message at {topic}; heard: {:?}", self.at(topic)), || {
            self.at(topic).into_iter().find(|message| is_it(message))
        })
    }

    /// Waits until the last message at the status topic is this word.
    pub(crate) fn status(&self, word: &str) {
        wait_for(&format!("the status {word}"), || {
            self.at("pump-dose/status").last().filter(|message| message.text == word).map(drop)
        });
    }

    /// Waits for the last state of a pump to be of this word, and returns it.
    pub(crate) fn state(&self, pump: &str, word: &str) -> Value {
        let topic = format!("pump-dose/{pump}/state");
        wait_for(&format!("the state {word}"), || {
            let last = self.at(&topic).last().map(Message::json)?;
            (last["state"] == word).then_some(last)
        })
    }

    /// Sends a command and returns its answer, which is the next one at the topic of answers.
    pub(crate) fn ask(&self, pump: &str, word: &str, text: &str) -> Value {
        let topic = format!("pump-dose/{pump}/answer");
        let before = self.at(&topic).len();
        self.send(&format!("pump-dose/{pump}/{word}/set"), text);
        wait_for(&format!("the answer to {word} {text}"), || self.at(&topic).get(before).map(Message::json))
    }
}
