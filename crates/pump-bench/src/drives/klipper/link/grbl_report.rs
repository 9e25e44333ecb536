//! A report of grbl, by which a board that speaks grbl's protocol is known before any byte of Klipper's goes there.

/// Question for a report, to which grbl answers at once, and in a hold too (grbl 1.1, "Real-time Commands").
pub(super) const QUESTION: &[u8] = b"?";

/// Fewest letters of a state: `Run`, `Jog`.
const LETTERS: usize = 3;

/// Says if `bytes` hold the begin of a report, as `<Hold:0|` of grbl 1.1 or `<Hold,` of grbl 0.9.
pub(super) fn is_in(bytes: &[u8]) -> bool {
    bytes.split(|byte| *byte == b'<').skip(1).any(|report| {
        let letters = report.iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
        letters >= LETTERS && matches!(report.get(letters), Some(b'|' | b':' | b','))
    })
}
