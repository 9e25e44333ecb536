//! Requests that are refused: other sites, missing tokens, bodies without end, and more connections than there are.

use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::json;

use crate::laboratory::{Laboratory, PATIENCE, Service};

/// Sends bytes and reads the answer to its end, or to the end of the patience.
fn raw(url: &str, bytes: &[u8]) -> String {
    let mut stream = connect(url);
    stream.write_all(bytes).unwrap();
    let mut answer = Vec::new();
    // A connection that is closed while bytes are on their way may be reset.
    if let Err(error) = stream.read_to_end(&mut answer) {
        assert!(
            [ErrorKind::ConnectionReset, ErrorKind::WouldBlock, ErrorKind::TimedOut].contains(&error.kind())
        );
    }
    String::from_utf8_lossy(&answer).into_owned()
}

fn connect(url: &str) -> TcpStream {
    let stream = TcpStream::connect(url.trim_start_matches("http://")).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(15))).unwrap();
    stream.set_write_timeout(Some(PATIENCE)).unwrap();
    stream
}

#[test]
fn another_site_cannot_dose() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    let host = service.url.trim_start_matches("http://").to_owned();
    let body = r#"{"volume": "1mL"}"#;
    let post = |headers: &str| {
        let length = body.len();
        let head = "POST /api/v1/pumps/acid/dose HTTP/1.1\r\nconnection: close\r\n";
        raw(&service.url, format!("{head}content-length: {length}\r\n{headers}\r\n\r\n{body}").as_bytes())
    };
    let json = "content-type: application/json";
    for (headers, status) in [
        (format!("host: evil.example\r\n{json}"), "421"),
        (json.to_owned(), "421"),
        (format!("host: {host}\r\norigin: http://evil.example\r\n{json}"), "403"),
        (format!("host: {host}\r\norigin: null\r\n{json}"), "403"),
        (format!("host: {host}\r\nsec-fetch-site: cross-site\r\n{json}"), "403"),
        (format!("host: {host}\r\ncontent-type: text/plain"), "415"),
        (format!("host: {host}\r\ncontent-type: application/x-www-form-urlencoded"), "415"),
    ] {
        let answer = post(&headers);
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{headers}: {answer}");
        assert!(answer.contains("\"schema\":\"error/1\""), "{headers}: {answer}");
    }
    assert!(laboratory.log("acid").is_empty(), "nothing moved");
    assert!(post(&format!("host: {host}\r\n{json}")).starts_with("HTTP/1.1 202 "));
}

/// Logs in at the page. Returns the cookie.
fn logged_in(service: &Service, token: &str) -> String {
    let login = json!({"token": token}).to_string();
    let host = service.url.trim_start_matches("http://");
    let request = format!(
        "POST /login HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\nconnection: close\r\n\
         content-length: {}\r\n\r\n{login}",
        login.len()
    );
    let answer = raw(&service.url, request.as_bytes());
    let cookie = answer.lines().find(|line| line.starts_with("set-cookie: ")).unwrap();
    assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"), "{cookie}");
    cookie.trim_start_matches("set-cookie: ").split(';').next().unwrap().to_owned()
}

#[test]
fn a_login_outlives_a_restart_and_a_kill_and_ends_for_all_or_with_the_token() {
    let laboratory = Laboratory::new(&["acid"], "");
    fs::write(laboratory.path("token"), "0123456789abcdef\n").unwrap();
    let mut service = laboratory.serve(&["--token-file", "token"]);
    let phone = logged_in(&service, "0123456789abcdef");
    let may = |service: &Service, cookie: &str| service.get_with("/api/v1/pumps", &[("cookie", cookie)]).0;
    assert_eq!(may(&service, &phone), 200);
    service.end();
    let mut service = laboratory.serve_again(&service);
    assert_eq!(may(&service, &phone), 200, "after a restart");
    let tablet = logged_in(&service, "0123456789abcdef");
    service.kill();
    let mut service = laboratory.serve_again(&service);
    assert_eq!((may(&service, &phone), may(&service, &tablet)), (200, 200), "after a kill");
    let stopped = service.post_with("/api/v1/stop", &json!({}), &[("cookie", &phone)]);
    assert_eq!(stopped.0, 200, "{}", stopped.1);
    // No file tells a cookie.
    for file in ["history.sqlite", "history.sqlite-wal"] {
        let bytes = fs::read(laboratory.path("records").join(file)).unwrap();
        let value = phone.split_once('=').unwrap().1;
        assert!(!String::from_utf8_lossy(&bytes).contains(value), "{file}");
    }

    fs::write(laboratory.path("token"), "fedcba9876543210\n").unwrap();
    service.end();
    let mut service = laboratory.serve_again(&service);
    assert_eq!(may(&service, &phone), 401, "the token was changed");
    let phone = logged_in(&service, "fedcba9876543210");
    let tablet = logged_in(&service, "fedcba9876543210");
    assert_eq!(service.post_with("/logout", &json!({}), &[("cookie", &tablet)]).0, 200);
    assert_eq!(may(&service, &phone), 401, "all were logged out");
    service.end();
    assert_eq!(may(&laboratory.serve_again(&service), &phone), 401);
}

#[test]
fn other_computers_need_the_token_and_people_log_in() {
    let laboratory = Laboratory::new(&["acid"], "");
    let refused = laboratory.run(&["serve", "--listen", "0.0.0.0:0"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("has no token"));

    fs::write(laboratory.path("token"), "0123456789abcdef\n").unwrap();
    let service = laboratory.serve(&["--pace", "fast", "--token-file", "token"]);
    let dose = |headers: &[(&str, &str)]| {
        service.post_with("/api/v1/pumps/acid/dose", &json!({"volume": "1mL"}), headers)
    };
    assert_eq!(dose(&[]).0, 401);
    assert_eq!(dose(&[("authorization", "Bearer 0123456789abcdee")]).0, 401);
    assert_eq!(service.get("/api/v1/pumps").0, 401);
    assert_eq!(service.get("/events").0, 401);
    assert_eq!(service.get("/openapi.json").0, 401);
    assert_eq!(service.get("/login").1, json!({"needed": true, "may": false}));
    assert!(laboratory.log("acid").is_empty());
    let (status, order) = dose(&[("authorization", "Bearer 0123456789abcdef")]);
    assert_eq!(status, 202, "{order}");

    assert_eq!(service.post("/login", &json!({"token": "wrong"})).0, 401);
    let cookie = logged_in(&service, "0123456789abcdef");
    assert_eq!(service.get_with("/api/v1/pumps", &[("cookie", &cookie)]).0, 200);
    // A command of the same user on this machine needs no token.
    assert_eq!(laboratory.run(&["1mL"]).status.code(), Some(0));
}

#[test]
fn a_command_of_anybody_else_is_not_carried_out() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    let body = json!({"pump": "acid", "words": ["1mL"], "folder": "/", "attended": false});
    assert_eq!(service.post("/api/v1/command", &body).0, 403);
    assert_eq!(service.post_with("/api/v1/command", &body, &[("authorization", "Bearer x")]).0, 403);
    assert!(laboratory.log("acid").is_empty());
    use std::os::unix::fs::PermissionsExt;
    let mode = fs::metadata(laboratory.path("records/serve.json")).unwrap().permissions().mode();
    assert_eq!(mode & 0o077, 0, "only this user can read the token");
}

#[test]
fn a_query_that_cannot_be_read_is_an_error_like_any_other() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    for (path, word) in [
        ("/api/v1/pumps/acid/log?format=xml", "xml"),
        ("/api/v1/orders?limit=-1", "limit"),
        ("/api/v1/orders?colour=red", "colour"),
        ("/api/v1/notes?limit=many", "limit"),
    ] {
        let (status, error) = service.get(path);
        assert_eq!((status, &error["schema"]), (422, &"error/1".into()), "{path}: {error}");
        let message = error["message"].as_str().unwrap();
        assert!(message.starts_with("the query: ") && message.contains(word), "{path}: {message}");
    }
}

#[test]
fn a_body_without_end_and_a_head_without_end_are_refused() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    let host = service.url.trim_start_matches("http://");
    let head = format!(
        "POST /api/v1/pumps/acid/dose HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\n"
    );
    let long = format!("{head}connection: close\r\ncontent-length: 600000\r\n\r\n{}", " ".repeat(600_000));
    let mut stream = connect(&service.url);
    // The service may close before all is sent.
    let _ = stream.write_all(long.as_bytes());
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    let answer = String::from_utf8_lossy(&answer);
    assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 413 "), "{answer}");

    // A head that never ends is closed after its time; the others are answered meanwhile.
    let mut slow = connect(&service.url);
    slow.write_all(b"GET / HTTP/1.1\r\nhost: loc").unwrap();
    assert_eq!(service.get("/api/v1/pumps").0, 200);
    let mut rest = Vec::new();
    slow.read_to_end(&mut rest).unwrap();
    assert!(rest.is_empty() || rest.starts_with(b"HTTP/1.1 408"), "{}", String::from_utf8_lossy(&rest));
}

#[test]
fn a_thousand_connections_are_bounded_and_leave_the_service_whole() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    let mut open = Vec::new();
    let (mut refused, mut held) = (0, 0);
    for _ in 0..1000 {
        // A machine may have fewer file descriptors left: that too is a bound.
        let Ok(stream) = TcpStream::connect(service.url.trim_start_matches("http://")) else { break };
        stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        open.push(stream);
    }
    let host = service.url.trim_start_matches("http://").to_owned();
    for stream in &mut open {
        let _ = stream.write_all(format!("GET /login HTTP/1.1\r\nhost: {host}\r\n\r\n").as_bytes());
        let mut first = [0; 12];
        match stream.read_exact(&mut first) {
            Ok(()) if first.starts_with(b"HTTP/1.1 200") => held += 1,
            _ => refused += 1,
        }
    }
    assert!(held > 0 && held <= 256 && refused >= open.len() - 256, "{held} held, {refused} refused");
    drop(open);
    let answered = crate::laboratory::wait_for("the service to answer again", || {
        Some(service.get("/api/v1/pumps").0).filter(|status| *status == 200)
    });
    assert_eq!(answered, 200);
    service.ended(&service.dose("acid", "1mL", &json!({})));
}

#[test]
fn a_stop_is_answered_where_streams_and_idle_clients_have_every_place() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let id = service.dose("acid", "200mL", &json!({"rate": "0.5mL/s"}));
    service.moves("acid");
    let host = service.url.trim_start_matches("http://").to_owned();
    let mut streams = Vec::new();
    let is_held = |stream: &mut TcpStream| {
        stream.write_all(format!("GET /events HTTP/1.1\r\nhost: {host}\r\n\r\n").as_bytes()).unwrap();
        let mut first = [0; 12];
        stream.read_exact(&mut first).unwrap();
        first.starts_with(b"HTTP/1.1 200")
    };
    loop {
        let mut stream = connect(&service.url);
        if !is_held(&mut stream) {
            break;
        }
        streams.push(stream);
    }
    // Connections that were used before may still have a place each.
    assert!((240..=256).contains(&streams.len()), "{}", streams.len());
    // More than there are in reserve say nothing.
    let idle: Vec<TcpStream> = (0..200).map(|_| connect(&service.url)).collect();
    let (status, stopped) = service.post("/api/v1/stop", &json!({}));
    assert_eq!((status, &stopped["asked"]), (200, &json!([id])), "{stopped}");
    assert_eq!(service.get("/api/v1/pumps").0, 503, "only a stop has a place");
    drop((streams, idle));
    crate::laboratory::wait_for("a place", || (service.get("/api/v1/pumps").0 == 200).then_some(()));
    assert_eq!(service.ended(&id)["code"], 143);
}
