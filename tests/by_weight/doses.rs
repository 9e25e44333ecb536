//! Claims about doses that arrive.

use crate::balance::{Speech, Truth};
use crate::rig::{Rig, each, heard, number, truth};

/// Volume of a drop from the pump file's nozzle of 1.6 mm, mL: the law of Tate with the correction of Harkins and Brown
/// (see `falling_drop_ml`), as `dose pumps check` says it.
const FILE_DROP_ML: f64 = 0.027;

#[test]
fn a_board_doses_until_its_balance_shows_the_mass_whatever_the_pump_displaces() {
    each([Speech::MtSics, Speech::Sbi], |speech| {
        let rig = Rig::new(speech, truth());
        // A dose by volume leaves a carry.
        let first = rig.json(&["0.5mL"]);
        let carry_ml = number(&first, "carry_ml");
        let (from, before_g) = (rig.steps(), rig.landed_g());
        let found = rig.json(&rig.by_weight(&["6g", "--rate", "1.5mL/s"]));
        let weighed = &found["by_weight"];
        let (landed_g, steps) = (rig.landed_g() - before_g, rig.steps() - from);
        // Half a drop of the file and a drop of the truth: nothing comes nearer than the drops fall.
        let g_ml = truth().g_ml;
        let allowed_g = (FILE_DROP_ML.max(truth().drop_ml) + 0.002) * g_ml;
        assert!((landed_g - 6.0).abs() <= allowed_g, "{landed_g}: {found}");
        assert!((number(weighed, "mass_g") - landed_g).abs() < 0.0025, "{landed_g}: {found}");
        assert!((number(weighed, "target_g") - 6.0).abs() < 1e-9, "{found}");
        assert_eq!(
            (found["volume_basis"].as_str(), found["completed"].as_bool()),
            (Some("weighed"), Some(true))
        );
        assert_eq!(found["balance_g"], weighed["mass_g"]);
        // The volume is that of the mass in air, and its uncertainty holds what is in the vessel.
        let off_ml = number(&found, "delivered_ml") - landed_g / g_ml;
        assert!(off_ml.abs() < number(&found, "expanded_uncertainty_ml"), "{off_ml}: {found}");
        // The pump delivers 3 % more than its model, which knows the steps.
        assert_eq!(found["steps_made"].as_i64(), Some(steps), "{found}");
        let vessel = rig.balance.vessel();
        let turned_ml = vessel.modelled_ml(from + steps) - vessel.modelled_ml(from);
        drop(vessel);
        assert!((number(weighed, "turned_ml") - turned_ml).abs() < 1e-3, "{turned_ml}: {found}");
        assert!(turned_ml <= number(weighed, "most_ml") && number(weighed, "stretches") >= 2.0, "{found}");
        // Nothing is carried, and what the dose before left is dropped and told.
        assert_eq!((number(&found, "carry_ml"), number(&found, "carry_in_ml")), (0.0, 0.0), "{found}");
        assert!((number(weighed, "dropped_ml") - carry_ml).abs() < 1e-12, "{carry_ml}: {found}");
        let dropped = found["warnings"].to_string().contains("the balance ended the dose");
        assert_eq!(dropped, carry_ml != 0.0, "{found}");
        let status = rig.json(&["status"]);
        assert_eq!(number(&status, "carry_ml"), 0.0);
        assert!(status["unfinished"].is_null(), "{status}");
        let last = &status["last_by_weight"];
        for key in ["target_g", "mass_g", "digit_g", "turned_ml", "dropped_ml"] {
            assert_eq!(last[key], weighed[key], "{key}: {status}");
        }
        assert_eq!(last["volume_ml"], found["delivered_ml"]);
        // The next dose, by volume, repays nothing, and the status tells of no weighing then.
        let next = rig.json(&["1mL"]);
        assert_eq!(number(&next, "carry_in_ml"), 0.0);
        assert!(rig.json(&["status"])["last_by_weight"].is_null());
    });
}

#[test]
fn a_person_reads_what_was_asked_for_and_what_the_balance_shows() {
    heard(|| {
        let rig = Rig::new(Speech::MtSics, truth());
        let ended = rig.types(&rig.by_weight(&["4g", "--rate", "1.5mL/s"]));
        assert_eq!(ended.code, Some(0), "{ended:?}");
        let mass = format!("by weight: {:.3} g of 4.000 g in ", rig.landed_g());
        // The last digit of two readings may differ.
        let close = &mass[.."by weight: 4.0".len()];
        assert!(
            ended.out.contains(close) && ended.out.contains(" g of 4.000 g in "),
            "{mass}: {}",
            ended.out
        );
        assert!(ended.out.contains("4 g requested by a balance in air"), "{}", ended.out);
        assert!(ended.out.contains("the model's first value"), "{}", ended.out);
        let status = rig.types(&["status"]).out;
        assert!(
            status.contains("last dose by weight: 4.0") && status.contains(" g of 4.000 g asked for"),
            "{status}"
        );
        assert!(status.contains("carries nothing to the next dose"), "{status}");
    });
}

#[test]
fn a_dose_from_an_unknown_angle_at_the_default_rate_ends_at_its_mass() {
    each([0.0, 40.0, 80.0], |turned_deg: f64| {
        let rig =
            Rig::from_unknown_angle(Speech::MtSics, Truth { zero_rad: turned_deg.to_radians(), ..truth() });
        let found = rig.json(&rig.by_weight(&["4g"]));
        let landed_g = rig.landed_g();
        let allowed_g = (FILE_DROP_ML.max(truth().drop_ml) + 0.002) * truth().g_ml;
        assert!((landed_g - 4.0).abs() <= allowed_g, "{landed_g}: {found}");
        let warnings = found["warnings"].to_string();
        assert!(
            warnings.contains("the rollers' angle is unknown: the first stretches are shorter"),
            "{found}"
        );
        // The angle cannot be given with a dose by weight, so no remedy says so.
        assert!(warnings.contains("dose home") && !warnings.contains("--start-angle"), "{found}");
    });
}
