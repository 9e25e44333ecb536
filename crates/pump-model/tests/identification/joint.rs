//! Claims about one line from several recordings.

use pump_model::identification::{
    IdentificationError, JointFit, JointRecording, LineFit, PressureSample, Recording, RotorMotion, Sought,
};
use pump_model::{Leg, Line, Port, Pump};

use crate::dice::{Coverage, Dice};

const STEADY: RotorMotion<'_> = RotorMotion::Steady { angle_rad: 0.2, speed_rad_s: 4.0 };
const SLOW: [Leg; 1] = [Leg {
    start_s: 0.1,
    duration_s: f64::INFINITY,
    angle_rad: 0.3,
    speed_rad_s: 3.0,
    acceleration_rad_s2: 0.0,
}];
const FAST: [Leg; 1] = [Leg { start_s: 0.0, speed_rad_s: -11.0, ..SLOW[0] }];

/// Returns readings at uneven times on a pump with this line.
fn record(
    line: Line,
    motion: RotorMotion<'_>,
    (count, noise_kpa): (u32, f64),
    dice: &mut Dice,
) -> Vec<PressureSample> {
    let published = Pump::three_roller();
    let pump = Pump::new(*published.geometry(), *published.roller_volume(), line, line).unwrap();
    let time_s = |n: u32, dice: &mut Dice| f64::from(n) * 2e-3 + dice.between(0.0, 1e-3);
    let mut samples: Vec<_> =
        (0..count).map(|n| PressureSample { time_s: time_s(n, dice), pressure_kpa: 0.0 }).collect();
    let recording = Recording { port: Port::Outlet, samples: &samples, motion };
    let exact: Vec<f64> = recording.predicted_kpa(&pump).unwrap().collect();
    for (sample, kpa) in samples.iter_mut().zip(exact) {
        sample.pressure_kpa = kpa + noise_kpa * dice.normal();
    }
    samples
}

fn other() -> Line {
    Line { resistance_kpa_s_ml: 0.14, compliance_ml_kpa: 0.03, inertance_kpa_s2_ml: 0.006, ..Line::PUBLISHED }
}

fn outlet<'a>(samples: &'a [PressureSample], motion: RotorMotion<'a>) -> Recording<'a> {
    Recording { port: Port::Outlet, samples, motion }
}

#[test]
fn one_recording_alone_is_the_fit_of_one() {
    let (pump, mut dice) = (Pump::three_roller(), Dice(5));
    for motion in [RotorMotion::FromRest(&SLOW), STEADY] {
        let samples = record(other(), motion, (400, 0.3), &mut dice);
        let recording = outlet(&samples, motion);
        let sought = Sought::LINE.with_pressure(true);
        let single = LineFit::of(&pump, &recording, sought.with_angle(true)).unwrap();
        let mut one = [JointRecording::new(recording).with_angle(true)];
        let joint = JointFit::of(&pump, &mut one, sought).unwrap();
        let own = one[0].found().unwrap();
        let near = |one: f64, other: f64| assert!((one / other - 1.0).abs() < 1e-5, "{one} {other}");
        near(joint.line().resistance_kpa_s_ml, single.line().resistance_kpa_s_ml);
        near(joint.line().reservoir_kpa, single.line().reservoir_kpa);
        near(own.angle_rad.value, single.angle_rad.value);
        near(own.angle_rad.standard, single.angle_rad.standard);
        near(joint.inertance_kpa_s2_ml.standard, single.inertance_kpa_s2_ml.standard);
        near(joint.covariance[0][1], single.covariance[0][1]);
        near(joint.covariance[2][3], single.covariance[2][5]);
        near(joint.covariance_with_line(own)[0][2], single.covariance[3][2]);
        near(joint.rms_kpa, single.rms_kpa);
    }
}

#[test]
fn a_recording_twice_has_twice_the_information() {
    let (pump, mut dice) = (Pump::three_roller(), Dice(6));
    let motion = RotorMotion::FromRest(&FAST);
    let samples = record(other(), motion, (300, 0.3), &mut dice);
    let recording = outlet(&samples, motion);
    let single = LineFit::of(&pump, &recording, Sought::LINE.with_angle(true)).unwrap();
    let mut two = [JointRecording::new(recording).with_angle(true); 2];
    let joint = JointFit::of(&pump, &mut two, Sought::LINE).unwrap();
    // Covariances over the variance of a residual, whose degrees of freedom are the independent samples less the
    // parameters.
    let alone = single.rms_kpa * single.rms_kpa / (300.0 / single.correlated_samples - 4.0) * 300.0;
    let together = joint.rms_kpa * joint.rms_kpa / (joint.independent_samples - 5.0) * 600.0;
    for n in 0..3 {
        let (one, half) = (single.covariance[n][n] / alone, joint.covariance[n][n] / together);
        // Student's widening is a little less of more samples.
        assert!((0.5 * one / half - 1.0).abs() < 0.02, "{n}: {one:e} {half:e}");
    }
    let [one, other] = two.map(|recording| *recording.found().unwrap());
    let (between, own) = (joint.covariance_between(&one, &other)[0][0], one.covariance[0][0]);
    assert!(between > 0.0 && between < own, "{between} {own}");
}

#[test]
fn several_recordings_give_the_line_within_its_errors_as_often_as_stated() {
    let (pump, mut dice) = (Pump::three_roller(), Dice(7));
    let mut coverage: [Coverage; 4] = Default::default();
    for n in 0..200 {
        let motions = [RotorMotion::FromRest(&SLOW), RotorMotion::FromRest(&FAST), STEADY];
        let samples = motions.map(|motion| record(other(), motion, (200, 0.5), &mut dice));
        let mut recordings: [JointRecording<'_>; 3] = core::array::from_fn(|n| {
            JointRecording::new(outlet(&samples[n], motions[n])).with_angle(true).with_start(n == 0)
        });
        let fit = JointFit::of(&pump, &mut recordings, Sought::LINE.with_pressure(true)).unwrap();
        let (found, truth) = (fit.line(), other());
        coverage[0].take(fit.resistance_kpa_s_ml, truth.resistance_kpa_s_ml);
        coverage[1].take(fit.inertance_kpa_s2_ml, truth.inertance_kpa_s2_ml);
        coverage[2].take(fit.reservoir_kpa, truth.reservoir_kpa);
        coverage[3].take(recordings[2].found().unwrap().angle_rad, 0.0);
        // Each alone, with what is sought of it in the joint fit too.
        for (recording, motion) in recordings.iter().zip(motions).take(if n < 20 { 3 } else { 0 }) {
            let sought = Sought::LINE.with_pressure(true).with_angle(true).with_start(recording.seeks_start);
            let single = LineFit::of(&pump, &outlet(recording.recording.samples, motion), sought);
            if let Ok(single) = single {
                let (joint, alone) = (fit.inertance_kpa_s2_ml.standard, single.inertance_kpa_s2_ml.standard);
                assert!(joint < alone, "{joint:e} {alone:e}");
            }
        }
        assert!((found.compliance_ml_kpa / truth.compliance_ml_kpa - 1.0).abs() < 0.1);
    }
    for coverage in &coverage {
        coverage.is_as_stated();
    }
}

#[test]
fn a_surer_recording_weighs_more() {
    let (pump, mut dice) = (Pump::three_roller(), Dice(8));
    let motion = RotorMotion::FromRest(&FAST);
    let sharp = record(other(), motion, (300, 0.05), &mut dice);
    let dull = record(other(), motion, (300, 5.0), &mut dice);
    let of = |dull_kpa: f64| {
        let mut both = [(&sharp, 0.05), (&dull, dull_kpa)]
            .map(|(samples, kpa)| JointRecording::new(outlet(samples, motion)).with_standard_kpa(kpa));
        JointFit::of(&pump, &mut both, Sought::LINE).unwrap().inertance_kpa_s2_ml
    };
    let (weighed, equal) = (of(5.0), of(0.05));
    assert!(10.0 * weighed.standard < equal.standard, "{weighed:?} {equal:?}");
    assert!((weighed.value - other().inertance_kpa_s2_ml).abs() < 3.0 * weighed.standard);
}

#[test]
fn what_is_no_joint_record_is_refused() {
    let (pump, mut dice) = (Pump::three_roller(), Dice(9));
    let samples = record(other(), STEADY, (100, 0.1), &mut dice);
    let recording = outlet(&samples, STEADY);
    let told = |recordings: &mut [JointRecording<'_>], sought| {
        JointFit::of(&pump, recordings, sought).unwrap_err().to_string()
    };
    assert!(told(&mut [], Sought::LINE).starts_with("0 samples of pressure"));
    let both = JointRecording::new(recording).with_angle(true).with_start(true);
    assert!(told(&mut [both], Sought::LINE).contains("the same in a steady state"));
    let unsure = JointRecording::new(recording).with_standard_kpa(0.0);
    assert!(told(&mut [unsure], Sought::LINE).contains("standard uncertainty of the pressure in kPa is 0"));
    let short = JointRecording::new(Recording { samples: &samples[..1], ..recording }).with_angle(true);
    assert!(told(&mut [JointRecording::new(recording), short], Sought::LINE).starts_with("1 samples"));
    let mut one = [JointRecording::new(recording)];
    let stopped = JointFit::of_while(&pump, &mut one, Sought::LINE, &|| false);
    assert_eq!(stopped.unwrap_err(), IdentificationError::Stopped);
    assert!(one[0].found().is_none());
}
