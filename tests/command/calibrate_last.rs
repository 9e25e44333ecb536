//! `dose calibrate last`, as a person at the bench uses it.

use crate::user::{User, number};

/// Volume of 1 g of water of 25 °C on a balance in air of 85.7 kPa, mL. From Z of ISO 8655-6 with the density of Kell
/// (1975), 997.047 kg/m³, and air of 1.001 kg/m³ at 50 % humidity.
const Z_ML_G: f64 = 1.003_84;

#[test]
fn the_weight_of_the_last_dose_calibrates_the_next() {
    let user = User::new();
    // Ten revolutions: a dose of half a revolution scatters too much to be surer than the model.
    let before = user.json(&["213mL"]);
    let found = user.json(&["calibrate", "last", "217.26g"]);
    let factor = number(&found["displacement"], "factor");
    let expected = 217.26 * Z_ML_G / number(&before, "planned_ml");
    assert!((factor - expected).abs() < 2e-5, "{factor} {expected}");
    assert_eq!(found["source"], "last");
    let after = user.json(&["213mL"]);
    assert_eq!(after["volume_basis"], "calibrated");
    assert!(number(&after, "expanded_uncertainty_ml") < number(&before, "expanded_uncertainty_ml"));
    // A second dose joins the first, at the speed that its rate takes now.
    let said = user.types(&["calibrate", "last", "212.57g"]);
    assert!(said.code == 0 && said.out.contains("2 runs at"), "{}{}", said.out, said.err);
    assert_eq!(user.types(&["10mL"]).code, 0, "the default rate is still covered");
}

#[test]
fn a_volume_that_was_read_is_taken_with_its_option_and_without() {
    let user = User::new();
    user.json(&["213mL"]);
    let found = |words: &[&str]| {
        let found = user.json(&[&["calibrate", "last", "--dry-run"], words].concat());
        (number(&found["displacement"], "factor"), number(&found["displacement"], "reading"))
    };
    assert_eq!(found(&["--volume", "218.1mL"]), found(&["218.1mL"]));
    let mass = user.is_refused(&["calibrate", "last", "--volume", "217.26g"]);
    assert!(mass.contains("`217.26g` is a mass; write it without --volume"), "{mass}");
    assert!(
        user.is_refused(&["calibrate", "last", "218g", "--volume", "218mL"]).contains("cannot be used with")
    );
}

#[test]
fn a_weighing_that_is_less_sure_than_the_model_waits_for_more() {
    let user = User::new();
    // Half a revolution: its scatter is 6.5 % on the stated prior, and the model's mean is sure to 2.4 %.
    let before = user.json(&["10mL", "--start-angle", "0deg+-0deg"]);
    let said = user.types(&["calibrate", "last", "9.90g"]).out;
    assert!(said.contains("calibration 1 waits: the mean volume by these doses"), "{said}");
    assert!(said.contains("doses keep to the model") && !said.contains("from now on"), "{said}");
    let after = user.json(&["10mL", "--start-angle", "0deg+-0deg"]);
    assert_eq!(after["volume_basis"], "model");
    let unsure_ml = |report| number(report, "expanded_uncertainty_ml");
    // The carry makes the second dose a little larger.
    assert!((unsure_ml(&after) / unsure_ml(&before) - 1.0).abs() < 1e-3, "{after}");
    // The next one joins it, and so do more until they are surer than the model.
    let mut found = user.json(&["calibrate", "last", "9.91g"]);
    let mut doses = 2;
    while found["used"] == false && doses < 20 {
        assert_eq!(found["runs"].as_array().unwrap().len(), doses);
        user.json(&["10mL"]);
        found = user.json(&["calibrate", "last", if doses % 2 == 0 { "9.90g" } else { "9.91g" }]);
        doses += 1;
    }
    assert_eq!((&found["used"], found["runs"].as_array().unwrap().len()), (&true.into(), doses), "{found}");
    assert!(doses > 2);
    assert_eq!(user.json(&["10mL"])["volume_basis"], "calibrated");
}

#[test]
fn a_weighing_that_waits_ends_with_its_tube() {
    let user = User::new();
    user.json(&["10mL"]);
    assert_eq!(user.json(&["calibrate", "last", "9.90g"])["used"], false);
    assert_eq!(user.types(&["tube", "--new"]).code, 0);
    user.json(&["10mL"]);
    let found = user.json(&["calibrate", "last", "9.90g"]);
    assert_eq!(found["runs"].as_array().unwrap().len(), 1, "{found}");
}

#[test]
fn a_coarser_scale_says_so_by_its_last_digit() {
    let user = User::new();
    user.json(&["10mL"]);
    let standard = |reading: &str| {
        let found = user.json(&["calibrate", "last", reading, "--anew", "--dry-run"]);
        number(&found["displacement"], "reading")
    };
    // Two readings, each known to a step over the square root of 12.
    let step = (2.0_f64 / 12.0).sqrt() / (10.0 * Z_ML_G);
    // Water of 25 °C grows by 2.57e-4 a degree (CRC Handbook), and its temperature is known to 0.8 °C.
    let with_density = |reading: f64| reading.hypot(0.8 * 2.57e-4);
    assert!((standard("10.0g") / with_density(0.1 * step) - 1.0).abs() < 0.01);
    assert!((standard("10.00g") / with_density(0.01 * step) - 1.0).abs() < 0.01);
    assert!((standard("10g") / with_density(step) - 1.0).abs() < 0.01);
}

#[test]
fn what_cannot_be_the_weight_of_the_last_dose_is_refused_and_nothing_is_kept() {
    let user = User::new();
    let refused = user.is_refused(&["calibrate", "last", "10g"]);
    assert!(refused.contains("no dose is on record") && refused.contains("dose calibrate last"), "{refused}");
    user.json(&["10mL"]);
    // 49.5 g are 49.69 mL, 4.97 times 10 mL.
    let wrong = "the reading is 49.69 mL of water, 4.97 times the 9.9994 mL that the last dose delivered by the model";
    for (reading, part) in [("49.5g", wrong), ("10", "has no unit"), ("-10g", "without sign")] {
        let refused = user.is_refused(&["calibrate", "last", reading]);
        assert!(refused.contains(part) && !refused.contains("run 1"), "{reading}: {refused}");
    }
    let said = user.types(&["calibrate", "last", "10.1g", "--dry-run"]);
    assert!(said.code == 0 && said.out.contains("nothing is kept"), "{}", said.err);
    assert!(user.types(&["calibrate", "list"]).out.contains("is not calibrated"));
    user.json(&["prime", "5mL"]);
    assert!(user.is_refused(&["calibrate", "last", "5g"]).contains("primed"));
}

#[test]
fn a_calibration_by_runs_is_not_replaced_by_one_dose_unless_that_is_asked_for() {
    let user = User::new();
    let table = "speed_rpm,revolutions,volume_ml\n10,3,64.6\n10,3,64.7\n60,3,64.5\n60,3,64.6\n";
    std::fs::write(user.path("runs.csv"), table).unwrap();
    user.json(&["calibrate", "run", "--from", "runs.csv"]);
    user.json(&["10mL"]);
    let refused = user.is_refused(&["calibrate", "last", "10.1g"]);
    assert!(refused.contains("rests on 4 runs") && refused.contains("--add"), "{refused}");
    let added = user.json(&["calibrate", "last", "10.1g", "--add"]);
    assert_eq!(added["runs"].as_array().unwrap().len(), 5);
    let alone = user.json(&["calibrate", "last", "10.1g", "--anew"]);
    assert_eq!(alone["runs"].as_array().unwrap().len(), 1);
}

#[test]
fn one_weighed_dose_rests_on_a_stated_prior_and_a_second_is_offered_first() {
    let user = User::new();
    user.json(&["213mL"]);
    let said = user.types(&["calibrate", "last", "213.0g", "--dry-run"]).out;
    let at = |part: &str| said.find(part).unwrap_or_else(|| panic!("{part}: {said}"));
    // 1.3 times the 0.47 % of ten revolutions.
    assert!(
        at("one weighed dose shows no scatter") < at("0.61 %") && at("0.61 %") < at("41 % smaller or larger")
    );
    let offered = at("weigh one more dose like this");
    assert!(offered < at("warning") && offered < at("would use it if it were kept"), "{said}");
    let found = user.json(&["calibrate", "last", "213.0g"]);
    let next = &found["next_weighing"];
    // Student's t of 3 degrees of freedom is 3.31, of 4 it is 2.87 (GUM, table G.2): of a dose and its mean, with a
    // drop of 60 µL from an outlet that nobody described. The second scatters as the file says.
    let drop = 0.05995 / 6_f64.sqrt() / 213.0;
    let of_mean = |t: f64, pooled: f64, doses: f64| {
        100.0 * ((t * pooled).powi(2) + (2.0 * drop).powi(2)).sqrt() / doses.sqrt()
    };
    let (first, second) = (1.3 * 0.0047, 0.0047 * ((3.0 * 1.69 + 1.0) / 4.0_f64).sqrt());
    for (key, percent) in [
        ("mean_percent", of_mean(3.31, first, 1.0)),
        ("dose_percent", of_mean(3.31, first, 1.0) * 2_f64.sqrt()),
        ("then_mean_percent", of_mean(2.87, second, 2.0)),
        ("then_dose_percent", of_mean(2.87, second, 2.0) * 3_f64.sqrt()),
    ] {
        assert!((number(next, key) / percent - 1.0).abs() < 0.01, "{key}: {next} {percent}");
    }
    assert_eq!(next["more"], 1);

    let dose = user.json(&["213mL", "--dry-run"]);
    for share in dose["uncertainty_budget"].as_array().unwrap() {
        let rests = share["source"] == "repeatability" || share["source"] == "calibration";
        assert_eq!(share["prior"]["weighed"] == 1, rests, "{share}");
        let remedy = share["remedy"].as_str().unwrap();
        assert_eq!(
            remedy.contains("weigh one more dose") && remedy.contains("dose calibrate last"),
            rests,
            "{share}"
        );
    }
    let details = user.types(&["213mL", "--dry-run", "-v"]).out;
    assert!(
        details.contains("on a stated prior of 0.61, 1.3 times the pump file's, beside 1 weighed dose"),
        "{details}"
    );
}

#[test]
fn a_scatter_that_was_measured_is_no_prior() {
    let user = User::new();
    let shown = user.types(&["pumps", "show", "three-roller"]).out;
    let stated = shown.replace("[uncertainty]", "[uncertainty]\nrepeatability_at_ml = 213.0");
    assert_ne!(shown, stated);
    std::fs::write(user.path("pump.toml"), stated).unwrap();
    user.json(&["213mL", "--pump", "pump.toml"]);
    let found = user.json(&["calibrate", "last", "213.0g", "--pump", "pump.toml"]);
    assert!(
        found["displacement"]["prior"].is_null() && found["next_weighing"]["dose_percent"].is_null(),
        "{found}"
    );
    let dose = user.json(&["213mL", "--pump", "pump.toml", "--dry-run"]);
    assert!(
        dose["uncertainty_budget"].as_array().unwrap().iter().all(|share| share["prior"].is_null()),
        "{dose}"
    );
}

#[test]
fn a_dose_that_says_less_than_the_model_is_not_used() {
    let user = User::new();
    let is_used = |volume: &str, reading: &str| {
        user.json(&[volume]);
        user.json(&["calibrate", "last", reading, "--dry-run"])["used"] == true
    };
    // Half a revolution is known to 2 x 4.7 %, ten revolutions to 2 x 1 %; the model to 2 x 2.4 %.
    assert!(!is_used("10mL", "10.0g") && is_used("213mL", "213.0g"));
}

#[test]
fn a_fluid_far_thicker_than_the_one_that_was_weighed_is_warned_of() {
    let user = User::new();
    user.json(&["213mL"]);
    assert_eq!(user.json(&["calibrate", "last", "217.26g"])["used"], true);
    let warned = |arguments: &[&str]| {
        let report = user.json(&[&["213mL", "--dry-run"], arguments].concat());
        report["warnings"].to_string().contains("calibration 1 was weighed with water at 25 °C, and this is")
    };
    assert!(warned(&["--fluid", "glycerol 50%"]));
    assert!(!warned(&[]) && !warned(&["--temperature", "40degC"]) && !warned(&["--fluid", "ethanol"]));
}

#[test]
fn masses_of_two_fluids_are_never_read_as_one() {
    let user = User::new();
    user.json(&["213mL"]);
    let water = user.json(&["calibrate", "last", "217.26g"]);
    assert_eq!(number(&water["runs"][0], "temperature_degc"), 25.0);
    user.json(&["213mL"]);
    let ethanol = ["calibrate", "last", "168.2g", "--fluid", "ethanol"];
    let refused = user.is_refused(&ethanol);
    assert!(
        refused.contains("calibration 1 was weighed with water, and this dose with ethanol"),
        "{refused}"
    );
    assert!(refused.contains("--anew") && refused.contains("--fluid"), "{refused}");
    let alone = user.json(&[&ethanol[..], &["--anew"]].concat());
    assert_eq!((alone["runs"].as_array().unwrap().len(), &alone["fluid"]), (1, &"ethanol".into()));
    // A later temperature leaves the earlier masses what they were.
    user.json(&["213mL"]);
    let warm = user.json(&["calibrate", "last", "167.9g", "--fluid", "ethanol", "--temperature", "26degC"]);
    let degc: Vec<_> = (0..2).map(|run| number(&warm["runs"][run], "temperature_degc")).collect();
    assert_eq!(degc, [25.0, 26.0], "{warm}");
}

#[test]
fn a_dose_is_weighed_as_the_fluid_that_it_was_made_with() {
    let user = User::new();
    let glycerol = ["--fluid", "glycerol 60%", "--temperature", "22degC"];
    user.json(&[&["213mL"], &glycerol[..]].concat());
    let weighed = user.types(&["calibrate", "last", "245.5g"]);
    assert!(
        weighed.err.contains("the dose was glycerol 60% at 22 °C, and its reading is taken as that"),
        "{}",
        weighed.err
    );
    assert!(
        weighed.out.contains("1 run at") && weighed.out.contains("glycerol 60% at 22 °C"),
        "{}",
        weighed.out
    );
    let list = user.json(&["calibrate", "list"]);
    // 60 % of glycerol has 1.153 g/mL at 22 °C (Cheng 2008), and 245.5 g of it are 213 mL.
    let factor = number(&list["calibrations"][0]["displacement"], "factor");
    assert!((factor - 1.0).abs() < 3e-3, "{list}");
    assert!(user.types(&["calibrate", "list"]).out.contains("1 run of glycerol 60% at"));
    // A person who knows better says so, and hears what is on record.
    let corrected = user.types(&["calibrate", "last", "213.0g", "--fluid", "water", "--anew"]);
    assert!(
        corrected.err.contains(
            "the dose was made as glycerol 60% at 22 °C, and its reading is taken as water at 22 °C"
        ),
        "{}",
        corrected.err
    );
    let log = user.types(&["log", "--format", "json"]).out;
    let dose: serde_json::Value = serde_json::from_str(log.lines().next().unwrap()).unwrap();
    assert_eq!((&dose["fluid"], number(&dose, "temperature_degc")), (&"glycerol 60%".into(), 22.0));
}

#[test]
fn a_second_reading_of_a_dose_says_that_it_takes_the_place_of_the_first() {
    let user = User::new();
    user.json(&["213mL"]);
    let first = user.types(&["calibrate", "last", "217.30g"]);
    assert!(!first.err.contains("takes the place"), "{}", first.err);
    let second = user.types(&["calibrate", "last", "217.26g"]);
    assert!(
        second.err.contains("this reading takes the place of 217.30g of the same dose"),
        "{}",
        second.err
    );
    assert!(second.out.contains("1 run at"), "{}", second.out);
}

#[test]
fn a_reading_far_beyond_what_the_dose_was_known_to_be_is_taken_only_if_it_is_meant() {
    let user = User::new();
    user.json(&["213mL"]);
    // The model is sure to 2 x 2.4 %, so that a reading 8 % off may be right, and one 30 % off is hardly so.
    assert_eq!(user.types(&["calibrate", "last", "229.0g", "--dry-run"]).code, 0);
    let unlikely = user.is_refused(&["calibrate", "last", "277.0g"]);
    for said in ["the reading is 278", "the last dose was 213", "was not emptied", "add --anyway"] {
        assert!(unlikely.contains(said), "{said}: {unlikely}");
    }
    assert!(user.types(&["calibrate", "list"]).out.contains("is not calibrated"));
    let meant = user.json(&["calibrate", "last", "277.0g", "--anyway"]);
    assert!((number(&meant["displacement"], "factor") - 1.305).abs() < 0.01, "{meant}");
    // Once it is weighed the pump is known to a percent.
    user.json(&["213mL"]);
    let unlikely = user.is_refused(&["calibrate", "last", "229.0g", "--anew"]);
    assert!(unlikely.contains("add --anyway"), "{unlikely}");
}

#[test]
fn doses_that_scatter_far_too_much_are_told_as_a_slip() {
    let user = User::new();
    user.json(&["213mL"]);
    let first = user.json(&["calibrate", "last", "217.26g"]);
    user.json(&["213mL"]);
    let told = |found: &serde_json::Value, part: &str| found["warnings"].to_string().contains(part);
    // The calibrated dose is 212.2 g. 2.3 % apart, where a dose of ten revolutions is to scatter by 0.6 %.
    let wide = user.json(&["calibrate", "last", "207.36g", "--dry-run"]);
    assert!(told(&wide, "one more dose shows if a reading slipped"), "{wide}");
    let second = user.json(&["calibrate", "last", "190.26g", "--anyway"]);
    assert!(!told(&first, "scatter by") && told(&second, "one of them is hardly right"), "{second}");
}

#[test]
fn a_dose_that_no_scale_can_tell_of_names_the_doses_that_one_can() {
    let user = User::new();
    assert_eq!(user.types(&["home", "--unknown"]).code, 0);
    user.json(&["12mL"]);
    let refused = user.is_refused(&["calibrate", "last", "12.1g"]);
    assert!(
        refused.contains("not known to better than 2 deg") && refused.contains("as doses of "),
        "{refused}"
    );
    let volume = refused.split("as doses of ").nth(1).unwrap().split(' ').next().unwrap();
    user.json(&[format!("{volume}mL").as_str()]);
    let grams = volume.parse::<f64>().unwrap() / Z_ML_G;
    let found = user.json(&["calibrate", "last", &format!("{grams:.2}g")]);
    assert!((number(&found["displacement"], "factor") - 1.0).abs() < 2e-3, "{found}");
}

#[test]
fn the_first_dose_of_a_bought_head_calibrates_although_nobody_knows_the_angle() {
    let user = User::new();
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/pumps/bought-head.toml");
    std::fs::copy(own, user.path("bought.toml")).unwrap();
    let with = |words: &[&str]| user.types(&[words, &["--pump", "bought.toml"]].concat());
    assert_eq!(with(&["home", "--unknown"]).code, 0);
    // A part of a pitch more than 40 of them.
    let dose = with(&["5.06mL", "--format", "json"]);
    let dose: serde_json::Value = serde_json::from_str(&dose.out).unwrap();
    let said = with(&["calibrate", "last", "5.15g"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let by_angle = said.err.split("uncertain by ± ").nth(1).unwrap().split(' ').next().unwrap();
    // Bounds of the volume over the angles: a sine between them has 1/sqrt(2) of half their distance.
    let half_ml = 0.5 * (number(&dose, "volume_most_ml") - number(&dose, "volume_least_ml"));
    let standard_ml = 0.5 * by_angle.parse::<f64>().unwrap();
    assert!(standard_ml > 0.3 * half_ml && standard_ml < half_ml, "{by_angle}: {dose}");
    let found = with(&["calibrate", "list", "--format", "json"]).out;
    assert!(found.contains("\"start_half_width_deg\":45"), "{found}");
}

#[test]
fn the_next_dose_to_weigh_is_of_whole_pitches_as_doses_are_planned_now() {
    let user = User::new();
    assert_eq!(user.types(&["home", "--set", "0deg", "--tolerance", "20deg"]).code, 0);
    user.json(&["7.1062mL"]);
    // One pitch is so unsure that the calibration waits, and doses keep to the model.
    let said = user.types(&["calibrate", "last", "7.5g"]).out;
    assert!(said.contains("calibration 1 waits"), "{said}");
    let volume = said.split("like this, of ").nth(1).unwrap().split(' ').next().unwrap();
    assert!(volume.starts_with("7.10"), "{said}");
    // Doses on record are told apart by their second.
    std::thread::sleep(std::time::Duration::from_millis(1100));
    user.json(&[format!("{volume}mL").as_str()]);
    assert_eq!(user.json(&["calibrate", "last", "7.4g"])["runs"].as_array().unwrap().len(), 2);
}

#[test]
fn a_calibration_that_was_weighed_with_other_steps_or_another_head_is_warned_of() {
    let user = User::new();
    let own =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/pumps/bought-head.toml"))
            .unwrap();
    std::fs::write(user.path("bought.toml"), &own).unwrap();
    user.json(&["25mL", "--pump", "bought.toml"]);
    assert_eq!(user.types(&["calibrate", "last", "24.9g", "--pump", "bought.toml"]).code, 0);
    let warnings = || user.json(&["5mL", "--pump", "bought.toml", "--dry-run"])["warnings"].to_string();
    assert!(!warnings().contains("steps per revolution"), "{}", warnings());
    assert!(own.contains("steps_per_rev = 3200"), "{own}");
    std::fs::write(user.path("bought.toml"), own.replace("steps_per_rev = 3200", "steps_per_rev = 6400"))
        .unwrap();
    assert!(
        warnings().contains("stated 3200 steps per revolution of the head, and now it states 6400")
            && warnings().contains("doses are 2 times as large"),
        "{}",
        warnings()
    );
    std::fs::write(user.path("bought.toml"), own.replace("[rollers]", "tube_bore_mm = 1.6\n[rollers]"))
        .unwrap();
    let said = "weighed with 4 rollers, and the pump file states 4 rollers and a tube of 1.6 mm bore now";
    assert!(warnings().contains(said), "{}", warnings());
    std::fs::write(user.path("bought.toml"), own.replace("count = 4", "count = 3")).unwrap();
    assert!(
        warnings().contains("weighed with 4 rollers, and the pump file states 3 rollers now"),
        "{}",
        warnings()
    );
}

#[test]
fn a_mistaken_unit_is_told_before_the_fluid() {
    let user = User::new();
    user.json(&["213mL"]);
    user.json(&["calibrate", "last", "217.26g"]);
    user.json(&["213mL", "--fluid", "glycerol 60%"]);
    let refused = user.is_refused(&["calibrate", "last", "245.5kg"]);
    assert!(refused.contains("half to twice the 2"), "{refused}");
}

#[test]
fn a_reading_that_cannot_be_is_told_beside_the_volume_that_the_dose_was_planned_for() {
    let user = User::new();
    let table = "speed_rpm,revolutions,volume_ml\n10,3,53.6\n10,3,53.7\n60,3,53.5\n60,3,53.6\n";
    std::fs::write(user.path("runs.csv"), table).unwrap();
    user.json(&["calibrate", "run", "--from", "runs.csv"]);
    let planned_ml = number(&user.json(&["10mL"]), "planned_ml");
    // The calibration in use now is none of the dose's.
    assert_eq!(user.types(&["calibrate", "use", "none"]).code, 0);
    let refused = user.is_refused(&["calibrate", "last", "72.5mL", "--anew"]);
    let said = refused.split(" times the ").nth(1).unwrap();
    let target_ml: f64 = said.split(' ').next().unwrap().parse().unwrap();
    assert!(
        (target_ml - planned_ml).abs() < 1e-3 && refused.contains("is 72.5 mL of water, 7.25"),
        "{refused}"
    );
    // 53.6 mL in place of the model's 63.96 mL: the model has 11.9 mL where the calibration has 10.
    let model_ml = said.split("half to twice the ").nth(1).unwrap().split(' ').next().unwrap();
    assert!((model_ml.parse::<f64>().unwrap() / target_ml - 1.193).abs() < 5e-3, "{refused}");
}
