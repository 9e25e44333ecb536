//! One order, and the words of its command.

use serde::{Deserialize, Serialize};

use super::error::OrderError;
use super::options::{Choice, Options, option, read_options};
use super::task::{Task, name};

/// Order to a pump, or to a rack.
///
/// ```
/// use pump_service::order::{Choice, Order, Task};
///
/// let mut order = Order::new("ph-down", Task::Dose { volume: "25mL".to_owned() });
/// order.options.insert("rate".to_owned(), Choice::Text("5mL/s".to_owned()));
/// order.options.insert("smooth".to_owned(), Choice::Switch(true));
/// let words = order.words()?;
/// assert_eq!(words, ["25mL", "--pump=ph-down", "--rate=5mL/s", "--smooth", "--format=json"]);
///
/// order.options.insert("on-fail".to_owned(), Choice::Text("reboot".to_owned()));
/// assert!(order.words().unwrap_err().to_string().starts_with("--on-fail is no option of this order; allowed: rate,"));
/// # Ok::<(), pump_service::order::OrderError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Order {
    /// Name of the pump in the configuration; that of a rack's order is empty.
    pub pump: String,
    /// Thing to do.
    #[serde(flatten)]
    pub task: Task,
    /// Options of the command by their names.
    #[serde(default, deserialize_with = "read_options")]
    pub options: Options,
}

impl Order {
    /// An order without options.
    pub fn new(pump: &str, task: Task) -> Self {
        Self { pump: pump.to_owned(), task, options: Options::new() }
    }

    /// Returns true if the order plans alone: nothing moves, and nothing is kept.
    pub(crate) fn is_dry(&self) -> bool {
        self.options.get("dry-run") == Some(&Choice::Switch(true))
    }

    /// Returns the words of the command, without the program's name.
    ///
    /// # Errors
    ///
    /// [`OrderError`] for an option that is not for orders, and for texts that cannot be words.
    pub fn words(&self) -> Result<Vec<String>, OrderError> {
        let mut words = self.task.words(&self.pump)?;
        if matches!(self.task, Task::Command { .. }) {
            return Ok(words);
        }
        // Standing and clearing name their pump as a word, so that nobody means another one by a default.
        if !matches!(self.task, Task::Rack { .. } | Task::Stand { .. } | Task::Clear { .. }) {
            words.push(option("pump", name("pump", &self.pump)?));
        }
        words.extend(self.task.options(&self.options)?);
        // Going back to a calibration is reported in words alone.
        if !matches!(self.task, Task::UseCalibration { .. }) {
            words.push(option("format", "json"));
        }
        Ok(words)
    }
}

#[cfg(test)]
mod tests {
    use super::super::options::Choice;
    use super::*;

    fn dose(volume: &str) -> Order {
        Order::new("acid", Task::Dose { volume: volume.to_owned() })
    }

    #[test]
    fn no_text_becomes_an_option_of_its_own() {
        for volume in ["--on-fail=reboot", "-", "prime", "", "25mL\n--x", "--5mL"] {
            assert!(dose(volume).words().is_err(), "{volume:?}");
        }
        for pump in ["--on-fail", "../x.toml", "x.toml", "a b", ""] {
            assert!(Order { pump: pump.to_owned(), ..dose("5mL") }.words().is_err(), "{pump:?}");
        }
        assert_eq!(dose("-5 mL").words().unwrap()[0], "-5 mL");
    }

    #[test]
    fn a_typed_command_is_told_by_what_the_pump_does() {
        let told = [
            (vec!["6mL", "--pump=acid"], "dosing 6mL"),
            (vec!["prime", "20mL"], "priming 20mL"),
            (vec!["prime", "--rate=max", "20mL"], "carrying out the command `prime --rate=max 20mL`"),
            (vec!["home", "--sensor"], "carrying out the command `home --sensor`"),
        ];
        for (words, doing) in told {
            let words = words.into_iter().map(str::to_owned).collect();
            assert_eq!(Task::Command { words }.doing(), doing);
        }
    }

    #[test]
    fn an_option_that_reaches_the_computer_is_refused() {
        for option in
            ["on-fail", "plot", "steps", "trace", "driver", "port", "pump", "config", "state-dir", "format"]
        {
            let mut order = dose("5mL");
            order.options.insert(option.to_owned(), Choice::Text("x".to_owned()));
            assert!(matches!(order.words(), Err(OrderError::Option { .. })), "{option}");
        }
    }

    #[test]
    fn a_switch_takes_no_value_and_a_value_is_no_switch() {
        let with = |name: &str, choice| {
            let mut order = dose("5mL");
            order.options.insert(name.to_owned(), choice);
            order.words()
        };
        assert!(with("smooth", Choice::Text("yes".to_owned())).is_err());
        assert!(with("rate", Choice::Switch(true)).is_err());
        assert!(!with("smooth", Choice::Switch(false)).unwrap().contains(&"--smooth".to_owned()));
    }
}
