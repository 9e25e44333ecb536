//! Texts that a person can read, whatever a program has passed.

/// Longest number, and longest word, that a message repeats.
const LONGEST_NUMBER: usize = 24;
const LONGEST_WORD: usize = 80;

/// Returns a message with its long numbers in scientific notation and its long words cut.
pub(crate) fn readable(message: &str) -> String {
    let mut read = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(first) = rest.chars().next() {
        let is_number = is_of_number(first);
        let is_space = first.is_whitespace();
        let ends = |c: char| is_of_number(c) != is_number || c.is_whitespace() != is_space;
        let (part, after) = rest.split_at(rest.find(ends).unwrap_or(rest.len()));
        read += &shortened(part, is_number);
        rest = after;
    }
    read
}

fn is_of_number(c: char) -> bool {
    c.is_ascii_digit() || c == '.'
}

fn shortened(part: &str, is_number: bool) -> String {
    let (longest, number) = match is_number {
        true => (LONGEST_NUMBER, part.parse::<f64>().ok().filter(|number| number.is_finite())),
        false => (LONGEST_WORD, None),
    };
    if part.chars().count() <= longest {
        return part.to_owned();
    }
    match number {
        Some(number) => format!("{number:e}"),
        None => {
            let head: String = part.chars().take(longest - 4).collect();
            format!("{head}... ({} characters)", part.chars().count())
        }
    }
}
