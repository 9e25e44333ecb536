//! The commands that a setup tells: they run as they are printed, for this pump.

use pump_bench::notice::{Remedy, Wording};

use crate::advice;

/// Words that the commands of a setup need so that they mean this pump and its balance.
#[derive(Debug, Clone, Default)]
pub(super) struct Runnable {
    /// Words of a command that weighs, as `--scale-port /dev/ttyUSB1`.
    pub(super) scale: String,
    /// Name of the pump.
    pub(super) pump: String,
}

/// Commands that a balance can read for.
const WEIGHING: [&str; 3] = ["dose setup", "dose calibrate run", "dose calibrate verify"];

impl Runnable {
    /// The words of remedies in a setup. A dose of the setup is exact from any angle, and a balance need not be tared
    /// for it.
    pub(super) fn words(&self) -> Wording {
        match self.scale.is_empty() {
            true => |remedy| match remedy {
                Remedy::WeighOneMore => "`dose setup` makes it and asks for its weight",
                other => in_setup(other),
            },
            false => |remedy| match remedy {
                Remedy::WeighOneMore => "`dose setup` makes it and weighs it",
                other => in_setup(other),
            },
        }
    }

    /// The words of a remedy at a question, where no option can be typed.
    pub(super) fn at_question(remedy: Remedy) -> &'static str {
        match remedy {
            Remedy::StateMaxSpeed => {
                "quit, and `dose setup --max-speed 300rpm` says what your motor and tube allow"
            }
            other => advice::words(other),
        }
    }

    /// Completes the commands of a text, which stand between back quotes.
    pub(super) fn complete(&self, text: &str) -> String {
        let quoted = text.split('`').enumerate();
        let parts = quoted.map(|(at, part)| if at % 2 == 1 { self.command(part) } else { part.to_owned() });
        parts.collect::<Vec<_>>().join("`")
    }

    /// Completes a command. What is none stays.
    fn command(&self, command: &str) -> String {
        let Self { scale, pump } = self;
        let words = command.split_whitespace().collect::<Vec<_>>().join(" ");
        let Some(rest) = words.strip_prefix("dose ") else { return command.to_owned() };
        if rest == "setup" || rest.starts_with("setup --") {
            return self.command(&words.replacen("setup", &format!("setup {pump}"), 1));
        }
        let weighs = WEIGHING.iter().any(|known| words.starts_with(known));
        let scale = if weighs && !words.contains("--weight") { scale.as_str() } else { "" };
        let names = if rest.starts_with("setup ") || words.contains("--pump") || rest.starts_with("pumps ") {
            String::new()
        } else {
            format!("--pump {pump}")
        };
        let added = [scale, &names].into_iter().filter(|added| !added.is_empty());
        [words.as_str()].into_iter().chain(added).collect::<Vec<_>>().join(" ")
    }
}

/// The words of a remedy for a setup, which takes other options than a dose.
fn in_setup(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::AcceptBoard => {
            "if the board was replaced, `dose home --unknown --accept-settings` takes the one that is there"
        }
        Remedy::AcceptSettings => {
            "if another board is at this port, connect the pump's own board or name its port with --port; if you \
             changed the settings or replaced the board, `dose home --unknown --accept-settings` takes it as it is; \
             otherwise set them back"
        }
        Remedy::ResetBoard => {
            "if nobody else uses it, `dose home --unknown --accept-settings` resets it and takes it: each of its \
             motors is without current meanwhile"
        }
        other => advice::words(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runnable(scale: &str) -> Runnable {
        Runnable { scale: scale.to_owned(), pump: "acid".to_owned() }
    }

    #[test]
    fn a_command_names_the_pump_and_its_balance() {
        let told = |scale: &str| {
            let runnable = runnable(scale);
            runnable
                .complete(&format!("{}; `--use` has doses use it", runnable.words()(Remedy::WeighOneMore)))
        };
        assert_eq!(told(""), "`dose setup acid` makes it and asks for its weight; `--use` has doses use it");
        assert_eq!(
            told("--scale-port /dev/ttyUSB1"),
            "`dose setup acid --scale-port /dev/ttyUSB1` makes it and weighs it; `--use` has doses use it"
        );
        let known = "`acid` is set up: `dose 5mL --pump acid` doses, `dose setup acid` weighs again";
        assert_eq!(runnable("").complete(known), known);
    }
}
