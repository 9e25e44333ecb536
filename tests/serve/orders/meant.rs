//! An unfinished dose is accepted or resumed if it is the one that was meant.

use serde_json::{Value, json};

use crate::laboratory::{Laboratory, Service};

/// Begins an order, stops it once the pump moves, and returns the number of the dose that is unfinished then.
fn stopped(service: &Service, id: &str) -> Value {
    service.moves("acid");
    service.post("/api/v1/pumps/acid/stop", &json!({}));
    service.ended(id);
    service.get("/api/v1/pumps/acid").1["status"]["unfinished"]["number"].clone()
}

#[test]
fn another_unfinished_dose_than_the_one_that_was_meant_is_left_alone() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let post = |word: &str, dose: &Value| {
        service.post(&format!("/api/v1/pumps/acid/{word}"), &json!({"options": {"dose": dose}}))
    };
    let order = service.dose("acid", "60mL", &json!({"rate": "1mL/s"}));
    let first = stopped(&service, &order);
    assert_eq!(first, 1);
    // Somebody else resumes it to its end, and has another one stopped meanwhile.
    let (status, rest) =
        service.post("/api/v1/pumps/acid/resume", &json!({"options": {"rate": "max", "dose": order}}));
    assert_eq!(status, 202, "{rest}");
    assert_eq!(service.ended(rest["id"].as_str().unwrap())["state"], "done");
    for word in ["accept", "resume"] {
        let (status, gone) = post(word, &first);
        assert_eq!(
            (status, &gone["kind"], &gone["moved"]),
            (409, &json!("changed"), &json!(false)),
            "{gone}"
        );
        assert_eq!(gone["message"], "dose `1` is not unfinished any more; no dose is", "{gone}");
    }
    let second = stopped(&service, &service.dose("acid", "40mL", &json!({"rate": "1mL/s"})));
    for word in ["accept", "resume"] {
        let (status, other) = post(word, &first);
        assert_eq!((status, &other["code"], &other["kind"]), (409, &json!(2), &json!("changed")), "{other}");
        assert_eq!(other["message"], "dose `1` is not unfinished any more; dose 3 of 40 mL is", "{other}");
    }
    let dry = json!({"options": {"dose": "1", "dry-run": true}});
    assert_eq!(service.post("/api/v1/pumps/acid/resume", &dry).0, 409);
    assert_eq!(service.get("/api/v1/pumps/acid").1["status"]["unfinished"]["number"], second);
    let (status, accepted) = post("accept", &second);
    assert_eq!((status, &accepted["state"]), (202, &json!("done")), "{accepted}");
}
