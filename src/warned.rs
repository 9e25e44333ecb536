//! The warnings that a command has told. Each kind is told once.

use std::collections::BTreeSet;

use pump_bench::notice::Notice;

/// The kinds of warning that were told.
#[derive(Debug, Default)]
pub(crate) struct Warned(BTreeSet<String>);

impl Warned {
    /// The warnings of kinds that were not told yet. They count as told from now on.
    pub(crate) fn untold(&mut self, warnings: &[Notice]) -> Vec<Notice> {
        warnings.iter().filter(|warning| self.0.insert(kind(warning.text()))).cloned().collect()
    }
}

/// The words of a warning without its numbers: those of one kind differ from dose to dose.
fn kind(text: &str) -> String {
    // A sign or a bracket may stand before the first digit, as in `(±0.12`.
    let is_number =
        |word: &str| word.chars().find(|letter| letter.is_alphanumeric()).is_some_and(char::is_numeric);
    text.split(' ').filter(|word| !is_number(word)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_told_once_whatever_its_numbers() {
        let mut warned = Warned::default();
        let of = |text: &str| vec![Notice::from(text.to_owned())];
        let peak = |rpm: &str| of(&format!("the dose peaks at {rpm} r/min, and was calibrated to -3 r/min"));
        assert_eq!(warned.untold(&peak("2.5289")), peak("2.5289"));
        assert_eq!(warned.untold(&peak("26.342")), []);
        let late =
            |by: &str| of(&format!("the dose took longer than planned (0.{by} s, ±{by} %, [{by}..9])"));
        assert_eq!(warned.untold(&late("12")), late("12"));
        assert_eq!(warned.untold(&late("345")), []);
        let other = of("the tube has 2.5289 mL left");
        assert_eq!(warned.untold(&other), other);
    }
}
