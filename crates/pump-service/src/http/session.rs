//! Logins of people at the page. They hold over a restart of the service, and end with its token.

use std::fmt::Write;

use axum::http::StatusCode;
use jiff::{SignedDuration, Timestamp};
use sha2::{Digest, Sha256};

use super::failure::Failure;
use crate::history::History;
use crate::order::random_hex;
use crate::service::Refusal;

/// Name of the cookie.
pub(super) const SESSION_COOKIE: &str = "dose-session";

/// Time for which a login holds.
pub(super) const HOLDS: SignedDuration = SignedDuration::from_hours(30 * 24);

/// Begins a login with this token. Returns the value of its cookie.
pub(super) fn begin(history: &History, token: &str) -> Result<String, Failure> {
    let failed = |error| Failure::new(StatusCode::INTERNAL_SERVER_ERROR, "service", error);
    let value = random_hex::<32>().map_err(failed)?;
    history.begin_login(&mark(token, &value), Timestamp::now()).map_err(Refusal::from)?;
    Ok(value)
}

/// Returns true if the login of this cookie holds.
pub(super) fn holds(history: &History, token: &str, value: &str) -> Result<bool, Failure> {
    let since = Timestamp::now().checked_sub(HOLDS).unwrap_or(Timestamp::MIN);
    Ok(history.has_login(&mark(token, value), since).map_err(Refusal::from)?)
}

/// The mark of a login on record. Whoever reads it learns no cookie, and another token has other marks.
fn mark(token: &str, value: &str) -> String {
    let digest = Sha256::new().chain_update(token).chain_update([0]).chain_update(value).finalize();
    digest.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
