//! A pump that comes to stand at a limit, and what is told of a dose that moves and of one that is done.

use std::fs;

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, wait_for};

fn limited() -> Laboratory {
    let laboratory = Laboratory::new(&["acid"], "");
    let file = laboratory.path("acid.toml");
    fs::write(&file, fs::read_to_string(&file).unwrap() + "\n[safety]\nmax_ml_per_day = 50.0\n").unwrap();
    laboratory
}

#[test]
fn a_pump_that_comes_to_stand_at_a_limit_is_told_to_everyone_once() {
    let laboratory = limited();
    laboratory.tell_failures();
    let service = laboratory.serve(&["--pace", "fast"]);
    let ask = |options: Value| {
        service.post("/api/v1/pumps/acid/dose", &json!({"volume": "60mL", "options": options}))
    };
    assert_eq!(ask(json!({"dry-run": true})).0, 423);
    assert!(laboratory.told().is_empty(), "the pump does not stand for a plan");
    for _ in 0..2 {
        assert_eq!(ask(json!({})).0, 423);
    }
    wait_for("on_fail", || (!laboratory.told().is_empty()).then_some(()));
    assert_eq!(laboratory.told(), ["acid 5 safety"]);
    let (_, notes) = service.get("/api/v1/notes");
    let text = notes[0]["text"].as_str().unwrap();
    assert!(text.starts_with("acid stands until a person clears it: 60."), "{notes}");
    assert_eq!((&notes[0]["kind"], notes.as_array().unwrap().len()), (&json!("safety"), 1), "{notes}");
}

#[test]
fn a_dose_counts_as_it_is_delivered_and_its_rest_is_under_way() {
    let laboratory = limited();
    let service = laboratory.serve(&[]);
    service.dose("acid", "49mL", &json!({"rate": "1mL/s"}));
    let counted = |status: &Value| {
        let of = |key: &str| status["safety"][key].as_f64().unwrap();
        let (day_ml, rest_ml, left_ml) = (of("day_ml"), of("under_way_ml"), of("day_left_ml"));
        assert!((day_ml + rest_ml + left_ml - 50.0).abs() < 0.05, "{status}");
        assert_eq!((of("received_ml"), status["wear"]["volume_ml"].as_f64()), (day_ml, Some(day_ml)));
        (day_ml, left_ml)
    };
    let (mut views, mut last_ml) = (0, 0.0);
    // The page's stream, the view and the numbers count on while the pump moves, as the command does by the record.
    while views < 3 {
        let view = wait_for("more to count", || {
            let view = service.get("/api/v1/pumps/acid").1;
            (view["status"]["safety"]["day_ml"].as_f64() > Some(last_ml)).then_some(view)
        });
        let answer = laboratory.run(&["safety", "--pump", "acid", "--format", "json"]);
        let (of_view, of_command) =
            (counted(&view["status"]), counted(&serde_json::from_slice(&answer.stdout).unwrap()));
        assert!((of_view.1 - 1.0).abs() < 0.05, "the whole plan is not free any more: {view}");
        assert!((0.0..2.5).contains(&(of_command.0 - of_view.0)), "{of_view:?}, {of_command:?}");
        assert!(view["order"].is_string() && view["status"]["unfinished"].is_null(), "{view}");
        (views, last_ml) = (views + 1, of_view.0);
    }
    let numbers = service.get("/metrics").1;
    let number = |name: &str| -> f64 {
        let line = numbers.as_str().unwrap().lines().find(|line| line.starts_with(&format!("{name}{{")));
        line.and_then(|line| line.rsplit(' ').next()?.parse().ok()).unwrap()
    };
    assert!(number("dose_day_ml") >= last_ml && number("dose_tube_volume_ml_total") >= last_ml);
    assert!((number("dose_day_ml") + number("dose_under_way_ml") - 49.0).abs() < 0.05);
    service.post("/api/v1/stop", &json!({}));
    let view = wait_for("the pump to stand", || {
        let view = service.get("/api/v1/pumps/acid").1;
        view["order"].is_null().then_some(view)
    });
    assert_eq!(view["status"]["safety"]["under_way_ml"], 0.0, "nobody makes the rest: {view}");
}

#[test]
fn the_log_says_who_ordered_a_dose() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    service.ended(&service.dose("acid", "2mL", &json!({})));
    assert!(laboratory.run(&["3mL", "--pump", "acid"]).status.success());
    assert!(laboratory.run(&["4mL", "--pump", "acid", "--no-service"]).status.success());
    let answer = service.get("/api/v1/pumps/acid/log?format=csv").1;
    let lines: Vec<&str> = answer.as_str().unwrap().lines().collect();
    let ends = [",order,origin,weighed,accepted", ",http,false,", ",command,false,", ",,,false,"];
    assert_eq!(lines.len(), ends.len(), "{lines:?}");
    assert!(lines.iter().zip(ends).all(|(line, end)| line.ends_with(end)), "{lines:?}");
    let answer = service.get("/api/v1/pumps/acid/log").1;
    let origin = |line: &str| serde_json::from_str::<Value>(line).unwrap()["origin"].clone();
    let origins: Vec<Value> = answer.as_str().unwrap().lines().map(origin).collect();
    assert_eq!(origins, [json!("http"), json!("command"), Value::Null]);
    wait_for("the last dose", || {
        (service.get("/api/v1/pumps/acid").1["last"]["asked"] == "4 mL").then_some(())
    });
}

#[test]
fn a_dose_that_was_resumed_is_told_as_a_whole_and_one_that_was_accepted_names_who_did() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let stopped = || {
        let id = service.dose("acid", "9mL", &json!({"rate": "3mL/s"}));
        service.moves("acid");
        service.post("/api/v1/pumps/acid/stop", &json!({}));
        service.ended(&id);
    };
    let ends = |path: &str| {
        let order = service.post(path, &json!({})).1;
        service.ended(order["id"].as_str().unwrap());
    };
    stopped();
    let part = service.get("/api/v1/pumps/acid").1["last"].clone();
    ends("/api/v1/pumps/acid/resume");
    let view = service.get("/api/v1/pumps/acid").1;
    let (whole, number) = (&view["whole"], |of: &Value, key: &str| of[key].as_f64().unwrap());
    assert_eq!((&whole["time"], &whole["requested_ml"]), (&part["time"], &json!(9.0)));
    assert_eq!(whole["before_ml"], part["delivered_ml"]);
    let sum_ml = number(&part, "delivered_ml") + number(&view["last"], "delivered_ml");
    assert!((number(whole, "delivered_ml") - sum_ml).abs() < 1e-9 && (sum_ml - 9.0).abs() < 0.01, "{view}");
    stopped();
    assert!(service.get("/api/v1/pumps/acid").1["whole"].is_null(), "another dose");
    ends("/api/v1/pumps/acid/accept");
    let answer = service.get("/api/v1/pumps/acid/log").1;
    let accepted = |line: &str| serde_json::from_str::<Value>(line).unwrap()["accepted"].clone();
    let accepted: Vec<Value> = answer.as_str().unwrap().lines().map(accepted).collect();
    assert_eq!(accepted, [Value::Null, Value::Null, json!("http")]);
    let note = &service.get("/api/v1/notes").1[0];
    assert_eq!(note["text"], "the interrupted dose of acid was accepted, by http");
}

#[test]
fn a_run_for_a_time_that_was_stopped_is_no_dose() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let body = json!({"options": {"rate": "1mL/s", "for": "10s"}});
    let (_, run) = service.post("/api/v1/pumps/acid/run", &body);
    service.moves("acid");
    service.post("/api/v1/pumps/acid/stop", &json!({}));
    service.ended(run["id"].as_str().unwrap());
    let (status, refused) = service.post("/api/v1/pumps/acid/dose", &json!({"volume": "1mL"}));
    assert_eq!((status, &refused["code"]), (409, &json!(4)));
    let message = refused["message"].as_str().unwrap();
    assert!(message.starts_with("a run of continuous flow is unfinished: "), "{message}");
}

#[test]
fn a_stop_at_the_page_alarms_nobody_and_one_by_a_program_does() {
    let laboratory = Laboratory::new(&["acid"], "");
    laboratory.tell_failures();
    let service = laboratory.serve(&[]);
    let slow = json!({"rate": "0.5mL/s", "unfinished": "accept"});
    let stopped = |headers: &[(&str, &str)]| {
        let id = service.dose("acid", "50mL", &slow);
        service.moves("acid");
        let (status, told) = service.post_with("/api/v1/pumps/acid/stop", &json!({}), headers);
        assert_eq!((status, &told["asked"]), (200, &json!([id])), "{told}");
        assert_eq!(service.ended(&id)["code"], 143);
        laboratory.told()
    };
    assert!(stopped(&[("origin", &service.url)]).is_empty(), "the person at the page is there");
    assert_eq!(stopped(&[]), ["acid 143 stopped"]);
}
