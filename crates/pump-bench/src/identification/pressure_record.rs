//! R, C and L from a pressure waveform, and what is to be said of them.

use pump_model::identification::{
    Estimate, IdentificationError, LineFit, Motion, PressureSample, Recording, Sought,
};
use pump_model::math::{degrees, rpm};
use pump_model::{Leg, Port, Pump};

use super::identified::{Identified, Parameter};
use crate::export::Fitted;

/// How a rotor came to its speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Begin {
    /// From rest.
    Ramp {
        /// rad/s², positive.
        acceleration_rad_s2: f64,
    },
    /// From rest, at full speed at once.
    Step,
    /// It had turned at this speed for long.
    Steady,
}

/// What the rotor did while a pressure was recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// How it began.
    pub begin: Begin,
    /// When it began to turn, in the time of the record, s; without meaning where it had turned for long.
    pub start_s: f64,
    /// Angle at the start, or at time 0 where it had turned for long, rad.
    pub angle_rad: f64,
    /// Speed that it came to, rad/s; negative in reverse.
    pub speed_rad_s: f64,
}

impl Turning {
    /// The motion from rest.
    fn legs(&self) -> Vec<Leg> {
        let cruise = Leg { start_s: self.start_s, ..Leg::constant_speed(self.angle_rad, self.speed_rad_s) };
        let Begin::Ramp { acceleration_rad_s2 } = self.begin else {
            return vec![cruise];
        };
        let ramp = Leg {
            duration_s: self.speed_rad_s.abs() / acceleration_rad_s2,
            speed_rad_s: 0.0,
            acceleration_rad_s2: acceleration_rad_s2 * self.speed_rad_s.signum(),
            ..cruise
        };
        vec![ramp, Leg { start_s: ramp.end_s(), angle_rad: ramp.end_angle_rad(), ..cruise }]
    }
}

/// Part of a swing of the line over which neighbouring residuals may be alike and still be noise. The integrated
/// autocorrelation time of a residual that swings with the line is 1/pi of a swing; two thirds of that are such a residual with
/// a third of the variance in white noise.
const MOST_ALIKE: f64 = 0.2;

/// Residuals whose RMS is less than this part of the samples' standard deviation are small, alike or not.
const SMALL_RESIDUALS: f64 = 0.05;

/// Fits the line of a port of `pump` to a waveform, starting from the pump's.
pub fn identified_line(
    pump: &Pump,
    port: Port,
    samples: &[PressureSample],
    turning: &Turning,
    sought: Sought,
) -> Result<Identified, IdentificationError> {
    let Turning { begin, start_s, angle_rad, speed_rad_s } = *turning;
    let legs = turning.legs();
    let motion = match begin {
        Begin::Steady => Motion::Steady { angle_rad, speed_rad_s },
        Begin::Ramp { .. } | Begin::Step => Motion::FromRest(&legs),
    };
    let recording = Recording { port, samples, motion };
    let fit = LineFit::of(pump, &recording, sought)?;
    let line = fit.line();
    let points: Vec<_> = samples
        .iter()
        .zip(fit.pressures_kpa(pump, &recording, &line)?)
        .map(|(sample, fitted)| Fitted { x: sample.time_s, measured: sample.pressure_kpa, fitted })
        .collect();
    let moved = |found: Estimate, by: f64| Estimate { value: found.value + by, ..found };
    let angle = moved(fit.angle_rad, angle_rad).times(degrees(1.0));
    let parameters = [
        ("resistance_kpa_s_ml", "resistance", "kPa s/mL", fit.resistance_kpa_s_ml, sought.resistance),
        ("compliance_ml_kpa", "compliance", "mL/kPa", fit.compliance_ml_kpa, sought.compliance),
        ("inertance_kpa_s2_ml", "inertance", "kPa s²/mL", fit.inertance_kpa_s2_ml, sought.inertance),
        ("reservoir_kpa", "reservoir", "kPa absolute", fit.reservoir_kpa, sought.pressure),
        ("start_angle_deg", "start angle", "°", angle, sought.angle),
        ("start_s", "start", "s", moved(fit.start_s, start_s), sought.start),
    ]
    .into_iter()
    .map(|(key, name, unit, found, is_sought)| Parameter { key, name, unit, found, is_held: !is_sought });
    let independent = samples.len() as f64 / fit.correlated_samples;
    Ok(Identified {
        kind: "line",
        port,
        headline: format!(
            "{} line at {:.4} r/min, {} samples worth {independent:.0} independent ones",
            port.name(),
            rpm(speed_rad_s),
            samples.len(),
        ),
        parameters: parameters.collect(),
        independent,
        points,
        warnings: doubts(&fit, samples),
        line,
    }
    .with_weak_correlation(true))
}

/// Whether the swings of the line pass between the samples, and whether what is left over is no noise.
fn doubts(fit: &LineFit, samples: &[PressureSample]) -> Vec<String> {
    let time_s = |sample: Option<&PressureSample>| sample.map_or(0.0, |sample| sample.time_s);
    let interval_s = (time_s(samples.last()) - time_s(samples.first())) / (samples.len() - 1) as f64;
    let swing_s = std::f64::consts::TAU / fit.line().natural_rad_s();
    let mut doubts = Vec::new();
    if swing_s < 4.0 * interval_s {
        doubts.push(format!(
            "a swing of the line takes {swing_s:.4} s, less than four samples; record more often"
        ));
    }
    let alike_s = fit.correlated_samples * interval_s;
    // A single sample is alike to itself.
    let is_alike = fit.correlated_samples > 2.0 && alike_s > MOST_ALIKE * swing_s;
    if is_alike && fit.rms_kpa > SMALL_RESIDUALS * fit.spread_kpa {
        doubts.push(format!(
            "what the fit leaves over, {:.3} kPa RMS, stays alike for {alike_s:.4} s, as long as swings of the line ({swing_s:.4} s) \
             and no noise: the model misses something, and the ± leave it out; check speed, start and what is held",
            fit.rms_kpa,
        ));
    }
    doubts
}
