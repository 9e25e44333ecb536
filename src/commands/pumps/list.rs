//! `dose pumps list`: the built-in pumps, or the bought heads of the catalogue.

use clap::Args;
use pump_bench::catalogue::BUILT_IN;
use pump_bench::heads::{heads_json, heads_matching, heads_text, nearest_heads};
use pump_bench::report::ErrorKind;
use serde::Serialize;

use crate::failure::Failure;
use crate::options::report::FormatOption;
use crate::terminal::{print, tell};

#[derive(Debug, Default, Args)]
pub(crate) struct ListArgs {
    /// List bought heads and their tubings, with mL per revolution as published
    #[arg(long)]
    catalogue: bool,
    /// Words that the name, maker, head or tubing must have
    #[arg(value_name = "WORD", requires = "catalogue")]
    words: Vec<String>,
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
                let json = serde_json::json!({ "schema": "pump-list/1", "pumps": pumps });
                print(&format!("{json}\n"))
            }
            false => print(&BUILT_IN.map(|(name, what)| format!("{name:<24}{what}\n")).concat()),
        }
    }

    /// Lists the heads with all of these words.
    fn list_heads(&self, words: &[String]) -> Result<(), Failure> {
        let heads = heads_matching(words);
        if heads.is_empty() {
            let words = words.join(" ");
            let nearest = nearest_heads(&words).join(", ");
            let refused = Failure::refused(format!(
                "no head of the catalogue has the words `{words}`; the nearest are {nearest}"
            ));
            return Err(refused.kind(ErrorKind::Usage).value(&words).allowed(&nearest));
        }
        if self.format.json() {
            print(&(heads_json(&heads) + "\n"))
        } else {
            tell(&(heads_text(&heads) + "`dose calibrate run` weighs what yours delivers.\n"))
        }
    }
}
