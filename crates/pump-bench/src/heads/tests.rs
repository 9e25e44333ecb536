//! The catalogue as data: names, ranges, and the volume of a revolution against the bore.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_PI_4;

use super::*;

#[test]
fn the_catalogue_holds_forty_heads_and_more_under_names_of_their_own() {
    let heads = bought_heads();
    assert!(heads.len() >= 40, "{} rows", heads.len());
    let names: BTreeSet<&str> = heads.iter().map(|head| head.name.as_str()).collect();
    assert_eq!(names.len(), heads.len(), "a name stands twice");
    for head in heads {
        let name = &head.name;
        let kebab = |word: &str| {
            !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
        };
        assert!(name.split('-').all(kebab) && name.len() <= 64, "{name}");
        let maker = head.maker.split(' ').next().unwrap().to_lowercase();
        assert!(name.starts_with(&maker), "{name} is not named after {}", head.maker);
        assert_eq!(bought_head(name), Some(head), "{name}");
    }
    assert_eq!(bought_head("masterflex-ls-1"), None);
}

#[test]
fn every_row_names_its_document_its_table_and_who_quotes_it() {
    for head in bought_heads() {
        let (name, source) = (&head.name, &head.source);
        assert!(source.document.len() > 15 && source.address.starts_with("http"), "{name}");
        let places = ["table ", "page ", "data/"];
        assert!(places.iter().any(|place| source.table.contains(place)), "{name}: {}", source.table);
        // A figure that passed through other hands names them, and one of the maker's own document names its maker.
        let is_makers = source.kind == Provenance::Maker;
        assert_eq!(source.quoted_by.is_none(), is_makers, "{name}");
        assert!(source.quoted_by.as_ref().is_none_or(|by| by.len() > 10), "{name}");
        let names_maker = source.document.contains(head.maker.split(' ').next().unwrap());
        assert!(names_maker, "{name}: {}", source.document);
        let number = head.published.split(' ').next().unwrap().parse::<f64>();
        assert!(number.is_ok_and(|number| number > 0.0), "{}: {}", head.name, head.published);
    }
}

/// Bench heads carry their rollers some 3 to 30 mm from the shaft, so the path of a bore around it is some 20 to
/// 190 mm. A volume of a revolution beyond is a slip of a unit or of a digit.
#[test]
fn the_volume_of_a_revolution_fills_the_bore_along_a_path_of_a_bench_heads_length() {
    for head in bought_heads() {
        assert!((1e-4..=10.0).contains(&head.ml_per_rev), "{}", head.name);
        assert!(head.rollers.is_none_or(|rollers| (2..=12).contains(&rollers)), "{}", head.name);
        assert!(head.wall_mm.is_none_or(|wall| (0.5..=4.0).contains(&wall)), "{}", head.name);
        if let Some(bore) = head.bore_mm {
            assert!((0.1..=12.0).contains(&bore), "{}", head.name);
            let path_mm = 1000.0 * head.ml_per_rev / (FRAC_PI_4 * bore * bore);
            assert!((20.0..=190.0).contains(&path_mm), "{}: {path_mm} mm", head.name);
        }
    }
}

/// The volume of a revolution is the bore's area times the length of its path, less what the rollers flatten.
/// The flattened length grows with the bore, so the volume grows with the bore and its ratio to the bore squared falls.
///
/// The fall stays within a factor of 2.5. Of Ismatec's table for six rollers the program aguaclara makes the law
/// q = pi/4 d² (P - 13 d), with a path P for all bores d (aguaclara.research.peristaltic_pump). For the widest span
/// here, 1.6 to 8 mm on a path that ends at 145 mm (`runze-yz1515x-3`), this law falls by (166 - 21)/(166 - 104) = 2.3.
/// Smallest flows of 12 mL/min that are rounded to whole ones add 1.04. Factors from 1.1 to 2.4 are what the tables
/// hold. A decimal point, a unit or a neighbouring row that was mistaken breaks this bound or the rise with the bore.
#[test]
fn within_a_head_the_volume_of_a_revolution_goes_with_the_bore_squared() {
    let mut heads: BTreeMap<(&str, &str), Vec<&BoughtHead>> = BTreeMap::new();
    for head in bought_heads() {
        heads.entry((&head.maker, &head.head)).or_default().push(head);
    }
    let mut compared = 0;
    for (head, rows) in heads {
        let known: Vec<(f64, f64, Option<f64>)> = rows
            .iter()
            .filter_map(|row| row.bore_mm.map(|bore| (bore, row.ml_per_rev, row.wall_mm)))
            .collect();
        let shares: Vec<f64> = known.iter().map(|(bore, ml, _)| ml / (bore * bore)).collect();
        let largest = shares.iter().copied().fold(0.0, f64::max);
        let smallest = shares.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(known.is_empty() || largest <= 2.5 * smallest, "{head:?}: {shares:?}");
        for (bore, ml, wall) in &known {
            for (other, more, other_wall) in &known {
                let wider = other > bore && other_wall == wall;
                assert!(!wider || more > ml, "{head:?}: {other} mm gives {more} mL, {bore} mm {ml} mL");
                compared += usize::from(wider);
            }
        }
    }
    assert!(compared > 200, "{compared} pairs");
}

/// Figures of the documents, typed anew beside the data.
#[test]
fn rows_hold_what_their_documents_state() {
    for (name, ml_per_rev, rollers, bore_mm) in [
        ("omega-fpu5mt-1-32in", 0.05, None, Some(0.79375)),
        ("omega-fpu5mt-4mm", 1.43, None, Some(4.0)),
        ("masterflex-ls-13", 0.06, None, Some(0.8)),
        ("masterflex-ls-16", 0.80, None, Some(3.1)),
        ("masterflex-ls-18", 3.8, None, Some(8.0)),
        ("masterflex-ls-36", 4.8, None, None),
        ("kamoer-kpmp10-1-52mm", 0.059, Some(4), Some(1.52)),
        ("kamoer-kpmp10-0-25mm", 0.00135, Some(4), Some(0.25)),
        ("kamoer-kphm400-25", 1.0, Some(3), Some(4.8)),
        ("runze-yz1515x-3-18", 1627.2 / 400.0, Some(3), Some(8.0)),
        ("runze-sn15-6-14", 59.5 / 400.0, Some(6), Some(1.6)),
        ("runze-rz1030b-4-1-42mm", 47.0 / 400.0, Some(4), Some(1.42)),
        ("runze-rz1030b-8-3x1mm", 114.0 / 400.0, Some(8), Some(3.0)),
    ] {
        let head = bought_head(name).unwrap();
        assert!((head.ml_per_rev - ml_per_rev).abs() < 1e-12, "{name}: {}", head.ml_per_rev);
        assert_eq!((head.rollers, head.bore_mm), (rollers, bore_mm), "{name}");
    }
    let yz = bought_head("runze-yz1515x-3-14").unwrap();
    assert_eq!(yz.published, "116.5 mL/min at 400 r/min; 1.1 mL/min at 5 r/min");
    assert_eq!(yz.source.kind, Provenance::Quoted);
}

/// The maker's own rule for its heads, Q = k r² N in mL/s, cm and r/min (runzefluid.com, peristaltic pump tubing size
/// vs flow rate). It stands apart from the tables, and its k is one for all bores of a head.
#[test]
fn the_makers_rule_agrees_with_its_tables_at_middling_bores() {
    for (name, k, within) in [
        ("runze-yz1515x-3-16", 0.592, 0.20),
        ("runze-yz1515x-6-16", 0.434, 0.30),
        ("runze-sn15-3-16", 0.586, 0.05),
        ("runze-rz1030b-4-1-42mm", 0.385, 0.05),
        ("runze-rz01-4-1-42mm", 0.327, 0.10),
    ] {
        let head = bought_head(name).unwrap();
        let radius_cm = 0.05 * head.bore_mm.unwrap();
        let rule_ml = 60.0 * k * radius_cm * radius_cm;
        assert!(
            (head.ml_per_rev / rule_ml - 1.0).abs() < within,
            "{name}: {} against {rule_ml}",
            head.ml_per_rev
        );
    }
}

#[test]
fn words_narrow_the_list_whatever_their_letters() {
    assert_eq!(heads_matching(&["Masterflex"]).len(), 10);
    assert_eq!(heads_matching(&["MASTERFLEX", "16"]).len(), 1);
    assert_eq!(heads_matching(&[] as &[&str]).len(), bought_heads().len());
    assert!(heads_matching(&["no such head"]).is_empty());
}

#[test]
fn a_number_is_that_of_the_rollers_the_bore_or_the_size_and_no_part_of_another() {
    let names =
        |words: &[&str]| heads_matching(words).iter().map(|head| head.name.as_str()).collect::<Vec<_>>();
    assert_eq!(names(&["runze", "4", "1.6"]), ["runze-rz01-4-1-6x1-6mm"]);
    assert_eq!(names(&["yz1515x", "3", "16#"]), ["runze-yz1515x-3-16"]);
    assert_eq!(names(&["kamoer", "1.3mm"]), ["kamoer-kpmp10-1-30mm"]);
    assert_eq!(names(&["omega", "1/16in"]), ["omega-fpu5mt-1-16in"]);
    // 1.6 mm is the wall of most tubes, and 3 is a part of 13.
    assert_eq!(names(&["masterflex", "3"]), [] as [&str; 0]);
}
