//! Commands that find their service by the url of the configuration.

use std::fs;
use std::net::TcpListener;
use std::process::{Output, Stdio};

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, Service, signal};

const TOKEN: &str = "0123456789abcdef";

/// A laboratory whose service needs a token, and another one that names it by its url.
fn places(more: &str) -> (Laboratory, Service, Laboratory) {
    let there = Laboratory::new(&["acid", "base"], "");
    fs::write(there.path("token"), TOKEN).unwrap();
    let service = there.serve(&["--token-file", "token"]);
    let here = Laboratory::new(&["acid"], &format!("[service]\nurl = \"{}\"\n{more}", service.url));
    (there, service, here)
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).replace("\n  ", " ")
}

#[test]
fn a_command_is_carried_out_by_the_service_of_its_url_and_says_what_it_says_alone() {
    let (there, service, here) = places("token_file = \"word\"\n");
    fs::write(here.path("word"), format!("{TOKEN}\n")).unwrap();
    let alone = Laboratory::new(&["acid"], "");
    let text = |output: &Output| {
        let lines = String::from_utf8(output.stdout.clone()).unwrap();
        let timeless = |line: &&str| !line.contains("T") || !line.contains("+00:00");
        lines.lines().filter(timeless).map(str::to_owned).collect::<Vec<_>>()
    };
    for words in [&["2", "mL", "--rate", "2mL/s"][..], &["1mL", "-v"], &["prime", "3mL"]] {
        let asked = here.run(words);
        assert_eq!(asked.status.code(), Some(0), "{words:?}: {}", errors(&asked));
        assert_eq!(text(&asked), text(&alone.run(words)), "{words:?}");
    }
    // The flow of a run is measured by its time, which is another one here.
    assert_eq!(here.run(&["run", "--volume", "1mL", "--rate", "1mL/s"]).status.code(), Some(0));
    assert_eq!((there.log("acid").len(), here.log("acid").len()), (4, 0));
    let (_, orders) = service.get("/login");
    assert_eq!(orders["needed"], true);
    let told = here.run(&["1mL", "--format", "json"]);
    let report: Value = serde_json::from_slice(&told.stdout).unwrap();
    assert_eq!((&report["schema"], &report["pump"]), (&json!("dose/1"), &json!("acid")));
    // Without the file the environment has the token.
    fs::remove_file(here.path("word")).unwrap();
    let missed = here.run(&["1mL"]);
    assert_eq!(missed.status.code(), Some(2));
    assert!(errors(&missed).contains("word"), "{}", errors(&missed));
    let told = here.dose(&["1mL"]).env("DOSE_SERVICE_TOKEN", TOKEN).output().unwrap();
    assert_eq!(told.status.code(), Some(0), "{}", errors(&told));
}

#[test]
fn the_status_is_that_of_the_service_of_the_url() {
    let (there, service, here) = places("");
    assert_eq!(there.run(&["2mL", "--no-service"]).status.code(), Some(0));
    let run = |words: &[&str]| {
        let told = here.dose(words).env("DOSE_SERVICE_TOKEN", TOKEN).output().unwrap();
        (told.status.code(), String::from_utf8(told.stdout.clone()).unwrap(), errors(&told))
    };
    for words in [
        &["status"][..],
        &["status", "--pump", "base"],
        &["status", "--all"],
        &["status", "--tube-limit", "9L"],
    ] {
        let (code, told, error) = run(words);
        assert_eq!(code, Some(0), "{words:?}: {error}");
        assert_eq!(told, String::from_utf8(there.run(words).stdout).unwrap(), "{words:?}");
    }
    let (_, told, _) = run(&["status", "--format", "json"]);
    let told: Value = serde_json::from_str(&told).unwrap();
    assert!((told["wear"]["volume_ml"].as_f64().unwrap() - 2.0).abs() < 0.01, "{told}");
    // The record of this computer is empty.
    let (_, told, _) = run(&["status", "--no-service", "--format", "json"]);
    assert_eq!(serde_json::from_str::<Value>(&told).unwrap()["wear"]["volume_ml"], 0.0, "{told}");
    for (words, why) in [
        (
            ["status", "--pump", "dye"],
            "there is no pump `dye`; the configuration names acid, base (the service at",
        ),
        (["status", "--rack", "../rack.toml"], "write a name of the configuration"),
    ] {
        let (code, _, error) = run(&words);
        assert!(code == Some(2) && error.contains(why), "{words:?}: {error}");
    }
    let refused = here.run(&["status"]);
    assert!(errors(&refused).contains("needs its token"), "{}", errors(&refused));
    drop(service);
    let (code, _, error) = run(&["status"]);
    assert!(
        code == Some(2) && error.contains("read the record of this computer with --no-service"),
        "{error}"
    );
}

#[test]
fn a_command_without_a_name_takes_the_default_pump_of_the_service_at_the_url() {
    let (there, _service, here) = places("");
    let config = fs::read_to_string(here.path("config.toml")).unwrap();
    let run = |words: &[&str]| {
        let told = here.dose(words).env("DOSE_SERVICE_TOKEN", TOKEN).output().unwrap();
        assert_eq!(told.status.code(), Some(0), "{words:?}: {}", errors(&told));
        serde_json::from_slice::<Value>(&told.stdout).unwrap()["pump"].clone()
    };
    fs::write(here.path("config.toml"), config.replace("default_pump = \"acid\"\n", "")).unwrap();
    for words in [["2mL", "--format", "json"], ["status", "--format", "json"]] {
        assert_eq!(run(&words), "acid", "{words:?}");
    }
    assert_eq!(there.log("acid").len(), 1);
    // A default of this configuration is a name.
    fs::write(here.path("config.toml"), config.replace("acid", "base")).unwrap();
    assert_eq!(run(&["status", "--format", "json"]), "base");
}

#[test]
fn a_pump_is_put_to_stand_and_cleared_at_the_service_of_the_url() {
    let (there, service, here) = places("");
    let run = |words: &[&str]| {
        let told = here.dose(words).env("DOSE_SERVICE_TOKEN", TOKEN).output().unwrap();
        (told.status.code(), String::from_utf8(told.stdout.clone()).unwrap(), errors(&told))
    };
    let stands = || !there.status("acid")["safety"]["stand"].is_null();
    let (code, told, error) = run(&["safety", "stand", "acid", "--reason", "the hose is off"]);
    assert!(
        code == Some(0) && told.starts_with("acid stands, and your reason is on record"),
        "{told}{error}"
    );
    assert!(stands());
    let (_, own, _) = run(&["status", "--no-service", "--format", "json"]);
    assert!(serde_json::from_str::<Value>(&own).unwrap()["safety"]["stand"].is_null(), "{own}");
    let (code, _, error) = run(&["1mL"]);
    assert!(code == Some(5) && error.contains("clear it with `dose safety clear acid --reason"), "{error}");
    let (code, told, error) = run(&["safety", "clear", "acid", "--reason", "it is on again", "--by", "Ada"]);
    assert!(code == Some(0) && told.starts_with("acid may go on"), "{told}{error}");
    assert!(!stands());
    let journal = fs::read_to_string(there.path("records/acid/sim/journal.jsonl")).unwrap();
    assert!(journal.contains("it is on again (by Ada)"), "{journal}");
    let (code, told, error) = run(&["vessel", "emptied"]);
    assert!(code == Some(0) && told.starts_with("the vessel of acid is empty on record"), "{told}{error}");
    assert_eq!(run(&["safety", "clear", "dye", "--reason", "x"]).0, Some(2));
    drop(service);
}

#[test]
fn an_interrupt_stops_the_motion_at_the_url() {
    let (there, _service, here) = places("");
    let mut command = here.dose(&["200mL", "--rate", "0.5mL/s"]);
    command.env("DOSE_SERVICE_TOKEN", TOKEN).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    crate::laboratory::wait_for("the motion", || there.status("acid")["in_use_by"].as_str().map(drop));
    signal(child.id(), "INT");
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(130), "{}", errors(&ended));
    assert_eq!(there.log("acid")[0]["cause"], "SIGINT");
}

#[test]
fn a_refusal_names_the_url_and_moves_nothing() {
    let (there, service, here) = places("");
    let run = |words: &[&str], token: &str| {
        let ended = here.dose(words).env("DOSE_SERVICE_TOKEN", token).output().unwrap();
        (ended.status.code(), errors(&ended))
    };
    for (words, token, told) in [
        (
            &["1mL"][..],
            "wrong",
            "has refused the token of the variable DOSE_SERVICE_TOKEN: the service has another one",
        ),
        (&["1mL", "--pump", "dye"], TOKEN, "there is no pump `dye`; the configuration names acid, base"),
        (&["1mL", "--plot", "dose.svg"], TOKEN, "--plot is no option of this order; allowed: rate"),
        (&["1mL", "--on-fail", "touch x"], TOKEN, "--on-fail is no option of this order; allowed: rate"),
    ] {
        let (code, error) = run(words, token);
        assert_eq!(code, Some(2), "{words:?}: {error}");
        assert!(error.contains(told) && error.contains(&service.url), "{words:?}: {error}");
    }
    let none = errors(&here.run(&["1mL"]));
    assert!(
        none.contains("needs its token; name a file that has it with `token_file` in [service], or"),
        "{none}"
    );
    let config = fs::read_to_string(here.path("config.toml")).unwrap();
    fs::write(here.path("config.toml"), config + "token_file = \"word\"\n").unwrap();
    fs::write(here.path("word"), "fedcba9876543210\n").unwrap();
    let wrong = errors(&here.run(&["1mL"]));
    let of_file = format!("has refused the token of the file {}", here.path("word").display());
    assert!(wrong.contains(&of_file) && !wrong.contains("fedcba"), "{wrong}");
    let (code, error) = run(&["1mL", "--pump", "dye", "--format", "json"], TOKEN);
    let error: Value = serde_json::from_str(&error).unwrap();
    assert_eq!((code, &error["schema"], &error["moved"]), (Some(2), &json!("error/1"), &json!(false)));
    // Words of a command are no order, also with the token.
    let body = json!({"order": {"pump": "acid", "task": "command", "words": ["1mL"]}, "json": false,
        "verbose": false, "attended": false});
    let bearer = format!("Bearer {TOKEN}");
    let headers = [("authorization", bearer.as_str())];
    assert_eq!(service.post_with("/api/v1/command/order", &body, &headers).0, 403);
    assert_eq!((there.log("acid").len(), here.log("acid").len()), (0, 0));
}

#[test]
fn a_url_where_no_service_is_refuses_and_moves_nothing() {
    // The port is free once this listener is dropped.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let url = format!("http://127.0.0.1:{port}");
    let here = Laboratory::new(&["acid"], &format!("[service]\nurl = \"{url}\"\n"));
    let refused = here.run(&["1mL"]);
    assert_eq!(refused.status.code(), Some(2));
    let words = format!("no service answers at {url}, the `url` of [service] in the configuration: ");
    assert!(
        errors(&refused).contains(&words) && errors(&refused).contains("--no-service"),
        "{}",
        errors(&refused)
    );
    assert!(here.log("acid").is_empty());
    assert_eq!(here.run(&["1mL", "--no-service"]).status.code(), Some(0));
    assert_eq!(here.log("acid").len(), 1);
    // A service of these records is found first.
    let _service = here.serve(&["--pace", "fast"]);
    assert_eq!(here.run(&["1mL"]).status.code(), Some(0));
    assert_eq!(here.log("acid").len(), 2);
    for words in [&["safety", "stand", "acid", "--reason", "x"][..], &["vessel", "emptied"]] {
        assert_eq!(here.run(words).status.code(), Some(0), "{words:?}");
    }
    assert_eq!(here.status("acid")["safety"]["stand"]["reason"], "x");
}
