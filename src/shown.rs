//! Control characters in texts and in JSON: shown, and not obeyed. Names come from files and boards.

use std::borrow::Cow;

/// Shows the control characters of a text instead of obeying them: names come from files and boards. The marks that
/// turn the direction of writing are shown too, as they hide what a name is.
pub(crate) fn shown(text: &str) -> Cow<'_, str> {
    if !text.contains(steers) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if steers(c) { out.extend(c.escape_default()) } else { out.push(c) }
    }
    Cow::Owned(out)
}

/// True for a character that moves a terminal's cursor or turns the direction of writing.
fn steers(c: char) -> bool {
    let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || c.is_control() && c != '\n'
}

/// Writes the characters of JSON that steer a terminal as JSON's own escapes. A program reads them as they were.
pub(crate) fn json_shown(json: &str) -> Cow<'_, str> {
    if !json.contains(steers) {
        return Cow::Borrowed(json);
    }
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        // All of these characters lie in the basic plane: four digits name them.
        if steers(c) { out.push_str(&format!("\\u{:04x}", u32::from(c))) } else { out.push(c) }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown() {
        assert_eq!(shown("a\u{1b}[2J\r\u{9b}\u{202e}\nb°"), "a\\u{1b}[2J\\r\\u{9b}\\u{202e}\nb°");
    }

    #[test]
    fn control_characters_of_json_are_escaped_as_json_does() {
        let json = serde_json::json!({ "name": "a\u{1b}[2J\u{9b}\u{7f}\u{202e}b°" });
        let shown = json_shown(&format!("{json}\n")).into_owned();
        assert_eq!(shown, "{\"name\":\"a\\u001b[2J\\u009b\\u007f\\u202eb°\"}\n");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&shown).unwrap(), json);
    }
}
