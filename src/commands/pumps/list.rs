//! `dose pumps list`: the pumps of the configuration and the built-in pumps, or the bought heads of the catalogue.

use clap::Args;
use pump_bench::catalogue::BUILT_IN;
use pump_bench::heads::{heads_json, heads_matching, heads_text, nearest_heads};
use pump_bench::report::{ErrorKind, ShownPump};
use serde::Serialize;

use crate::advice;
use crate::failure::Failure;
use crate::options::pump::ConfigOption;
use crate::options::report::FormatOption;
use crate::terminal::{print_json, tell};

#[derive(Debug, Args)]
pub(crate) struct ListArgs {
    /// List bought heads and their tubings, with mL per revolution as published
    #[arg(long)]
    catalogue: bool,
    /// Words that the name, maker, head or tubing must have
    #[arg(value_name = "WORD", requires = "catalogue")]
    words: Vec<String>,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    format: FormatOption,
}

/// A built-in pump in the list.
#[derive(Serialize)]
struct BuiltIn {
    name: &'static str,
    description: &'static str,
}

impl ListArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        match self.catalogue {
            true => self.list_heads(&self.words),
            false if self.format.json() => {
                let pumps = BUILT_IN.map(|(name, description)| BuiltIn { name, description });
                let configured = ShownPump::all(&self.config.config()?);
                let json =
                    serde_json::json!({ "schema": "pump-list/1", "configured": configured, "pumps": pumps });
                print_json(&format!("{json}\n"))
            }
            false => list_pumps(&self.config),
        }
    }

    /// Lists the heads with all of these words.
    fn list_heads(&self, words: &[String]) -> Result<(), Failure> {
        let heads = heads_matching(words);
        if heads.is_empty() {
            let words = words.join(" ");
            let nearest = nearest_heads(&words).join(", ");
            let refused = Failure::refused(format!(
                "no head of the catalogue has the words `{words}`; the nearest are {nearest}; a head that is not in \
                 the catalogue is known by its volume of a revolution, as `dose setup --ml-per-rev 0.5mL`"
            ));
            return Err(refused.kind(ErrorKind::Usage).value(&words).allowed(&nearest));
        }
        if self.format.json() {
            print_json(&(heads_json(&heads) + "\n"))
        } else {
            tell(&heads_text(&heads, advice::words))
        }
    }
}

/// Lists the pumps of the configuration with their files, then the built-in ones.
pub(super) fn list_pumps(config: &ConfigOption) -> Result<(), Failure> {
    let configured: String = ShownPump::all(&config.config()?).iter().map(ShownPump::line).collect();
    tell(&(configured + &BUILT_IN.map(|(name, what)| format!("{name:<24}{what}\n")).concat()))
}
