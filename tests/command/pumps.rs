//! Pump files from a drawing, from measured points and from hoses.

use std::fs;

use pump_model::volume_fit::PUBLISHED_POINTS;

use crate::user::{User, number};

/// Table 1 of McIntyre et al.
pub(crate) const DRAWING: [&str; 14] = [
    "pumps",
    "new",
    "--tube",
    "10x14mm",
    "--backplate",
    "63mm",
    "--roller",
    "20mm",
    "--offset",
    "40mm",
    "--contact",
    "30deg",
    "--rollers",
    "3",
];

#[test]
fn a_drawing_whose_rollers_take_more_than_the_bore_delivers_is_refused_for_that() {
    let user = User::new();
    let crowded = user.is_refused(&[&DRAWING[..13], &["99", "crowded.toml"]].concat());
    assert!(crowded.contains("99 rollers") && !crowded.contains("NaN"), "{crowded}");
    assert!(!user.path("crowded.toml").exists());
}

#[test]
fn a_drawing_becomes_a_pump_that_doses_and_says_that_it_is_estimated() {
    let user = User::new();
    let answer = user.types(&[&DRAWING[..], &["--id", "drawn", "drawn.toml"]].concat());
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert!(answer.out.contains("`dose pumps check drawn.toml`"), "{}", answer.out);

    let check = user.types(&["pumps", "check", "drawn.toml"]).out;
    for text in [
        "roller    2.2267 mL over 66.81°, estimated from the drawing",
        "20.9547 mL per revolution",
        "nozzle    in air unless [outlet] end says otherwise; a drop from 10 mm has 140 µL",
        "C 0.0455 mL/kPa, L 0.00420 kPa s²/mL, estimated from its hose, R at 8.7 mL/s",
        "unsure    13.1 % of the volume, 8.7 % of it at a speed, and 0.13 mL of a roller",
    ] {
        assert!(check.contains(text), "{text}: {check}");
    }
    let estimated = check.lines().find(|line| line.trim_start().starts_with("estimated")).unwrap();
    assert!(estimated.contains("uncertainties"), "{check}");
    let measured = user.json(&["25mL", "--rate", "5mL/s", "--dry-run"]);
    let drawn = user.json(&["25mL", "--rate", "5mL/s", "--pump", "drawn.toml"]);
    assert_eq!((&measured["volume_basis"], &drawn["volume_basis"]), (&"model".into(), &"estimated".into()));
    let unsure = |report| number(report, "expanded_uncertainty_ml");
    assert!(unsure(&drawn) > 4.0 * unsure(&measured));
    assert!(drawn["warnings"][0].as_str().unwrap().contains("estimated from the drawing"));
    assert!((number(&drawn, "delivered_ml") - number(&drawn, "planned_ml")).abs() < 2e-3);
}

#[test]
fn the_file_goes_to_standard_output_unless_named_and_replaces_nothing() {
    let user = User::new();
    let text = user.types(&DRAWING).out;
    assert!(
        text.contains("# Estimated from the dimensions") && text.contains("contact_angle_deg = 30.0\n"),
        "{text}"
    );
    assert!(
        text.contains("# As given.\n[tube]\n") && text.contains("# Assumed: a drawing does not tell."),
        "{text}"
    );
    fs::write(user.path("mine.toml"), "precious").unwrap();
    let message = user.is_refused(&[&DRAWING[..], &["mine.toml"]].concat());
    assert!(message.contains("mine.toml is there already"), "{message}");
    assert_eq!(fs::read_to_string(user.path("mine.toml")).unwrap(), "precious");
    assert!(user.is_refused(&[&DRAWING[..], &["no/such/folder/x.toml"]].concat()).contains("cannot write"));
}

#[test]
fn drawings_of_pumps_that_cannot_work_are_refused_by_name() {
    let user = User::new();
    for (option, with, expected) in [
        ("--tube", "10mm", "is not a tube; write bore x outer"),
        ("--tube", "14x10mm", "the outer diameter, 10 mm, must be more than the bore, 14 mm"),
        ("--backplate", "63", "has no unit"),
        ("--offset", "38mm", "use a smaller backplate, or a larger roller"),
        ("--offset", "44mm", "beyond the backplate radius"),
        ("--contact", "85deg", "psi = 360 - 303.45 - 66.81 = -10.26 deg"),
        ("--rollers", "1", "no roller seals"),
        ("--rollers", "0", "number of rollers is 0"),
        ("--roller", "-20mm", "negative"),
    ] {
        let mut arguments = DRAWING.map(str::to_owned);
        let place = arguments.iter().position(|word| word == option).unwrap();
        arguments[place] = format!("{option}={with}");
        arguments[place + 1].clear();
        let words: Vec<_> = arguments.iter().map(String::as_str).filter(|word| !word.is_empty()).collect();
        let message = user.is_refused(&words);
        assert!(message.contains(expected), "{option} {with}: {message}");
    }
    assert!(
        user.is_refused(&[&DRAWING[..], &["--id", "My Pump"]].concat()).contains("[pump] id is `My Pump`")
    );
    assert!(user.is_refused(&[&DRAWING[..], &["--rate", "5mL/s"]].concat()).contains("takes no --rate"));
    assert!(user.is_refused(&DRAWING[..12]).contains("--rollers"));
}

/// The three-roller pump with other keys in `[roller_volume]`.
fn with_roller_volume(three: &str, keys: &str) -> String {
    let start = three.find("[roller_volume]").unwrap();
    let end = start + three[start..].find("[inlet]").unwrap();
    format!("{}[roller_volume]\n{keys}\n\n{}", &three[..start], &three[end..])
}

#[test]
fn measured_points_in_the_file_make_the_pump() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    let points: Vec<_> = PUBLISHED_POINTS.iter().map(|(deg, ml)| format!("[{deg:?}, {ml:?}]")).collect();
    let table = |fit: &str| {
        with_roller_volume(
            &three,
            &format!("source = \"measured\"\nfit = \"{fit}\"\npoints_deg_ml = [{}]", points.join(", ")),
        )
    };
    fs::write(user.path("quintic.toml"), table("quintic")).unwrap();
    let check = user.types(&["pumps", "check", "quintic.toml"]).out;
    assert!(check.contains("2.1055 mL over 50.53°, from 15 measured points, 0.0074 mL RMS off\n"), "{check}");
    assert!(check.contains("21.3185 mL per revolution"), "{check}");
    fs::write(user.path("spline.toml"), table("spline").replace("2.08]", "2.01]")).unwrap();
    let check = user.types(&["pumps", "check", "spline.toml"]).out;
    assert!(check.contains("they fall by 0.0143 mL from 42.87° to 46.53°"), "{check}");
    // The file that is shown can be read again.
    let shown = user.types(&["pumps", "show", "spline.toml"]).out;
    fs::write(user.path("again.toml"), &shown).unwrap();
    assert_eq!(user.types(&["pumps", "show", "again.toml"]).out, shown);
    assert_eq!(user.json(&["25mL", "--pump", "spline.toml", "--dry-run"])["volume_basis"], "model");
}

#[test]
fn tables_that_contradict_themselves_are_refused_by_name() {
    let user = User::new();
    let three = user.types(&["pumps", "show", "three-roller"]).out;
    let refused = |text: String, expected: &str| {
        fs::write(user.path("my.toml"), text).unwrap();
        let message = user.is_refused(&["25mL", "--pump", "my.toml"]);
        assert!(message.contains(expected) && message.contains("my.toml"), "{expected}: {message}");
    };
    for (keys, expected) in [
        ("engagement_angle_deg = 50.0", "missing field `polynomial_ml_deg`"),
        (
            "source = \"drawing\"\nengagement_angle_deg = 50.0",
            "`engagement_angle_deg` means nothing with source = \"drawing\"",
        ),
        ("source = \"guess\"", "unknown variant `guess`"),
        ("source = \"drawing\"\nwidth = 1.0", "unknown field `width`"),
        ("source = \"measured\"\npoints_deg_ml = [[0.0, 0.0]]", "missing field `fit`"),
        (
            "source = \"measured\"\nfit = \"spline\"\npoints_deg_ml = [[0.0, 0.0]]",
            "at 1 different angles; the curve needs 3",
        ),
    ] {
        refused(with_roller_volume(&three, keys), expected);
    }
    let hose = "[inlet.hose]\nbore_radius_mm = 5.0\nouter_radius_mm = 7.0\nlength_mm = 331.0\nmodulus_mpa = 3.5\n\
                poisson_ratio = 0.5\nminor_loss = 5.75\n";
    let resistance =
        "resistance_kpa_s_ml = 0.1108\ncompliance_ml_kpa = 0.0361\ninertance_kpa_s2_ml = 0.0042\n";
    assert!(three.contains(resistance));
    let both = three.replace("[outlet]", &format!("{hose}\n[outlet]"));
    refused(both.clone(), "`resistance_kpa_s_ml` and `hose` exclude each other");
    refused(
        three.replacen("compliance_ml_kpa = 0.0361\n", "", 1),
        "missing field `compliance_ml_kpa` (or a `hose`)",
    );
    let by_hose = both.replacen(resistance, "", 1);
    refused(by_hose.replace("name = \"water\"", "name = \"oil\""), "[fluid] viscosity_mpa_s is missing");
    refused(
        by_hose.replace("poisson_ratio = 0.5", "poisson_ratio = 0.6"),
        "Poisson ratio of the hose is 0.6",
    );
    fs::write(user.path("my.toml"), &by_hose).unwrap();
    let check = user.types(&["pumps", "check", "my.toml"]).out;
    assert!(check.contains("inlet     R 0.0035 kPa s/mL, C 0.0455 mL/kPa"), "{check}");
    assert!(
        check.contains("outlet    R 0.1108 kPa s/mL, C 0.0361 mL/kPa, L 0.00420 kPa s²/mL, as given"),
        "{check}"
    );
}

#[test]
fn the_steps_of_the_motor_are_said_or_the_file_says_that_nobody_did() {
    let user = User::new();
    let new = |options: &[&str]| user.types(&[&DRAWING[..], options].concat());
    let untold = new(&["untold.toml"]);
    assert!(untold.out.contains("the motor's steps are not known"), "{}", untold.out);
    let text = fs::read_to_string(user.path("untold.toml")).unwrap();
    assert!(
        text.contains("confirmed = false\n") && text.contains("and take out `confirmed = false`"),
        "{text}"
    );
    let check = user.types(&["pumps", "check", "untold.toml"]).out;
    assert!(check.contains("motor     12800 steps per revolution, gear 1, assumed: a real motor"), "{check}");
    assert!(
        check.contains("  assumed   steps of the motor, direction of the motor, ambient pressure"),
        "{check}"
    );
    // 200 full steps of 1.8 degrees, sixteen microsteps each.
    for (options, said) in [
        (
            &["--steps-per-rev", "3200"][..],
            "3200 steps per revolution of the motor, x gear 1 = 3200 of the head",
        ),
        (&["--microsteps", "16"], "200 full steps x 16 microsteps = 3200 steps"),
        (
            &["--full-steps", "400", "--microsteps", "8", "--gear", "3"],
            "= 3200 steps per revolution of the motor, x gear 3 = 9600",
        ),
    ] {
        let _ = fs::remove_file(user.path("told.toml"));
        let told = new(&[options, &["told.toml"]].concat());
        assert!(told.out.contains(said), "{options:?}: {}", told.out);
        let text = fs::read_to_string(user.path("told.toml")).unwrap();
        assert!(
            text.contains("steps_per_rev = 3200\n") && !text.contains("\nconfirmed"),
            "{options:?}: {text}"
        );
    }
    assert!(fs::read_to_string(user.path("told.toml")).unwrap().contains("full_steps_per_rev = 400\n"));
    let refused = |options: &[&str]| user.is_refused(&[&DRAWING[..], options].concat());
    assert!(refused(&["--gear", "3"]).contains("add --steps-per-rev 3200, or --microsteps 16"));
    assert!(refused(&["--steps-per-rev", "3200", "--microsteps", "16"]).contains("cannot be used with"));
    assert!(
        refused(&["--steps-per-rev", "0"])
            .contains("number of steps per revolution is 0; allowed: whole numbers from 4 to 100000000")
    );
    assert!(refused(&["--full-steps", "70000", "--microsteps", "70000"]).contains("allowed: 4 to 100000000"));
}

#[test]
fn a_new_pump_stands_where_it_is_told() {
    let user = User::new();
    let place = [
        "--altitude",
        "500m",
        "--suction-lift",
        "1.2m",
        "--discharge-lift",
        "0.5m",
        "--steps-per-rev",
        "3200",
    ];
    assert_eq!(user.types(&[&DRAWING[..], &place[..], &["high.toml"]].concat()).code, 0);
    let text = fs::read_to_string(user.path("high.toml")).unwrap();
    for key in ["altitude_m = 500.0\n", "lift_mm = 1200.0\n", "lift_mm = 500.0\n"] {
        assert!(text.contains(key), "{key}: {text}");
    }
    assert!(!text.contains("pressure_kpa") && !text.contains("reservoir_kpa"), "{text}");
    let check = user.types(&["pumps", "check", "high.toml"]).out;
    // 954.61 hPa at 500 m (U.S. Standard Atmosphere 1976); 9.777 kPa a metre of water at 25 °C.
    assert!(check.contains("ambient   95.461 kPa at 500 m (ISO 2533)"), "{check}");
    assert!(check.contains("reservoir 83.72") && check.contains("by a lift of 1200 mm"), "{check}");
    assert!(check.contains("reservoir 100.3") && check.contains("by a lift of 500 mm"), "{check}");
    assert_eq!(user.json(&["5mL", "--dry-run", "--pump", "high.toml"])["pump"], "high");
    let refused = |options: &[&str]| user.is_refused(&[&DRAWING[..], options].concat());
    assert!(refused(&["--altitude", "9.1km"]).contains("9.1km"));
    assert!(
        refused(&["--altitude", "9100m"]).contains("[ambient] altitude_m is 9100; allowed: -500 to 9000")
    );
    assert!(refused(&["--altitude", "1m", "--ambient", "1bara"]).contains("cannot be used with"));
    assert!(refused(&["--ambient", "0kPag"]).contains("give it absolute"));
    // Water at 25 °C boils under a column of (101.325 - 3.17) kPa, 10.04 m.
    assert!(refused(&["--suction-lift", "10.1m"]).contains("water is not sucked up 10.1 m: the air of "));
    assert_eq!(user.types(&[&DRAWING[..], &["--altitude", "-430m", "low.toml"]].concat()).code, 0);
}

#[test]
fn the_catalogue_is_listed_for_people_and_for_programs() {
    let user = User::new();
    let text = user.types(&["pumps", "list", "--catalogue", "masterflex", "16"]).out;
    assert!(text.contains("masterflex-ls-16") && !text.contains("masterflex-ls-13"), "{text}");
    assert!(text.contains("aguaclara") && text.contains("`dose calibrate run`"), "{text}");
    let all = user.json(&["pumps", "list", "--catalogue"]);
    assert_eq!(all["schema"], "head-list/1");
    assert!(all["heads"].as_array().unwrap().len() >= 40);
    let yz = user.json(&["pumps", "list", "--catalogue", "runze-yz1515x-3-14"]);
    let row = &yz["heads"][0];
    assert!((number(row, "ml_per_rev") - 116.5 / 400.0).abs() < 1e-12, "{row}");
    assert_eq!((&row["rollers"], &row["source"]["kind"]), (&3.into(), &"quoted".into()));
    let built_in = user.json(&["pumps", "list"]);
    assert_eq!(built_in["pumps"][0]["name"], "three-roller");
    let message = user.is_refused(&["pumps", "list", "--catalogue", "mastreflex-ls-16"]);
    assert!(message.contains("the nearest are masterflex-ls-16,"), "{message}");
}

#[test]
fn a_bought_head_becomes_a_pump_that_doses_by_its_name_alone() {
    let user = User::new();
    let new = ["pumps", "new", "--head", "masterflex-ls-16", "--rollers", "3", "bench.toml"];
    assert_eq!(user.types(&new).code, 0);
    let text = fs::read_to_string(user.path("bench.toml")).unwrap();
    assert!(text.contains("catalogue = \"masterflex-ls-16\"\n") && !text.contains("ml_per_rev ="), "{text}");
    assert!(text.contains("# As published: 0.8 mL per revolution, bore 3.1 mm\n"), "{text}");
    let check = user.types(&["pumps", "check", "bench.toml"]).out;
    for line in [
        "catalogue Masterflex L/S, L/S 16: 0.8 mL per revolution (program)",
        "0.8000 mL per revolution, 0.2667 mL per pitch of 120.00°",
    ] {
        assert!(check.contains(line), "{line}: {check}");
    }
    let dose = user.json(&["8mL", "--pump", "bench.toml"]);
    assert!((number(&dose, "delivered_ml") - 8.0).abs() < 2e-3, "{dose}");
    // Between pumps 15 % and between tubings 15 % at this bore (Omega FPU5MT, table 9-3), both rectangular, are
    // 12.2 % standard: a dose of 8 mL is no surer than 1.96 mL.
    assert!(number(&dose, "expanded_uncertainty_ml") > 1.96, "{dose}");
}

#[test]
fn a_bought_head_takes_the_motor_and_the_place_that_a_drawn_one_takes() {
    let user = User::new();
    let head = ["pumps", "new", "--head", "kamoer-kphm400-25"];
    let untold = user.types(&[&head[..], &["untold.toml"]].concat());
    assert!(untold.out.contains("the motor's steps are not known"), "{}", untold.out);
    let text = fs::read_to_string(user.path("untold.toml")).unwrap();
    assert!(
        text.contains("confirmed = false\n") && text.contains("# Assumed: a catalogue does not tell."),
        "{text}"
    );
    assert!(text.contains("# Assumed: sea level") && !text.contains("lift_mm"), "{text}");
    let check = user.types(&["pumps", "check", "untold.toml"]).out;
    for line in [
        "  given     volume of a revolution, density of the fluid\n",
        "  assumed   volume of a roller, pressures of the reservoirs, steps of the motor,",
        "  unknown   R, C and L of the inlet, R, C and L of the outlet\n",
    ] {
        assert!(check.contains(line), "{line}: {check}");
    }
    let own = [
        "--microsteps",
        "16",
        "--gear",
        "2",
        "--altitude",
        "500m",
        "--suction-lift",
        "1.2m",
        "--discharge-lift",
        "0.5m",
    ];
    let told = user.types(&[&head[..], &own[..], &["told.toml"]].concat());
    assert!(told.out.contains("= 3200 steps per revolution of the motor, x gear 2 = 6400"), "{}", told.out);
    let text = fs::read_to_string(user.path("told.toml")).unwrap();
    for key in ["steps_per_rev = 3200\n", "gear = 2.0\n", "altitude_m = 500.0\n", "lift_mm = 1200.0\n"] {
        assert!(text.contains(key), "{key}: {text}");
    }
    assert!(!text.contains("\nconfirmed") && text.contains("direction_confirmed = false"), "{text}");
    let check = user.types(&["pumps", "check", "told.toml"]).out;
    // 954.61 hPa at 500 m (U.S. Standard Atmosphere 1976); 9.777 kPa a metre of water at 25 °C.
    assert!(check.contains("settling are not known; reservoir 83.72"), "{check}");
    assert!(check.contains("reservoir 100.3") && check.contains("by a lift of 500 mm"), "{check}");
    let dose = user.json(&["8mL", "--dry-run", "--pump", "told.toml"]);
    assert!((number(&dose, "planned_ml") - 8.0).abs() < 2e-3 && dose["inlet_min_kpa"].is_null(), "{dose}");
}

#[test]
fn a_head_that_the_catalogue_cannot_give_is_refused_with_what_to_do() {
    let user = User::new();
    let new = |more: &[&str]| user.is_refused(&[&["pumps", "new"], more].concat());
    let message = new(&["--head", "masterflex-ls-61", "--rollers", "3"]);
    assert!(message.contains("is `masterflex-ls-61`; the nearest are masterflex-ls-16,"), "{message}");
    assert!(new(&["--head", "masterflex-ls-16"]).contains("count yours and add --rollers 3"));
    assert!(new(&["--head", "kamoer-kphm400-25", "--tube", "10x14mm"]).contains("--tube"));
    assert!(new(&["--head", "kamoer-kphm400-25", "--hose", "1m"]).contains("--hose"));
    // Its document states three rollers.
    assert_eq!(user.types(&["pumps", "new", "--head", "kamoer-kphm400-25"]).code, 0);
    assert_eq!(user.types(&["pumps", "new", "--head", "kamoer-kphm400-25", "--id", "Not An Id"]).code, 2);
}

#[test]
fn the_section_of_a_head_carries_its_dimensions_by_the_names_of_the_options() {
    let user = User::new();
    let labels =
        ["tube 10 x 14 mm", "backplate 63 mm", "roller 20 mm", "offset 40 mm", "contact 30°", "3 rollers"];
    let read = |file: &str| fs::read_to_string(user.path(file)).unwrap();
    assert_eq!(user.types(&["pumps", "show", "three-roller", "--plot", "show.svg"]).code, 0);
    for label in labels {
        assert!(read("show.svg").contains(label), "{label}");
        let option = label.split(' ').find(|word| word.chars().all(char::is_alphabetic)).unwrap();
        assert!(user.types(&["pumps", "new", "-h"]).out.contains(&format!("--{option}")), "{option}");
    }
    let new = user.types(&[&DRAWING[..], &["drawn.toml", "--plot", "new.svg"]].concat());
    assert_eq!(new.code, 0, "{}", new.err);
    assert!(read("new.svg").contains("<polygon") && read("new.svg").contains("rollers"));
    let bought = ["pumps", "new", "--head", "kamoer-kphm400-25", "bought.toml"];
    assert_eq!(user.types(&bought).code, 0);
    let unknown = user.is_refused(&["pumps", "show", "bought.toml", "--plot", "x.svg"]);
    assert!(unknown.contains("there are no dimensions to draw"), "{unknown}");
}

#[test]
fn a_check_says_that_a_heads_flow_reverses() {
    let user = User::new();
    let shown = user.types(&["pumps", "show", "three-roller"]).out;
    assert!(!user.types(&["pumps", "check", "three-roller"]).out.contains("reverses"));
    // The paper's head with 1.2 times its roller volume: q_out is negative over a part of the pitch.
    let file = shown.replace("[roller_volume]\n", "[roller_volume]\ntotal_ml = 2.5266\n");
    fs::write(user.path("reversing.toml"), file).unwrap();
    let checked = user.types(&["pumps", "check", "reversing.toml"]);
    assert!(checked.out.contains("it reverses while a roller leaves"), "{}{}", checked.out, checked.err);
}

#[test]
fn a_new_pump_file_says_its_id_and_whose_record_it_goes_on_with() {
    let user = User::new();
    let new = |file: &str| {
        let words = ["pumps", "new", "--head", "masterflex-ls-16", "--rollers", "3", file];
        let said = user.types(&words);
        assert_eq!(said.code, 0, "{}", said.err);
        said.out
    };
    assert!(new("b1.6.toml").contains("id        b1-6: the name of its record"));
    assert!(new("My acid.toml").contains("id        my-acid: "));
    assert!(!new("acid.toml").contains("id     "));
    user.json(&["8mL", "--pump", "acid.toml"]);
    fs::create_dir(user.path("other")).unwrap();
    let said = new("other/acid.toml");
    assert!(said.contains("a pump `acid` has a record already"), "{said}");
}

#[test]
fn a_built_in_pump_is_checked_as_its_file_is() {
    let user = User::new();
    let built_in = user.types(&["pumps", "check", "three-roller"]);
    assert_eq!(built_in.code, 0, "{}", built_in.err);
    fs::write(user.path("shown.toml"), user.types(&["pumps", "show", "three-roller"]).out).unwrap();
    let shown = user.types(&["pumps", "check", "shown.toml"]);
    assert!(
        built_in.out.contains("21.3185 mL per revolution") && built_in.out == shown.out,
        "{}",
        built_in.out
    );
}
