//! R, C and L from a pressure waveform, with their warnings.

use pump_model::identification::{
    Estimate, IdentificationError, LineFit, PressureSample, Recording, RotorMotion, Sought,
};
use pump_model::units::{degrees, rpm};
use pump_model::{Leg, Line, Port, Pump};

use super::identified::{Identified, Parameter};
use super::thinned::Thinned;
use crate::export::Fitted;
use crate::notice::Notice;

/// The way in which a rotor came to its speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Begin {
    /// Ramp from rest to the speed.
    Ramp {
        /// Acceleration of the ramp, in rad/s², positive.
        acceleration_rad_s2: f64,
    },
    /// Step from rest to the full speed at once.
    Step,
    /// Steady speed since long before the record.
    Steady,
}

/// The motion of the rotor while a pressure was recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turning {
    /// Way in which the rotor came to its speed.
    pub begin: Begin,
    /// Time in the record at which the rotor began to turn, in s. A steady speed does not use it.
    pub start_s: f64,
    /// Angle of the rotor at the start, in rad. With a steady speed it is the angle at time 0.
    pub angle_rad: f64,
    /// Speed that the rotor came to, in rad/s. Negative in reverse.
    pub speed_rad_s: f64,
}

impl Turning {
    /// Returns the legs of the motion from rest.
    pub fn legs(&self) -> Vec<Leg> {
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

    /// Returns the motion, whose [`Self::legs`] from rest are given.
    pub fn motion<'a>(&self, legs: &'a [Leg]) -> RotorMotion<'a> {
        match self.begin {
            Begin::Steady => RotorMotion::Steady { angle_rad: self.angle_rad, speed_rad_s: self.speed_rad_s },
            Begin::Ramp { .. } | Begin::Step => RotorMotion::FromRest(legs),
        }
    }
}

/// Fraction of a swing of the line over which neighbouring residuals may be alike and still be noise.
///
/// A residual that swings with the line has an integrated autocorrelation time of 1/pi of a swing. With a
/// third of its variance in white noise, two thirds of that time remain.
const MOST_ALIKE: f64 = 0.2;

/// Fraction of the samples' standard deviation below which the RMS of the residuals is small, alike or not.
const SMALL_RESIDUALS: f64 = 0.05;

/// Returns the time of a swing of a line, in s.
pub(super) fn swing_s(line: &Line) -> f64 {
    std::f64::consts::TAU / line.natural_rad_s()
}

/// Fits the line of a port to a waveform, starting from the line of `pump`.
///
/// A long recording is thinned to the samples that the fit needs. The headline says so, and [`Identified::rows`].
///
/// # Errors
/// Returns the [`IdentificationError`] of samples or a motion that determine no line.
pub fn identified_line(
    pump: &Pump,
    port: Port,
    samples: &[PressureSample],
    turning: &Turning,
    sought: Sought,
) -> Result<Identified, IdentificationError> {
    identified_line_while(pump, port, samples, turning, sought, &|| true)
}

/// Fits the line as [`identified_line`] does, and asks `goes_on` many times a millisecond whether to go on.
///
/// # Errors
/// Returns [`IdentificationError::Stopped`] once `goes_on` returned false, and otherwise the errors of
/// [`identified_line`].
pub fn identified_line_while(
    pump: &Pump,
    port: Port,
    samples: &[PressureSample],
    turning: &Turning,
    sought: Sought,
    goes_on: &dyn Fn() -> bool,
) -> Result<Identified, IdentificationError> {
    let Turning { start_s, angle_rad, speed_rad_s, .. } = *turning;
    let legs = turning.legs();
    let motion = turning.motion(&legs);
    let rows = samples.len();
    let pitch_s = pump.pitch_rad() / speed_rad_s.abs();
    let Thinned { samples, words } = Thinned::of(samples, f64::min(swing_s(pump.line(port)), pitch_s));
    let samples = &*samples;
    let recording = Recording { port, samples, motion };
    let fit = LineFit::of_while(pump, &recording, sought, goes_on)?;
    let line = fit.line();
    let points: Vec<_> = samples
        .iter()
        .zip(fit.pressures_kpa(pump, &recording, &line)?)
        .map(|(sample, fitted)| Fitted { x: sample.time_s, measured: sample.pressure_kpa, fitted })
        .collect();
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
    let residuals = ResidualSize {
        rms_kpa: fit.rms_kpa,
        spread_kpa: fit.spread_kpa,
        correlated_samples: fit.correlated_samples,
    };
    Ok(Identified {
        kind: "line",
        port,
        headline: format!(
            "{} line at {:.4} r/min, {words} worth {independent:.0} independent ones",
            port.name(),
            rpm(speed_rad_s),
        ),
        parameters: parameters.collect(),
        rows,
        independent,
        points,
        covariance: covariance(&fit, sought),
        warnings: doubts(&residuals, &line, samples).into_iter().map(Notice::from).collect(),
        line,
        nozzle: None,
    }
    .with_weak_correlation(true))
}

/// Returns an estimate, moved by a number that is known.
pub(super) fn moved(found: Estimate, by: f64) -> Estimate {
    Estimate { value: found.value + by, ..found }
}

/// Returns the covariances of the parameters that were sought, in the order and the units of the report.
fn covariance(fit: &LineFit, sought: Sought) -> Vec<f64> {
    // Places in the fit's order, and the report's units.
    let reported = [
        (sought.resistance, 0, 1.0),
        (sought.compliance, 1, 1.0),
        (sought.inertance, 2, 1.0),
        (sought.pressure, 5, 1.0),
        (sought.angle, 3, degrees(1.0)),
        (sought.start, 4, 1.0),
    ];
    let found = || reported.iter().filter(|(is_sought, ..)| *is_sought);
    let row = |&(_, row, unit): &(bool, usize, f64)| {
        found()
            .map(move |&(_, column, other): &(bool, usize, f64)| unit * other * fit.covariance[row][column])
    };
    found().flat_map(row).collect()
}

/// Size of the residuals of a fit, beside the samples.
pub(super) struct ResidualSize {
    /// RMS of the residuals, in kPa.
    pub(super) rms_kpa: f64,
    /// Standard deviation of the samples, in kPa.
    pub(super) spread_kpa: f64,
    /// Number of neighbouring samples that say as much as one independent sample.
    pub(super) correlated_samples: f64,
}

/// Warns if swings of the line pass between the samples, and if the residuals are no noise.
pub(super) fn doubts(residuals: &ResidualSize, line: &Line, samples: &[PressureSample]) -> Vec<String> {
    let time_s = |sample: Option<&PressureSample>| sample.map_or(0.0, |sample| sample.time_s);
    let interval_s = (time_s(samples.last()) - time_s(samples.first())) / (samples.len() - 1) as f64;
    let swing_s = swing_s(line);
    let mut doubts = Vec::new();
    if swing_s < 4.0 * interval_s {
        doubts.push(format!(
            "a swing of the line takes {swing_s:.4} s, less than four samples; record more often"
        ));
    }
    let alike_s = residuals.correlated_samples * interval_s;
    // A single sample is always alike to itself.
    let is_alike = residuals.correlated_samples > 2.0 && alike_s > MOST_ALIKE * swing_s;
    if is_alike && residuals.rms_kpa > SMALL_RESIDUALS * residuals.spread_kpa {
        doubts.push(format!(
            "the residual of the fit, {:.3} kPa RMS, stays alike for {alike_s:.4} s, too long for noise \
             beside a swing of the line ({swing_s:.4} s): the model misses something that the ± do not \
             contain; check speed, start and the parameters that are held",
            residuals.rms_kpa,
        ));
    }
    doubts
}
