//! Quantities that are read and quantities that are refused.

use std::f64::consts::TAU as TURN;

use super::{
    TubeSize, amount, angle_rad, flow_ml_s, length_mm, pressure, speed_rad_s, temperature_degc, time_s,
    tube_size, volume_ml,
};

fn ml(text: &str) -> f64 {
    amount(text).unwrap().volume_ml(1000.0)
}

#[test]
fn every_form_of_the_contract_is_read() {
    for (text, expected) in [
        ("25mL", 25.0),
        ("25 mL", 25.0),
        ("0.025 L", 25.0),
        ("0.025l", 25.0),
        ("250uL", 0.25),
        ("250\u{b5}L", 0.25),
        ("250\u{3bc}L", 0.25),
        ("1e3uL", 1.0),
        ("1E-3L", 1.0),
        (".5mL", 0.5),
        ("5.mL", 5.0),
        ("+5mL", 5.0),
        ("-5mL", -5.0),
        ("\u{2212}5mL", -5.0),
        ("25 g", 25.0),
        ("2500mg", 2.5),
    ] {
        assert!((ml(text) - expected).abs() < 1e-12, "{text}");
    }
    assert!((volume_ml("2 L").unwrap() - 2000.0).abs() < 1e-9);
    assert!((flow_ml_s("600 mL/min").unwrap() - 10.0).abs() < 1e-12);
    assert!((flow_ml_s("2 L/h").unwrap() - 2000.0 / 3600.0).abs() < 1e-12);
    assert!((flow_ml_s("10mL/s").unwrap() - 10.0).abs() < 1e-12);
    assert!((speed_rad_s("60rpm").unwrap() - TURN).abs() < 1e-12);
    assert!((speed_rad_s("60 r/min").unwrap() - TURN).abs() < 1e-12);
    assert_eq!(time_s("1.5s").unwrap(), 1.5);
    assert_eq!(time_s("2min").unwrap(), 120.0);
    assert!((angle_rad("-30deg").unwrap() + TURN / 12.0).abs() < 1e-15);
    assert_eq!(angle_rad("0.5rad").unwrap(), 0.5);
    assert_eq!(angle_rad("1rev").unwrap(), TURN);
    assert_eq!(angle_rad("0deg").unwrap(), 0.0);
    assert_eq!(temperature_degc("21.5degC").unwrap(), 21.5);
    assert_eq!(temperature_degc("-4 °C").unwrap(), -4.0);
    assert!(temperature_degc("21").is_err() && temperature_degc("21K").is_err());
    assert_eq!(pressure("120kPaa").unwrap().absolute_kpa(85.7), 120.0);
    assert!((pressure("20kPag").unwrap().absolute_kpa(85.7) - 105.7).abs() < 1e-12);
    assert!((pressure("1.2bara").unwrap().absolute_kpa(85.7) - 120.0).abs() < 1e-12);
    assert!((pressure("15psia").unwrap().absolute_kpa(85.7) - 103.4213594).abs() < 1e-6);
}

#[test]
fn what_is_refused_names_what_was_read_and_what_is_accepted() {
    let refused = |text: &str| amount(text).unwrap_err().to_string();
    assert!(refused("25").starts_with("`25` has no unit; write for example 25mL"));
    assert!(refused("25ML").contains("unknown volume or mass unit `ML`, did you mean `mL`"));
    assert!(
        refused("25 furlongs").contains("unknown volume or mass unit `furlongs`; accepted: kg, g, mg; L,")
    );
    assert!(
        refused("24.9lb").contains("unit `lb`; accepted: kg, g, mg")
            && refused("25KG").contains("`kg` (case")
    );
    assert!(refused("25rpm").contains("which is a speed unit"));
    for text in ["NaN mL", "infmL", "-inf mL", "1e999mL"] {
        assert!(refused(text).contains("not a finite number"), "{text}");
    }
    assert!(refused("0mL").contains("is zero"));
    assert!(refused("2,5mL").contains("comma"));
    assert!(refused("").contains("empty volume"));
    assert!(refused("mL").contains("does not start with a number"));
    assert!(flow_ml_s("-5mL/s").unwrap_err().to_string().contains("`-5mL/s` is negative"));
    assert!(flow_ml_s("0mL/s").is_err());
    assert!(flow_ml_s("5mL").unwrap_err().to_string().contains("which is a volume unit"));
    assert_eq!(
        pressure("15 psi").unwrap_err().to_string(),
        "`15 psi` may be absolute or gauge; write `15psia` (absolute) or `15psig` (above ambient)"
    );
    assert!(pressure("15").is_err());
    assert!(pressure("15furlongsa").is_err());
}

#[test]
fn lengths_and_tubes_are_read() {
    for (text, mm) in [("63mm", 63.0), ("6.3 cm", 63.0), ("0.331m", 331.0), ("1in", 25.4)] {
        assert!((length_mm(text).unwrap() - mm).abs() < 1e-12, "{text}");
    }
    for text in ["10x14mm", "10 x 14 mm", "10mm x 14mm", "1x1.4cm", "10×14mm", "1cmx14mm"] {
        assert_eq!(tube_size(text).unwrap(), TubeSize { bore_mm: 10.0, outer_mm: 14.0 }, "{text}");
    }
    assert_eq!(
        tube_size("10mm").unwrap_err().to_string(),
        "`10mm` is not a tube; write bore x outer diameter with their unit, such as 10x14mm"
    );
    assert_eq!(
        tube_size("3x1mm").unwrap_err().to_string(),
        "`3x1mm` has no wall: the outer diameter, 1 mm, must be more than the bore, 3 mm; write the bore \
         first, as 10x14mm"
    );
    for text in ["10x14", "x14mm", "10xmm", "0x14mm", "-10x14mm", "10x14mL", ""] {
        assert!(tube_size(text).is_err(), "{text}");
    }
    assert!(length_mm("63").unwrap_err().to_string().contains("has no unit; write for example 63mm"));
}

proptest::proptest! {
    #[test]
    fn no_text_makes_it_panic(text in "\\PC*") {
        let _ = (amount(&text), flow_ml_s(&text), speed_rad_s(&text), time_s(&text));
        let _ = (angle_rad(&text), pressure(&text), volume_ml(&text), length_mm(&text), tube_size(&text));
    }
}
