//! An angle as a person states it: with a tolerance, or without one.

use std::f64::consts::PI;

use pump_model::units::degrees;

use super::error::QuantityError;
use super::kind::Kind;
use super::quantity::{angle_rad, rotor_angle_rad};
use super::reading::{QuantityText, shown};
use crate::numbers::significant;

/// Signs between an angle and its tolerance.
const SIGNS: [&str; 3] = ["\u{b1}", "+-", "+/-"];

/// Largest tolerance of an angle, rad. Half a turn either way is every angle.
const MOST_RAD: f64 = PI;

/// An angle, and the tolerance within which the true angle lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedAngle {
    /// Angle, in rad.
    pub angle_rad: f64,
    /// Largest distance of the true angle on either side, in rad, from 0 to pi. `None` if the text gives none.
    pub tolerance_rad: Option<f64>,
}

/// Reads an angle with its tolerance, `30deg+-1deg`, `30deg±1deg`, `30+-1deg`, or without, `30deg`.
///
/// ```
/// use pump_bench::units::stated_angle;
///
/// let stated = stated_angle("30deg+-1deg")?;
/// assert!((stated.angle_rad - 30_f64.to_radians()).abs() < 1e-15);
/// assert_eq!(stated.tolerance_rad, stated_angle("0 ± 1 deg")?.tolerance_rad);
/// assert_eq!(stated_angle("30deg")?.tolerance_rad, None);
/// # Ok::<(), pump_bench::units::QuantityError>(())
/// ```
///
/// # Errors
/// [`QuantityError::NoTolerance`] if nothing follows the sign, and [`QuantityError::Tolerance`] if the tolerance is
/// outside its range. Otherwise the [`QuantityError`] of a text that is no angle, or of an angle beyond one turn.
pub fn stated_angle(text: &str) -> Result<StatedAngle, QuantityError> {
    let text = shown(text.trim());
    let Some((angle, tolerance)) = SIGNS.iter().find_map(|sign| text.split_once(sign)) else {
        return Ok(StatedAngle { angle_rad: rotor_angle_rad(&text)?, tolerance_rad: None });
    };
    let (angle, tolerance) = (angle.trim(), tolerance.trim());
    if tolerance.is_empty() {
        return Err(QuantityError::NoTolerance { text });
    }
    let tolerance_rad = Some(tolerance_rad(tolerance)?);
    // An angle without a unit has the unit of its tolerance.
    let angle_rad = match angle.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
        true => rotor_angle_rad(&format!("{angle}{}", QuantityText::new(tolerance, Kind::Angle)?.unit))?,
        false => rotor_angle_rad(angle)?,
    };
    Ok(StatedAngle { angle_rad, tolerance_rad })
}

/// Reads the tolerance of an angle, which may be zero, and returns it in rad.
///
/// # Errors
/// [`QuantityError::Tolerance`] if the tolerance is outside its range. Otherwise the [`QuantityError`] of a text that
/// is no angle.
pub fn tolerance_rad(text: &str) -> Result<f64, QuantityError> {
    let tolerance_rad = angle_rad(text)?;
    if (0.0..=MOST_RAD).contains(&tolerance_rad) {
        // Zero has no sign.
        return Ok(tolerance_rad.abs());
    }
    let [tolerance_deg, most_deg] = [tolerance_rad, MOST_RAD].map(|rad| significant(degrees(rad), 6));
    Err(QuantityError::Tolerance { text: shown(text.trim()), tolerance_deg, most_deg })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn every_sign_is_read_and_a_bare_angle_takes_the_unit_of_its_tolerance() {
        for text in [
            "30deg+-1deg",
            "30deg±1deg",
            "30deg +/- 1deg",
            " 30 deg ± 1 deg ",
            "30+-1deg",
            "30.±1.0°",
            "30deg+\u{2212}1deg",
        ] {
            let StatedAngle { angle_rad, tolerance_rad } = stated_angle(text).unwrap();
            assert!((angle_rad - PI / 6.0).abs() < 1e-15, "{text}: {angle_rad}");
            assert!((tolerance_rad.unwrap() - PI / 180.0).abs() < 1e-15, "{text}: {tolerance_rad:?}");
        }
        let back = stated_angle("\u{2212}0.5rad+-10mrad").unwrap();
        assert_eq!(back, StatedAngle { angle_rad: -0.5, tolerance_rad: Some(0.01) });
        assert_eq!(stated_angle("1rev").unwrap(), StatedAngle { angle_rad: 2.0 * PI, tolerance_rad: None });
        assert_eq!(stated_angle("1deg+-0deg").unwrap().tolerance_rad, Some(0.0));
        assert_eq!(stated_angle("1deg+-180deg").unwrap().tolerance_rad, Some(PI));
    }

    #[test]
    fn what_is_no_stated_angle_is_refused_with_what_to_write() {
        let refused = |text: &str| stated_angle(text).unwrap_err().to_string();
        assert_eq!(
            refused("30deg+-200deg"),
            "`200deg` is no tolerance of an angle: it is 200 deg; allowed: 0 to 180 deg, as in 30deg+-1deg"
        );
        assert!(
            refused("30deg+--1deg")
                .starts_with("`-1deg` is no tolerance of an angle: it is -1 deg; allowed: 0")
        );
        assert_eq!(refused("30deg+-"), "`30deg+-` has no tolerance; write for example 30deg+-1deg");
        assert!(refused("30deg+-1").contains("`1` has no unit"));
        assert!(refused("30+-1mL").contains("unknown angle unit `mL`"));
        assert!(refused("+-1deg").contains("empty angle"));
        assert!(refused("").contains("empty angle"));
        assert!(refused("30deg-1deg").contains("unknown angle unit `deg-1deg`"));
        assert!(refused("30deg+-infdeg").contains("not a finite number"));
        assert!(refused("30deg+-1deg+-1deg").contains("unknown angle unit"));
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "\\PC*", angle in "\\PC{0,9}", tolerance in "\\PC{0,9}") {
            let _ = (stated_angle(&text), tolerance_rad(&text), stated_angle(&format!("{angle}+-{tolerance}")));
        }

        #[test]
        fn an_angle_reads_with_a_tolerance_as_without_one(
            angle_deg in -360.0..360.0_f64,
            tolerance_deg in 0.0..180.0_f64,
            sign in prop_oneof![Just("+-"), Just("±"), Just("+/-")],
        ) {
            let stated = stated_angle(&format!("{angle_deg}deg{sign}{tolerance_deg}deg")).unwrap();
            let bare = stated_angle(&format!("{angle_deg}deg")).unwrap();
            prop_assert_eq!(stated.angle_rad.to_bits(), bare.angle_rad.to_bits());
            prop_assert!((stated.tolerance_rad.unwrap() - tolerance_deg * PI / 180.0).abs() < 1e-14);
        }
    }
}
