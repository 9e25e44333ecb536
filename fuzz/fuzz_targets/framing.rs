//! Frames with a right checksum around any header and body.

/// Returns a frame with this version, number, session and body.
pub fn framed(version: u8, number: u16, session: u64, received_at: Option<u64>, body: &[u8]) -> Vec<u8> {
    let mut plain = vec![version];
    plain.extend(number.to_le_bytes());
    plain.extend(session.to_le_bytes());
    plain.extend(received_at.map(u64::to_le_bytes).into_iter().flatten());
    plain.extend(body);
    let sum = crc32fast::hash(&plain);
    plain.extend(sum.to_le_bytes());
    let mut coded = vec![0; cobs::max_encoding_length(plain.len())];
    let len = cobs::encode(&plain, &mut coded);
    coded.truncate(len);
    [&[0], &coded[..], &[0]].concat()
}
