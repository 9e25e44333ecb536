//! The format of a command or a message, as its string in the dictionary says.
//!
//! Source: Klipper3d/klipper, `docs/Protocol.md`, "Declaring commands" and "Message Block Contents".

use std::sync::Arc;

use super::block::CONTENT_MOST;
use super::error::MessageError;
use super::kind::Kind;
use super::message::{Message, Received, Value};
use super::number;

/// Format of a command or a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::drives::klipper) struct Format {
    id: i32,
    /// String of the dictionary, as `queue_step oid=%c interval=%u count=%hu add=%hi`.
    string: String,
    /// Name of the command or the message. It is empty for an output, which is a sentence for people.
    name: String,
    /// Parameters, by name and kind. Those of an output have no names.
    parameters: Vec<(String, Kind)>,
}

impl Format {
    /// Makes the format of a string such as `queue_step oid=%c interval=%u`. `None` if the string is no such format.
    pub(in crate::drives::klipper) fn new(id: i32, string: &str) -> Option<Self> {
        let mut words = string.split_ascii_whitespace();
        let name = words.next()?.to_owned();
        let parameters = words.map(|word| {
            let (name, place_holder) = word.split_once('=')?;
            Some((name.to_owned(), Kind::of(place_holder)?))
        });
        let parameters = parameters.collect::<Option<_>>()?;
        Some(Self { id, string: string.to_owned(), name, parameters })
    }

    /// Makes the format of an output: a sentence for people with place holders. `None` for an unknown place holder.
    pub(in crate::drives::klipper) fn output(id: i32, string: &str) -> Option<Self> {
        let mut parameters = Vec::new();
        let mut rest = string;
        while let Some(at) = rest.find('%') {
            rest = &rest[at..];
            rest = match rest.strip_prefix("%%") {
                Some(rest) => rest,
                None => {
                    let (kind, rest) = Kind::split(rest)?;
                    parameters.push((String::new(), kind));
                    rest
                }
            };
        }
        Some(Self { id, string: string.to_owned(), name: String::new(), parameters })
    }

    /// Returns the number of the command or the message.
    pub(in crate::drives::klipper) fn id(&self) -> i32 {
        self.id
    }

    /// Returns the name of the command or the message.
    pub(in crate::drives::klipper) fn name(&self) -> &str {
        &self.name
    }

    /// Returns the string of the dictionary.
    pub(in crate::drives::klipper) fn string(&self) -> &str {
        &self.string
    }

    /// Returns the parameters by name and kind.
    pub(in crate::drives::klipper) fn parameters(&self) -> &[(String, Kind)] {
        &self.parameters
    }

    /// Returns the bytes of a command with these values, one for each parameter.
    pub(in crate::drives::klipper) fn encode(&self, values: &[Value<'_>]) -> Result<Vec<u8>, MessageError> {
        let unfit = || MessageError::Values { format: self.string.clone(), given: values.len() };
        if values.len() != self.parameters.len() {
            return Err(unfit());
        }
        let mut bytes = Vec::new();
        number::put(&mut bytes, i64::from(self.id));
        for ((parameter, kind), value) in self.parameters.iter().zip(values) {
            match (value, kind.range()) {
                (Value::Number(value), Some(range)) if range.contains(value) => {
                    number::put(&mut bytes, *value);
                }
                (Value::Number(value), Some(range)) => {
                    let (least, most) = range.into_inner();
                    let (command, parameter, value) = (self.name.clone(), parameter.clone(), *value);
                    return Err(MessageError::Range { command, parameter, value, least, most });
                }
                (Value::Bytes(value), None) => {
                    number::put(&mut bytes, i64::try_from(value.len()).unwrap_or(i64::from(u32::MAX)));
                    bytes.extend_from_slice(value);
                }
                _ => return Err(unfit()),
            }
        }
        if bytes.len() > CONTENT_MOST {
            let (command, bytes) = (self.name.clone(), bytes.len());
            return Err(MessageError::Long { command, bytes, most: CONTENT_MOST });
        }
        Ok(bytes)
    }

    /// Takes the number of a message from the front of a content.
    pub(in crate::drives::klipper) fn take_id(content: &mut &[u8]) -> Result<i32, MessageError> {
        Ok(number::take(content)?.cast_signed())
    }

    /// Takes the values of a message from the front of a content, after its number.
    pub(in crate::drives::klipper) fn take(
        self: &Arc<Self>,
        content: &mut &[u8],
    ) -> Result<Message, MessageError> {
        let mut values = Vec::with_capacity(self.parameters.len());
        for (_, kind) in &self.parameters {
            let bits = number::take(content)?;
            values.push(if *kind == Kind::Bytes {
                let count = usize::try_from(bits).map_err(|_| MessageError::CutOff)?;
                let (bytes, rest) = content.split_at_checked(count).ok_or(MessageError::CutOff)?;
                *content = rest;
                Received::Bytes(bytes.to_vec())
            } else {
                Received::Number(kind.number(bits))
            });
        }
        Ok(Message::new(Arc::clone(self), values))
    }

    /// Returns the string with `value` in place of each place holder.
    #[cfg(test)]
    pub(super) fn text(&self, mut value: impl FnMut() -> String) -> String {
        let mut text = String::new();
        let mut rest = self.string.as_str();
        while let Some(at) = rest.find('%') {
            text.push_str(&rest[..at]);
            rest = &rest[at..];
            if let Some((_, after)) = Kind::split(rest) {
                text.push_str(&value());
                rest = after;
            } else {
                text.push('%');
                rest = rest.strip_prefix("%%").unwrap_or(&rest[1..]);
            }
        }
        text.push_str(rest);
        text
    }
}
