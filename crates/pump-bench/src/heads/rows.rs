//! The rows of the catalogue: all of them, one by its name, and those that match words.

use std::sync::OnceLock;

use super::bought_head::BoughtHead;
use super::table::rows_of;

/// Text of the catalogue.
const TEXT: &str = include_str!("heads.toml");

/// Returns the heads of the catalogue, in its order.
///
/// ```
/// assert!(pump_bench::heads::bought_heads().len() >= 40);
/// ```
pub fn bought_heads() -> &'static [BoughtHead] {
    static ROWS: OnceLock<Vec<BoughtHead>> = OnceLock::new();
    // A test reads the same text, so that no release has another.
    ROWS.get_or_init(|| rows_of(TEXT).unwrap_or_else(|error| unreachable!("heads.toml: {error}")))
}

/// Returns the head of a name, or `None` for another name.
pub fn bought_head(name: &str) -> Option<&'static BoughtHead> {
    bought_heads().iter().find(|head| head.name == name)
}

/// Returns the heads of which every word is in the name, the maker, the head or the tubing. Small and capital letters
/// count alike.
///
/// ```
/// let names: Vec<_> = pump_bench::heads::heads_matching(&["kamoer", "1.52"]).iter().map(|head| &head.name).collect();
/// assert_eq!(names, ["kamoer-kpmp10-1-52mm"]);
/// ```
pub fn heads_matching(words: &[impl AsRef<str>]) -> Vec<&'static BoughtHead> {
    let words: Vec<String> = words.iter().map(|word| word.as_ref().to_lowercase()).collect();
    bought_heads()
        .iter()
        .filter(|head| {
            let text = format!("{} {} {} {}", head.name, head.maker, head.head, head.tubing).to_lowercase();
            words.iter().all(|word| text.contains(word))
        })
        .collect()
}
