//! Claims about doses by weight that a person or the death of the process ends.

use std::process::Command;

use crate::balance::Speech;
use crate::rig::{Ended, Rig, heard, number, truth};

#[test]
fn ctrl_c_decelerates_and_the_status_says_that_the_dose_was_by_weight() {
    heard(|| {
        let rig = Rig::new(Speech::MtSics, truth());
        let child = rig.begins(&rig.by_weight(&["8g", "--rate", "1.5mL/s"]), 3_000);
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        let ended: Ended = child.wait_with_output().unwrap().into();
        assert_eq!(ended.code, Some(130), "{ended:?}");
        assert!(
            ended.err.contains("`dose resume --pump pump.toml` makes the rest by volume"),
            "{}",
            ended.err
        );
        assert!(ended.out.contains("then stopped") && ended.out.contains(" g of 8.000 g"), "{}", ended.out);
        let modelled_ml = rig.balance.vessel().modelled_ml(rig.steps());
        // The last reading in motion lacks what still arrives, so the model tells the volume.
        assert!(ended.out.contains("when the motor was stopped, and rising"), "{}", ended.out);
        let told_ml = ended.out.split(" mL ± ").next().and_then(|text| text.rsplit(' ').next()).unwrap();
        let told_ml: f64 = told_ml.parse().unwrap();
        assert!((told_ml - modelled_ml).abs() < 0.006, "{modelled_ml}: {}", ended.out);
        // The ± is that of what was made: 2.4 % and the scatter of 2 mL, and no part of what was left.
        let unsure_ml = ended.out.split(" mL ± ").nth(1).and_then(|text| text.split(' ').next()).unwrap();
        let unsure_ml: f64 = unsure_ml.parse().unwrap();
        assert!(unsure_ml < 0.2 * told_ml, "{unsure_ml}: {}", ended.out);
        let is_count = |line: &str| line.contains(" steps made") && !line.contains(" of ");
        assert!(ended.out.lines().any(is_count), "{}", ended.out);
        let status = rig.json(&["status"]);
        for bound in ["delivered_least_ml", "delivered_most_ml"] {
            assert!(
                (number(&status["unfinished"], bound) - modelled_ml).abs() < 1e-6,
                "{modelled_ml}: {status}"
            );
        }
        assert_eq!(status["unfinished"]["by_weight"], true);
    });
}

#[test]
fn a_dose_that_is_killed_is_known_between_bounds_and_its_rest_is_made_by_volume() {
    heard(|| {
        let rig = Rig::new(Speech::MtSics, truth());
        let words = rig.by_weight(&["8mL", "--rate", "1.5mL/s"]);
        let mut child = rig.begins(&words, 3_000);
        child.kill().unwrap();
        child.wait().unwrap();
        let modelled_ml = rig.balance.vessel().modelled_ml(rig.steps());
        let status = rig.json(&["status"]);
        let dose = &status["unfinished"];
        let (least_ml, most_ml) = (number(dose, "delivered_least_ml"), number(dose, "delivered_most_ml"));
        assert!(least_ml <= modelled_ml && modelled_ml <= most_ml, "{modelled_ml}: {status}");
        assert!(most_ml < 8.0 && dose["by_weight"] == true, "{status}");
        // A new dose would be a second one.
        assert_eq!(rig.types(&words).code, Some(4));
        let rest = rig.json(&["resume"]);
        assert!(rest["by_weight"].is_null() && rest["completed"] == true, "{rest}");
        assert!(rest["warnings"].to_string().contains("made by volume"), "{rest}");
        // The board's count tells the steps, so the whole is the volume asked for, by the model and not to the ceiling.
        let turned_ml = rig.balance.vessel().modelled_ml(rig.steps());
        assert!((turned_ml - 8.0).abs() < 0.002, "{turned_ml}");
        let status = rig.json(&["status"]);
        assert!(status["unfinished"].is_null() && status["last_by_weight"].is_null(), "{status}");
    });
}
