//! The facts of an error: its kind, the value and what is allowed.

use std::error::Error;
use std::fmt::Display;

use super::kind::ErrorKind;
use crate::notice::{Remedy, Wording, with_remedies, with_sources};
use crate::report::ending::Ending;

/// Facts of an error, as programs read them.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct ErrorFacts {
    /// Kind of the error.
    pub kind: ErrorKind,
    /// Value that is wrong, with its unit where it has one. `None` if no single value is wrong.
    pub value: Option<String>,
    /// Values that are allowed. `None` if there is no such range or list.
    pub allowed: Option<String>,
}

impl ErrorFacts {
    /// Returns the facts of an error without a value.
    pub fn of(kind: ErrorKind) -> Self {
        Self { kind, value: None, allowed: None }
    }

    /// Returns the facts of an error with the value that is wrong.
    #[must_use]
    pub fn value(self, value: impl Display) -> Self {
        Self { value: Some(value.to_string()), ..self }
    }

    /// Returns the facts of an error with the values that are allowed.
    #[must_use]
    pub fn allowed(self, allowed: impl Display) -> Self {
        Self { allowed: Some(allowed.to_string()), ..self }
    }
}

/// An error that tells programs its facts. Its text is for people.
pub trait Explain: Error {
    /// Returns the facts of the error.
    fn facts(&self) -> ErrorFacts;

    /// Tells how a command ends with this error. Most errors come before anything moves.
    fn ending(&self) -> Ending {
        Ending::Refused
    }

    /// Returns the remedies of the error, in the order in which they are to be tried. The text of the error has
    /// none of them: the command and Python word remedies in ways of their own.
    fn remedies(&self) -> Vec<Remedy> {
        Vec::new()
    }

    /// Returns the text of the error and of all its sources, and then the remedies in a front end's words.
    fn told(&self, words: Wording) -> String
    where
        Self: Sized,
    {
        with_remedies(with_sources(self), &self.remedies(), words)
    }
}

impl<E: Explain> Explain for &E {
    fn facts(&self) -> ErrorFacts {
        (*self).facts()
    }

    fn ending(&self) -> Ending {
        (*self).ending()
    }

    fn remedies(&self) -> Vec<Remedy> {
        (*self).remedies()
    }
}
