//! One line of a journal: JSON with the checksum of its contents.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// Line as it stands in the file.
#[derive(Serialize, Deserialize)]
struct Line<'a> {
    /// CRC-32 (ISO-HDLC) of the bytes of `entry`, as eight hexadecimal digits.
    crc32: String,
    #[serde(borrow)]
    entry: &'a RawValue,
}

/// Encodes an entry as a line with its newline.
pub(crate) fn encode(entry: &impl Serialize) -> serde_json::Result<String> {
    let text = serde_json::to_string(entry)?;
    let crc32 = format!("{:08x}", crc32fast::hash(text.as_bytes()));
    let line = Line { crc32, entry: serde_json::from_str(&text)? };
    Ok(serde_json::to_string(&line)? + "\n")
}

/// Decodes the entry of a line without its newline. The error describes the damage.
pub(crate) fn decode<T: DeserializeOwned>(line: &str) -> Result<T, String> {
    let line: Line<'_> = serde_json::from_str(line).map_err(|error| error.to_string())?;
    let text = line.entry.get();
    let crc32 = format!("{:08x}", crc32fast::hash(text.as_bytes()));
    if crc32 != line.crc32 {
        return Err(format!("its checksum is {crc32}, not {} as written", line.crc32));
    }
    serde_json::from_str(text).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_comes_back_and_a_changed_one_does_not() {
        let line = encode(&(1.0 / 3.0, "a\nb")).unwrap();
        assert_eq!(line.matches('\n').count(), 1);
        assert_eq!(decode::<(f64, String)>(line.trim_end()), Ok((1.0 / 3.0, "a\nb".to_owned())));
        for n in 0..line.len() - 1 {
            let mut bytes = line.clone().into_bytes();
            bytes[n] ^= 1;
            let changed = String::from_utf8(bytes).unwrap();
            assert!(decode::<(f64, String)>(changed.trim_end()).is_err(), "{changed}");
            assert!(decode::<(f64, String)>(&line[..n]).is_err(), "{n}");
        }
    }
}
