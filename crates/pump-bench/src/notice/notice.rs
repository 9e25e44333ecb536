//! A notice: a fact for the user, with what a person can do about it.

use std::fmt;

use serde::{Serialize, Serializer};

use super::remedy::{Remedy, Wording};

/// A warning or a note for the user: a fact, and the remedies that a person has.
///
/// The text states the fact and names no command. A front end adds the remedies in words of its own.
///
/// ```
/// use pump_bench::notice::{Notice, Remedy};
///
/// let notice = Notice::from("the rollers' angle is unknown").with_remedy(Remedy::FindAngle);
/// assert_eq!(notice.to_string(), "the rollers' angle is unknown");
/// let worded = notice.worded(|_| "press the button `home`");
/// assert_eq!(worded, "the rollers' angle is unknown; press the button `home`");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    text: String,
    remedies: Vec<Remedy>,
}

impl Notice {
    /// Returns the notice with one more remedy.
    #[must_use]
    pub fn with_remedy(mut self, remedy: Remedy) -> Self {
        self.remedies.push(remedy);
        self
    }

    /// Drops a remedy that is no longer needed.
    pub(crate) fn drop_remedy(&mut self, remedy: Remedy) {
        self.remedies.retain(|other| *other != remedy);
    }

    /// Replaces a remedy where it stands.
    pub(crate) fn swap_remedy(&mut self, remedy: Remedy, by: Remedy) {
        self.remedies.iter_mut().filter(|other| **other == remedy).for_each(|other| *other = by);
    }

    /// Returns the text of the notice, without its remedies.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the remedies, in the order in which they are to be tried.
    pub fn remedies(&self) -> &[Remedy] {
        &self.remedies
    }

    /// Returns the text of the notice and its remedies in a front end's words.
    pub fn worded(&self, words: Wording) -> String {
        with_remedies(self.text.clone(), &self.remedies, words)
    }

    /// Returns the notice whose text has the remedies in a front end's words.
    #[must_use]
    pub(crate) fn told(&self, words: Wording) -> Self {
        Self { text: self.worded(words), remedies: Vec::new() }
    }
}

/// Returns a text with remedies after it, in a front end's words.
pub(crate) fn with_remedies(mut text: String, remedies: &[Remedy], words: Wording) -> String {
    for remedy in remedies {
        text.push_str("; ");
        text.push_str(words(*remedy));
    }
    text
}

impl From<String> for Notice {
    fn from(text: String) -> Self {
        Self { text, remedies: Vec::new() }
    }
}

impl From<&str> for Notice {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.pad(&self.text)
    }
}

/// Writes the notice as its text.
impl Serialize for Notice {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&self.text)
    }
}
