//! A typed command as an order, by its task and its options.

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches};
use serde_json::{Map, Value, json};

use crate::cli;
use crate::user_name::user_name;

/// Options and words that say where the pump is or how the report is printed, or that are the task itself: by clap's
/// ids.
const NO_OPTIONS: [&str; 8] = ["pump", "config", "state_dir", "format", "verbose", "rack", "reason", "by"];

/// Returns the body that orders what `leaf`, the command at `path`, asks of `pump`. Its options are those that were
/// typed; the service refuses those that are for no order. An empty `pump` is the service's default.
pub(super) fn of(leaf: &ArgMatches, path: &[&str], pump: &str, json: bool) -> Value {
    let typed = |id: &str| {
        leaf.ids().any(|known| known == id) && leaf.value_source(id) == Some(ValueSource::CommandLine)
    };
    let words = |id: &str| -> String {
        let values = leaf.try_get_raw(id).ok().flatten();
        let words = values.into_iter().flatten().map(|value| value.to_string_lossy().into_owned());
        words.collect::<Vec<_>>().join(" ")
    };
    let root = cli::command();
    let command = path.iter().try_fold(&root, |command, name| command.find_subcommand(name)).unwrap_or(&root);
    let mut options = Map::new();
    let is_option = |arg: &&Arg| !NO_OPTIONS.contains(&arg.get_id().as_str()) && typed(arg.get_id().as_str());
    for (arg, name) in
        command.get_arguments().filter(is_option).filter_map(|arg| Some((arg, arg.get_long()?)))
    {
        let choice = match arg.get_action().takes_values() {
            true => words(arg.get_id().as_str()).into(),
            false => true.into(),
        };
        options.insert(name.to_owned(), choice);
    }
    let mut order = json!({"pump": pump, "task": path.last().unwrap_or(&"dose"), "options": options});
    if path == ["run"] && typed("rack") {
        (order["task"], order["rack"]) = ("rack".into(), words("rack").into());
    } else if path != ["run"] && typed("volume") {
        order["volume"] = words("volume").into();
    }
    for text in ["reason", "by"].into_iter().filter(|text| typed(text)) {
        order[text] = words(text).into();
    }
    if path == ["safety", "clear"] && !typed("by") {
        order["by"] = user_name().into();
    }
    let attended = std::io::IsTerminal::is_terminal(&std::io::stdin());
    json!({"order": order, "json": json, "verbose": typed("verbose"), "attended": attended})
}
