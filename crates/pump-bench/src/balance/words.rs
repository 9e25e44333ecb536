//! The words of a balance, fit for a message.

/// Most characters of a balance that a message repeats.
const MOST: usize = 60;

/// Returns a line as a message shows it: no control characters, and no more than 60 characters.
pub(in crate::balance) fn shown_line(text: &str) -> String {
    let text: String = text.trim().chars().filter(|c| !c.is_control()).collect();
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", text.get(..end).unwrap_or_default()),
        None => text,
    }
}
