//! Claims about rollers that do not stand where the record says, or nobody knows where.

use crate::balance::{Speech, Truth};
use crate::rig::{Rig, heard, number, truth};

#[test]
fn a_rotor_that_was_turned_by_hand_is_named_as_the_cause_and_an_unknown_angle_mends_it() {
    heard(|| {
        // The rig says 20 deg: half a pitch away a small dose is another one.
        let rig = Rig::new(Speech::MtSics, Truth { zero_rad: 80_f64.to_radians(), ..truth() });
        let dose = rig.by_weight(&["2g", "--rate", "1.5mL/s"]);
        let ended = rig.types(&dose);
        assert_eq!(ended.code, Some(1), "{ended:?}");
        assert!(
            ended.err.contains("if the rotor was turned by hand")
                && ended.err.contains("`dose home --unknown --pump pump.toml`"),
            "{}",
            ended.err
        );
        let left_g = rig.landed_g();
        for words in [&["discard"][..], &["home", "--unknown"]] {
            let ended = rig.types(words);
            assert_eq!(ended.code, Some(0), "{words:?}: {ended:?}");
        }
        let found = rig.json(&dose);
        assert!((rig.landed_g() - left_g - 2.0).abs() < 0.045, "{}: {found}", rig.landed_g());
        // The model's volume is one of many now.
        let weighed = &found["by_weight"];
        assert!(number(weighed, "turned_most_ml") >= number(weighed, "turned_least_ml"), "{found}");
        let status = rig.types(&["status"]).out;
        assert!(status.contains("last dose by weight") && !status.contains("by the model"), "{status}");
    });
}

#[test]
fn runs_of_whole_pitches_say_nothing_of_an_unknown_angle() {
    heard(|| {
        let rig = Rig::from_unknown_angle(Speech::MtSics, truth());
        let port = rig.balance.path().to_str().unwrap();
        let run = [
            "calibrate",
            "run",
            "--speeds",
            "10rpm",
            "--runs",
            "1",
            "--volume",
            "14mL",
            "--scale-port",
            port,
        ];
        let ended = rig.types(&run);
        assert_eq!(ended.code, Some(0), "{ended:?}");
        assert!(
            !ended.err.contains("angle is unknown") && !ended.out.contains("angle is unknown"),
            "{ended:?}"
        );
        // Drops hang at both ends of 14.2 mL.
        assert!(
            ended.out.contains("model volume times 1.03") || ended.out.contains("times 1.02"),
            "{}",
            ended.out
        );
        // A dose of whole pitches has one volume from every angle, and says so.
        let ended = rig.types(&["21.318mL", "--dry-run"]);
        assert!(
            !ended.out.contains("from this alone, the volume of the whole dose lies 21"),
            "{}",
            ended.out
        );
    });
}
