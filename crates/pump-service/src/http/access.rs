//! The hosts, origins and tokens that may use the service.

use std::collections::BTreeSet;
use std::net::{IpAddr, SocketAddr};

use axum::http::header::{AUTHORIZATION, COOKIE, HOST, ORIGIN};
use axum::http::{HeaderMap, Method, StatusCode};
use thiserror::Error;

use super::failure::Failure;
use super::session::{self, SESSION_COOKIE};
use crate::history::History;

/// Shortest token, in bytes.
const SHORTEST_TOKEN: usize = 16;

/// Access that cannot be set up so.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AccessError {
    /// Other computers reach the address, and no token keeps them out.
    #[error(
        "{0} is reached by other computers, and the service has no token; name a file with a token, or listen on \
         127.0.0.1 alone"
    )]
    NoToken(SocketAddr),
    /// The token is too short.
    #[error("the token has {0} letters; at least 16 are needed, as `openssl rand -hex 16` makes them")]
    ShortToken(usize),
}

/// Rules of who may use the service.
#[derive(Debug)]
pub struct Access {
    /// Token of programs, and word of the page's login; `None` on an address that only this machine reaches.
    token: Option<String>,
    /// Token of commands of this user on this machine.
    local: String,
    /// Names and addresses by which the service may be called.
    hosts: BTreeSet<String>,
}

impl Access {
    /// Rules for a service at `listen`, which a proxy may call by one of `hosts`. `local` is the token of commands on
    /// this machine.
    ///
    /// # Errors
    ///
    /// [`AccessError`] if other computers reach the address and there is no good token.
    pub fn new(
        listen: SocketAddr,
        token: Option<String>,
        local: String,
        hosts: impl IntoIterator<Item = String>,
    ) -> Result<Self, AccessError> {
        match &token {
            None if !listen.ip().is_loopback() => return Err(AccessError::NoToken(listen)),
            Some(token) if token.len() < SHORTEST_TOKEN => return Err(AccessError::ShortToken(token.len())),
            _ => {}
        }
        let mut hosts: BTreeSet<String> = hosts.into_iter().map(|host| host.to_ascii_lowercase()).collect();
        hosts.extend(["localhost".to_owned(), "127.0.0.1".to_owned(), "[::1]".to_owned()]);
        if !listen.ip().is_unspecified() {
            hosts.insert(match listen.ip() {
                IpAddr::V4(ip) => ip.to_string(),
                IpAddr::V6(ip) => format!("[{ip}]"),
            });
        }
        Ok(Self { token, local, hosts })
    }

    /// Returns true if people log in.
    pub(super) fn needs_login(&self) -> bool {
        self.token.is_some()
    }

    /// Refuses a request that names another host: a page elsewhere whose name was bent to this address (DNS rebinding).
    pub(super) fn check_host(&self, headers: &HeaderMap) -> Result<(), Failure> {
        let host = headers.get(HOST).and_then(|host| host.to_str().ok()).unwrap_or_default();
        let name = without_port(host).to_ascii_lowercase();
        if self.hosts.contains(&name) || (self.token.is_some() && name.parse::<IpAddr>().is_ok()) {
            return Ok(());
        }
        let known = self.hosts.iter().cloned().collect::<Vec<_>>().join(", ");
        let host: String = host.chars().take(80).collect();
        let message = format!(
            "the service is not called `{}`; allowed: {known}; add the name to hosts in [service]",
            host.escape_debug()
        );
        Err(Failure::new(StatusCode::MISDIRECTED_REQUEST, "host", message))
    }

    /// Refuses a request that changes something and comes from a page of another site.
    pub(super) fn check_origin(&self, method: &Method, headers: &HeaderMap) -> Result<(), Failure> {
        if method == Method::GET || method == Method::HEAD {
            return Ok(());
        }
        let text = |name: &str| headers.get(name).and_then(|value| value.to_str().ok());
        let refused = |from: &str| {
            let from: String = from.chars().take(80).collect();
            let message = format!("a page of {} may not use the service", from.escape_debug());
            Err(Failure::new(StatusCode::FORBIDDEN, "origin", message))
        };
        if let Some(origin) = headers.get(ORIGIN) {
            let origin = origin.to_str().unwrap_or_default();
            let of_host = origin.split_once("://").map(|(_, host)| host);
            if of_host.is_none() || of_host != text(HOST.as_str()) {
                return refused(origin);
            }
        }
        match text("sec-fetch-site") {
            None | Some("same-origin" | "none") => Ok(()),
            Some(site) => refused(&format!("another site ({site})")),
        }
    }

    /// Refuses a request without a token or a login of the history, where one is needed.
    pub(super) fn check_token(&self, headers: &HeaderMap, history: &History) -> Result<(), Failure> {
        let Some(token) = &self.token else { return Ok(()) };
        let bearer = headers.get(AUTHORIZATION).and_then(|value| value.to_str().ok());
        let bearer = bearer.and_then(|value| value.strip_prefix("Bearer "));
        if bearer.is_some_and(|given| is_same(given, token))
            || self.is_local(headers)
            || is_logged_in(headers, history, token)?
        {
            return Ok(());
        }
        let message = "a token is needed: send the header `Authorization: Bearer <TOKEN>`, or log in at /";
        Err(Failure::new(StatusCode::UNAUTHORIZED, "token", message))
    }

    /// Returns true if the request has the token of commands on this machine.
    pub(super) fn is_local(&self, headers: &HeaderMap) -> bool {
        let bearer = headers.get(AUTHORIZATION).and_then(|value| value.to_str().ok());
        let bearer = bearer.and_then(|value| value.strip_prefix("Bearer "));
        bearer.is_some_and(|given| is_same(given, &self.local))
    }

    /// Begins a login with this token, and returns the value of its cookie. `None` if it is not the service's token.
    pub(super) fn log_in(&self, given: &str, history: &History) -> Result<Option<String>, Failure> {
        let token = self.token.as_ref().filter(|token| is_same(given, token));
        token.map(|token| session::begin(history, token)).transpose()
    }
}

/// Returns true if the request has the cookie of a login that holds.
fn is_logged_in(headers: &HeaderMap, history: &History, token: &str) -> Result<bool, Failure> {
    let cookies = headers.get_all(COOKIE).iter().filter_map(|cookie| cookie.to_str().ok());
    let pairs = cookies.flat_map(|cookies| cookies.split(';')).filter_map(|pair| pair.trim().split_once('='));
    for (_, value) in pairs.filter(|(name, _)| *name == SESSION_COOKIE) {
        if session::holds(history, token, value)? {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Compares in a time that tells nothing of the place of the first difference.
fn is_same(given: &str, token: &str) -> bool {
    let pairs = given.bytes().zip(token.bytes());
    given.len() == token.len() && pairs.fold(0, |differs, (one, two)| differs | (one ^ two)) == 0
}

/// Returns a host without its port.
fn without_port(host: &str) -> &str {
    match (host.rfind(':'), host.rfind(']')) {
        (Some(colon), Some(bracket)) if colon > bracket => &host[..colon],
        (Some(colon), None) => &host[..colon],
        _ => host,
    }
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderValue;

    use super::*;

    fn access(token: Option<&str>) -> Access {
        let listen = "127.0.0.1:8737".parse().unwrap();
        Access::new(listen, token.map(str::to_owned), "local-token".to_owned(), ["pumps.lab".to_owned()])
            .unwrap()
    }

    fn history() -> History {
        History::open(std::path::Path::new(":memory:")).unwrap()
    }

    fn headers(pairs: &[(&'static str, &'static str)]) -> HeaderMap {
        pairs.iter().map(|(name, value)| (name.parse().unwrap(), HeaderValue::from_static(value))).collect()
    }

    #[test]
    fn a_name_that_was_bent_to_this_address_is_refused() {
        let access = access(None);
        for host in ["localhost:8737", "127.0.0.1:8737", "[::1]:8737", "PUMPS.lab", "localhost"] {
            assert!(access.check_host(&headers(&[("host", host)])).is_ok(), "{host}");
        }
        for host in ["evil.example", "evil.example:8737", "", "127.0.0.1.evil.example", "10.0.0.7"] {
            assert!(access.check_host(&headers(&[("host", host)])).is_err(), "{host}");
        }
        assert!(access.check_host(&HeaderMap::new()).is_err());
    }

    #[test]
    fn a_post_of_another_site_is_refused_and_a_program_is_not() {
        let access = access(None);
        let post =
            |pairs: &[(&'static str, &'static str)]| access.check_origin(&Method::POST, &headers(pairs));
        let host = ("host", "localhost:8737");
        assert!(post(&[host]).is_ok());
        assert!(post(&[host, ("origin", "http://localhost:8737")]).is_ok());
        assert!(
            post(&[host, ("origin", "https://localhost:8737"), ("sec-fetch-site", "same-origin")]).is_ok()
        );
        for origin in
            ["http://evil.example", "null", "http://localhost:9999", "http://localhost:8737.evil.example"]
        {
            assert!(post(&[host, ("origin", origin)]).is_err(), "{origin}");
        }
        assert!(post(&[host, ("sec-fetch-site", "cross-site")]).is_err());
        assert!(post(&[host, ("sec-fetch-site", "same-site")]).is_err());
    }

    #[test]
    fn an_address_that_others_reach_needs_a_token() {
        let listen = "0.0.0.0:8737".parse().unwrap();
        let made = |token: Option<&str>| Access::new(listen, token.map(str::to_owned), String::new(), []);
        assert!(matches!(made(None), Err(AccessError::NoToken(_))));
        assert!(matches!(made(Some("short")), Err(AccessError::ShortToken(5))));
        assert!(made(Some("0123456789abcdef")).is_ok());
    }

    #[test]
    fn only_the_whole_token_opens() {
        let (access, history) = (access(Some("0123456789abcdef")), history());
        let opens =
            |given: &'static str| access.check_token(&headers(&[("authorization", given)]), &history).is_ok();
        assert!(opens("Bearer 0123456789abcdef"));
        assert!(opens("Bearer local-token"));
        for given in ["Bearer 0123456789abcde", "Bearer ", "0123456789abcdef", "Basic 0123456789abcdef"] {
            assert!(!opens(given), "{given}");
        }
        assert!(access.check_token(&HeaderMap::new(), &history).is_err());
    }

    #[test]
    fn a_login_ends_with_its_token_and_with_every_login() {
        let (token, history) = ("0123456789abcdef", history());
        let first = access(Some(token));
        assert_eq!(first.log_in("0123456789abcdee", &history).unwrap(), None);
        let value = first.log_in(token, &history).unwrap().unwrap();
        let cookie = HeaderValue::from_str(&format!("a=b; {SESSION_COOKIE}={value}")).unwrap();
        let headers = HeaderMap::from_iter([(COOKIE, cookie)]);
        assert!(first.check_token(&headers, &history).is_ok());
        // First with the token of before the restart, then with another one.
        assert!(access(Some(token)).check_token(&headers, &history).is_ok());
        assert!(access(Some("fedcba9876543210")).check_token(&headers, &history).is_err());
        history.end_logins().unwrap();
        assert!(first.check_token(&headers, &history).is_err());
    }
}
