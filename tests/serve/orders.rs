//! Orders over HTTP.

mod hung;
mod meant;
mod told;
mod weighed;

use std::fs;

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, signal, wait_for};

#[test]
fn a_dose_over_http_is_the_dose_of_the_command() {
    let laboratory = Laboratory::new(&["acid", "base"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    let id = service.dose("acid", "5mL", &json!({"rate": "2mL/s", "smooth": true}));
    let order = service.ended(&id);
    assert_eq!((&order["state"], &order["code"]), (&json!("done"), &json!(0)), "{order}");

    let (status, dose) = service.get(&format!("/api/v1/doses/{id}"));
    assert_eq!((status, &dose["schema"], &dose["completed"]), (200, &json!("dose/1"), &json!(true)));
    assert!((dose["delivered_ml"].as_f64().unwrap() - 5.0).abs() < 0.01);

    // The command's own report of the same dose on the other pump differs in names and times alone.
    let words = ["5mL", "--pump", "base", "--rate", "2mL/s", "--smooth", "--format", "json", "--no-service"];
    let typed: Value = serde_json::from_slice(&laboratory.run(&words).stdout).unwrap();
    let keys = |dose: &Value| dose.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(keys(&dose), keys(&typed));
    for key in keys(&dose).iter().filter(|key| !["pump", "time"].contains(&key.as_str())) {
        assert_eq!(dose[key], typed[key], "{key}");
    }
    assert_eq!(laboratory.log("acid").len(), 1);
}

#[test]
fn a_dose_whose_process_is_killed_is_told_to_everyone() {
    let laboratory = Laboratory::new(&["acid"], "");
    laboratory.tell_failures();
    let config = fs::read_to_string(laboratory.path("config.toml")).unwrap();
    let with_bounds =
        config.replace("$DOSE_FAIL_KIND", "$DOSE_FAIL_KIND $DOSE_FAIL_LEAST_ML $DOSE_FAIL_MOST_ML");
    fs::write(laboratory.path("config.toml"), with_bounds).unwrap();
    let service = laboratory.serve(&[]);
    // A volume that another order has delivered before does not count.
    service.ended(&service.dose("acid", "2mL", &json!({"rate": "4mL/s"})));
    let id = service.dose("acid", "20mL", &json!({"rate": "1mL/s"}));
    service.moves("acid");
    let holder = laboratory.status("acid")["in_use_by"].to_string();
    let process: String = holder.chars().filter(char::is_ascii_digit).collect();
    signal(process.parse().unwrap(), "KILL");
    let order = service.ended(&id);
    let error = &order["error"];
    assert_eq!((&order["state"], &order["code"]), (&json!("failed"), &json!(1)), "{order}");
    assert_eq!((&error["schema"], &error["kind"]), (&json!("error/1"), &json!("killed")), "{order}");
    assert_eq!(error["moved"], true, "{order}");
    assert!(error["message"].as_str().unwrap().contains("SIGKILL"), "{order}");
    let told = wait_for("on_fail", || laboratory.told().first().cloned());
    let told: Vec<&str> = told.split(' ').collect();
    assert_eq!(told[..3], ["acid", "1", "killed"]);
    let status = laboratory.status("acid");
    for (told, bound) in told[3..].iter().zip(["delivered_least_ml", "delivered_most_ml"]) {
        let recorded_ml = status["unfinished"][bound].as_f64().unwrap();
        assert!((told.parse::<f64>().unwrap() - recorded_ml).abs() < 1e-9, "{told}: {status}");
    }
    assert_eq!(told.len(), 5, "{told:?}");
    let notes = service.get("/api/v1/notes").1;
    let note = &notes[0];
    assert_eq!(note["pump"], "acid", "{notes}");
    let text = note["text"].as_str().unwrap();
    assert!(text.contains(&id) && text.contains("; it has delivered "), "{notes}");
    // The journal has the bounds of what was delivered.
    assert!(!laboratory.status("acid")["unfinished"].is_null());
}

#[test]
fn a_run_until_it_is_stopped_tells_no_end() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let (status, run) = service.post("/api/v1/pumps/acid/run", &json!({"options": {"rate": "1mL/s"}}));
    assert_eq!(status, 202, "{run}");
    service.moves("acid");
    let (_, view) = service.get("/api/v1/pumps/acid");
    let progress = &view["progress"];
    assert_eq!((&progress["of_ml"], &progress["of_steps"]), (&Value::Null, &json!(0)), "{progress}");
    assert_eq!(view["pitch_deg"], 120.0, "{view}");
    let (status, refused) = service.post("/api/v1/pumps/acid/dose", &json!({"volume": "1mL"}));
    let busy = "pump acid is running (by http); wait until it is done, or stop it";
    assert_eq!((status, &refused["message"]), (409, &json!(busy)), "{refused}");
    service.post("/api/v1/stop", &json!({}));
    assert!(service.ended(run["id"].as_str().unwrap())["reports"][0]["delivered_ml"].as_f64().unwrap() > 0.0);
}

#[test]
fn an_option_that_is_no_text_is_refused_by_its_name() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    for (options, told) in [
        (json!({"rate": 5}), "the option rate is `5`; write a text with its unit, as \"5mL/min\""),
        (json!({"repeat": 2}), "the option repeat is `2`; write a text, as \"5\""),
        (
            json!({"smooth": [1]}),
            "the option smooth is `[1]`; write a text with its unit, or true for an option",
        ),
    ] {
        let (status, error) =
            service.post("/api/v1/pumps/acid/dose", &json!({"volume": "1mL", "options": options}));
        assert_eq!((status, &error["schema"]), (422, &json!("error/1")), "{error}");
        assert!(error["message"].as_str().unwrap().contains(told), "{error}");
    }
    assert!(laboratory.log("acid").is_empty(), "nothing moved");
}

#[test]
fn the_usual_flow_of_a_pump_is_the_one_that_the_configuration_sets() {
    let laboratory = Laboratory::new(&["acid"], "[defaults]\nrate = \"1.5mL/min\"\n");
    let service = laboratory.serve(&["--pace", "fast"]);
    let (_, view) = service.get("/api/v1/pumps/acid");
    assert!((view["default_flow_ml_s"].as_f64().unwrap() - 0.025).abs() < 1e-9, "{view}");
    let order = service.ended(&service.dose("acid", "1mL", &json!({"dry-run": true})));
    assert_eq!(order["reports"][0]["cruise_flow_ml_s"], 0.025, "{order}");
}

#[test]
fn a_history_that_was_lost_takes_the_doses_over_from_the_logs() {
    let laboratory = Laboratory::new(&["acid", "base"], "");
    let mut service = laboratory.serve(&["--pace", "fast"]);
    let lost = [service.dose("acid", "5mL", &json!({})), service.dose("base", "2.5mL", &json!({}))];
    for id in &lost {
        service.ended(id);
    }
    service.kill();
    for ending in ["", "-wal", "-shm"] {
        let _ = fs::remove_file(laboratory.path(&format!("records/history.sqlite{ending}")));
    }
    service = laboratory.serve_again(&service);
    let (status, orders) = service.get("/api/v1/orders");
    assert_eq!((status, orders.as_array().unwrap().len()), (200, 2), "{orders}");
    for (pump, volume) in [("acid", "5 mL"), ("base", "2.5 mL")] {
        let of_pump = orders.as_array().unwrap().iter().find(|order| order["pump"] == pump).unwrap();
        assert_eq!((&of_pump["task"], &of_pump["state"]), (&json!("dose"), &json!("done")), "{orders}");
        assert_eq!((&of_pump["volume"], &of_pump["origin"]), (&json!(volume), &json!("the pump's log")));
        let told = of_pump["messages"][0].as_str().unwrap();
        assert!(told.starts_with(if pump == "acid" { "delivered 5.0" } else { "delivered 2.5" }), "{told}");
        let logged = laboratory.log(pump);
        let begun = of_pump["begun"].as_str().unwrap();
        assert_eq!(begun[..19], logged[0]["time"].as_str().unwrap()[..19], "{orders} {logged:?}");
    }
    let (_, events) = service.get("/api/v1/notes");
    assert!(events.to_string().contains("the history is new, and has the 2 doses"), "{events}");
    // A dose that somebody typed elsewhere is the pump's last dose too.
    assert!(laboratory.run(&["3mL", "--pump", "acid", "--no-service"]).status.success());
    let last = wait_for("the view of the pump", || {
        let last = service.get("/api/v1/pumps/acid").1["last"].clone();
        (last["number"] == 2).then_some(last)
    });
    assert_eq!(
        (&last["schema"], &last["asked"], &last["end"]),
        (&json!("log/1"), &json!("3 mL"), &json!("done"))
    );
    // The history is taken over once.
    service.kill();
    service = laboratory.serve_again(&service);
    assert_eq!(service.get("/api/v1/orders").1.as_array().unwrap().len(), 2);
}

#[test]
fn a_repeated_key_doses_once_and_over_a_restart() {
    let laboratory = Laboratory::new(&["acid"], "");
    let mut service = laboratory.serve(&["--pace", "fast"]);
    let path = "/api/v1/pumps/acid/dose";
    let key = [("idempotency-key", "night 7")];
    let (body, other) = (json!({"volume": "2mL"}), json!({"volume": "3mL"}));
    let (status, first) = service.post_with(path, &body, &key);
    assert_eq!(status, 202, "{first}");
    let id = first["id"].as_str().unwrap().to_owned();
    let (status, again) = service.post_with(path, &body, &key);
    assert_eq!((status, &again["id"]), (202, &json!(id)));
    let (status, error) = service.post_with(path, &other, &key);
    assert_eq!((status, &error["kind"]), (422, &json!("key")));

    service.ended(&id);
    assert_eq!(service.end(), Some(0));
    let service = laboratory.serve_again(&service);
    let (status, after) = service.post_with(path, &body, &key);
    assert_eq!((status, &after["id"], &after["state"]), (202, &json!(id), &json!("done")));
    let (status, _) = service.post_with(path, &other, &key);
    assert_eq!(status, 422);
    assert_eq!(laboratory.log("acid").len(), 1, "one dose was made");
}

#[test]
fn a_stopped_dose_is_resumed_or_accepted() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let id = service.dose("acid", "20mL", &json!({"rate": "1mL/s"}));
    service.moves("acid");
    let (status, busy) = service.post("/api/v1/pumps/acid/dose", &json!({"volume": "1mL"}));
    assert_eq!((status, &busy["code"], &busy["kind"]), (409, &json!(3), &json!("busy")));
    let (status, stopped) = service.post("/api/v1/pumps/acid/stop", &json!({}));
    assert_eq!((status, &stopped["asked"]), (200, &json!([id])));
    let order = service.ended(&id);
    assert_eq!((&order["state"], &order["code"]), (&json!("failed"), &json!(143)), "{order}");
    let part_ml = order["reports"][0]["delivered_ml"].as_f64().unwrap();
    assert!(part_ml > 0.0 && part_ml < 20.0);
    assert_eq!(laboratory.log("acid")[0]["cause"], "the service's stop");

    let (status, unfinished) = service.post("/api/v1/pumps/acid/dose", &json!({"volume": "1mL"}));
    assert_eq!((status, &unfinished["code"]), (409, &json!(4)));
    let (status, rest) = service.post("/api/v1/pumps/acid/resume", &json!({"options": {"rate": "max"}}));
    assert_eq!(status, 202, "{rest}");
    let rest = service.ended(rest["id"].as_str().unwrap());
    assert_eq!(rest["state"], "done", "{rest}");
    let rest_ml = rest["reports"][0]["delivered_ml"].as_f64().unwrap();
    assert!((part_ml + rest_ml - 20.0).abs() < 0.01, "{part_ml} + {rest_ml}");
    let (status, nothing) = service.post("/api/v1/pumps/acid/accept", &json!({}));
    assert_eq!((status, &nothing["code"]), (422, &json!(2)), "{nothing}");
}

#[test]
fn a_pump_that_stands_is_cleared_by_name_and_reason() {
    let laboratory = Laboratory::new(&["acid"], "");
    let file = laboratory.path("acid.toml");
    let limited = fs::read_to_string(&file).unwrap() + "\n[safety]\nmax_ml_per_day = 5.0\n";
    fs::write(&file, limited).unwrap();
    let service = laboratory.serve(&["--pace", "fast"]);
    let id = service.dose("acid", "4mL", &json!({}));
    service.ended(&id);
    let (status, stands) = service.post("/api/v1/pumps/acid/dose", &json!({"volume": "4mL"}));
    assert_eq!((status, &stands["code"]), (423, &json!(5)), "{stands}");
    let (status, still) = service.post("/api/v1/pumps/acid/dose", &json!({"volume": "0.5mL"}));
    assert_eq!((status, &still["code"]), (423, &json!(5)), "{still}");
    let clear = |body: Value| service.post("/api/v1/pumps/acid/clear", &body);
    assert_eq!(clear(json!({"reason": " ", "by": "Ada"})).0, 422);
    for nobody in [json!({"reason": "hose back"}), json!({"reason": "hose back", "by": " "})] {
        let (status, nameless) = clear(nobody);
        let told = nameless["message"].as_str().unwrap();
        assert!(status == 422 && told.contains("write the name of the person who clears the pump"), "{told}");
    }
    assert!(!laboratory.status("acid")["safety"]["stand"].is_null());
    let (status, cleared) = clear(json!({"reason": "the tank was changed", "by": "Ada"}));
    assert_eq!((status, &cleared["state"]), (202, &json!("done")), "{cleared}");
    let (_, notes) = service.get("/api/v1/notes?limit=1");
    assert_eq!(notes[0]["text"], "acid was cleared by Ada: the tank was changed", "{notes}");
    service.ended(&service.dose("acid", "4mL", &json!({})));
}

#[test]
fn the_calibration_before_is_used_again() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    service.ended(&service.dose("acid", "25mL", &json!({})));
    let calibrate = |body: Value| service.post("/api/v1/pumps/acid/calibrate", &body);
    let (status, tried) = calibrate(json!({"reading": "24.9g", "options": {"dry-run": true}}));
    assert_eq!((status, &tried["reports"][0]["schema"]), (202, &json!("calibration/1")), "{tried}");
    let known = || service.get("/api/v1/pumps/acid/calibrations").1;
    assert_eq!(known(), json!({"schema": "calibrations/1", "active": null, "calibrations": []}));
    assert_eq!(calibrate(json!({"reading": "24.9g"})).0, 202);
    assert_eq!(known()["calibrations"][0]["version"], 1, "{}", known());
    let choose = |word: &str| {
        let (status, made) = service.post("/api/v1/pumps/acid/calibrate/use", &json!({"calibration": word}));
        (status, made, known()["active"].clone())
    };
    for (word, active) in [("1", json!(1)), ("none", Value::Null)] {
        let (status, order, now) = choose(word);
        assert_eq!((status, &order["state"], now), (202, &json!("done"), active), "{order}");
    }
    for wrong in ["7", "-1", "", "one"] {
        let (status, refused, active) = choose(wrong);
        assert_eq!((status, active), (422, Value::Null), "{wrong}: {refused}");
    }
}

#[test]
fn what_cannot_be_done_is_refused_with_the_words_of_the_command() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    let dose = |body: Value| service.post("/api/v1/pumps/acid/dose", &body);
    let (status, error) = dose(json!({"volume": "5"}));
    assert_eq!((status, &error["schema"], &error["code"]), (422, &json!("error/1"), &json!(2)));
    let typed = laboratory.run(&["5", "--pump", "acid", "--format", "json", "--no-service"]);
    let typed: Value = serde_json::from_slice(&typed.stderr).unwrap();
    assert_eq!(error, typed);

    let (status, error) = dose(json!({"volume": "5mL", "options": {"on-fail": "touch /tmp/x"}}));
    assert_eq!(status, 422);
    assert!(
        error["message"].as_str().unwrap().starts_with("--on-fail is no option of this order; allowed: rate")
    );
    let (status, error) = dose(json!({"volume": "5mL", "speed": "9rpm"}));
    assert_eq!(status, 422);
    assert!(error["message"].as_str().unwrap().contains("unknown field `speed`"), "{error}");
    assert_eq!(service.post("/api/v1/pumps/nobody/dose", &json!({"volume": "5mL"})).0, 404);
    assert_eq!(service.get("/api/v1/orders/0123").0, 404);
    assert_eq!(service.get("/nowhere").0, 404);
    assert!(laboratory.log("acid").is_empty(), "nothing moved");
}

#[test]
fn every_path_that_is_described_is_answered() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    let (status, description) = service.get("/openapi.json");
    assert_eq!(status, 200);
    let paths = description["paths"].as_object().unwrap();
    assert!(paths.len() >= 20, "{}", paths.len());
    for (path, methods) in paths {
        if path == "/events" {
            continue;
        }
        let filled = path.replace("{name}", "acid").replace("{id}", "0123456789abcdef");
        for method in methods.as_object().unwrap().keys() {
            let (status, answer) = match method.as_str() {
                "get" => service.get(&filled),
                "post" => service.post(&filled, &json!({})),
                edit => {
                    let entry = filled.strip_prefix("/api/v1/schedule/entries").unwrap();
                    service.edit(&edit.to_uppercase(), entry, &json!({}), "\"a\"")
                }
            };
            assert!(status != 405 && status < 500, "{method} {path}: {status} {answer}");
            if status >= 400 {
                assert_eq!(answer["schema"], "error/1", "{method} {path}: {answer}");
            }
        }
    }
}

#[test]
fn a_service_that_cannot_use_a_pump_file_says_why() {
    let laboratory = Laboratory::new(&["acid"], "");
    let file = laboratory.path("acid.toml");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replace("inertance_kpa_s2_ml = 0.0042", "inertance_kpa_s2_ml = -1.0")).unwrap();
    let refused = laboratory.run(&["serve", "--listen", "127.0.0.1:0"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    assert!(said.starts_with("error: pump acid: ") && said.contains("-1"), "{said}");
}
