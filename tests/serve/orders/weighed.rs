//! A reading is that of the dose that was weighed.

use serde_json::json;

use crate::laboratory::Laboratory;

#[test]
fn a_reading_is_refused_once_another_dose_came_than_was_weighed() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    let first = service.dose("acid", "25mL", &json!({"retract": "0.1mL"}));
    service.ended(&first);
    let weighed = |reading: &str, dose: &str| {
        let body = json!({"reading": reading, "options": {"dose": dose, "dry-run": true}});
        service.post("/api/v1/pumps/acid/calibrate", &body)
    };
    let weigh = |dose: &str| weighed("24.9g", dose);
    for dose in [first.as_str(), "1"] {
        let (status, made) = weigh(dose);
        assert_eq!(status, 202, "the retraction after the dose is no other dose: {made}");
    }
    let (status, unknown) = weigh("77");
    assert_eq!((status, &unknown["kind"]), (422, &json!("record")), "{unknown}");
    let second = laboratory.run(&["1.5mL", "--pump", "acid"]);
    assert!(second.status.success(), "{second:?}");
    for dose in [first.as_str(), "1"] {
        let (status, refused) = weigh(dose);
        assert_eq!((status, &refused["kind"], &refused["moved"]), (409, &json!("changed"), &json!(false)));
        let message = refused["message"].as_str().unwrap();
        assert!(message.contains("another dose of 1.5 mL came since, at 20"), "{message}");
    }
    assert_eq!(weighed("1.6g", "3").0, 202, "the second dose has the number after the retraction's");
    let line = laboratory.run(&["calibrate", "last", "24.9g", "--pump", "acid", "--dose", "1"]);
    let said = String::from_utf8(line.stderr).unwrap();
    assert!(line.status.code() == Some(2) && said.contains("another dose of 1.5 mL came since"), "{said}");
}

#[test]
fn a_dose_that_was_stopped_and_resumed_is_weighed_by_the_order_of_its_rest() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&[]);
    let first = service.dose("acid", "20mL", &json!({}));
    service.moves("acid");
    service.post("/api/v1/pumps/acid/stop", &json!({}));
    service.ended(&first);
    let (_, rest) = service.post("/api/v1/pumps/acid/resume", &json!({"options": {"rate": "max"}}));
    let rest = rest["id"].as_str().unwrap();
    service.ended(rest);
    let weigh = |order: &str| {
        let body = json!({"reading": "19.9g", "options": {"dose": order, "dry-run": true}});
        service.post("/api/v1/pumps/acid/calibrate", &body).0
    };
    assert_eq!((weigh(&first), weigh(rest)), (409, 202));
}
