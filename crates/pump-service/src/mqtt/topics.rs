//! Names of the topics.

/// Last word of each topic that takes commands.
const SET: &str = "set";

/// Name of the topic's level that stops every pump.
pub(super) const STOP: &str = "stop";

/// The topics below one root.
#[derive(Debug, Clone)]
pub(super) struct Topics {
    root: String,
}

/// A topic that takes commands: the word of the command, and the pump unless it is for all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Command<'a> {
    pub(super) pump: Option<&'a str>,
    pub(super) word: &'a str,
}

impl Topics {
    pub(super) fn below(root: &str) -> Self {
        Self { root: root.to_owned() }
    }

    pub(super) fn root(&self) -> &str {
        &self.root
    }

    /// Topic that says whether the service is there.
    pub(super) fn status(&self) -> String {
        format!("{}/status", self.root)
    }

    /// Topic of what a person should know, which keeps the last one.
    pub(super) fn notes(&self) -> String {
        format!("{}/notes", self.root)
    }

    /// Topic of a pump.
    pub(super) fn of(&self, pump: &str, what: &str) -> String {
        format!("{}/{pump}/{what}", self.root)
    }

    /// Topic of a pump's commands of this word.
    pub(super) fn set(&self, pump: &str, word: &str) -> String {
        format!("{}/{pump}/{word}/{SET}", self.root)
    }

    /// Topic of the answers to commands.
    pub(super) fn answer(&self, command: Command<'_>) -> String {
        self.of(command.pump.unwrap_or(STOP), "answer")
    }

    /// Filters of all topics that take commands.
    pub(super) fn filters(&self) -> [String; 2] {
        [format!("{}/{STOP}/{SET}", self.root), format!("{}/+/+/{SET}", self.root)]
    }

    /// Reads the topic of a command.
    pub(super) fn command<'a>(&self, topic: &'a str) -> Option<Command<'a>> {
        let below = topic.strip_prefix(&self.root)?.strip_prefix('/')?;
        match below.split('/').collect::<Vec<_>>()[..] {
            [STOP, SET] => Some(Command { pump: None, word: STOP }),
            [pump, word, SET] => Some(Command { pump: Some(pump), word }),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_names_its_pump_or_stops_all() {
        let topics = Topics::below("lab/pumps");
        let read = |topic| topics.command(topic).map(|command| (command.pump, command.word));
        assert_eq!(read("lab/pumps/acid/dose/set"), Some((Some("acid"), "dose")));
        assert_eq!(read("lab/pumps/stop/set"), Some((None, "stop")));
        // A pump may be called `stop`.
        let stop = topics.set("stop", "stop");
        assert_eq!(read(&stop), Some((Some("stop"), "stop")));
        for topic in
            ["lab/pumps/acid/state", "lab/acid/dose/set", "lab/pumps2/acid/dose/set", "lab/pumps/set"]
        {
            assert_eq!(read(topic), None, "{topic}");
        }
    }
}
