//! A list of bought heads: JSON for programs, a table for people.

use std::collections::BTreeSet;
use std::fmt::Write;

use serde::Serialize;

use super::bought_head::BoughtHead;
use crate::notice::{Remedy, Wording};
use crate::numbers::significant;

/// The list as JSON.
#[derive(Serialize)]
struct HeadList<'a> {
    schema: &'static str,
    heads: &'a [&'a BoughtHead],
}

/// Returns the heads as one line of JSON (`schema` `head-list/1`).
pub fn heads_json(heads: &[&BoughtHead]) -> String {
    let list = HeadList { schema: "head-list/1", heads };
    serde_json::to_string(&list).unwrap_or_else(|error| unreachable!("heads are plain values: {error}"))
}

/// Returns the heads as a table, with the documents below it. A front end words what makes a head surer.
///
/// ```
/// use pump_bench::heads::{heads_matching, heads_text};
///
/// let text = heads_text(&heads_matching(&["masterflex", "16"]), |_| "weigh it");
/// assert!(text.contains("masterflex-ls-16          0.8         -        3.1       program"), "{text}");
/// ```
pub fn heads_text(heads: &[&BoughtHead], words: Wording) -> String {
    let mut text = String::new();
    let mut line = |name: &str, ml: &str, rollers: &str, bore: &str, figures: &str| {
        let _ = writeln!(text, "{name:<26}{ml:<12}{rollers:<9}{bore:<10}{figures}");
    };
    line("head and tubing", "mL/rev", "rollers", "bore mm", "figures");
    for head in heads {
        let known = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
        let rollers = known(head.rollers.map(|rollers| rollers.to_string()));
        let bore = known(head.bore_mm.map(|bore| significant(bore, 4)));
        line(&head.name, &significant(head.ml_per_rev, 4), &rollers, &bore, head.source.kind.as_str());
    }
    let mut told = BTreeSet::new();
    for head in heads {
        let source = &head.source;
        let cited = source.cited();
        if told.insert(cited.clone()) {
            let _ = writeln!(text, "\n{}: {cited}\n  {}", source.kind, source.address);
        }
    }
    let surer = words(Remedy::WeighToBeSurer);
    let _ = writeln!(text, "\nA head that nobody has weighed may differ by 10 to 25 %; {surer}.");
    text
}
