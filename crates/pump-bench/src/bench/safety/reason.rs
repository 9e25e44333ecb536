//! The reason that a person or a program gives, as the journal keeps it.

/// Longest reason that is kept, in bytes.
const MOST: usize = 1000;

/// Passes a reason without the spaces around it. `empty` is what is wrong with an empty one.
///
/// # Errors
///
/// Fault of the reason: it is empty, or too long.
pub(super) fn checked<'a>(reason: &'a str, empty: &'static str) -> Result<&'a str, &'static str> {
    let reason = reason.trim();
    if reason.is_empty() {
        return Err(empty);
    }
    if reason.len() > MOST {
        return Err("the reason is longer than 1000 bytes");
    }
    Ok(reason)
}
