//! A bought head, of which a data sheet tells the volume per revolution and the number of rollers.

use std::fs;

use pump_model::{DefaultPulse, Line, Pump};
use serde_json::Value;

#[cfg(target_os = "linux")]
use crate::unattended::clock::with_room;
use crate::user::{User, number};

/// Writes the pump file of the docs, with `change` made to it.
fn pump(user: &User, change: [&str; 2]) -> &'static str {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/pumps/bought-head.toml");
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(change[0]), "{change:?}");
    fs::write(user.path("bought.toml"), text.replace(change[0], change[1])).unwrap();
    "bought.toml"
}

fn share_ml(report: &Value, source: &str) -> f64 {
    let shares = report["uncertainty_budget"].as_array().unwrap();
    shares.iter().find(|share| share["source"] == source).map_or(0.0, |share| number(share, "standard_ml"))
}

#[test]
fn the_details_and_the_warning_of_a_smooth_flow_agree() {
    let user = User::new();
    let bought = pump(&user, ["count = 4", "count = 4"]);
    let words = ["10mL", "--pump", bought, "--smooth", "--dry-run"];
    let text = user.types(&[&words[..], &["-v"]].concat()).out;
    let figures = |from: &str, to: &str| {
        let (_, rest) = text.split_once(from).unwrap_or_else(|| panic!("{from}: {text}"));
        let (found, _) = rest.split_once(to).unwrap_or_else(|| panic!("{to}: {text}"));
        found.to_owned()
    };
    let details = "no smoother than at constant speed: ripple peak to peak at the rollers ";
    let expected = figures(details, " % expected");
    assert_eq!(expected, figures("the ripple at the rollers is expected to be ", " % peak to peak"));
    let ripple = &user.json(&words)["ripple_at_rollers"];
    let median = number(ripple, "peak_to_peak_median");
    assert!((100.0 * median - expected.parse::<f64>().unwrap()).abs() < 1.0, "{ripple} {text}");
    // The paper's head is known by its drawing.
    let known = user.types(&["10mL", "--smooth", "--dry-run", "-v"]).out;
    assert!(
        known.contains(" smoother than at constant speed: ") && !known.contains("no smoother"),
        "{known}"
    );
}

#[test]
#[cfg(target_os = "linux")]
fn a_refused_dose_tells_the_reason_and_nothing_of_the_plan() {
    let user = User::new();
    let bought = pump(&user, ["id = \"bought-head\"", "id = \"mine\""]);
    let made = user.types(&["2mL", "--pump", bought]);
    assert!(made.out.contains("warning: only the volume per revolution"), "{}{}", made.out, made.err);
    // The next dose is planned, and has no room on the disk.
    let room = fs::metadata(user.path("state/mine/sim/journal.jsonl")).unwrap().len() + 20;
    let refused = with_room(&user, room, &["2mL", "--pump", bought]);
    let err = String::from_utf8(refused.stderr).unwrap();
    assert!(refused.status.code() == Some(2) && err.starts_with("error: cannot write "), "{err}");
    assert!(!err.contains("warning:"), "{err}");
}

#[test]
fn a_dose_of_a_bought_head_is_made_and_says_what_is_not_known() {
    let user = User::new();
    let bought = pump(&user, ["count = 4", "count = 4"]);
    let report = user.json(&["25mL", "--pump", bought]);
    assert_eq!((&report["volume_basis"], &report["completed"]), (&"estimated".into(), &true.into()));
    // 25 mL are 50 turns of 3200 steps: whole pitches are exact.
    assert_eq!(report["steps"], 160_000);
    assert!((number(&report, "delivered_ml") - 25.0).abs() < 2e-3, "{report}");
    for key in ["settle_s", "inlet_min_kpa", "outlet_max_kpa", "backflow_ml", "ripple_at_line_end"] {
        assert_eq!(report[key], Value::Null, "{key}");
    }
    for limit in ["discharge_pressure", "suction_pressure", "tube_collapse", "settling", "torque"] {
        assert!(
            report["limits_not_checked"].as_array().unwrap().contains(&limit.into()),
            "{limit}: {report}"
        );
    }
    // sqrt(25² + 20²)/sqrt(3) % of a head whose bore is not known, and nothing within whole pitches.
    assert!((share_ml(&report, "model") / 25.0 - 0.185).abs() < 1e-4, "{report}");
    assert!(share_ml(&report, "pulse") < 1e-9);
    assert!(report["warnings"][0].as_str().unwrap().contains("only the volume per revolution is known"));

    // The record goes on, and a part of a pitch is as unsure as the default pulse.
    let part = user.json(&["60uL", "--pump", bought]);
    assert!(share_ml(&part, "pulse") > 2e-3, "{part}");
    // The dose ended after 50 turns, so the angle of the record is 0 again.
    assert!(number(&part, "start_angle_deg").abs() < 1e-6, "{part}");
    let text = user.types(&["60uL", "--pump", bought, "--dry-run", "-v"]).out;
    for said in ["pressure not known", "settling not known", "names no lines", "settling"] {
        assert!(text.contains(said), "{said}: {text}");
    }
    let status = user.types(&["status", "--pump", bought]);
    assert_eq!(status.code, 0, "{}", status.err);
}

#[test]
fn the_file_is_checked_shown_and_written_as_rust() {
    let user = User::new();
    let bought = pump(&user, ["count = 4", "count = 4"]);
    let check = user.types(&["pumps", "check", bought]).out;
    for said in [
        "of the bore's pitch; as drawings of heads vary",
        "0.5000 mL per revolution, 0.1250 mL per pitch of 90.00°",
        "inlet     not given: its pressures and its settling are not known",
        "unsure    18.5 % of the volume, 8.7 % of it at a speed; a dose scatters by 0.47 % (standard uncertainties)",
    ] {
        assert!(check.contains(said), "{said}: {check}");
    }
    let shown = user.types(&["pumps", "show", bought]).out;
    assert!(shown.contains("[head]\nml_per_rev = 0.5\n") && !shown.contains("[backplate]"), "{shown}");
    let source = user.types(&["pumps", "show", bought, "--format", "rust"]).out;
    assert!(source.contains("pub static PUMP: Pump") && source.contains("rollers: 4"), "{source}");
    let simulated = user.types(&["simulate", "--pump", bought, "--speed", "20rpm", "--duration", "1s"]);
    assert_eq!(simulated.code, 0, "{}", simulated.err);
}

#[test]
fn lines_make_pressures_known_and_limits_possible() {
    let user = User::new();
    let line = "resistance_kpa_s_ml = 0.5\ncompliance_ml_kpa = 0.01\ninertance_kpa_s2_ml = 0.02\n\
                reservoir_kpa = 101.325\n";
    let lines = format!("[inlet]\n{line}[outlet]\n{line}[motor]");
    let known = pump(&user, ["[motor]", &lines]);
    let report = user.json(&["5mL", "--pump", known, "--max-outlet-pressure", "200kPaa"]);
    assert!(number(&report, "outlet_max_kpa") > 101.5 && report["settle_s"].is_number(), "{report}");
    assert!(!report["limits_not_checked"].as_array().unwrap().contains(&"settling".into()));

    let unknown = pump(&user, ["count = 4", "count = 4"]);
    let said = user.is_refused(&["5mL", "--pump", unknown, "--max-outlet-pressure", "200kPaa"]);
    assert!(
        said.contains("[inlet] resistance_kpa_s_ml is missing") && said.contains("a pressure limit"),
        "{said}"
    );
}

#[test]
fn a_head_that_is_given_twice_or_cannot_be_is_refused_before_anything_moves() {
    let user = User::new();
    for (change, said) in [
        (
            ["[motor]", "[tube]\nbore_radius_mm = 1.0\nouter_radius_mm = 2.0\n[motor]"],
            "0.5 beside [tube] bore_radius_mm",
        ),
        (["count = 4", "count = 4\nradius_mm = 3.0"], "0.5 beside [rollers] radius_mm"),
        (["ml_per_rev = 0.5", "ml_per_rev = -0.5"], "[head] ml_per_rev is -0.5"),
        (["ml_per_rev = 0.5", "ml_per_turn = 0.5"], "ml_per_turn"),
        (["count = 4", "count = 0"], "number of rollers is 0"),
        (["[motor]", "[speed_law]\nlaw = \"inlet-pressure\"\n[motor]"], "speed_law"),
        (["[motor]", "[limits]\nmax_outlet_kpa = 200.0\n[motor]"], "[limits] max_outlet_kpa is 200"),
    ] {
        let bought = pump(&user, change);
        let refusal = user.is_refused(&["5mL", "--pump", bought]);
        assert!(refusal.contains(said), "{said}: {refusal}");
    }
    assert_eq!(user.record(), None);
}

#[test]
fn short_doses_find_the_pulse_in_the_place_of_the_default() {
    let user = User::new();
    let bought = pump(&user, ["count = 4", "count = 4"]);
    // Short doses of a head whose pulse takes 20 % over 45 deg. The default takes 26 % over 55.5 deg.
    let pulse = DefaultPulse::new(0.2, 45.0);
    let head = Pump::from_ml_per_rev(0.5, 4, pulse, Line::PUBLISHED, Line::PUBLISHED).unwrap();
    let volume_ml = |from_deg: f64, to_deg: f64| {
        let at = |deg: f64| head.outlet_curve().volume_ml(deg.to_radians());
        at(to_deg) - at(from_deg)
    };
    let mut table = String::from("start_angle_deg,turned_deg,volume_ml\n");
    for from_deg in (0..90).step_by(5).map(f64::from) {
        table.push_str(&format!("{from_deg},20,{}\n", volume_ml(from_deg, from_deg + 20.0)));
    }
    fs::write(user.path("short.csv"), table).unwrap();
    let dose = ["60uL", "--pump", bought, "--start-angle", "20deg", "--dry-run"];
    let error_ml =
        |report: &Value| volume_ml(20.0, number(report, "end_angle_deg")) - number(report, "planned_ml");
    let before = user.json(&dose);
    assert!(error_ml(&before).abs() > 1e-3, "{before}");
    assert!(error_ml(&before).abs() < number(&before, "expanded_uncertainty_ml"), "{before}");

    let found = user.types(&["calibrate", "phase", "--pump", bought, "--use", "--from", "short.csv"]);
    assert_eq!(found.code, 0, "{} {}", found.out, found.err);
    let after = user.json(&dose);
    assert!(error_ml(&after).abs() < 1e-4, "{after}");
    assert!(share_ml(&after, "pulse") < 0.2 * share_ml(&before, "pulse"), "{after}");
    assert!(number(&after["calibration"], "roller_volume_ml") > 0.0, "{after}");
}

#[test]
fn the_docs_table_of_bounds_is_what_doses_state() {
    let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/bought_head.md")).unwrap();
    let (_, section) = page.split_once("## Bounds of a dose").unwrap();
    let rows: Vec<Vec<&str>> = section
        .lines()
        .filter(|line| line.starts_with("| ") && line.contains("mL |"))
        .map(|line| line.split('|').map(str::trim).filter(|cell| !cell.is_empty()).collect())
        .filter(|cells: &Vec<&str>| cells[0].ends_with("mL"))
        .collect();
    assert!(rows.len() >= 5, "{section}");
    for (column, changes, is_weighed) in [
        (1, ["count = 4", "count = 4"], false),
        (2, ["count = 4", "count = 4"], true),
        (3, ["[motor]", "[outlet]\nend = \"immersed\"\n[motor]"], true),
    ] {
        let user = User::new();
        let bought = pump(&user, changes);
        if is_weighed {
            assert_eq!(user.types(&["home", "--set", "0deg+-1deg", "--pump", bought]).code, 0);
            user.json(&["10mL", "--pump", bought]);
            user.json(&["calibrate", "last", "9.87g", "--pump", bought]);
        }
        for cells in &rows {
            let volume = cells[0].replace(' ', "");
            let dose = [volume.as_str(), "--pump", bought, "--start-angle", "0deg+-1deg", "--dry-run"];
            let found_ml = number(&user.json(&dose), "expanded_uncertainty_ml");
            let stated_ml: f64 =
                cells[column].trim_start_matches("± ").trim_end_matches(" mL").parse().unwrap();
            assert!((found_ml / stated_ml - 1.0).abs() < 0.01, "{volume}, column {column}: {found_ml}");
        }
    }
}

#[test]
fn the_docs_ripples_of_a_smooth_flow_are_those_that_a_dose_warns_of() {
    let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/bought_head.md")).unwrap();
    let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
    let user = User::new();
    let bought = pump(&user, ["count = 4", "count = 4"]);
    for (rate, stated) in [
        ("0.2mL/s", "230 % or more at 0.2 mL/s"),
        ("0.1mL/s", "354 % at 0.1 mL/s"),
        ("0.8mL/s", "144 % at 0.8 mL/s"),
    ] {
        let from = ["--start-angle", "30deg+-1deg", "--smooth", "--dry-run"];
        let report = user.json(&[&["5mL", "--pump", bought, "--rate", rate], &from[..]].concat());
        let (percent, _) = stated.split_once(" %").unwrap();
        let warned = report["warnings"].to_string();
        assert!(warned.contains(&format!("expected to be {percent} % peak to peak")), "{warned}");
        assert!(warned.contains("and 131 % at constant speed") && page.contains(stated), "{stated}");
    }
    assert!(page.contains("each by 131 % at constant speed"));
}

#[test]
fn a_dose_repeats_what_the_check_doubts_of_a_head_until_it_is_weighed() {
    let user = User::new();
    let one = pump(&user, ["count = 4", "count = 1"]);
    let text = fs::read_to_string(user.path(one)).unwrap();
    // 9.5 m of water are 92.9 kPa.
    fs::write(user.path(one), format!("{text}\n[inlet]\nlift_mm = 9500.0\n")).unwrap();
    let check = user.types(&["pumps", "check", one]).out;
    let dose = ["25mL", "--pump", one, "--dry-run"];
    let warned = |report: &Value| report["warnings"].to_string();
    let report = user.json(&dose);
    for part in
        ["one roller seals the tube only on a bed", "the pump sucks with 92.9 kPa below the air's pressure"]
    {
        assert!(check.contains(&format!("warning   {part}")), "{part}: {check}");
        assert_eq!(warned(&report).matches(part).count(), 1, "{part}: {report}");
    }
    let four = pump(&user, ["count = 4", "count = 4"]);
    let report = warned(&user.json(&["25mL", "--pump", four, "--dry-run"]));
    assert!(!report.contains("one roller") && !report.contains("sucks with"), "{report}");
}

#[test]
fn a_dose_that_sucks_deeper_than_tubes_are_known_to_stand_is_warned_of_at_its_rate() {
    let user = User::new();
    let bought = pump(&user, ["count = 4", "count = 4"]);
    let text = fs::read_to_string(user.path(bought)).unwrap();
    let line =
        "resistance_kpa_s_ml = 80.0\ncompliance_ml_kpa = 0.01\ninertance_kpa_s2_ml = 1e-4\nlift_mm = 0.0\n";
    fs::write(user.path(bought), format!("{text}\n[inlet]\n{line}\n[outlet]\n{line}")).unwrap();
    let warned = |rate: &str| {
        let report = user.json(&["25mL", "--pump", bought, "--rate", rate, "--dry-run"]);
        report["warnings"].to_string().matches("the pump sucks with").count()
    };
    // 80 kPa s/mL make 8 kPa of a mean flow of 0.1 mL/s, and 64 kPa of 0.8 mL/s.
    assert_eq!((warned("0.1mL/s"), warned("0.8mL/s")), (0, 1));
}

#[test]
fn a_head_that_was_changed_in_a_copy_of_the_built_in_file_has_the_uncertainty_of_a_pump_that_nobody_weighed()
{
    let user = User::new();
    let shown = user.types(&["pumps", "show", "three-roller"]).out;
    let copy = shown.replace("id = \"three-roller\"", "id = \"mine\"");
    let said = "the pump file states 2.4 %, which the makers of the built-in pump measured of theirs";
    let dosed = |text: &str, fact: &str| {
        fs::write(user.path("mine.toml"), text).unwrap();
        let check = user.types(&["pumps", "check", "mine.toml"]);
        assert!(check.out.contains(&format!("  warning   {said}{fact}")), "{}{}", check.out, check.err);
        let dose = user.json(&["25mL", "--pump", "mine.toml", "--dry-run"]);
        assert!(dose["warnings"].to_string().contains(&format!("{said}{fact}")), "{dose}");
        (check.out, dose["expanded_uncertainty_ml"].as_f64().unwrap())
    };
    // 2 x 2.4 % of 25 mL, and less for the scatter and the drop.
    let (_, renamed_ml) = dosed(&copy, ", not of this one");
    assert!((1.2..1.6).contains(&renamed_ml), "{renamed_ml}");
    // 2 x sqrt(13² + 8.7²) % of 25 mL are 7.8 mL.
    let (check, changed_ml) =
        dosed(&copy.replace("count = 3", "count = 4"), ", and its head is another; 13 %");
    assert!((7.7..8.0).contains(&changed_ml), "{changed_ml}");
    assert!(
        check.contains("13 % of the volume, 8.7 % of it at a speed") && !check.contains("2.4 % of"),
        "{check}"
    );
    assert!(!user.types(&["pumps", "check", "three-roller"]).out.contains(said));
}

#[test]
fn a_bought_head_is_not_drawn_and_the_refusal_says_why() {
    let user = User::new();
    for (words, option) in [
        (&["--ml-per-rev", "0.5mL", "--rollers", "4"][..], "--ml-per-rev"),
        (&["--head", "masterflex-ls-16", "--rollers", "4"], "--head"),
    ] {
        let refused = user.is_refused(&[&["pumps", "new"], words, &["--plot", "head.svg"]].concat());
        let said =
            format!("--plot draws the dimensions of a head, and {option} gives none; leave --plot out");
        assert!(refused.contains(&said) && !user.path("head.svg").exists(), "{refused}");
    }
}

#[test]
fn the_example_file_shares_its_record_with_no_pump_that_the_docs_set_up() {
    let user = User::new();
    let bought = pump(&user, ["count = 4", "count = 4"]);
    let id = user.json(&["5mL", "--pump", bought, "--dry-run"])["pump"].as_str().unwrap().to_owned();
    for docs in [include_str!("../../docs/setup.md"), include_str!("../../README.md")] {
        let names: Vec<_> = docs
            .split("dose setup ")
            .skip(1)
            .filter_map(|rest| rest.split([' ', '`', '\n']).next())
            .collect();
        assert!(names.contains(&"acid") && !names.contains(&id.as_str()), "{id}: {names:?}");
    }
}
