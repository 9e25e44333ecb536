//! A command that asks the running service to carry it out: several people and programs then see what moves, and can
//! stop it. The service of this user's records runs the same command with the same words. A service at the url of the
//! configuration, which belongs to somebody else, takes it as an order, whose options reach no file of its computer.
//! Reports and exit codes are the same.

mod order;
mod service;

use std::env;
use std::io::{IsTerminal, stdin};
use std::path::Path;
use std::process::ExitCode;

use clap::ArgMatches;
use pump_bench::config::Config;
use serde_json::{Value, json};

use self::service::Service;
use crate::terminal::say_error;

/// Commands that the service carries out; the empty one is a dose.
const ASKED: [&str; 6] = ["", "prime", "purge", "run", "resume", "accept"];

/// Commands that the service carries out by their words as an order: a pump whose input is not well is not cleared.
const CLEAR: &str = "safety clear";

/// Commands that a service at the url of the configuration carries out too. Beside a service of these records the
/// record itself takes them.
const ASKED_AT_URL: [&str; 2] = ["safety stand", "vessel emptied"];

/// Command that a service at the url of the configuration answers. That of these records has nothing else to tell.
const STATUS: &str = "status";

/// Options with which a command is carried out by itself: they say so, move nothing, or name a motor or a balance of
/// their own.
const BY_ITSELF: [&str; 5] = ["no_service", "dry_run", "driver", "port", "until_scale"];

/// Has the service carry the command out. Returns its exit code, or none if the command is to be carried out by itself:
/// no service runs, it does not have this pump, or the command is not for it. A service that the configuration names by
/// its url is asked or the command is refused.
pub(crate) fn ask(matches: &ArgMatches, words: &[String], json: bool) -> Option<ExitCode> {
    if env::var_os("DOSE_SERVICE").is_some_and(|word| word == "off") {
        return None;
    }
    let (mut leaf, mut path) = (matches, Vec::new());
    while let Some((name, inner)) = leaf.subcommand() {
        path.push(name);
        leaf = inner;
    }
    let is_typed = |id: &str| {
        let known = leaf.ids().any(|known| known == id);
        known && leaf.value_source(id) == Some(clap::parser::ValueSource::CommandLine)
    };
    let command = path.join(" ");
    let (is_status, is_clear) = (command == STATUS, command == CLEAR);
    let is_at_url = ASKED_AT_URL.contains(&command.as_str());
    let is_here = BY_ITSELF.into_iter().any(is_typed) || (is_status && is_typed("state_dir"));
    if is_here || !(is_status || is_clear || is_at_url || ASKED.contains(&command.as_str())) {
        return None;
    }
    let text = |id: &str| leaf.try_get_raw(id).ok().flatten().and_then(|mut values| values.next());
    // A command that cannot find its configuration says so by itself.
    let config = Config::of_user(text("config").map(Path::new)).ok()?;
    let state_dir = text("state_dir").map(Into::into).or_else(|| config.state_dir().ok())?;
    let is_rack = path == ["run"] && text("rack").is_some();
    let typed = if path.first() == Some(&"safety") { text("name") } else { text("pump") };
    let named = typed.and_then(|pump| pump.to_str()).or(config.named_default_pump());
    let pump = if is_rack { "" } else { named.unwrap_or(config.default_pump()) };
    if let Some(service) = Service::beside(&state_dir) {
        if is_status || is_at_url {
            // The records are here, and each command reads and writes them by itself.
            if service.answers() {
                is_status.then(|| service.warn_of_schedule());
                return None;
            }
        } else {
            let begun = match is_clear {
                true => service.begin("/api/v1/command/order", &order::of(leaf, &path, pump, json)),
                false => service.begin("/api/v1/command", &typed_words(pump, words)?),
            };
            if let Some(answer) = begun {
                return Some(service.follow(answer, json));
            }
        }
    }
    // Where nobody names a pump, that service takes the default of its own configuration.
    let pump = if is_rack { "" } else { named.unwrap_or_default() };
    Some(match Service::at(config.service().url()?, &config) {
        Ok(service) if is_status => {
            let word = |id: &str| text(id).map(|word| word.to_string_lossy());
            let body = json!({"pump": pump, "rack": word("rack"), "all": is_typed("all"),
                "tube_limit": word("tube_limit"), "json": json});
            service.warn_of_schedule();
            service.follow(service.status(&body), json)
        }
        Ok(service) => service.follow(service.order(&order::of(leaf, &path, pump, json)), json),
        Err(failure) => {
            say_error(&failure, json);
            ExitCode::from(failure.exit_code())
        }
    })
}

/// Returns the body that has a service of this user's records carry out these words. `None` where nobody knows in which
/// folder they were typed.
fn typed_words(pump: &str, words: &[String]) -> Option<Value> {
    let folder = env::current_dir().ok()?;
    Some(json!({"pump": pump, "words": words, "folder": folder, "attended": stdin().is_terminal()}))
}
