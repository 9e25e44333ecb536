//! Commands that ask the running service.

use std::process::{Command, Stdio};

use serde_json::json;

use crate::laboratory::{Laboratory, signal, wait_for};

#[test]
fn a_command_beside_a_service_says_what_it_says_alone() {
    let laboratory = Laboratory::new(&["dye", "acid", "base"], "");
    let service = laboratory.serve(&[]);
    for words in [&["2mL", "--rate", "2mL/s"][..], &["1mL", "-v"], &["prime", "3mL"], &["resume"], &["5"]] {
        let asked = laboratory.run(&[words, &["--pump", "acid"]].concat());
        let alone = laboratory.run(&[words, &["--pump", "base", "--no-service"]].concat());
        let text = |bytes: &[u8]| {
            let lines = String::from_utf8(bytes.to_vec()).unwrap().replace("base", "acid");
            let timeless = |line: &&str| !line.contains("T") || !line.contains("+00:00");
            lines.lines().filter(timeless).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(asked.status.code(), alone.status.code(), "{words:?}");
        assert_eq!(text(&asked.stdout), text(&alone.stdout), "{words:?}");
        assert_eq!(text(&asked.stderr), text(&alone.stderr), "{words:?}");
    }
    let (_, orders) = service.get("/api/v1/orders");
    let orders = orders.as_array().unwrap();
    assert!(orders.iter().all(|order| order["origin"] == "command"), "{orders:?}");
    let states: Vec<&str> = orders.iter().rev().map(|order| order["state"].as_str().unwrap()).collect();
    assert_eq!(states, ["done", "done", "done", "refused", "refused"]);
}

#[test]
fn a_command_beside_a_service_says_how_long_its_motion_takes_yet() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let typed = laboratory.dose(&[]);
    let program = typed.get_program().to_str().unwrap();
    // `script` gives the command a terminal.
    let words = format!("stty cols 100; exec {program} 3mL --rate 1mL/s --pump acid");
    let mut command = Command::new("script");
    command.args(["-qec", &words, "/dev/null"]).env("DOSE_CONFIG", laboratory.path("config.toml"));
    command.env("HOME", laboratory.path("")).env("TERM", "xterm").env_remove("DOSE_SERVICE");
    let made = command.stdin(Stdio::null()).output().unwrap();
    let text = String::from_utf8_lossy(&made.stdout);
    assert!(made.status.success(), "{text}");
    assert!(text.contains(" of 3.0") && text.contains(" second") && text.contains(" left"), "{text}");
    assert_eq!(service.get("/api/v1/orders").1[0]["origin"], "command");
}

#[test]
fn a_pump_file_is_cleared_by_itself_beside_a_service() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    for word in ["stand", "clear"] {
        let made = laboratory.run(&["safety", word, "./acid.toml", "--reason", "the hose"]);
        assert_eq!(made.status.code(), Some(0), "{word}: {}", String::from_utf8_lossy(&made.stderr));
        assert_eq!(laboratory.status("acid")["safety"]["stand"].is_null(), word == "clear");
    }
    assert_eq!(service.get("/api/v1/orders").1, json!([]), "the service was not asked");
}

#[test]
fn an_interrupt_stops_the_motion_that_the_service_makes() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let mut command = laboratory.dose(&["20mL", "--rate", "1mL/s"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    service.moves("acid");
    signal(child.id(), "INT");
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(130), "{}", String::from_utf8_lossy(&ended.stderr));
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert!(said.contains("stopped by the user") && !said.contains("error/1"), "{said}");
    // The order has the error as programs read it, although the command told it to a person.
    let order = service.get("/api/v1/orders").1[0].clone();
    let error = &order["error"];
    assert_eq!((&order["state"], &error["schema"]), (&json!("failed"), &json!("error/1")), "{order}");
    assert_eq!((&error["code"], &error["kind"]), (&json!(130), &json!("stopped")), "{order}");
    let log = laboratory.log("acid");
    assert_eq!((log.len(), &log[0]["cause"]), (1, &json!("SIGINT")));
}

#[test]
fn a_command_that_is_killed_leaves_no_motion_behind() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let mut command = laboratory.dose(&["20mL", "--rate", "1mL/s", "--pace", "real"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    service.moves("acid");
    child.kill().unwrap();
    child.wait().unwrap();
    wait_for("the pump to stand", || service.get("/api/v1/pumps/acid").1["order"].is_null().then_some(()));
    let log = laboratory.log("acid");
    assert_eq!((log.len(), &log[0]["cause"]), (1, &json!("the end of the command that ordered it")));
    assert!(!laboratory.status("acid")["unfinished"].is_null());
    let order = service.get("/api/v1/orders").1[0].clone();
    assert_eq!(
        (&order["error"]["code"], &order["error"]["kind"]),
        (&json!(143), &json!("stopped")),
        "{order}"
    );
}

#[test]
fn a_service_that_was_killed_is_asked_no_more() {
    let laboratory = Laboratory::new(&["acid"], "");
    let mut service = laboratory.serve(&[]);
    service.kill();
    assert!(laboratory.path("records/serve.json").exists());
    let made = laboratory.run(&["2mL"]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
}
