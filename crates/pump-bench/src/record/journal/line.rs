//! One line of a journal: JSON with the checksum of its contents.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// Line as it stands in the file.
#[derive(Serialize, Deserialize)]
struct Line<'a> {
    /// CRC-32 (ISO-HDLC) of the bytes of `entry`, as eight hexadecimal digits. In a line with a number it is
    /// that of the number's digits, a space, and the bytes of `entry`.
    crc32: String,
    /// Number of the line, one more than that of the line before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    number: Option<u64>,
    #[serde(borrow)]
    entry: &'a RawValue,
}

/// Encodes an entry as a line with its newline.
pub(crate) fn encode(entry: &impl Serialize) -> serde_json::Result<String> {
    encoded(None, entry)
}

/// Encodes an entry as a line with its number and its newline.
pub(super) fn encode_numbered(number: u64, entry: &impl Serialize) -> serde_json::Result<String> {
    encoded(Some(number), entry)
}

/// Decodes the entry of a line without its newline. The error describes the damage.
pub(crate) fn decode<T: DeserializeOwned>(line: &str) -> Result<T, String> {
    decode_numbered(line).map(|(_, entry)| entry)
}

/// Decodes the number, if there is one, and the entry of a line without its newline. The error describes the
/// damage.
pub(in crate::record) fn decode_numbered<T: DeserializeOwned>(
    line: &str,
) -> Result<(Option<u64>, T), String> {
    let line: Line<'_> = serde_json::from_str(line).map_err(|error| error.to_string())?;
    let text = line.entry.get();
    let crc32 = checksum(line.number, text);
    if crc32 != line.crc32 {
        return Err(format!("its checksum is {crc32}, not {} as written", line.crc32));
    }
    let entry = serde_json::from_str(text).map_err(|error| error.to_string())?;
    Ok((line.number, entry))
}

fn encoded(number: Option<u64>, entry: &impl Serialize) -> serde_json::Result<String> {
    let text = serde_json::to_string(entry)?;
    let line = Line { crc32: checksum(number, &text), number, entry: serde_json::from_str(&text)? };
    Ok(serde_json::to_string(&line)? + "\n")
}

fn checksum(number: Option<u64>, entry: &str) -> String {
    let hash = match number {
        Some(number) => crc32fast::hash(format!("{number} {entry}").as_bytes()),
        None => crc32fast::hash(entry.as_bytes()),
    };
    format!("{hash:08x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_comes_back_and_a_changed_one_does_not() {
        let entry = (1.0 / 3.0, "a\nb".to_owned());
        for number in [None, Some(17)] {
            let line = encoded(number, &entry).unwrap();
            assert_eq!(line.matches('\n').count(), 1);
            assert_eq!(decode_numbered(line.trim_end()), Ok((number, entry.clone())));
            for n in 0..line.len() - 1 {
                let mut bytes = line.clone().into_bytes();
                bytes[n] ^= 1;
                let changed = String::from_utf8(bytes).unwrap();
                assert!(decode::<(f64, String)>(changed.trim_end()).is_err(), "{changed}");
                assert!(decode::<(f64, String)>(&line[..n]).is_err(), "{n}");
            }
        }
    }
}
