//! A message of the board, and the values of a command.

use std::sync::Arc;

use super::error::MessageError;
use super::format::Format;

/// Value of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives::klipper) enum Value<'a> {
    /// Number of any size.
    Number(i64),
    /// Bytes.
    Bytes(&'a [u8]),
}

impl<'a> From<&'a [u8]> for Value<'a> {
    fn from(bytes: &'a [u8]) -> Self {
        Self::Bytes(bytes)
    }
}

/// Makes values of numbers.
macro_rules! numbers {
    ($($number:ty),*) => {
        $(impl From<$number> for Value<'_> {
            fn from(number: $number) -> Self {
                Self::Number(i64::from(number))
            }
        })*
    };
}

numbers!(bool, u8, u16, u32, i16, i32, i64);

/// Value that came from the board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Received {
    Number(i64),
    Bytes(Vec<u8>),
}

/// Message of the board.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::drives::klipper) struct Message {
    format: Arc<Format>,
    values: Vec<Received>,
}

impl Message {
    pub(super) fn new(format: Arc<Format>, values: Vec<Received>) -> Self {
        Self { format, values }
    }

    /// Returns the name of the message. An output for people has none.
    pub(in crate::drives::klipper) fn name(&self) -> &str {
        self.format.name()
    }

    /// Returns a number by its name.
    pub(in crate::drives::klipper) fn number(&self, parameter: &str) -> Result<i64, MessageError> {
        match self.value(parameter) {
            Some(Received::Number(number)) => Ok(*number),
            _ => Err(self.missing("number", parameter)),
        }
    }

    /// Returns a number by its name, as 32 bits without a sign.
    pub(in crate::drives::klipper) fn unsigned(&self, parameter: &str) -> Result<u32, MessageError> {
        Ok(self.number(parameter)? as u32)
    }

    /// Returns bytes by their name.
    pub(in crate::drives::klipper) fn bytes(&self, parameter: &str) -> Result<&[u8], MessageError> {
        match self.value(parameter) {
            Some(Received::Bytes(bytes)) => Ok(bytes),
            _ => Err(self.missing("bytes", parameter)),
        }
    }

    /// Returns the message in words, with its values at their places.
    #[cfg(test)]
    pub(in crate::drives::klipper) fn text(&self) -> String {
        let mut values = self.values.iter();
        self.format.text(|| match values.next() {
            Some(Received::Number(number)) => number.to_string(),
            Some(Received::Bytes(bytes)) => bytes.escape_ascii().to_string(),
            None => String::new(),
        })
    }

    fn value(&self, parameter: &str) -> Option<&Received> {
        let place = self.format.parameters().iter().position(|(name, _)| name == parameter)?;
        self.values.get(place)
    }

    fn missing(&self, kind: &'static str, parameter: &str) -> MessageError {
        MessageError::Missing { message: self.name().to_owned(), kind, parameter: parameter.to_owned() }
    }
}
