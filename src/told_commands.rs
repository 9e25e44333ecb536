//! The commands that the program tells: they mean the pump, the configuration and the record of the command that was
//! typed.

use std::borrow::Cow;
use std::cell::RefCell;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock, OnceLock};

use clap::parser::ValueSource;
use clap::{ArgMatches, Command};
use pump_bench::config::{Config, config_path};
use pump_bench::setup::SetupFolder;

/// Options that say which pump a command means and where its record is, by clap's ids.
const OF_PLACES: [(&str, &str); 5] = [
    ("pump", "--pump"),
    ("config", "--config"),
    ("state_dir", "--state-dir"),
    ("driver", "--driver"),
    ("port", "--port"),
];

/// Arguments that say that a command means several pumps, by clap's ids.
const OF_SEVERAL: [&str; 2] = ["rack", "all"];

/// Word of a told command in place of which the name of the pump stands.
const NAME: &str = "NAME";

/// The pump of the command line, its places that the next command needs too, and the definitions of all commands.
#[derive(Clone)]
struct Told {
    /// Options that were typed, with their values.
    typed: Vec<(&'static str, String)>,
    /// Name of the pump; none where a command means several.
    pump: Option<String>,
    root: Definitions,
}

/// Definitions of all commands. They take a megabyte, so they are made when a command is told.
type Definitions = Arc<LazyLock<Command>>;

impl Told {
    /// The places of a command that means this one of several pumps.
    fn of_pump(&self, pump: &str) -> Self {
        let mut typed = self.typed.clone();
        typed.retain(|(option, _)| *option != "--pump");
        // Beside commands of other pumps, that of the usual one is read better with its name.
        typed.insert(0, ("--pump", pump.to_owned()));
        Self { typed, pump: Some(pump.to_owned()), ..self.clone() }
    }
}

static TOLD: OnceLock<Told> = OnceLock::new();

thread_local! {
    /// The one of several pumps that the words of this thread are about.
    static MEANT: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Does something whose words are about this one of several pumps: commands that are told meanwhile mean that pump.
pub(crate) fn meaning<T>(pump: &str, does: impl FnOnce() -> T) -> T {
    let before = MEANT.replace(Some(pump.to_owned()));
    let done = does();
    MEANT.set(before);
    done
}

/// Notes the options of the command line that the next command needs too. The pump that a command without `--pump`
/// means anyway is left out.
///
/// `root` makes the definitions of all commands.
pub(crate) fn note(matches: &ArgMatches, root: fn() -> Command) {
    let mut leaf = matches;
    while let Some((_, inner)) = leaf.subcommand() {
        leaf = inner;
    }
    let typed = OF_PLACES.into_iter().filter_map(|(id, option)| {
        let is_typed =
            leaf.ids().any(|known| known == id) && leaf.value_source(id) == Some(ValueSource::CommandLine);
        let mut values = leaf.try_get_raw(id).ok().flatten().filter(|_| is_typed)?;
        Some((option, values.next()?.to_str()?.to_owned()))
    });
    let mut typed: Vec<_> = typed.collect();
    // A command that makes a pump file writes its driver and port into it.
    if matches.subcommand_name().is_some_and(|command| ["setup", "pumps"].contains(&command)) {
        typed.retain(|(option, _)| !["--driver", "--port"].contains(option));
    }
    let config = typed.iter().find(|(option, _)| *option == "--config").map(|(_, path)| path.as_ref());
    let of_environment = std::env::var("DOSE_PUMP").ok().filter(|pump| !pump.is_empty());
    let of_config = || Some(Config::of_user(config).ok()?.default_pump().to_owned());
    let usual = of_environment.or_else(of_config);
    let named = typed.iter().find(|(option, _)| *option == "--pump").map(|(_, pump)| pump.clone());
    let is_typed = |id: &&str| {
        leaf.ids().any(|known| known == *id) && leaf.value_source(id) == Some(ValueSource::CommandLine)
    };
    let pump = named.or_else(|| usual.clone()).filter(|_| !OF_SEVERAL.iter().any(is_typed));
    typed.retain(|(option, value)| *option != "--pump" || usual.as_ref() != Some(value));
    let root = Arc::new(LazyLock::new(root));
    let _ = TOLD.set(Told { typed, pump, root });
}

/// Words with the command that goes on with the setup of a pump, if that was left before its end.
pub(crate) fn setup_that_was_left(pump: &str) -> Option<String> {
    let typed = TOLD.get().and_then(|told| told.typed.iter().find(|(option, _)| *option == "--config"));
    let config = typed.map(|(_, path)| PathBuf::from(path)).or_else(config_path)?;
    let answers = SetupFolder::of(&config).read(pump).ok().flatten()?;
    (!answers.is_finished()).then(|| format!("`dose setup {pump}` goes on with its setup, which was left"))
}

/// Words with the command that asks which way a pump's motor turns, if the pump was set up.
pub(crate) fn setup_asks_again(pump: &str) -> Option<String> {
    let typed = TOLD.get().and_then(|told| told.typed.iter().find(|(option, _)| *option == "--config"));
    let config = typed.map(|(_, path)| PathBuf::from(path)).or_else(config_path)?;
    let answers = SetupFolder::of(&config).read(pump).ok().flatten()?;
    answers
        .is_finished()
        .then(|| format!("or `dose setup {pump}` turns the motor once, and asks which way it went"))
}

/// Completes the commands of a text, which stand between back quotes.
pub(crate) fn completed(text: &str) -> Cow<'_, str> {
    match TOLD.get() {
        Some(told) if text.contains("`dose ") => Cow::Owned(match MEANT.with_borrow(Clone::clone) {
            Some(pump) => completed_with(text, &told.of_pump(&pump)),
            None => completed_with(text, told),
        }),
        _ => Cow::Borrowed(text),
    }
}

fn completed_with(text: &str, Told { typed, pump, root, .. }: &Told) -> String {
    let parts = text.split('`').enumerate();
    let parts = parts.map(|(at, part)| match part.strip_prefix("dose ") {
        Some(rest) if at % 2 == 1 => match named(rest, pump.as_deref()) {
            // The name says the pump, so an option would say it twice.
            Some(rest) => {
                let places: Vec<_> =
                    typed.iter().filter(|(option, _)| *option != "--pump").cloned().collect();
                command(&rest, &places, root)
            }
            None => command(rest, typed, root),
        },
        _ => part.to_owned(),
    });
    parts.collect::<Vec<_>>().join("`")
}

/// A command with the pump in place of its `NAME`; none for a command without it, or where nobody knows the pump.
fn named(rest: &str, pump: Option<&str>) -> Option<String> {
    let pump = shell_word(pump.filter(|_| rest.split(' ').any(|word| word == NAME))?);
    let words: Vec<&str> = rest.split(' ').map(|word| if word == NAME { &pump } else { word }).collect();
    Some(words.join(" "))
}

/// Completes a command by the options that it takes.
fn command(rest: &str, typed: &[(&str, String)], root: &Command) -> String {
    let words: Vec<&str> = rest.split_whitespace().collect();
    let mut path: Vec<&Command> = Vec::new();
    for word in &words {
        let Some(inner) = path.last().unwrap_or(&root).find_subcommand(word) else { break };
        path.push(inner);
    }
    let path = if path.is_empty() { vec![root] } else { path };
    // The help of a subcommand hides what that of its command shows.
    let takes = |option: &str| {
        let long = option.strip_prefix("--");
        let lists = |command: &&Command, is_shown: bool| {
            command.get_arguments().any(|arg| arg.get_long() == long && (!is_shown || !arg.is_hide_set()))
        };
        path.last().is_some_and(|leaf| lists(leaf, false)) && path.iter().any(|command| lists(command, true))
    };
    // `dose setup` finds a board wherever it is, and asks for what a new pump needs.
    let asks = |option: &str| words.first() == Some(&"setup") && ["--driver", "--port"].contains(&option);
    // A told command that was completed before has the name of the pump in it.
    let is_named = |option: &str, value: &str| {
        option == "--pump" && format!(" {rest} ").contains(&format!(" {} ", shell_word(value)))
    };
    let missing = typed.iter().filter(|(option, value)| {
        !words.contains(option) && takes(option) && !asks(option) && !is_named(option, value)
    });
    let added: String = missing.map(|(option, value)| format!(" {option} {}", shell_word(value))).collect();
    format!("dose {rest}{added}")
}

/// A word as the shell reads it again.
pub(crate) fn shell_word(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use clap::Arg;

    use super::*;

    /// Commands of which some mean a pump.
    fn definitions() -> Command {
        let of_pump = |command: Command| {
            let state_dir = Arg::new("state_dir").long("state-dir");
            command.arg(Arg::new("pump").long("pump")).arg(state_dir)
        };
        let calibrate = Command::new("calibrate").subcommand(of_pump(Command::new("use")));
        let resume = of_pump(Command::new("resume"));
        of_pump(Command::new("dose")).subcommands([calibrate, resume, Command::new("pumps")])
    }

    #[test]
    fn commands_go_to_the_motor_that_was_typed() {
        let typed = [("--driver", "grbl".to_owned()), ("--port", "/dev/pts/4".to_owned())];
        fn motor(command: Command) -> Command {
            command.arg(Arg::new("driver").long("driver")).arg(Arg::new("port").long("port"))
        }
        let root = || {
            motor(Command::new("dose")).subcommands([
                motor(Command::new("resume")),
                motor(Command::new("setup")),
                Command::new("log"),
            ])
        };
        let told = Told { typed: typed.to_vec(), pump: None, root: Arc::new(LazyLock::new(root)) };
        let told = |text: &str| completed_with(text, &told);
        assert_eq!(told("`dose resume` makes"), "`dose resume --driver grbl --port /dev/pts/4` makes");
        assert_eq!(told("`dose log` lists"), "`dose log` lists");
        assert_eq!(told("`dose setup` finds the boards"), "`dose setup` finds the boards");
    }

    #[test]
    fn commands_mean_the_pump_and_the_record_that_were_typed() {
        let typed = [("--pump", "my acid.toml".to_owned()), ("--state-dir", "/srv/state".to_owned())];
        let pump = Some("my acid.toml".to_owned());
        let told = Told { typed: typed.to_vec(), pump, root: Arc::new(LazyLock::new(definitions)) };
        let told = |text: &str| completed_with(text, &told);
        assert_eq!(
            told("`dose resume NAME --reason <TEXT>`"),
            "`dose resume 'my acid.toml' --reason <TEXT> --state-dir /srv/state`"
        );
        let places = "--pump 'my acid.toml' --state-dir /srv/state";
        assert_eq!(
            told("finish it with `dose resume`, or"),
            format!("finish it with `dose resume {places}`, or")
        );
        assert_eq!(
            told("`dose calibrate use none` goes"),
            format!("`dose calibrate use none {places}` goes")
        );
        assert_eq!(told("`dose 5mL --pump base`"), "`dose 5mL --pump base --state-dir /srv/state`");
        assert_eq!(told("`dose home  --mark 'a  b'`"), format!("`dose home  --mark 'a  b' {places}`"));
        // Some commands mean no pump, and what is no command stays.
        assert_eq!(told("`dose pumps list`, `acid`, dose resume"), "`dose pumps list`, `acid`, dose resume");
    }

    #[test]
    fn commands_of_one_of_several_pumps_mean_that_pump_and_are_completed_once() {
        let typed = vec![("--state-dir", "/srv/state".to_owned())];
        let told = Told { typed, pump: None, root: Arc::new(LazyLock::new(definitions)) };
        let of = |pump: &str, text: &str| completed_with(text, &told.of_pump(pump));
        let base = "`dose resume base --state-dir /srv/state`";
        assert_eq!(completed_with(&of("base", "`dose resume NAME`"), &told.of_pump("base")), base);
        let base = "`dose resume --pump racks/base.toml --state-dir /srv/state`";
        assert_eq!(of("racks/base.toml", "`dose resume`"), base);
        assert_eq!(completed_with(base, &told), base);
        assert_eq!(of("acid", "`dose resume`"), "`dose resume --pump acid --state-dir /srv/state`");
        assert_eq!(of("acid", "`dose pumps NAME`"), "`dose pumps acid`");
    }

    /// A service has a process for each motion, and definitions take a megabyte.
    #[test]
    fn a_text_that_tells_no_command_makes_no_definitions() {
        let root = Arc::new(LazyLock::new((|| unreachable!("nobody needs them")) as fn() -> Command));
        let told = Told { typed: Vec::new(), pump: Some("acid".to_owned()), root };
        let told = told.of_pump("base");
        assert_eq!(completed_with("the pump `base` stands", &told), "the pump `base` stands");
    }

    #[test]
    fn a_word_is_quoted_for_the_shell_where_it_must_be() {
        assert_eq!(shell_word("/dev/ttyUSB1"), "/dev/ttyUSB1");
        assert_eq!(shell_word("read it's \"x\""), "'read it'\\''s \"x\"'");
    }
}
