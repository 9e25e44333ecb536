//! The path of a bore around the rotor, which a volume of a revolution and a bore tell, and the volumes that a bore
//! allows.

use core::f64::consts::{FRAC_PI_4, PI};

/// Longest path of a bore around a rotor, in mm: that of a rotor 3.2 m across. This is a convention, four times the
/// path of a large hose pump: Watson-Marlow state 20 L a revolution of the Bredel 100, whose hose has a bore of 100 mm.
const LONGEST_MM: f64 = 1e4;

/// Longest path that is usual, in mm: twice the catalogue's longest, 145 mm (`runze-yz1515x-3-14`).
const USUAL_MM: f64 = 290.0;

/// Longest path that is usual for wide bores, in bores. That of the Bredel 100 is 25 bores long.
const USUAL_BORES: f64 = 40.0;

/// Shortest path that is usual, in bores: half of the catalogue's shortest, 9.4 bores (`masterflex-ls-18`).
const FEWEST_BORES: f64 = 4.7;

/// Returns the length of tube that holds the volume of a revolution, in mm: V/(pi/4 d²).
pub(crate) fn path_mm(ml_per_rev: f64, bore_mm: f64) -> f64 {
    1e3 * ml_per_rev / area_mm2(bore_mm)
}

/// Returns the smallest and the largest volume of a revolution that a head with this bore can have, in mL.
///
/// A revolution delivers 2 pi a less what the rollers take, and they take two thirds of it at most
/// ([`PulseBounds`](crate::displacement::PulseBounds)). The bore's area times the radius R of its axis is a (McIntyre
/// et al.). The tube lies beside the shaft, so R is half a bore at least: V >= (2 pi/3) (d/2) (pi/4) d² = pi²/12 d³.
/// V <= (pi/4) d² L with the longest path L.
pub(crate) fn possible_ml(bore_mm: f64) -> (f64, f64) {
    let least_mm3 = PI * PI / 12.0 * bore_mm * bore_mm * bore_mm;
    (1e-3 * least_mm3, 1e-3 * LONGEST_MM * area_mm2(bore_mm))
}

/// Returns the smallest and the largest volume of a revolution that is usual for this bore, in mL: as in heads that are
/// published, with room on either side.
pub(crate) fn usual_ml(bore_mm: f64) -> (f64, f64) {
    let longest_mm = USUAL_MM.max(USUAL_BORES * bore_mm);
    (1e-3 * FEWEST_BORES * bore_mm * area_mm2(bore_mm), 1e-3 * longest_mm * area_mm2(bore_mm))
}

fn area_mm2(bore_mm: f64) -> f64 {
    FRAC_PI_4 * bore_mm * bore_mm
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::bought_heads;

    #[test]
    fn every_head_of_the_catalogue_is_usual_and_far_from_what_is_impossible() {
        let rows = bought_heads().iter().filter_map(|head| Some((head, head.bore_mm?)));
        let mut shortest = f64::INFINITY;
        let mut longest_mm = 0.0_f64;
        for (head, bore_mm) in rows {
            let (least_ml, most_ml) = usual_ml(bore_mm);
            assert!((least_ml..=most_ml).contains(&head.ml_per_rev), "{}", head.name);
            let (least_ml, most_ml) = possible_ml(bore_mm);
            assert!(head.ml_per_rev > 5.0 * least_ml && head.ml_per_rev < 0.2 * most_ml, "{}", head.name);
            let length_mm = path_mm(head.ml_per_rev, bore_mm);
            (shortest, longest_mm) = (shortest.min(length_mm / bore_mm), longest_mm.max(length_mm));
        }
        // The bounds follow from these two rows.
        assert!(
            (shortest - 9.45).abs() < 0.01 && (longest_mm - 144.9).abs() < 0.1,
            "{shortest} {longest_mm}"
        );
    }

    #[test]
    fn a_path_is_the_length_of_tube_that_holds_the_volume() {
        // 2 mL stand 100 mm high in a tube of 20 mm² (pi/4 5.046²).
        assert!((path_mm(2.0, 5.046_265) - 100.0).abs() < 1e-3);
        // A tube of 30 mm around a shaft of no width: a torus of R = r = 15 mm holds 2 pi² 15³ mm³, and rollers leave
        // a third.
        let torus_ml = 2e-3 * PI * PI * 15.0_f64.powi(3);
        assert!((possible_ml(30.0).0 - torus_ml / 3.0).abs() < 1e-9);
    }

    #[test]
    fn slips_of_a_digit_are_unusual_and_those_of_three_impossible() {
        // 0.29 mL through 1.6 mm is published.
        for (ml_per_rev, is_usual, is_possible) in
            [(0.29, true, true), (2.9, false, true), (0.029, true, true), (290.0, false, false)]
        {
            let within = |(least_ml, most_ml): (f64, f64)| (least_ml..=most_ml).contains(&ml_per_rev);
            assert_eq!(
                (within(usual_ml(1.6)), within(possible_ml(1.6))),
                (is_usual, is_possible),
                "{ml_per_rev}"
            );
        }
    }
}
