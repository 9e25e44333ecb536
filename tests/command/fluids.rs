//! Another fluid or temperature than the pump file's, as typed.

use crate::user::{User, number};

#[test]
fn a_mass_has_the_volume_of_its_temperature() {
    let user = User::new();
    let asked =
        |arguments: &[&str]| number(&user.json(&[&["25g", "--dry-run"], arguments].concat()), "requested_ml");
    // 997 kg/m³ in the pump file; 992.22 at 40 °C (CRC Handbook).
    assert!((asked(&[]) - 25e3 / 997.0).abs() < 1e-9);
    assert_eq!(asked(&["--fluid", "water"]), asked(&[]), "it is the pump file's at its temperature");
    for arguments in [&["--temperature", "40degC"][..], &["--fluid", "Water", "--temperature", "40degC"]] {
        assert!((asked(arguments) - 25e3 / 992.22).abs() < 1e-3, "{arguments:?}");
    }
}

#[test]
fn hot_water_boils_at_a_higher_pressure() {
    let user = User::new();
    // IAPWS: 47.41 kPa at 80 °C, above the 43.05 kPa at which the tube collapses.
    let hot = user.json(&["25mL", "--dry-run", "--temperature", "80degC"]);
    assert_eq!(hot["inlet_limit"], "vapour_pressure");
    assert!((number(&hot, "inlet_limit_kpa") - 47.41).abs() < 0.05, "{hot}");
    // Above the reservoir's 88.6 kPa nothing can be pumped.
    let boiling = user.is_refused(&["25mL", "--temperature", "97degC"]);
    assert!(boiling.contains("the fluid's vapour pressure; no speed holds every limit"), "{boiling}");
}

#[test]
fn what_is_not_known_of_a_fluid_is_refused_with_what_is() {
    let user = User::new();
    let unknown = user.is_refused(&["25g", "--fluid", "oil"]);
    assert!(unknown.contains("`oil`") && unknown.contains("known: water"), "{unknown}");
    assert!(user.is_refused(&["25g", "--temperature", "120degC"]).contains("allowed: 0 to 100"));
    assert!(user.is_refused(&["25g", "--temperature", "20"]).contains("20degC"));
    assert!(
        user.is_refused(&["status", "--fluid", "water"]).contains("--fluid means nothing to `dose status`")
    );

    let own = include_str!("../../examples/pumps/my-pump.toml");
    let own = own.replace("name = \"water\"", "name = \"syrup\"").replace("= 997.0", "= 1330.0");
    std::fs::write(user.path("syrup.toml"), own).unwrap();
    let pump = ["25g", "--dry-run", "--pump", "syrup.toml"];
    let asked = |arguments: &[&str]| number(&user.json(&[&pump, arguments].concat()), "requested_ml");
    for arguments in
        [&[][..], &["--fluid", "syrup"], &["--temperature", "25degC"], &["--temperature", "26degC"]]
    {
        assert!((asked(arguments) - 25e3 / 1330.0).abs() < 1e-9, "{arguments:?}");
    }
    assert!((asked(&["--fluid", "water"]) - 25e3 / 997.05).abs() < 1e-3);
    let warm = user.is_refused(&[&pump[..], &["--temperature", "40degC"]].concat());
    assert!(warm.contains("density of syrup is known at 25 °C alone"), "{warm}");
    assert!(
        user.is_refused(&[&pump[..], &["--fluid", "oil"]].concat())
            .contains("water and the pump file's own, syrup")
    );
}

#[test]
fn a_weighing_has_the_density_of_the_temperature_that_is_given() {
    let user = User::new();
    std::fs::write(user.path("runs.csv"), "speed_rpm,revolutions,mass_g\n40,10,212\n40,10,212\n40,10,212\n")
        .unwrap();
    let factor = |temperature: &str| {
        let found = user.json(&["calibrate", "run", "--from", "runs.csv", "--temperature", temperature]);
        number(&found["displacement"], "factor")
    };
    // 997.05 and 992.22 kg/m³; buoyancy changes the rest by 1e-4 of it.
    assert!((factor("40degC") / factor("25degC") - 997.0 / 992.22).abs() < 1e-4);
}
