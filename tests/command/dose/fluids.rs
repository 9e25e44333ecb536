//! Another fluid or temperature than the pump file's, as typed.

use crate::user::{User, number};

/// Volume for which a balance shows 25 g of a fluid, mL, in dry air of 85.7 kPa by the ideal gas law.
fn of_25_g_ml(density_kg_m3: f64, temperature_degc: f64) -> f64 {
    let air_kg_m3 = 85.7e3 * 0.028_965 / (8.314_46 * (273.15 + temperature_degc));
    25e3 * (1.0 - air_kg_m3 / 8000.0) / (density_kg_m3 - air_kg_m3)
}

#[test]
fn a_mass_has_the_volume_of_its_temperature() {
    let user = User::new();
    let asked =
        |arguments: &[&str]| number(&user.json(&[&["25g", "--dry-run"], arguments].concat()), "requested_ml");
    // 997.05 kg/m³ at 25 °C, 992.22 at 40 °C (CRC Handbook).
    assert!((asked(&[]) - of_25_g_ml(997.05, 25.0)).abs() < 1e-3);
    assert_eq!(asked(&["--fluid", "water"]), asked(&[]), "it is the pump file's at its temperature");
    for arguments in [&["--temperature", "40degC"][..], &["--fluid", "Water", "--temperature", "40degC"]] {
        assert!((asked(arguments) - of_25_g_ml(992.22, 40.0)).abs() < 1e-3, "{arguments:?}");
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
    assert!(user.is_refused(&["status", "--fluid", "water"]).contains("`dose status` takes no --fluid"));

    let own = include_str!("../../../examples/pumps/my-pump.toml");
    let own = own.replace("name = \"water\"", "name = \"syrup\"").replace("= 997.0", "= 1330.0");
    let own = own.replace("altitude_m = 0.0", "pressure_kpa = 85.7");
    std::fs::write(user.path("syrup.toml"), own).unwrap();
    let pump = ["25g", "--dry-run", "--pump", "syrup.toml"];
    let asked = |arguments: &[&str]| number(&user.json(&[&pump, arguments].concat()), "requested_ml");
    for arguments in
        [&[][..], &["--fluid", "syrup"], &["--temperature", "25degC"], &["--temperature", "26degC"]]
    {
        assert!((asked(arguments) - of_25_g_ml(1330.0, 25.0)).abs() < 1e-3, "{arguments:?}");
    }
    assert!((asked(&["--fluid", "water"]) - of_25_g_ml(997.05, 25.0)).abs() < 1e-3);
    let warm = user.is_refused(&[&pump[..], &["--temperature", "40degC"]].concat());
    assert!(warm.contains("density of syrup is known at 25 °C alone"), "{warm}");
    assert!(
        user.is_refused(&[&pump[..], &["--fluid", "oil"]].concat())
            .contains("and the pump file's own, syrup")
    );
}

#[test]
fn common_fluids_are_known_by_name() {
    let user = User::new();
    let asked = |fluid: &str, temperature: &str| {
        let arguments = ["25g", "--dry-run", "--fluid", fluid, "--temperature", temperature];
        number(&user.json(&arguments), "requested_ml")
    };
    // Riddick, Bunger, Sakano, "Organic Solvents": 785.04 and 781.26 kg/m³ at 25 °C; CRC Handbook: 1126.3 at 20 °C.
    for (fluid, temperature, density) in [
        ("ethanol", "25degC", 785.04),
        ("Isopropanol", "25degC", 781.26),
        ("2-propanol", "25degC", 781.26),
        ("glycerol 50%", "20degC", 1126.3),
        ("glycerol50%", "20degC", 1126.3),
    ] {
        assert!((asked(fluid, temperature) / of_25_g_ml(density, 25.0) - 1.0).abs() < 5e-4, "{fluid}");
    }
    // Antoine: 17.9 kPa at 40 °C, below the tube's collapse; above it the tube decides.
    let refused = user.is_refused(&["25g", "--fluid", "ethanol", "--temperature", "60degC"]);
    assert!(refused.contains("temperature of ethanol in degC is 60; allowed: 5 to 40"), "{refused}");
    let refused = user.is_refused(&["25g", "--fluid", "glycerol 120%"]);
    assert!(refused.contains("part of glycerol by mass is 1.2; allowed: 0 to 1"), "{refused}");
    assert!(user.is_refused(&["25g", "--fluid", "glycerol"]).contains("`glycerol 50%`"));

    // A hose of it needs no viscosity.
    let own = user.types(&["pumps", "show", "three-roller"]).out;
    let hose = "[outlet]\nreservoir_kpa = 88.637\n\n[outlet.hose]\nbore_radius_mm = 5.0\nouter_radius_mm = 7.0\n\
                length_mm = 331.0\nmodulus_mpa = 3.5\npoisson_ratio = 0.5\nminor_loss = 0.0\n\n[motor]";
    let (start, end) = (own.find("[outlet]").unwrap(), own.find("[motor]").unwrap());
    let own = format!("{}{hose}{}", &own[..start], &own[end + "[motor]".len()..]);
    let own = own.replace("name = \"water\"", "name = \"glycerol 80%\"").replace("= 997.0", "= 1205.4");
    std::fs::write(user.path("glycerol.toml"), own).unwrap();
    let check = user.types(&["pumps", "check", "glycerol.toml"]);
    // Laminar, 128 mu l/(pi d⁴): 45.9 mPa s at 25 °C (Segur and Oberstar) make 0.0619 kPa s/mL.
    let line = check.out.lines().find(|line| line.contains("outlet    R")).unwrap();
    let resistance: f64 = line.split_whitespace().nth(2).unwrap().parse().unwrap();
    assert!((resistance / 0.0619 - 1.0).abs() < 0.06, "{line}");
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

#[test]
fn a_thick_fluid_in_a_pump_that_nobody_weighed_is_warned_of() {
    let user = User::new();
    let warned = |arguments: &[&str]| {
        let report = user.json(&[&["25mL", "--dry-run"], arguments].concat());
        report["warnings"]
            .to_string()
            .contains("published volumes of a revolution are those of water at 25 °C, and this is")
    };
    assert!(warned(&["--fluid", "glycerol 50%"]));
    assert!(!warned(&[]) && !warned(&["--fluid", "ethanol"]) && !warned(&["--temperature", "60degC"]));
}
