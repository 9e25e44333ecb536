//! Commands and responses by their format strings, such as `queue_step oid=%c interval=%u count=%hu add=%hi`.

use super::number;

/// Argument of a command or response.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in super::super) enum Argument {
    Number(u32),
    Bytes(Vec<u8>),
}

impl From<u32> for Argument {
    fn from(number: u32) -> Self {
        Self::Number(number)
    }
}

/// Form of a message: its name and which of its parameters are bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in super::super) struct Shape {
    pub(in super::super) name: &'static str,
    are_bytes: Vec<bool>,
}

impl Shape {
    /// Reads a format string. A parameter with a star is a string of bytes, and the others are numbers.
    pub(in super::super) fn of(format: &'static str) -> Self {
        let mut words = format.split(' ');
        let name = words.next().unwrap_or_default();
        Self { name, are_bytes: words.map(|word| word.contains('*')).collect() }
    }

    /// Takes the arguments of a message from the front of `bytes`, or `None` if they do not fit.
    pub(in super::super) fn take(&self, bytes: &mut &[u8]) -> Option<Vec<Argument>> {
        self.are_bytes
            .iter()
            .map(|is_bytes| {
                let value = number::take(bytes)?;
                if !is_bytes {
                    return Some(Argument::Number(value));
                }
                let (text, rest) = bytes.split_at_checked(usize::try_from(value).ok()?)?;
                *bytes = rest;
                Some(Argument::Bytes(text.to_vec()))
            })
            .collect()
    }

    /// Returns the bytes of a message with this number.
    pub(in super::super) fn bytes(&self, id: u32, arguments: &[Argument]) -> Vec<u8> {
        assert_eq!(arguments.len(), self.are_bytes.len(), "the arguments of {}", self.name);
        let mut bytes = Vec::new();
        number::put(&mut bytes, id);
        for argument in arguments {
            match argument {
                Argument::Number(value) => number::put(&mut bytes, *value),
                Argument::Bytes(text) => {
                    number::put(&mut bytes, text.len() as u32);
                    bytes.extend(text);
                }
            }
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::{Argument, Shape};

    #[test]
    fn the_documentations_commands_are_encoded_as_it_says() {
        // docs/Protocol.md, "Message Block Contents": set_digital_out pin=86 value=1 is its number, 86 and 1.
        let shape = Shape::of("set_digital_out pin=%u value=%c");
        assert_eq!(shape.bytes(9, &[86.into(), 1.into()]), [9, 86, 1]);
        // docs/Protocol.md, first page: queue_step oid=7 interval=7458 count=10 add=331.
        let shape = Shape::of("queue_step oid=%c interval=%u count=%hu add=%hi");
        let numbers = [7, 7458, 10, 331].map(Argument::from);
        let bytes = shape.bytes(16, &numbers);
        assert_eq!(bytes, [16, 7, 0x80 | 58, 34, 10, 0x80 | 2, 75]);
        assert_eq!(shape.take(&mut &bytes[1..]), Some(numbers.to_vec()));
        assert_eq!(shape.take(&mut &bytes[1..6]), None);
    }

    #[test]
    fn strings_are_their_length_and_their_bytes() {
        let shape = Shape::of("identify_response offset=%u data=%.*s");
        let arguments = [Argument::Number(300), Argument::Bytes(vec![1, 2, 0x7e])];
        let bytes = shape.bytes(0, &arguments);
        assert_eq!(bytes, [0, 0x82, 44, 3, 1, 2, 0x7e]);
        assert_eq!(shape.take(&mut &bytes[1..]), Some(arguments.to_vec()));
        assert_eq!(shape.take(&mut &bytes[1..6]), None);
    }
}
