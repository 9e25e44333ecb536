//! R, C and L from a measured pressure waveform, by nonlinear least squares on the model.

use crate::error::{Allowed, ModelError, within};
use crate::head::flow_curve::FlowCurve;
use crate::line::line::Line;
use crate::math::{exp, log, sqrt, wrap};
use crate::pump::pump::Pump;

use super::autocorrelation::{LAGS, correlated_samples};
use super::error::IdentificationError;
use super::estimate::Estimate;
use super::marquardt::{Found, MOST_STEPS, Residuals, search};
use super::recording::{Motion, Recording, SAMPLES};
use super::triangle::Triangle;

/// Parameters: ln R, ln C, ln L, angle in rad, start in s, pressure in kPa; the logarithms keep a line physical.
const N: usize = 6;
const ANGLE: usize = 3;
const START: usize = 4;
const PRESSURE: usize = 5;
const NAMES: [&str; N] =
    ["resistance", "compliance", "inertance", "start angle", "start time", "reservoir pressure"];

/// Change of each parameter by which its effect is measured; that of the pressure is known.
const PROBES: [f64; PRESSURE] = [1e-5, 1e-5, 1e-5, 1e-5, 1e-6];

/// Angles over a pitch, and natural frequencies beside the given line's, from which the search may start: the sum of
/// squares has other minima where the line swings too often or too late.
const ANGLES: u32 = 12;
const FREQUENCIES: [f64; 5] = [1.0, 0.6, 0.8, 1.25, 1.7];

/// How many of them are followed to their minimum.
const FOLLOWED: usize = 3;

/// Part of the samples' variance that a fit of their shape must explain: less is a Pearson correlation below 0.32. With
/// four parameters and 100 independent samples this is an F of 2.7, where 2.5 comes by chance once in twenty times.
const LEAST_EXPLAINED: f64 = 0.1;

/// What is sought; the rest is held as the pump and the recording have it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sought {
    /// R.
    pub resistance: bool,
    /// C.
    pub compliance: bool,
    /// L.
    pub inertance: bool,
    /// The angle, which is added to that of the motion.
    pub angle: bool,
    /// The start, which is added to the time of the motion; found only where the first guess is not far off.
    pub start: bool,
    /// The reservoir's pressure, and with it what the sensor is off by.
    pub pressure: bool,
}

impl Sought {
    /// R, C and L.
    pub const LINE: Self = Self {
        resistance: true,
        compliance: true,
        inertance: true,
        angle: false,
        start: false,
        pressure: false,
    };

    /// Whether anything is sought that the mean pressure does not tell.
    fn is_of_shape(self) -> bool {
        self.compliance || self.inertance || self.angle || self.start
    }

    fn flags(self) -> [bool; N] {
        [self.resistance, self.compliance, self.inertance, self.angle, self.start, self.pressure]
    }
}

/// A line that was fitted to a waveform. What was not sought has the value it was held at and no uncertainty.
///
/// Standard uncertainties come from the Jacobian and the residuals. Neighbouring residuals are alike, so n samples say
/// as much as n over the residuals' integrated autocorrelation time: that many count. This holds for noise whose memory
/// is short beside a swing of the line. A mismatch that returns with every pulse is no noise and is not in them: RMSE
/// and correlation show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineFit {
    /// R, kPa s/mL.
    pub resistance_kpa_s_ml: Estimate,
    /// C, mL/kPa.
    pub compliance_ml_kpa: Estimate,
    /// L, kPa s²/mL.
    pub inertance_kpa_s2_ml: Estimate,
    /// What is added to the angle of the motion, rad, within half a pitch either way.
    pub angle_rad: Estimate,
    /// What is added to the time of the motion, s.
    pub start_s: Estimate,
    /// P_res, kPa absolute.
    pub reservoir_kpa: Estimate,
    /// Root of the mean square of the residuals, kPa.
    pub rms_kpa: f64,
    /// Standard deviation of the samples, kPa: what a constant pressure would leave over.
    pub spread_kpa: f64,
    /// How many neighbouring samples say as much as one independent sample.
    pub correlated_samples: f64,
    /// Steps of the search.
    pub steps: u32,
}

impl LineFit {
    /// Fits the line of the recording's port, starting from `pump`'s. The pump's flow is taken as known, and so is the
    /// motion but for what is sought of it.
    ///
    /// ```
    /// use pump_model::identification::{LineFit, Motion, PressureSample, Recording, Sought};
    /// use pump_model::{ExactRun, Leg, Line, Port, Pump};
    /// let legs = [Leg::constant_speed(0.0, 10.0)];
    /// // What a line with other L and C than the pump's would show.
    /// let other = Line { inertance_kpa_s2_ml: 0.006, compliance_ml_kpa: 0.03, ..Line::PUBLISHED };
    /// let pump = Pump::three_roller();
    /// let real = Pump::new(*pump.geometry(), *pump.roller_volume(), other, other)?;
    /// let mut run = ExactRun::from_rest(&real, Port::Outlet, legs);
    /// let samples: Vec<_> = (0..500)
    ///     .map(|n| f64::from(n) * 2e-3)
    ///     .map(|time_s| PressureSample { time_s, pressure_kpa: run.pressure_kpa(time_s) })
    ///     .collect();
    /// let recording = Recording { port: Port::Outlet, samples: &samples, motion: Motion::FromRest(&legs) };
    /// let fit = LineFit::of(&pump, &recording, Sought::LINE)?;
    /// assert!((fit.inertance_kpa_s2_ml.value - 0.006).abs() < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(pump: &Pump, recording: &Recording<'_>, sought: Sought) -> Result<Self, IdentificationError> {
        recording.validate()?;
        if sought.angle && sought.start && matches!(recording.motion, Motion::Steady { .. }) {
            return Err(IdentificationError::Same { first: NAMES[ANGLE], second: NAMES[START] });
        }
        let flags = sought.flags();
        let parameters = flags.iter().filter(|is_sought| **is_sought).count();
        let given = recording.samples.len();
        if given <= parameters || parameters == 0 {
            return Err(IdentificationError::TooFew {
                given,
                of: SAMPLES,
                needed: parameters + 1,
                parameters,
            });
        }
        let line = pump.line(recording.port);
        line.validate()?;
        let problem = Problem { recording, curve: pump.curve(recording.port), flags };
        let found = problem.best(line)?;
        let rms_kpa = sqrt(found.sum / given as f64);
        let spread_kpa = recording.spread_kpa();
        // Also where the search did not end: that is why.
        let explained = explained(rms_kpa, spread_kpa);
        if sought.is_of_shape() && explained < LEAST_EXPLAINED {
            return Err(IdentificationError::Unexplained {
                explained_percent: 100.0 * explained,
                least_percent: 100.0 * LEAST_EXPLAINED,
            });
        }
        if found.steps == MOST_STEPS {
            return Err(IdentificationError::NotConverged { steps: MOST_STEPS, rms_kpa });
        }
        let undetermined =
            |n: usize, why| IdentificationError::Undetermined { of: SAMPLES, parameter: NAMES[n], why };
        const NO_EFFECT: &str = "it has no effect on them that others do not have; seek fewer parameters";
        let variances =
            found.rows.variances().ok_or(undetermined(found.rows.singular().unwrap_or(0), NO_EFFECT))?;
        let correlated = correlated_samples(problem.residuals(&line_of(&found.at), &found.at)?)
            .ok_or(IdentificationError::Alike { samples: LAGS })?;
        let independent = given as f64 / correlated;
        let free = independent - parameters as f64;
        if free < 1.0 {
            let why = "what the fit leaves over is so alike that they say no more than a few would; check speed, angle and what is held, or record for longer";
            let first = flags.iter().position(|is_sought| *is_sought).unwrap_or(0);
            return Err(undetermined(first, why));
        }
        let estimate = |n: usize, value: f64, unit: f64| {
            let variance = if flags[n] { unit * unit * variances[n] * found.sum / free } else { 0.0 };
            Estimate::new(value, variance, free as u32)
        };
        let [resistance, compliance, inertance] =
            [0, 1, 2].map(|n| estimate(n, exp(found.at[n]), exp(found.at[n])));
        for (n, estimate) in [resistance, compliance, inertance].iter().enumerate() {
            if flags[n] && !estimate.differs_from_zero() {
                let why = "twice its standard error exceeds it; record where it matters, or hold it";
                return Err(undetermined(n, why));
            }
        }
        let pitch_rad = pump.pitch_rad();
        let angle_rad = wrap(found.at[ANGLE] + 0.5 * pitch_rad, pitch_rad) - 0.5 * pitch_rad;
        // Where R, C or L were held their bits stay what they were.
        let held =
            |n: usize, found: Estimate, value: f64| if flags[n] { found } else { estimate(n, value, 1.0) };
        Ok(Self {
            resistance_kpa_s_ml: held(0, resistance, line.resistance_kpa_s_ml),
            compliance_ml_kpa: held(1, compliance, line.compliance_ml_kpa),
            inertance_kpa_s2_ml: held(2, inertance, line.inertance_kpa_s2_ml),
            angle_rad: estimate(ANGLE, if flags[ANGLE] { angle_rad } else { 0.0 }, 1.0),
            start_s: estimate(START, found.at[START], 1.0),
            reservoir_kpa: estimate(PRESSURE, found.at[PRESSURE], 1.0),
            rms_kpa,
            spread_kpa,
            correlated_samples: correlated,
            steps: found.steps,
        })
    }

    /// Part of the samples' variance that the fit explains, 1 at most; negative where it is worse than a constant
    /// pressure.
    pub fn explained(&self) -> f64 {
        explained(self.rms_kpa, self.spread_kpa)
    }

    /// The line that was found.
    pub fn line(&self) -> Line {
        Line {
            resistance_kpa_s_ml: self.resistance_kpa_s_ml.value,
            compliance_ml_kpa: self.compliance_ml_kpa.value,
            inertance_kpa_s2_ml: self.inertance_kpa_s2_ml.value,
            reservoir_kpa: self.reservoir_kpa.value,
        }
    }

    /// Pressures of the fit at the times of the recording that was fitted, kPa absolute.
    pub fn pressures_kpa<'a>(
        &self,
        pump: &'a Pump,
        recording: &Recording<'a>,
        line: &'a Line,
    ) -> Result<impl Iterator<Item = f64> + use<'a>, IdentificationError> {
        let curve = pump.curve(recording.port);
        let above = recording.model_kpa(curve, line, self.angle_rad.value, self.start_s.value)?;
        Ok(above.map(|kpa| line.reservoir_kpa + kpa))
    }
}

/// 1 - (rms/spread)². Samples that are all the same have nothing to be explained.
fn explained(rms_kpa: f64, spread_kpa: f64) -> f64 {
    if spread_kpa > 0.0 { 1.0 - (rms_kpa / spread_kpa) * (rms_kpa / spread_kpa) } else { 0.0 }
}

/// A recording whose line is sought.
struct Problem<'a> {
    recording: &'a Recording<'a>,
    curve: &'a FlowCurve,
    flags: [bool; N],
}

fn line_of(at: &[f64; N]) -> Line {
    Line {
        resistance_kpa_s_ml: exp(at[0]),
        compliance_ml_kpa: exp(at[1]),
        inertance_kpa_s2_ml: exp(at[2]),
        reservoir_kpa: at[PRESSURE],
    }
}

impl Problem<'_> {
    /// Measured less model, kPa, of the line and the motion at these parameters.
    fn residuals<'b>(
        &'b self,
        line: &'b Line,
        at: &[f64; N],
    ) -> Result<impl Iterator<Item = f64> + use<'b>, ModelError> {
        let model = self.recording.model_kpa(self.curve, line, at[ANGLE], at[START])?;
        let reservoir_kpa = line.reservoir_kpa;
        let pairs = self.recording.samples.iter().zip(model);
        Ok(pairs.map(move |(sample, kpa)| sample.pressure_kpa - reservoir_kpa - kpa))
    }

    /// Mean of the residuals and sum of their squares about it.
    fn spread(&self, at: &[f64; N]) -> Result<(f64, f64), ModelError> {
        let (mut count, mut mean, mut square) = (0.0, 0.0, 0.0);
        for residual in self.residuals(&line_of(at), at)? {
            count += 1.0;
            let from = residual - mean;
            mean += from / count;
            square += from * (residual - mean);
        }
        Ok((mean, square))
    }

    /// The best minimum that is reached from the best of many starts.
    fn best(&self, line: &Line) -> Result<Found<N>, IdentificationError> {
        if self.flags[0] {
            // Its logarithm is sought.
            let parameter = "line resistance to start from in kPa s/mL";
            within(parameter, line.resistance_kpa_s_ml, Allowed::POSITIVE)?;
        }
        let logarithms =
            [line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml].map(log);
        let [resistance, compliance, inertance] = logarithms;
        let angles = if self.flags[ANGLE] { ANGLES } else { 1 };
        let (both, either) = (self.flags[1] && self.flags[2], self.flags[1] || self.flags[2]);
        let frequencies = if either { FREQUENCIES.len() } else { 1 };
        let mut starts = [([0.0; N], f64::INFINITY); FOLLOWED];
        for (angle, frequency) in (0..angles).flat_map(|angle| (0..frequencies).map(move |n| (angle, n))) {
            // A frequency that is f times as large takes L C that is f² times as small.
            let shift = if both { 1.0 } else { 2.0 } * log(FREQUENCIES[frequency]);
            let lowered =
                |n: usize, logarithm: f64| if self.flags[n] { logarithm - shift } else { logarithm };
            let angle_rad = f64::from(angle) / f64::from(angles) * self.curve.pitch_rad();
            let mut at = [
                resistance,
                lowered(1, compliance),
                lowered(2, inertance),
                angle_rad,
                0.0,
                line.reservoir_kpa,
            ];
            let (mean, mut sum) = self.spread(&at)?;
            if self.flags[PRESSURE] {
                at[PRESSURE] += mean;
            } else {
                sum += mean * mean * self.recording.samples.len() as f64;
            }
            let place = starts.iter().take_while(|(_, better)| *better <= sum).count();
            if let Some(worse) = starts.get_mut(place..).filter(|worse| !worse.is_empty()) {
                worse.rotate_right(1);
                worse[0] = (at, sum);
            }
        }
        let mut best: Option<Found<N>> = None;
        for (at, _) in starts.into_iter().filter(|(_, sum)| sum.is_finite()) {
            let found = search(self, at)?;
            if best.is_none_or(|best| found.sum < best.sum) {
                best = Some(found);
            }
        }
        best.ok_or(IdentificationError::NotConverged { steps: 0, rms_kpa: f64::INFINITY })
    }
}

impl Residuals<N> for Problem<'_> {
    fn sum(&self, at: &[f64; N]) -> Result<f64, ModelError> {
        Ok(self.residuals(&line_of(at), at)?.map(|residual| residual * residual).sum())
    }

    fn rows(&self, at: &[f64; N]) -> Result<Triangle<N>, ModelError> {
        // Either side of each parameter but the pressure, all in step with the residuals.
        let probes: [[f64; N]; 2 * PRESSURE] = core::array::from_fn(|k| {
            let mut probe = *at;
            probe[k / 2] += if k % 2 == 0 { PROBES[k / 2] } else { -PROBES[k / 2] };
            probe
        });
        let lines = probes.map(|probe| line_of(&probe));
        let mut sides = [const { None }; 2 * PRESSURE];
        for (k, side) in sides.iter_mut().enumerate().filter(|(k, _)| self.flags[k / 2]) {
            let (angle_rad, start_s) = (probes[k][ANGLE], probes[k][START]);
            *side = Some(self.recording.model_kpa(self.curve, &lines[k], angle_rad, start_s)?);
        }
        let line = line_of(at);
        let mut triangle = Triangle::holding(self.flags);
        for residual in self.residuals(&line, at)? {
            let mut row = [0.0; N];
            for n in (0..PRESSURE).filter(|n| self.flags[*n]) {
                let [more, less] = [2 * n, 2 * n + 1].map(|k| sides[k].as_mut().and_then(Iterator::next));
                row[n] = more.zip(less).map_or(0.0, |(more, less)| (more - less) / (2.0 * PROBES[n]));
            }
            row[PRESSURE] = if self.flags[PRESSURE] { 1.0 } else { 0.0 };
            triangle.push(row, residual);
        }
        Ok(triangle)
    }
}
