//! Numbers as an 8-bit board reads and prints them: in single precision.

/// Reads a number at the start of `text`, and returns it with the rest of the text. Digits beyond the
/// eighth count as zeros.
pub(super) fn read(text: &str) -> Option<(f32, &str)> {
    let (negative, body) = match text.strip_prefix('-') {
        Some(body) => (true, body),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (mut digits, mut whole, mut power, mut pointed, mut used) = (0_u32, 0_u32, 0_i32, false, 0);
    for character in body.chars() {
        match character.to_digit(10) {
            Some(digit) => {
                digits += 1;
                if digits <= 8 {
                    whole = whole * 10 + digit;
                    power -= i32::from(pointed);
                } else {
                    power += i32::from(!pointed);
                }
            }
            None if character == '.' && !pointed => pointed = true,
            None => break,
        }
        used += 1;
    }
    if digits == 0 {
        return None;
    }
    let mut value = whole as f32;
    while power <= -2 {
        value *= 0.01;
        power += 2;
    }
    if power == -1 {
        value *= 0.1;
    }
    for _ in 0..power.max(0) {
        value *= 10.0;
    }
    Some((if negative { -value } else { value }, &body[used..]))
}

/// Prints `value` with this number of decimals, rounded in single precision.
pub(super) fn print(value: f32, decimals: u32) -> String {
    let mut scaled = value.abs();
    let mut left = decimals;
    while left >= 2 {
        scaled *= 100.0;
        left -= 2;
    }
    if left == 1 {
        scaled *= 10.0;
    }
    let whole = (scaled + 0.5) as u64;
    let unit = 10_u64.pow(decimals);
    let sign = if value < 0.0 { "-" } else { "" };
    format!("{sign}{}.{:0width$}", whole / unit, whole % unit, width = decimals as usize)
}
