//! A frame of another version of the protocol: its first byte is the version, at the same place in all of them.

/// Bytes of the checksum at the end of a frame.
const SUM_BYTES: usize = 4;

/// Returns a frame, with a zero at each end, as firmware of this version would send it.
pub(super) fn spoken(frame: &[u8], version: u8) -> Vec<u8> {
    let mut payload = plain(frame);
    payload.truncate(payload.len().saturating_sub(SUM_BYTES));
    if let Some(first) = payload.first_mut() {
        *first = version;
    }
    let sum = crc32fast::hash(&payload);
    payload.extend(sum.to_le_bytes());
    coded(&payload)
}

/// Returns the bytes of a frame that is shorter than 254 bytes: each coded byte that tells a distance stands for a zero
/// (COBS).
fn plain(frame: &[u8]) -> Vec<u8> {
    let mut coded = frame.iter().copied().filter(|byte| *byte != 0);
    let mut plain = Vec::new();
    while let Some(distance) = coded.next() {
        plain.extend(coded.by_ref().take(usize::from(distance) - 1));
        plain.push(0);
    }
    plain.pop();
    plain
}

/// Returns the frame of these bytes.
fn coded(plain: &[u8]) -> Vec<u8> {
    let mut coded = vec![0];
    for part in plain.split(|byte| *byte == 0) {
        coded.push(part.len() as u8 + 1);
        coded.extend(part);
    }
    coded.push(0);
    coded
}
