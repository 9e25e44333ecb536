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
/// count alike. A number, as `4`, `1.6mm` or `16#`, is a whole one: that of the rollers, the bore in mm, the tubing's
/// size or the head.
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
            words.iter().all(|word| match number(word) {
                Some(number) => has_number(head, number),
                None => text.contains(word),
            })
        })
        .collect()
}

/// Returns the number that a word is: digits, with a point or a fraction's stroke, before the sign of a size or a unit.
fn number(word: &str) -> Option<&str> {
    let bare = ["mm", "in", "#"].iter().find_map(|unit| word.strip_suffix(unit)).unwrap_or(word);
    let is_number = bare.contains(is_digit) && bare.chars().all(|c| is_digit(c) || c == '.' || c == '/');
    is_number.then_some(bare)
}

fn is_digit(c: char) -> bool {
    c.is_ascii_digit()
}

/// Returns true if a number is that of the head, its rollers, its bore or its size. The size or the bore stands first
/// in the tubing's words.
fn has_number(head: &BoughtHead, number: &str) -> bool {
    let value = number.parse::<f64>().ok();
    let is = |found: f64| value == Some(found);
    let same = |found: &str| found == number || found.parse().is_ok_and(is);
    head.rollers.is_some_and(|rollers| is(f64::from(rollers)))
        || head.bore_mm.is_some_and(is)
        || numbers(&head.head).any(same)
        || numbers(&head.tubing).next().is_some_and(same)
}

/// Returns the numbers in a text.
fn numbers(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c| !(is_digit(c) || c == '.' || c == '/')).filter(|part| part.contains(is_digit))
}
