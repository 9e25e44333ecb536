//! Journals that version 0.1.0 wrote are read as that version read them. `samples/journals` has each journal with the
//! status that version 0.1.0 printed of it, without the folder.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs;
use std::path::PathBuf;

use pump_bench::report::Status;
use pump_bench::{Bench, DoseError, DoseRequest, built_in};
use serde_json::Value;

fn sample(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/samples/journals").join(name);
    fs::read_to_string(path).unwrap()
}

/// A bench whose journal is this sample.
fn bench(name: &str, folder: &tempfile::TempDir) -> Bench {
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder.path()).unwrap();
    fs::create_dir_all(bench.folder().path()).unwrap();
    fs::write(bench.folder().path().join("journal.jsonl"), sample(&format!("{name}.jsonl"))).unwrap();
    bench
}

#[test]
fn journals_of_the_first_version_give_the_status_that_it_printed() {
    for name in ["finished", "cut_off"] {
        let folder = tempfile::tempdir().unwrap();
        let status = Status::of(&bench(name, &folder)).unwrap();
        let mut found: Value = serde_json::from_str(&status.json()).unwrap();
        found.as_object_mut().unwrap().remove("folder");
        // Fields that later versions added.
        let added = ["carry_half_width_ml", "unfinished_calibration", "last_by_weight"]
            .map(|key| found.as_object_mut().unwrap().remove(key));
        assert_eq!(added, [Some(Value::from(0.0)), Some(Value::Null), Some(Value::Null)]);
        let lives =
            ["tube_life_h", "tube_life_revolutions"].map(|key| found.as_object_mut().unwrap().remove(key));
        assert_eq!(lives, [Some(Value::Null), Some(Value::Null)]);
        let added = ["angle_lost_by", "board"].map(|key| found.as_object_mut().unwrap().remove(key));
        assert_eq!(added, [const { Some(Value::Null) }; 2]);
        // All that the tube has pumped counts as if it were pumped now.
        let safety = found.as_object_mut().unwrap().remove("safety").unwrap();
        let pumped_ml = found["wear"]["volume_ml"].as_f64().unwrap();
        assert_eq!(safety["stand"], Value::Null);
        let [day_ml, received_ml] = ["day_ml", "received_ml"].map(|key| safety[key].as_f64().unwrap());
        assert!((received_ml - pumped_ml).abs() < 1e-9, "{received_ml} {pumped_ml}");
        assert!((0.0..=pumped_ml + 1e-9).contains(&day_ml), "{day_ml} {pumped_ml}");
        if let Some(unfinished) = found["unfinished"].as_object_mut() {
            assert_eq!(
                ["number", "target_g", "end", "cause"].map(|key| unfinished.remove(key)),
                [const { Some(Value::Null) }; 4]
            );
            assert_eq!(unfinished.remove("searched_ml"), Some(Value::from(0.0)));
            let added = ["by_weight", "over_time", "until_stopped"].map(|key| unfinished.remove(key));
            assert_eq!(added, [const { Some(Value::Bool(false)) }; 3]);
        }
        let mut expected: Value = serde_json::from_str(&sample(&format!("{name}.status.json"))).unwrap();
        // An angle that nobody knows was the middle of its range, and is null now.
        if expected["angle_known"] == false {
            expected["angle_deg"] = Value::Null;
        }
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn a_dose_that_the_first_version_left_unfinished_is_refused_resumed_or_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench("cut_off", &folder);
    let mut session = bench.session().unwrap();
    assert!(matches!(session.prepare(DoseRequest::dose(1.0)), Err(DoseError::Unfinished { .. })));
    let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    assert!((rest.plan.requested_ml() - (30_000.0 - 407.42)).abs() < 0.3, "{}", rest.plan.requested_ml());
    assert_eq!(rest.request.retract_ml, Some(0.1));
    session.discard().unwrap();
    assert!(session.prepare(DoseRequest::dose(1.0)).is_ok());
}

#[test]
fn an_angle_that_the_first_version_did_not_know_stays_unknown_once_the_roller_count_is_corrected() {
    // It was recorded as half a pitch of three rollers, 60 deg. With two rollers a pitch has 180 deg.
    let folder = tempfile::tempdir().unwrap();
    let mut file = built_in("two-roller").unwrap();
    file.pump = built_in("three-roller").unwrap().pump;
    let bench = Bench::new(file, None, folder.path()).unwrap();
    fs::create_dir_all(bench.folder().path()).unwrap();
    fs::write(bench.folder().path().join("journal.jsonl"), sample("finished.jsonl")).unwrap();
    let status: Value = serde_json::from_str(&Status::of(&bench).unwrap().json()).unwrap();
    assert_eq!((&status["recorded"], &status["angle_known"]), (&Value::from(true), &Value::from(false)));
    assert_eq!(status["angle_deg"], Value::Null);
}
