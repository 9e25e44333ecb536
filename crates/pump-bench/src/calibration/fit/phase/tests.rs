//! Fits of doses of pumps whose truth is known.

use std::num::NonZeroU32;

use pump_model::units::radians;

use super::*;
use crate::calibration::{AgainstSpeed, Displacement, Scatter};
use crate::displacement::SpeedDependentPump;
use crate::sampling::Dice;

const EXPECTED: Expected = Expected::new(0.0047, 0.005);

/// Returns the plant's volume of a revolution, as if it had been weighed without any error.
fn weighed(plant: &Pump) -> Displacement {
    let factor = plant.revolution_ml() / Pump::three_roller().revolution_ml();
    Displacement {
        reference_rpm: 60.0,
        factor,
        factor_standard: 0.0,
        slope_per_rpm: 0.0,
        slope_standard_per_rpm: 0.0,
        bend: None,
        scatter: Scatter::Seen { degrees_of_freedom: NonZeroU32::new(100).unwrap(), standard: 0.0 },
        lack_of_fit: 0.0,
        reading: 0.0,
        speeds_rpm: vec![60.0],
        prior: None,
        outliers: vec![],
        law: None,
    }
}

/// Returns doses of a fifth of a pitch from angles all over a pitch, with the expected noise.
fn doses(plant: &Pump, count: u32, dice: &mut Dice) -> Vec<ShortDose> {
    (0..count)
        .map(|n| {
            let start_angle_deg = f64::from(n) * 120.0 / f64::from(count);
            let (from_rad, to_rad) = (radians(start_angle_deg), radians(start_angle_deg + 24.0));
            let curve = plant.outlet_curve();
            let exact_ml = curve.volume_ml(to_rad) - curve.volume_ml(from_rad);
            let volume_ml = exact_ml * (1.0 + EXPECTED.repeatability * dice.normal())
                + EXPECTED.reading_ml * dice.normal();
            ShortDose { start_angle_deg, turned_deg: 24.0, volume_ml, speed_rpm: None }
        })
        .collect()
}

/// Returns a three-roller pump with another roller volume and engagement angle, 1 % more volume, and its zero
/// elsewhere.
fn plant(roller_ml: f64, engagement_deg: f64, zero_deg: f64) -> Pump {
    let base = Pump::three_roller();
    let roller = base.roller_volume().scaled_to(roller_ml).unwrap().stretched_to(engagement_deg).unwrap();
    let pump = Pump::new(*base.geometry(), roller, *base.inlet(), *base.outlet()).unwrap();
    pump.shifted(radians(zero_deg)).unwrap().scaled(1.01).unwrap()
}

fn fit_as(displacement: Option<&Displacement>, doses: &[ShortDose]) -> Result<PhaseFit, CalibrationError> {
    let base = Pump::three_roller();
    let pump = SpeedDependentPump::constant(base);
    let against = AgainstSpeed::of(displacement, &pump);
    PhaseFit::of(&base, Revolution { against, model_standard: 0.024 }, doses, &EXPECTED)
}

#[test]
fn parameters_are_recovered_within_twice_their_errors_as_often_as_stated() {
    let (mut dice, mut inside) = (Dice::new(11), [0; 3]);
    const PLANTS: u32 = 1000;
    for n in 0..PLANTS {
        let truth = (2.0 + 2e-4 * f64::from(n), 48.0 + 0.004 * f64::from(n), -55.0 + 0.1 * f64::from(n));
        let plant = plant(truth.0, truth.1, truth.2);
        let doses = doses(&plant, 24, &mut dice);
        let found = fit_as(Some(&weighed(&plant)), &doses).unwrap();
        let errors =
            [(found.roller_volume_ml, truth.0), (found.engagement_deg, truth.1), (found.zero_deg, truth.2)];
        for (inside, (found, truth)) in inside.iter_mut().zip(errors) {
            *inside += u32::from((found.value - truth).abs() < 2.0 * found.standard);
        }
        assert!(found.zero_deg.standard < 0.5 && found.roller_volume_ml.standard < 0.02, "{found:?}");
    }
    // 95.45 % of 1000; a binomial count lies within three of its deviations, 20, nearly always.
    for inside in inside {
        assert!((934..=975).contains(&inside), "{inside} of {PLANTS}");
    }
}

#[test]
fn what_is_unsure_of_the_revolution_is_unsure_of_the_roller_volume() {
    let plant = plant(2.06, 50.0, 10.0);
    let doses = doses(&plant, 24, &mut Dice::new(3));
    let with = |displacement: Option<&Displacement>| fit_as(displacement, &doses).unwrap().roller_volume_ml;
    let (weighed, unweighed) = (with(Some(&weighed(&plant))), with(None));
    assert!(unweighed.standard > 3.0 * weighed.standard, "{weighed:?} {unweighed:?}");
    assert!((weighed.value - 2.06).abs() < 2.0 * weighed.standard, "{weighed:?}");
    assert!((unweighed.value - 2.06).abs() < 2.0 * unweighed.standard, "{unweighed:?}");
}

#[test]
fn doses_that_say_nothing_of_a_pulse_are_refused() {
    let mut dice = Dice::new(5);
    let plant = plant(2.1, 50.0, 10.0);
    let known = weighed(&plant);
    let good = doses(&plant, 12, &mut dice);
    let fit = |doses: &[ShortDose]| fit_as(Some(&known), doses);
    assert!(fit(&good).is_ok());
    assert!(fit(&good[..4]).unwrap_err().to_string().contains("4 short doses; 5 at least"));
    let pitches: Vec<ShortDose> = good
        .iter()
        .map(|dose| ShortDose {
            turned_deg: 120.0,
            volume_ml: 7.1062 * (1.0 + 1e-3 * dice.normal()),
            ..*dose
        })
        .collect();
    let error = fit(&pitches).unwrap_err().to_string();
    assert!(error.contains("do not determine"), "{error}");
    let scattered: Vec<ShortDose> =
        good.iter().map(|dose| ShortDose { volume_ml: 0.2 + 3.0 * dice.uniform(), ..*dose }).collect();
    assert!(fit(&scattered).is_err());
}
