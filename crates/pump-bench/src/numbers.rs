//! Numbers worded for people.

use libm::floor;

/// Formats a number with `digits` significant digits, without an exponent and without trailing zeros.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = (f64::from(digits - 1) - floor(value.abs().log10())).clamp(0.0, 15.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Formats an uncertainty with two significant digits, a zero at the end among them.
pub(crate) fn two_digits(uncertainty: f64) -> String {
    let decimals = decimals_of(uncertainty);
    format!("{uncertainty:.decimals$}")
}

/// Returns the decimals that show an uncertainty with two significant digits.
pub(crate) fn decimals_of(uncertainty: f64) -> usize {
    if !(uncertainty > 0.0 && uncertainty.is_finite()) {
        return 6;
    }
    // 12 at most: nobody weighs a picolitre.
    (1.0 - floor(uncertainty.log10())).clamp(0.0, 12.0) as usize
}

/// Words a time in s, in the unit that suits it.
pub(crate) fn duration(time_s: f64) -> String {
    let (unit_s, unit) = match time_s {
        ..120.0 => (1.0, "s"),
        ..7200.0 => (60.0, "min"),
        ..172_800.0 => (3600.0, "h"),
        ..63_072_000.0 => (86_400.0, "days"),
        _ => (31_557_600.0, "years"),
    };
    format!("{} {unit}", significant(time_s / unit_s, 3))
}

/// Words a volume in mL that is known between two bounds.
pub(crate) fn between(least_ml: f64, most_ml: f64) -> String {
    if most_ml - least_ml < 1e-9 {
        format!("{least_ml:.4} mL")
    } else {
        let (least, most) = told_apart(least_ml, most_ml, 4);
        format!("between {least} and {most} mL")
    }
}

/// Formats two bounds with `decimals`, or with as many more as tell them apart, 9 at most.
pub(crate) fn told_apart(least: f64, most: f64, decimals: usize) -> (String, String) {
    let with = |decimals: usize| (format!("{least:.decimals$}"), format!("{most:.decimals$}"));
    (decimals..9).map(with).find(|(least, most)| least != most).unwrap_or_else(|| with(9))
}

/// Words a carry in mL: in µL, as every carry is.
pub(crate) fn microlitres(carry_ml: f64) -> String {
    let text = format!("{:.2}", 1e3 * carry_ml);
    // Less than a hundredth is none, whatever its sign.
    format!("{} µL", if text == "-0.00" { "0.00" } else { &text })
}

/// Words a carry in mL that is known within a half width, in µL, with two digits of the half width.
pub(crate) fn microlitres_within(carry_ml: f64, half_width_ml: f64) -> String {
    let decimals = (1.0 - floor((1e3 * half_width_ml).log10())).clamp(0.0, 4.0) as usize;
    format!("{:.decimals$} µL ± {:.decimals$} µL", 1e3 * carry_ml, 1e3 * half_width_ml)
}

/// A number with four decimals at most.
pub(crate) fn short(value: f64) -> String {
    format!("{value:.4}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_has_the_unit_that_suits_it() {
        for (time_s, told) in
            [(3.672, "3.67 s"), (600.0, "10 min"), (36_000.0, "10 h"), (1_700_398_800.0, "53.9 years")]
        {
            assert_eq!(duration(time_s), told);
        }
    }

    #[test]
    fn bounds_have_as_many_digits_as_tell_them_apart() {
        assert_eq!(between(1.412, 1.418), "between 1.4120 and 1.4180 mL");
        assert_eq!(between(1.412_31, 1.412_34), "between 1.41231 and 1.41234 mL");
        assert_eq!(between(1.41, 1.41), "1.4100 mL");
        assert_eq!(told_apart(1.4081, 1.4094, 2), ("1.408".to_owned(), "1.409".to_owned()));
    }

    #[test]
    fn a_carry_has_the_digits_of_its_half_width() {
        assert_eq!(microlitres_within(-0.001_046, 1.1), "-1 µL ± 1100 µL");
        assert_eq!(microlitres_within(0.012_346, 0.000_452), "12.35 µL ± 0.45 µL");
        assert_eq!(microlitres(0.012_346), "12.35 µL");
        assert_eq!((microlitres(-4e-6), microlitres(-6e-6)), ("0.00 µL".to_owned(), "-0.01 µL".to_owned()));
    }
}
