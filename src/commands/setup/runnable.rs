//! The commands that a setup tells: they run as they are printed, for this pump.

/// Words that the commands of a setup need so that they mean this pump, its record and its balance.
#[derive(Debug, Clone, Default)]
pub(super) struct Runnable {
    /// Words of every command, as `--config /srv/config.toml`.
    pub(super) places: String,
    /// Words of a command that weighs, as `--scale-port /dev/ttyUSB1`.
    pub(super) scale: String,
    /// Name of the pump.
    pub(super) pump: String,
}

/// Commands that a balance can read for.
const WEIGHING: [&str; 3] = ["dose setup", "dose calibrate run", "dose calibrate verify"];

impl Runnable {
    /// Completes the commands of a text, which stand between back quotes.
    pub(super) fn complete(&self, text: &str) -> String {
        let text = if self.scale.is_empty() {
            text.to_owned()
        } else {
            // The balance need not be tared for a dose of the setup.
            let again = format!("`dose setup {}` makes it and weighs it", self.pump);
            text.replace("make the dose again, then say `dose calibrate last` and its weight", &again)
        };
        let quoted = text.split('`').enumerate();
        let parts = quoted.map(|(at, part)| if at % 2 == 1 { self.command(part) } else { part.to_owned() });
        parts.collect::<Vec<_>>().join("`")
    }

    /// Completes a command. What is none stays.
    fn command(&self, command: &str) -> String {
        let Self { places, scale, pump } = self;
        let words = command.split_whitespace().collect::<Vec<_>>().join(" ");
        let Some(rest) = words.strip_prefix("dose ") else { return command.to_owned() };
        let weighs = WEIGHING.iter().any(|known| words.starts_with(known));
        let scale = if weighs && !words.contains("--weight") { scale.as_str() } else { "" };
        let names = if rest.starts_with("setup ") || words.contains("--pump") || rest.starts_with("pumps ") {
            String::new()
        } else {
            format!("--pump {pump}")
        };
        let added = [scale, &names, places].into_iter().filter(|added| !added.is_empty());
        [words.as_str()].into_iter().chain(added).collect::<Vec<_>>().join(" ")
    }
}

/// A word as the shell reads it again.
pub(super) fn shell_word(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runnable(scale: &str, places: &str) -> Runnable {
        Runnable { places: places.to_owned(), scale: scale.to_owned(), pump: "acid".to_owned() }
    }

    #[test]
    fn a_command_names_the_pump_its_places_and_its_balance() {
        let text =
            "make the dose again, then say `dose calibrate last` and its weight; `--use` has doses use it";
        assert_eq!(
            runnable("", "").complete(text),
            "make the dose again, then say `dose calibrate last --pump acid` and its weight; `--use` has doses use it"
        );
        assert_eq!(
            runnable("--scale-port /dev/ttyUSB1", "--config c.toml").complete(text),
            "`dose setup acid --scale-port /dev/ttyUSB1 --config c.toml` makes it and weighs it; `--use` has doses use \
             it"
        );
        let known = "`acid` is set up: `dose 5mL --pump acid` doses, `dose setup acid` weighs again";
        assert_eq!(runnable("", "").complete(known), known);
    }

    #[test]
    fn a_word_is_quoted_for_the_shell_where_it_must_be() {
        assert_eq!(shell_word("/dev/ttyUSB1"), "/dev/ttyUSB1");
        assert_eq!(shell_word("read it's \"x\""), "'read it'\\''s \"x\"'");
    }
}
