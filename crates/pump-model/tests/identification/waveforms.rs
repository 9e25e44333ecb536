//! Claims about R, C and L from a waveform.

use pump_model::identification::{Estimate, LineFit, PressureSample, Recording, RotorMotion, Sought};
use pump_model::{Leg, Line, Port, Pump};

use crate::dice::{Coverage, Dice};

/// Returns a motion from rest to 100 r/min at 500 rad/s², as a motor does, from a roller's angle.
const RAMP: [Leg; 2] = [
    Leg { start_s: 0.0, duration_s: 0.021, angle_rad: 0.3, speed_rad_s: 0.0, acceleration_rad_s2: 500.0 },
    Leg {
        start_s: 0.021,
        duration_s: f64::INFINITY,
        angle_rad: 0.410_25,
        speed_rad_s: 10.5,
        acceleration_rad_s2: 0.0,
    },
];

const ALL: Sought = Sought::LINE.with_angle(true).with_pressure(true);

fn with(line: Line) -> Pump {
    let pump = Pump::three_roller();
    Pump::new(*pump.geometry(), *pump.roller_volume(), line, line).unwrap()
}

/// Returns a line up to a third from the published one either way.
fn some_line(dice: &mut Dice) -> Line {
    let line = Line::PUBLISHED;
    Line {
        resistance_kpa_s_ml: line.resistance_kpa_s_ml * dice.between(0.7, 1.4),
        compliance_ml_kpa: line.compliance_ml_kpa * dice.between(0.7, 1.4),
        inertance_kpa_s2_ml: line.inertance_kpa_s2_ml * dice.between(0.7, 1.4),
        ..line
    }
}

/// Returns the readings of a sensor every 2 ms on a pump with this line. Each sample of the noise keeps
/// `memory` of the one before.
fn record(
    line: Line,
    port: Port,
    motion: RotorMotion<'_>,
    count: u32,
    (noise_kpa, memory): (f64, f64),
    dice: &mut Dice,
) -> Vec<PressureSample> {
    let times: Vec<_> =
        (0..count).map(|n| PressureSample { time_s: f64::from(n) * 2e-3, pressure_kpa: 0.0 }).collect();
    let pump = with(line);
    let exact: Vec<f64> = Recording { port, samples: &times, motion }.predicted_kpa(&pump).unwrap().collect();
    let mut noise = noise_kpa * dice.normal();
    times
        .iter()
        .zip(exact)
        .map(|(sample, kpa)| {
            noise = memory * noise + (1.0 - memory * memory).sqrt() * noise_kpa * dice.normal();
            PressureSample { pressure_kpa: kpa + noise, ..*sample }
        })
        .collect()
}

fn take(coverage: &mut [Coverage; 3], fit: &LineFit, line: &Line) {
    let found = [fit.resistance_kpa_s_ml, fit.compliance_ml_kpa, fit.inertance_kpa_s2_ml];
    let truth = [line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml];
    for ((coverage, found), truth) in coverage.iter_mut().zip(found).zip(truth) {
        coverage.take(found, truth);
    }
}

#[test]
fn a_start_from_rest_gives_the_line_within_its_errors_as_often_as_stated() {
    let (pump, mut dice) = (Pump::three_roller(), Dice(11));
    let mut coverage: [Coverage; 3] = Default::default();
    for n in 0..200 {
        let (line, port) = (some_line(&mut dice), if n % 2 == 0 { Port::Outlet } else { Port::Inlet });
        let motion = RotorMotion::FromRest(&RAMP);
        let samples = record(line, port, motion, 250, (0.5, 0.0), &mut dice);
        let fit = LineFit::of(&pump, &Recording { port, samples: &samples, motion }, Sought::LINE).unwrap();
        take(&mut coverage, &fit, &line);
        assert!((fit.rms_kpa / 0.5 - 1.0).abs() < 0.25 && fit.correlated_samples < 3.0, "{fit:?}");
        let part = |of: Estimate| of.standard / of.value;
        assert!(part(fit.inertance_kpa_s2_ml) < 0.02 && part(fit.resistance_kpa_s_ml) < 0.05, "{fit:?}");
    }
    coverage.iter().for_each(Coverage::is_as_stated);
}

#[test]
fn a_steady_record_with_noise_that_lingers_gives_line_angle_and_pressure_as_often_as_stated() {
    let (pump, mut dice) = (Pump::three_roller(), Dice(12));
    let mut coverage: [Coverage; 3] = Default::default();
    let [mut angle, mut pressure] = [(); 2].map(|()| Coverage::default());
    let mut correlated = 0.0;
    for _ in 0..200 {
        let line = Line { reservoir_kpa: dice.between(80.0, 100.0), ..some_line(&mut dice) };
        let angle_rad = dice.between(-1.0, 1.0);
        let real = RotorMotion::Steady { angle_rad, speed_rad_s: 9.0 };
        let samples = record(line, Port::Outlet, real, 500, (0.4, 0.6), &mut dice);
        let motion = RotorMotion::Steady { angle_rad: 0.0, speed_rad_s: 9.0 };
        let recording = Recording { port: Port::Outlet, samples: &samples, motion };
        let fit = LineFit::of(&pump, &recording, ALL).unwrap();
        take(&mut coverage, &fit, &line);
        angle.take(fit.angle_rad, angle_rad);
        pressure.take(fit.reservoir_kpa, line.reservoir_kpa);
        correlated += fit.correlated_samples / 200.0;
    }
    // The autocorrelation time is (1 + 0.6)/(1 - 0.6).
    assert!((correlated / 4.0 - 1.0).abs() < 0.15, "{correlated}");
    coverage.iter().chain([&angle, &pressure]).for_each(Coverage::is_as_stated);
}

#[test]
fn without_noise_every_parameter_comes_back() {
    let pump = Pump::three_roller();
    let line = Line {
        resistance_kpa_s_ml: 0.2,
        compliance_ml_kpa: 0.02,
        inertance_kpa_s2_ml: 0.008,
        reservoir_kpa: 95.0,
    };
    let late = RAMP.map(|leg| Leg { start_s: leg.start_s + 0.004, angle_rad: leg.angle_rad + 0.5, ..leg });
    let samples = record(line, Port::Outlet, RotorMotion::FromRest(&late), 500, (0.0, 0.0), &mut Dice(0));
    let recording = Recording { port: Port::Outlet, samples: &samples, motion: RotorMotion::FromRest(&RAMP) };
    let fit = LineFit::of(&pump, &recording, ALL.with_start(true)).unwrap();
    let found = fit.line();
    for (found, truth) in [
        (found.resistance_kpa_s_ml, line.resistance_kpa_s_ml),
        (found.compliance_ml_kpa, line.compliance_ml_kpa),
        (found.inertance_kpa_s2_ml, line.inertance_kpa_s2_ml),
        (found.reservoir_kpa, line.reservoir_kpa),
        (fit.angle_rad.value, 0.5),
        (fit.start_s.value, 0.004),
    ] {
        assert!((found / truth - 1.0).abs() < 1e-6, "{found} for {truth}");
    }
    let predicted = fit.pressures_kpa(&pump, &recording, &found).unwrap();
    assert!(predicted.zip(&samples).all(|(kpa, sample)| (kpa - sample.pressure_kpa).abs() < 1e-6));
    assert!(fit.rms_kpa < 1e-6);
}

#[test]
fn a_record_of_the_pumps_own_line_without_noise_is_fitted_from_an_edge_too() {
    let pump = Pump::three_roller();
    let mut dice = Dice(5);
    // At angle 0 a roller begins to leave the outlet. The residuals are those of rounding.
    for start_rad in [0.0, 0.1, 0.7, 1.5] {
        for port in [Port::Inlet, Port::Outlet] {
            for count in [151, 501, 1001] {
                let legs = [Leg::constant_speed(start_rad, 10.471_975_511_965_978)];
                let motion = RotorMotion::FromRest(&legs);
                let samples = record(Line::PUBLISHED, port, motion, count, (0.0, 0.0), &mut dice);
                let guess = [Leg::constant_speed(0.0, 10.471_975_511_965_978)];
                let recording = Recording { port, samples: &samples, motion: RotorMotion::FromRest(&guess) };
                let fit = LineFit::of(&pump, &recording, Sought::LINE.with_angle(true))
                    .unwrap_or_else(|error| panic!("{start_rad} {port} {count}: {error}"));
                let off_rad = fit.angle_rad.value - start_rad;
                let pitches = (off_rad / pump.pitch_rad()).round();
                assert!((off_rad - pitches * pump.pitch_rad()).abs() < 1e-7, "{off_rad}");
                assert!((fit.line().inertance_kpa_s2_ml / 0.0042 - 1.0).abs() < 1e-7, "{fit:?}");
                // Rounding repeats itself with the pulses, but has no memory.
                assert_eq!(fit.correlated_samples, 1.0, "{fit:?}");
            }
        }
    }
}

#[test]
fn lines_far_from_the_first_guess_are_found_too() {
    let pump = Pump::three_roller();
    for (compliance, inertance) in [(3.0, 1.0), (0.4, 1.0), (1.0, 2.5), (0.5, 0.5), (2.0, 1.5), (0.3, 2.0)] {
        let line = Line {
            compliance_ml_kpa: compliance * Line::PUBLISHED.compliance_ml_kpa,
            inertance_kpa_s2_ml: inertance * Line::PUBLISHED.inertance_kpa_s2_ml,
            ..Line::PUBLISHED
        };
        let motion = RotorMotion::FromRest(&RAMP);
        let samples = record(line, Port::Outlet, motion, 300, (0.2, 0.0), &mut Dice(7));
        let recording = Recording { port: Port::Outlet, samples: &samples, motion };
        let fit = LineFit::of(&pump, &recording, Sought::LINE).unwrap();
        let error = fit.inertance_kpa_s2_ml.value / line.inertance_kpa_s2_ml - 1.0;
        assert!(error.abs() < 0.03, "{compliance} {inertance}: {fit:?}");
    }
}

#[test]
fn what_is_held_keeps_its_bits_and_has_no_uncertainty() {
    let pump = Pump::three_roller();
    let line = Line { inertance_kpa_s2_ml: 0.006, ..Line::PUBLISHED };
    let motion = RotorMotion::FromRest(&RAMP);
    let samples = record(line, Port::Inlet, motion, 200, (0.3, 0.0), &mut Dice(3));
    let recording = Recording { port: Port::Inlet, samples: &samples, motion };
    let only = Sought::LINE.with_resistance(false).with_compliance(false);
    let fit = LineFit::of(&pump, &recording, only).unwrap();
    let held = |value| Estimate { value, standard: 0.0 };
    assert_eq!(fit.resistance_kpa_s_ml, held(0.1108));
    assert_eq!(fit.compliance_ml_kpa, held(0.0361));
    assert_eq!((fit.angle_rad, fit.start_s, fit.reservoir_kpa), (held(0.0), held(0.0), held(88.637)));
    assert!((fit.inertance_kpa_s2_ml.value - 0.006).abs() < 2.0 * fit.inertance_kpa_s2_ml.standard);
    assert!(fit.inertance_kpa_s2_ml.standard > 0.0);
}

#[test]
fn a_steady_record_is_what_a_start_becomes_in_either_direction() {
    let pump = Pump::three_roller();
    let samples: Vec<_> =
        (0..300).map(|n| PressureSample { time_s: 5.0 + f64::from(n) * 2e-3, pressure_kpa: 0.0 }).collect();
    for speed_rad_s in [9.0, -9.0] {
        for port in [Port::Inlet, Port::Outlet] {
            let legs = [Leg::constant_speed(0.7, speed_rad_s)];
            let kpa = |motion| {
                let recording = Recording { port, samples: &samples, motion };
                recording.predicted_kpa(&pump).unwrap().collect::<Vec<_>>()
            };
            let steady = kpa(RotorMotion::Steady { angle_rad: 0.7, speed_rad_s });
            let started = kpa(RotorMotion::FromRest(&legs));
            // Only exp(-13.19 x 5) of the start is left.
            assert!(steady.iter().zip(started).all(|(one, other)| (one - other).abs() < 1e-9));
        }
    }
}

#[test]
fn a_search_that_its_caller_stops_ends_between_two_samples_and_says_so() {
    use core::cell::Cell;
    use pump_model::identification::IdentificationError;

    let motion = RotorMotion::FromRest(&RAMP);
    let samples = record(Line::PUBLISHED, Port::Outlet, motion, 400, (0.3, 0.0), &mut Dice(3));
    let recording = Recording { port: Port::Outlet, samples: &samples, motion };
    let pump = with(Line { compliance_ml_kpa: 0.03, ..Line::PUBLISHED });
    let asked = Cell::new(0_u32);
    let up_to = |most: u32| {
        asked.set(0);
        LineFit::of_while(&pump, &recording, ALL, &|| {
            asked.set(asked.get() + 1);
            asked.get() < most
        })
    };
    let whole = up_to(u32::MAX).unwrap();
    let questions = asked.get();
    assert!(questions > 100, "{questions}");
    assert_eq!(whole, LineFit::of(&pump, &recording, ALL).unwrap());
    for most in [1, 2, questions / 2, questions - 1] {
        assert_eq!(up_to(most), Err(IdentificationError::Stopped));
        // Nothing is asked again once the answer was no.
        assert_eq!(asked.get(), most);
    }
    // A sample a day: the rotor passes a hundred thousand edges from one to the next, and is asked on the way.
    let days = [0.0, 1e4, 2e4].map(|time_s| PressureSample { time_s, pressure_kpa: 90.0 });
    let recording = Recording { samples: &days, ..recording };
    let stopped = LineFit::of_while(&pump, &recording, Sought::new().with_inertance(true), &|| {
        asked.set(asked.get() + 1);
        false
    });
    assert_eq!(stopped, Err(IdentificationError::Stopped));
}

#[test]
fn the_squares_of_residuals_are_those_of_the_predicted_pressures() {
    let steady = RotorMotion::Steady { angle_rad: 0.4, speed_rad_s: -7.0 };
    for (motion, dice) in [(RotorMotion::FromRest(&RAMP), 1), (steady, 2)] {
        let mut dice = Dice(dice);
        let mut samples = record(Line::PUBLISHED, Port::Inlet, motion, 500, (0.3, 0.0), &mut dice);
        let line = some_line(&mut dice);
        let pump = with(line);
        for times in 0..5 {
            let recording = Recording { port: Port::Inlet, samples: &samples, motion };
            let expected: f64 = samples
                .iter()
                .zip(recording.predicted_kpa(&pump).unwrap())
                .map(|(sample, kpa)| (sample.pressure_kpa - kpa) * (sample.pressure_kpa - kpa))
                .sum();
            let found = recording.residual_squares_kpa2(&Pump::three_roller(), &line, 0.0, 0.0).unwrap();
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected} at times {times}");
            // Then at rounded times, with gaps, as float32, and at intervals that differ.
            let mut count = 0;
            match times {
                0 => samples.iter_mut().for_each(|s| s.time_s = (s.time_s * 1e4).round() / 1e4),
                1 => samples.retain(|_| {
                    count += 1;
                    count % 50 != 7 && !(300..380).contains(&count)
                }),
                2 => samples.iter_mut().for_each(|s| s.time_s = f64::from(s.time_s as f32)),
                _ => {
                    for (n, sample) in samples.iter_mut().enumerate() {
                        sample.time_s += 1e-4 * (n as f64).sin();
                    }
                    samples.retain(|sample| sample.time_s > 0.0);
                }
            }
        }
    }
}

#[test]
fn the_slopes_of_the_squares_are_those_of_differences() {
    let steady = RotorMotion::Steady { angle_rad: 0.4, speed_rad_s: -7.0 };
    for (port, motion) in [(Port::Outlet, RotorMotion::FromRest(&RAMP)), (Port::Inlet, steady)] {
        let samples = record(Line::PUBLISHED, port, motion, 500, (0.3, 0.0), &mut Dice(3));
        let recording = Recording { port, samples: &samples, motion };
        let pump = Pump::three_roller();
        // R, C, L, angle, start and reservoir.
        let at = [0.12, 0.031, 0.005, 0.017, 0.0123, 89.0];
        let line = |at: [f64; 6]| Line {
            resistance_kpa_s_ml: at[0],
            compliance_ml_kpa: at[1],
            inertance_kpa_s2_ml: at[2],
            reservoir_kpa: at[5],
        };
        let squares = |at: [f64; 6]| recording.residual_squares_kpa2(&pump, &line(at), at[3], at[4]).unwrap();
        let (sum, slopes) = recording.residual_squares_with_slopes(&pump, &line(at), at[3], at[4]).unwrap();
        assert!((sum / squares(at) - 1.0).abs() < 1e-9);
        for (n, slope) in slopes.into_iter().enumerate() {
            let beside = |factor: f64| {
                let mut beside = at;
                beside[n] *= factor;
                squares(beside)
            };
            let difference = (beside(1.0 + 1e-6) - beside(1.0 - 1e-6)) / (2e-6 * at[n]);
            assert!((slope / difference - 1.0).abs() < 1e-4, "{port:?} {n}: {slope} for {difference}");
        }
    }
}

#[test]
fn the_covariance_of_a_fit_has_the_standard_uncertainties_on_its_diagonal() {
    let motion = RotorMotion::FromRest(&RAMP);
    let samples = record(Line::PUBLISHED, Port::Outlet, motion, 500, (0.3, 0.0), &mut Dice(9));
    let recording = Recording { port: Port::Outlet, samples: &samples, motion };
    let fit = LineFit::of(&with(Line::PUBLISHED), &recording, ALL).unwrap();
    let estimates = [
        fit.resistance_kpa_s_ml,
        fit.compliance_ml_kpa,
        fit.inertance_kpa_s2_ml,
        fit.angle_rad,
        fit.start_s,
        fit.reservoir_kpa,
    ];
    for (n, estimate) in estimates.iter().enumerate() {
        let standard = fit.covariance[n][n].sqrt();
        assert!((standard - estimate.standard).abs() <= 1e-12 * estimate.standard, "{n}: {standard}");
        for (k, row) in fit.covariance.iter().enumerate() {
            assert!((row[n] - fit.covariance[n][k]).abs() <= 1e-12 * row[n].abs());
        }
    }
}
