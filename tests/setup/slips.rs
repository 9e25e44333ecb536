//! Slips of a unit, a digit or a count: a head that cannot be is refused, and one that hardly is is warned of.

use std::fs;

use crate::person::{Desk, by_part};

/// Answers of a simulated pump but its head.
const SIM: [&str; 8] = ["--microsteps", "16", "--driver", "sim", "--altitude", "0m", "--yes", "--no-motion"];

#[test]
fn a_volume_that_no_head_delivers_through_its_bore_is_refused_with_the_range() {
    let desk = Desk::new();
    // pi²/12 d³ to pi/4 d² 10 m.
    for (ml, bore, range) in [("500mL", "1.6mm", "0.0034 to 20 mL"), ("0.5mL", "30mm", "22 to 7069 mL")] {
        let head = ["setup", "acid", "--ml-per-rev", ml, "--bore", bore, "--rollers", "4"];
        let refused = desk.types(&[&head[..], &SIM].concat());
        assert_eq!(refused.code, 2, "{}", refused.err);
        assert!(refused.err.contains(range) && refused.err.matches("error:").count() == 1, "{}", refused.err);
        assert_eq!((desk.configured("config.toml"), desk.configured("setup/acid.toml")), (None, None));
    }
    // A person is asked again where they stand, and nothing is lost.
    let answers =
        [("Head:", "0.5mL"), ("Rollers", "4"), ("Microsteps", "16"), ("Driver", "sim"), ("Altitude", "0m")];
    let (mut react, mut bores) = (by_part(&answers), ["30mm", "1.6mm"].iter());
    let ended = desk.answers(&["setup", "acid", "--no-motion"], &mut |question| {
        if question.starts_with("Bore") { bores.next().map(ToString::to_string) } else { react(question) }
    });
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("0.5 mL per revolution cannot be with a bore of 30 mm"), "{}", ended.err);
    assert!(desk.configured("pumps/acid.toml").unwrap().contains("tube_bore_mm = 1.6"));
}

#[test]
fn a_rate_that_hardly_turns_the_head_is_refused_at_its_question_with_the_range() {
    let desk = Desk::new();
    // A pitch of 0.5 mL/4 in an hour is 3.47e-5 mL/s, and 100 r/min are 0.833 mL/s.
    let range = "takes longer than an hour; allowed: 0.0000347 to 0.833 mL/s";
    let head = ["setup", "acid", "--ml-per-rev", "0.5mL", "--rollers", "4", "--rate", "1nL/s"];
    let refused = desk.types(&[&head[..], &SIM].concat());
    assert!(refused.code == 2 && refused.err.contains(range), "{}", refused.err);
    let answers =
        [("Head:", "0.5mL"), ("Rollers", "4"), ("Microsteps", "16"), ("Driver", "sim"), ("Altitude", "0m")];
    let (mut react, mut rates) = (by_part(&answers), ["1nL/s", "0.1uL/s"].iter());
    let ended = desk.answers(&["setup", "acid", "--no-motion"], &mut |question| {
        if question.starts_with("Rate") { rates.next().map(ToString::to_string) } else { react(question) }
    });
    assert!(ended.code == 0 && ended.err.contains(range), "{}", ended.err);
    assert!(desk.configured("pumps/acid.toml").unwrap().contains("default_rate_ml_s = 0.0001\n"));
}

#[test]
fn full_steps_that_no_motor_has_are_asked_again_and_taken_if_they_are_meant() {
    let desk = Desk::new();
    let doubt = "3200 full steps per revolution are unusual";
    let answers = [("Head:", "0.5mL"), ("Rollers", "4"), ("Driver", "sim"), ("Altitude", "0m")];
    let setup = |name: &str, full_steps: [&str; 2]| {
        let (mut react, mut steps) = (by_part(&answers), full_steps.iter());
        let ended = desk.answers(&["setup", name, "--no-motion"], &mut |question| match question {
            question if question.starts_with("Full steps") => steps.next().map(ToString::to_string),
            question if question.starts_with("Microsteps") => Some("1".to_owned()),
            question => react(question),
        });
        assert_eq!(ended.code, 0, "{}", ended.err);
        assert!(ended.err.contains(&format!("{doubt}: stepper motors have 20 to 400")), "{}", ended.err);
        (desk.configured(&format!("pumps/{name}.toml")).unwrap(), ended.err)
    };
    let (slip, said) = setup("slip", ["3200", "200"]);
    assert!(slip.contains("full_steps_per_rev = 200\n") && said.matches(doubt).count() == 1, "{slip}");
    let (meant, said) = setup("meant", ["3200", "3200"]);
    assert!(meant.contains("full_steps_per_rev = 3200\n"), "{meant}");
    // The question says it, and the warning before the file is written.
    assert_eq!(said.matches(doubt).count(), 2, "{said}");
    let option = ["setup", "said", "--ml-per-rev", "0.5mL", "--rollers", "4", "--full-steps", "3200"];
    let ended = desk.types(&[&option[..], &SIM].concat());
    assert!(ended.code == 0 && ended.err.contains(&format!("warning: {doubt}")), "{}", ended.err);
}

#[test]
fn what_is_unusual_is_said_before_the_file_is_written_and_by_the_check() {
    let desk = Desk::new();
    let warnings = [
        "5 mL per revolution fill 2487 mm of a bore of 1.6 mm",
        "40 rollers are more than heads have",
        "3000 steps per revolution are 15 microsteps of 200 full steps",
        // 100 m of 997 kg/m³ are 977.7 kPa.
        "the vessel presses back with 978 kPa",
    ];
    let plain = ["setup", "plain", "--ml-per-rev", "0.5mL", "--bore", "1.6mm", "--rollers", "4"];
    let said = desk.types(&[&plain[..], &SIM].concat());
    assert!(said.code == 0 && !said.err.contains("warning"), "{}", said.err);
    let one = ["setup", "one", "--ml-per-rev", "0.5mL", "--rollers", "1"];
    let said = desk.types(&[&one[..], &SIM].concat());
    assert!(said.code == 0 && said.err.contains("warning: one roller seals the tube only"), "{}", said.err);
    let odd = ["--ml-per-rev", "5mL", "--bore", "1.6mm", "--rollers", "40", "--discharge-lift", "100m"];
    let words = [&["setup", "odd"][..], &odd, &["--microsteps", "15"], &SIM[2..]].concat();
    let said = desk.types(&words);
    assert_eq!(said.code, 0, "{}", said.err);
    let check = desk.types(&["pumps", "check", "odd"]);
    assert_eq!(check.code, 0, "{}", check.err);
    let written_at = said.err.find("is written").unwrap();
    for warning in warnings {
        let at = said.err.find(&format!("warning: {warning}"));
        assert!(at.is_some_and(|at| at < written_at), "{warning}: {}", said.err);
        assert!(check.out.contains(&format!("  warning   {warning}")), "{warning}: {}", check.out);
    }
}

#[test]
fn a_new_file_of_the_catalogue_warns_of_what_its_owner_said() {
    let desk = Desk::new();
    let refused = desk.types(&["pumps", "new", "--head", "kamoer-kphm400-25", "--rollers", "40", "no.toml"]);
    assert!(
        refused.code == 2 && refused.err.contains("has 3 rollers by its document, and 40"),
        "{}",
        refused.err
    );
    let new = ["pumps", "new", "--head", "masterflex-ls-16", "--microsteps", "15", "--rollers", "40"];
    let told = desk.types(&[&new[..], &["odd.toml"]].concat());
    assert_eq!(told.code, 0, "{}", told.err);
    for warning in
        ["  warning   40 rollers are more", "  warning   3000 steps per revolution are 15 microsteps"]
    {
        assert!(told.out.contains(warning), "{warning}: {}", told.out);
    }
    // The file on standard output holds the file alone.
    let printed = desk.types(&new);
    assert!(printed.err.contains("warning: 40 rollers are more"), "{}", printed.err);
    assert!(!printed.out.contains("warning"), "{}", printed.out);
    fs::write(desk.path("again.toml"), printed.out).unwrap();
    assert_eq!(desk.types(&["pumps", "check", "again.toml"]).code, 0);
    // A bore that its owner states beside the catalogue's volume.
    let text = fs::read_to_string(desk.path("odd.toml")).unwrap();
    let name = "catalogue = \"masterflex-ls-16\"\n";
    assert!(text.contains(name), "{text}");
    fs::write(desk.path("odd.toml"), text.replace(name, &format!("{name}tube_bore_mm = 48.0\n"))).unwrap();
    let refused = desk.types(&["pumps", "check", "odd.toml"]);
    assert!(
        refused.code == 2
            && refused.err.contains("[head] ml_per_rev is 0.8 beside tube_bore_mm = 48; allowed: 91 to"),
        "{}",
        refused.err
    );
}

#[test]
fn a_new_file_of_a_volume_per_revolution_is_what_setup_writes() {
    let desk = Desk::new();
    let new =
        ["pumps", "new", "--ml-per-rev", "0.5mL", "--bore", "1.6mm", "--rollers", "4", "--microsteps", "16"];
    let told = desk.types(&[&new[..], &["--altitude", "0m", "acid.toml"]].concat());
    assert_eq!(told.code, 0, "{}", told.err);
    assert!(told.out.contains("200 full steps x 16 microsteps = 3200 steps"), "{}", told.out);
    let text = fs::read_to_string(desk.path("acid.toml")).unwrap();
    for line in ["ml_per_rev = 0.5\n", "tube_bore_mm = 1.6\n", "count = 4\n", "altitude_m = 0.0\n"] {
        assert!(text.contains(line), "{line}: {text}");
    }
    let dose = desk.json(&["5mL", "--pump", "acid.toml"]);
    assert!((dose["delivered_ml"].as_f64().unwrap() - 5.0).abs() < 2e-3, "{dose}");
    let impossible =
        ["pumps", "new", "--ml-per-rev", "500mL", "--bore", "1.6mm", "--rollers", "4", "no.toml"];
    let refused = desk.types(&impossible);
    assert!(refused.code == 2 && refused.err.contains("0.00337 to 20.1 for this bore"), "{}", refused.err);
    assert!(!desk.path("no.toml").exists());
    for (words, part) in [
        (&["--ml-per-rev", "0.5mL"][..], "--rollers"),
        (&["--ml-per-rev", "0.5mL", "--rollers", "4", "--tube", "10x14mm"], "cannot be used with"),
        (&["--bore", "1.6mm", "--rollers", "4"], "--ml-per-rev"),
    ] {
        let refused = desk.types(&[&["pumps", "new"], words].concat());
        assert!(refused.code == 2 && refused.err.contains(part), "{part}: {}", refused.err);
    }
}

/// Answers of the paper's head, whose backplate is said as `backplate`.
fn drawn<'a>(
    backplate: &'a mut dyn Iterator<Item = &'static str>,
) -> impl FnMut(&str) -> Option<String> + 'a {
    let mut react = by_part(&[
        ("Head:", "drawing"),
        ("Radius of a roller", "20mm"),
        ("From the shaft", "40mm"),
        ("Tube,", "10x14mm"),
        ("Contact", "30deg"),
        ("Microsteps", "16"),
        ("Driver", "sim"),
        ("Altitude", "0m"),
    ]);
    move |question| match question {
        q if q.starts_with("Radius of the backplate") => backplate.next().map(ToString::to_string),
        // Enter keeps what was said before.
        q if q.contains('[') => Some(String::new()),
        q if q.starts_with("Rollers") => Some("3".to_owned()),
        q => react(q),
    }
}

#[test]
fn a_wrong_dimension_of_a_drawing_is_said_at_the_drawing_and_can_be_mended_there() {
    let desk = Desk::new();
    let mut backplate = ["23mm", "63mm"].into_iter();
    let ended = desk.answers(&["setup", "acid", "--no-motion"], &mut drawn(&mut backplate));
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("mm deeper than the tube's walls"), "{}", ended.err);
    for kept in ["Rollers, counted [3]", "Radius of a roller [20mm]", "Contact angle [30deg]"] {
        assert!(ended.err.contains(kept), "{kept}: {}", ended.err);
    }
    assert!(desk.configured("pumps/acid.toml").unwrap().contains("radius_mm = 63.0"));
}

#[test]
fn a_drawing_that_was_left_wrong_is_asked_anew_and_one_that_was_typed_wrong_too() {
    let desk = Desk::new();
    let mut backplate = ["23mm"].into_iter();
    // The person leaves at the second question for the backplate.
    let left = desk.answers(&["setup", "acid", "--no-motion"], &mut drawn(&mut backplate));
    assert!(left.code == 2 && left.err.contains("--backplate 63mm"), "{}", left.err);
    let mut backplate = ["63mm"].into_iter();
    let ended = desk.answers(&["setup", "acid", "--no-motion"], &mut drawn(&mut backplate));
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(!ended.err.contains("Rollers, counted"), "the rollers are on record: {}", ended.err);

    let typed = [
        "--tube",
        "10x14mm",
        "--backplate",
        "23mm",
        "--roller",
        "20mm",
        "--offset",
        "40mm",
        "--contact",
        "30deg",
    ];
    let mut backplate = ["63mm"].into_iter();
    let words = [&["setup", "base", "--no-motion"][..], &typed].concat();
    let ended = desk.answers(&words, &mut drawn(&mut backplate));
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("Radius of the backplate (raceway) [23mm]"), "{}", ended.err);
}

#[test]
fn one_dimension_alone_changes_the_drawing_on_record() {
    let desk = Desk::new();
    let mut backplate = ["63mm"].into_iter();
    assert_eq!(desk.answers(&["setup", "acid", "--no-motion"], &mut drawn(&mut backplate)).code, 0);
    let changed = desk.types(&["setup", "acid", "--backplate", "62.5mm", "--yes", "--no-motion"]);
    assert_eq!(changed.code, 0, "{}", changed.err);
    let file = desk.configured("pumps/acid.toml").unwrap();
    assert!(file.contains("radius_mm = 62.5") && file.contains("offset_mm = 40"), "{file}");
    let refused = desk.types(&["setup", "acid", "--backplate", "59mm", "--yes", "--no-motion"]);
    assert!(refused.code == 2 && refused.err.contains("1.000 mm deeper"), "{}", refused.err);
    assert_eq!(desk.configured("pumps/acid.toml").unwrap(), file);
    let refused = desk.types(&["setup", "base", "--backplate", "63mm", "--yes"]);
    assert!(
        refused.code == 2 && refused.err.contains("a drawing takes --tube, --backplate"),
        "{}",
        refused.err
    );
    let refused = desk.types(&["setup", "acid", "--backplate", "63mm", "--head", "masterflex-ls-16"]);
    assert!(refused.code == 2 && refused.err.contains("cannot be used with"), "{}", refused.err);
}

#[test]
fn a_count_of_rollers_that_no_head_has_is_refused_without_a_word_of_a_file() {
    let desk = Desk::new();
    for head in [&["--ml-per-rev", "0.5mL"][..], &["--head", "masterflex-ls-16"]] {
        let refused = desk.types(&[&["setup", "acid", "--rollers", "0"], head, &SIM].concat());
        assert_eq!(refused.code, 2, "{}", refused.err);
        assert!(
            refused.err.contains("number of rollers is 0; allowed: whole numbers from 1 to 1000"),
            "{}",
            refused.err
        );
        assert!(!refused.err.contains("file"), "{}", refused.err);
    }
}

#[test]
fn a_rate_that_is_too_fast_at_the_question_names_a_command_and_no_option_that_cannot_be_typed_there() {
    let desk = Desk::new();
    let answers =
        [("Head:", "0.5mL"), ("Rollers", "4"), ("Microsteps", "16"), ("Driver", "sim"), ("Altitude", "0m")];
    let (mut react, mut rates) = (by_part(&answers), ["5mL/s", ""].iter());
    let ended = desk.answers(&["setup", "acid", "--no-motion"], &mut |question| {
        if question.starts_with("Rate") { rates.next().map(ToString::to_string) } else { react(question) }
    });
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(ended.err.contains("quit, and `dose setup acid --max-speed 300rpm` says what"), "{}", ended.err);
}
