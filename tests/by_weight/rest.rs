//! Claims about the rest of a dose by weight: the balance finishes what a signal, a kill or a fault cut off.

use std::process::{Child, Command};

use crate::balance::{Defect, Speech};
use crate::rig::{Rig, each, failing, heard, number, truth};

/// Volume of a drop, mL, and digits of two readings, g: nothing comes nearer than a drop falls.
const NEAR_G: f64 = 0.045;

fn resume_by_weight(rig: &Rig) -> Vec<&str> {
    rig.by_weight(&["resume"])
}

/// Kills a dose at once, or has it decelerate.
fn ends(mut child: Child, by: &str) {
    if by == "INT" {
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130));
    } else {
        child.kill().unwrap();
        child.wait().unwrap();
    }
}

#[test]
fn a_dose_that_was_cut_off_is_finished_by_its_balance() {
    each([("INT", 1), ("KILL", 1), ("KILL", 3)], |(by, times)| {
        let rig = Rig::new(Speech::MtSics, truth());
        let first = rig.by_weight(&["8g", "--rate", "1.5mL/s"]);
        let resumed = resume_by_weight(&rig);
        for number in 0..times {
            let words = if number == 0 { &first } else { &resumed };
            ends(rig.begins(words, rig.steps() + 700), by);
        }
        let from = rig.steps();
        let found = rig.json(&resumed);
        let (weighed, landed_g) = (&found["by_weight"], rig.landed_g());
        assert!((landed_g - 8.0).abs() <= NEAR_G, "{by}: {landed_g}: {found}");
        assert!((number(weighed, "mass_g") - landed_g).abs() < 0.0025, "{landed_g}: {found}");
        assert!((number(weighed, "target_g") - 8.0).abs() < 1e-9, "{found}");
        // The pump's model knows all the steps, those before the cut included.
        let steps = rig.steps();
        let modelled_ml = rig.balance.vessel().modelled_ml(steps);
        assert!((number(weighed, "turned_ml") - modelled_ml).abs() < 2e-3, "{modelled_ml}: {found}");
        assert_eq!(found["steps_made"].as_i64(), Some(steps - from), "{found}");
        let off_ml = number(&found, "delivered_ml") - landed_g / truth().g_ml;
        assert!(off_ml.abs() < number(&found, "expanded_uncertainty_ml"), "{off_ml}: {found}");
        assert!(number(weighed, "before_ml") > 0.1, "{found}");
        let status = rig.json(&["status"]);
        assert!(status["unfinished"].is_null() && number(&status, "carry_ml") == 0.0, "{status}");
        assert_eq!(status["last_by_weight"]["mass_g"], weighed["mass_g"], "{status}");
        assert_eq!(rig.types(&resumed).code, Some(2), "nothing is left");
    });
}

#[test]
fn a_fault_of_the_balance_that_is_mended_leaves_a_dose_to_be_finished_by_weight() {
    heard(|| {
        let rig = Rig::new(Speech::MtSics, failing(Defect::Overload, 1.5));
        assert_eq!(rig.types(&rig.by_weight(&["6g", "--rate", "1.5mL/s"])).code, Some(1));
        let text = rig.types(&["status"]).out;
        assert!(text.contains("`dose resume --until-scale --pump pump.toml` goes on"), "{text}");
        rig.balance.vessel().truth.defect = Defect::None;
        let ended = rig.types(&resume_by_weight(&rig));
        assert_eq!(ended.code, Some(0), "{ended:?}");
        assert!(ended.out.contains(" of an earlier command"), "{}", ended.out);
        assert!(ended.out.contains("6 g requested by a balance in air"), "{}", ended.out);
        assert!((rig.landed_g() - 6.0).abs() <= NEAR_G, "{}", rig.landed_g());
    });
}

#[test]
fn a_dose_from_an_unknown_angle_is_finished_by_its_balance() {
    heard(|| {
        let rig = Rig::from_unknown_angle(Speech::MtSics, truth());
        let first = rig.by_weight(&["8g", "--rate", "1.5mL/s"]);
        ends(rig.begins(&first, 1_500), "KILL");
        let found = rig.json(&resume_by_weight(&rig));
        assert!((rig.landed_g() - 8.0).abs() <= NEAR_G, "{}: {found}", rig.landed_g());
    });
}

#[test]
fn a_reading_that_the_pump_cannot_have_brought_about_moves_nothing() {
    // The vessel stood at 50 g: another one, none, a balance that was tared since.
    each([80.0, 0.0, -2.6], |vessel_g| {
        let rig = Rig::new(Speech::MtSics, truth());
        ends(rig.begins(&rig.by_weight(&["8g", "--rate", "1.5mL/s"]), 3_000), "INT");
        let (before, steps) = (rig.json(&["status"]), rig.steps());
        rig.balance.vessel().truth.vessel_g = vessel_g;
        let ended = rig.types(&resume_by_weight(&rig));
        assert_eq!(ended.code, Some(4), "{ended:?}");
        assert!(ended.err.contains("were expected: it showed 50.000 g before the dose"), "{}", ended.err);
        assert!(ended.err.contains("put the vessel back"), "{}", ended.err);
        assert_eq!(rig.steps(), steps);
        assert_eq!(rig.json(&["status"]), before);
        // The vessel back on the balance, it goes on.
        rig.balance.vessel().truth.vessel_g = 50.0;
        rig.json(&resume_by_weight(&rig));
        assert!((rig.landed_g() - 8.0).abs() <= NEAR_G, "{}", rig.landed_g());
    });
}

#[test]
fn a_balance_that_shows_all_that_was_asked_for_ends_the_dose_without_a_step() {
    heard(|| {
        let rig = Rig::new(Speech::MtSics, truth());
        ends(rig.begins(&rig.by_weight(&["3g", "--rate", "1.5mL/s"]), 1_200), "INT");
        let (steps, landed_g) = (rig.steps(), rig.landed_g());
        // Somebody adds what is missing, within the pump's uncertainty or not: a full vessel is refused, as any other.
        rig.balance.vessel().truth.vessel_g = 50.0 + (3.0 - landed_g);
        let ended = rig.types(&resume_by_weight(&rig));
        assert_eq!((ended.code, rig.steps()), (Some(4), steps), "{ended:?}");
    });
}

#[test]
fn a_dose_by_volume_has_no_rest_by_weight() {
    heard(|| {
        let rig = Rig::new(Speech::MtSics, truth());
        ends(rig.begins(&["8mL", "--rate", "1.5mL/s"], 3_000), "INT");
        let ended = rig.types(&resume_by_weight(&rig));
        assert_eq!(ended.code, Some(4), "{ended:?}");
        assert!(ended.err.contains("asked for by volume"), "{}", ended.err);
        // Without a word about a balance none is opened.
        let ended = rig.types(&["resume", "--scale-command", "echo 1 g"]);
        assert!(ended.code == Some(2) && ended.err.contains("--until-scale"), "{ended:?}");
        let ended = rig.types(&rig.by_weight(&["resume", "--smooth"]));
        assert!(ended.code == Some(4) && ended.err.contains("by volume"), "{ended:?}");
    });
}

#[test]
fn a_dose_that_reached_its_ceiling_goes_on_by_weight_only_with_a_higher_one() {
    heard(|| {
        // A part of the pump's volume is lost on the way, where the file is sure to 6 %.
        let rig = Rig::new(Speech::MtSics, crate::balance::Truth { factor: 0.92, ..truth() });
        let ended = rig.types(&rig.by_weight(&["4g", "--rate", "1.5mL/s", "--max-volume", "4.05mL"]));
        assert!(ended.code == Some(1) && ended.err.contains("home --unknown"), "{ended:?}");
        let steps = rig.steps();
        let ended = rig.types(&resume_by_weight(&rig));
        assert_eq!((ended.code, rig.steps()), (Some(4), steps), "{ended:?}");
        assert!(
            ended.err.contains("4.05 mL is the most") && ended.err.contains("--max-volume"),
            "{}",
            ended.err
        );
        let found = rig.json(&rig.by_weight(&["resume", "--max-volume", "5mL"]));
        assert!((rig.landed_g() - 4.0).abs() <= NEAR_G, "{}: {found}", rig.landed_g());
    });
}
