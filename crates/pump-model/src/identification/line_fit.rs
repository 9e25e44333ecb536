//! Resistance, compliance and inertance from a measured pressure waveform, by nonlinear least squares on the
//! model.

use libm::{exp, sqrt};

use crate::line::line::Line;
use crate::pump::pump::Pump;
use crate::units::wrap;

use super::autocorrelation::{LAGS, correlated_samples};
use super::error::IdentificationError;
use super::estimate::Estimate;
use super::least_squares::{Found, Residuals};
use super::readings::Readings;
use super::recording::Recording;
use super::sought::{ANGLE, N, PRESSURE, SEARCHED, START, Sought, count};
use super::student::widening;
use super::watch::Watch;
use super::waveform::{WaveformResiduals, line_of};

/// Smallest part of the samples' variance that a fit of their shape must explain. Less is a Pearson
/// correlation below 0.32. With four parameters and 100 independent samples this is an F of 2.7, where 2.5
/// comes by chance once in twenty times.
const LEAST_EXPLAINED: f64 = 0.1;

/// Residuals that are a smaller part of the largest pressure are those of rounding.
const ROUNDING: f64 = 1e-12;

/// Line that was fitted to a waveform. A parameter that was not sought has the value it was held at and no
/// uncertainty.
///
/// Standard uncertainties come from the Jacobian and the residuals. Neighbouring residuals are alike. So n
/// samples count as n over the residuals' integrated autocorrelation time.
///
/// This holds for noise whose memory is short beside a swing of the line. A mismatch that returns with every
/// pulse is no noise, and the uncertainties leave it out: RMSE and correlation show it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LineFit {
    /// Resistance R, kPa s/mL.
    pub resistance_kpa_s_ml: Estimate,
    /// Compliance C, mL/kPa.
    pub compliance_ml_kpa: Estimate,
    /// Inertance L, kPa s²/mL.
    pub inertance_kpa_s2_ml: Estimate,
    /// Angle that is added to that of the motion, rad, within half a pitch either way.
    pub angle_rad: Estimate,
    /// Time that is added to that of the motion, s.
    pub start_s: Estimate,
    /// Reservoir pressure P_res, kPa absolute.
    pub reservoir_kpa: Estimate,
    /// Root of the mean square of the residuals, kPa.
    pub rms_kpa: f64,
    /// Standard deviation of the samples, kPa: the RMS that a fit of a constant pressure would have.
    pub spread_kpa: f64,
    /// Number of neighbouring samples that say as much as one independent sample.
    pub correlated_samples: f64,
    /// Number of steps of the search.
    pub steps: u32,
    /// Covariances of resistance, compliance, inertance, angle, start and reservoir in their units and in this order,
    /// widened as the standard uncertainties are; 0 for what was held. Twice the root of a variance covers 95 %.
    pub covariance: [[f64; N]; N],
}

impl LineFit {
    /// Fits the line of the recording's port, starting from the line of `pump`. The fit takes the pump's flow
    /// as known. It takes the motion as known except for what is sought of it.
    ///
    /// ```
    /// use pump_model::identification::{LineFit, PressureSample, Recording, RotorMotion, Sought};
    /// use pump_model::{ExactRun, Leg, Line, Port, Pump};
    /// let legs = [Leg::constant_speed(0.0, 10.0)];
    /// // Readings on a line with other L and C than the pump's.
    /// let other = Line { inertance_kpa_s2_ml: 0.006, compliance_ml_kpa: 0.03, ..Line::PUBLISHED };
    /// let pump = Pump::three_roller();
    /// let real = Pump::new(*pump.geometry(), *pump.roller_volume(), other, other)?;
    /// let mut run = ExactRun::from_rest(&real, Port::Outlet, legs);
    /// let samples: Vec<_> = (0..500)
    ///     .map(|n| f64::from(n) * 2e-3)
    ///     .map(|time_s| PressureSample { time_s, pressure_kpa: run.pressure_kpa(time_s) })
    ///     .collect();
    /// let recording = Recording { port: Port::Outlet, samples: &samples, motion: RotorMotion::FromRest(&legs) };
    /// let fit = LineFit::of(&pump, &recording, Sought::LINE)?;
    /// assert!((fit.inertance_kpa_s2_ml.value - 0.006).abs() < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Refuses recordings that are no record, parameters that cannot be told apart, and samples that do not
    /// determine them. Also fails if the fit explains too little or does not converge.
    pub fn of(pump: &Pump, recording: &Recording<'_>, sought: Sought) -> Result<Self, IdentificationError> {
        Self::of_while(pump, recording, sought, &|| true)
    }

    /// Fits the line as [`Self::of`] does, and asks `goes_on` many times a millisecond whether to go on.
    ///
    /// # Errors
    ///
    /// Returns [`IdentificationError::Stopped`] once `goes_on` returned false, and otherwise the errors of
    /// [`Self::of`].
    pub fn of_while(
        pump: &Pump,
        recording: &Recording<'_>,
        sought: Sought,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Self, IdentificationError> {
        let watch = Watch::new(goes_on);
        let fit = Self::watched(pump, recording, sought, &watch);
        if watch.is_stopped() { Err(IdentificationError::Stopped) } else { fit }
    }

    fn watched(
        pump: &Pump,
        recording: &Recording<'_>,
        sought: Sought,
        watch: &Watch<'_>,
    ) -> Result<Self, IdentificationError> {
        recording.validate()?;
        let flags = sought.checked(recording)?;
        let line = pump.line(recording.port);
        line.validate()?;
        let waveform = WaveformResiduals { recording, pump, flags, watch };
        let found = waveform.best(line)?;
        let rms_kpa = sqrt(found.sum / recording.samples.len() as f64);
        let spread_kpa = recording.spread_kpa();
        converged(sought, (found.steps, found.converged()), rms_kpa, spread_kpa)?;
        let uncertainty = Uncertainty::of(&waveform, &found)?;
        let estimate = |n, value, unit| uncertainty.estimate(n, value, unit);
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
        // Parameters R, C and L that were held keep their bits.
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
            correlated_samples: uncertainty.correlated,
            steps: found.steps,
            covariance: uncertainty.covariance(&found.at),
        })
    }

    /// Returns the part of the samples' variance that the fit explains, 1 at most; negative if it is worse
    /// than a constant pressure.
    pub fn explained(&self) -> f64 {
        explained(self.rms_kpa, self.spread_kpa)
    }

    /// Returns the line that was found.
    pub fn line(&self) -> Line {
        Line {
            resistance_kpa_s_ml: self.resistance_kpa_s_ml.value,
            compliance_ml_kpa: self.compliance_ml_kpa.value,
            inertance_kpa_s2_ml: self.inertance_kpa_s2_ml.value,
            reservoir_kpa: self.reservoir_kpa.value,
        }
    }

    /// Returns the pressures of the fit at the times of the recording that was fitted, kPa absolute.
    ///
    /// # Errors
    ///
    /// Refuses a line that is not physical, and an undamped resonance at a steady speed.
    pub fn pressures_kpa<'a>(
        &self,
        pump: &'a Pump,
        recording: &Recording<'a>,
        line: &'a Line,
    ) -> Result<impl Iterator<Item = f64> + use<'a>, IdentificationError> {
        let curve = pump.curve(recording.port);
        let above = recording.model_kpa(curve, line, self.angle_rad.value, self.start_s.value, None)?;
        Ok(above.map(|kpa| line.reservoir_kpa + kpa))
    }
}

/// Refuses a fit that explains too little, or whose search did not end.
pub(super) fn converged(
    sought: Sought,
    (steps, has_ended): (u32, bool),
    rms_kpa: f64,
    spread_kpa: f64,
) -> Result<(), IdentificationError> {
    // This comes first: where the fit explains next to nothing, the search may not end either.
    let explained = explained(rms_kpa, spread_kpa);
    if sought.is_of_shape() && explained < LEAST_EXPLAINED {
        return Err(IdentificationError::Unexplained {
            explained_percent: 100.0 * explained,
            least_percent: 100.0 * LEAST_EXPLAINED,
        });
    }
    if !has_ended {
        return Err(IdentificationError::NotConverged { steps, rms_kpa });
    }
    Ok(())
}

/// Uncertainty of the parameters of a fit.
struct Uncertainty {
    flags: [bool; N],
    /// Covariances of the parameters if each residual had variance 1.
    covariances: [[f64; N]; N],
    /// Sum of squares of the residuals.
    sum: f64,
    /// Number of neighbouring samples that say as much as one independent sample.
    correlated: f64,
    /// Degrees of freedom.
    free: f64,
}

impl Uncertainty {
    fn of(waveform: &WaveformResiduals<'_>, found: &Found<N>) -> Result<Self, IdentificationError> {
        const NO_EFFECT: &str = "it has no effect on them that others do not have; seek fewer parameters";
        let covariances =
            found.rows.covariances().ok_or(undetermined(found.rows.singular().unwrap_or(0), NO_EFFECT))?;
        let (correlated, _) = correlated(waveform, &found.at)?;
        let independent = waveform.recording.samples.len() as f64 / correlated;
        let free = independent - count(waveform.flags) as f64;
        if free < 1.0 {
            let why = "the residual of the fit is so alike that they say no more than a few would; check \
                       speed, angle and what is held, or record for longer";
            let first = waveform.flags.iter().position(|is_sought| *is_sought).unwrap_or(0);
            return Err(undetermined(first, why));
        }
        Ok(Self { flags: waveform.flags, covariances, sum: found.sum, correlated, free })
    }

    /// Returns the estimate of a parameter whose value is `value`. Its unit is `unit` times that of the
    /// search.
    fn estimate(&self, n: usize, value: f64, unit: f64) -> Estimate {
        let is_sought = self.flags[n];
        let variance =
            if is_sought { unit * unit * self.covariances[n][n] * self.sum / self.free } else { 0.0 };
        Estimate::new(value, variance, self.free as u32)
    }

    /// Returns the covariances in the units of the parameters where the search ended.
    fn covariance(&self, at: &[f64; N]) -> [[f64; N]; N] {
        let wider = widening(self.free as u32);
        // The search seeks logarithms of R, C and L.
        let unit = |n: usize| match (self.flags[n], n) {
            (false, _) => 0.0,
            (true, 0..=2) => exp(at[n]),
            (true, _) => 1.0,
        };
        let scale = wider * wider * self.sum / self.free;
        core::array::from_fn(|n| core::array::from_fn(|k| scale * unit(n) * unit(k) * self.covariances[n][k]))
    }
}

/// Returns the number of neighbouring samples that say as much as one independent sample, and the sum of the squares of
/// the residuals, kPa².
pub(super) fn correlated(
    waveform: &WaveformResiduals<'_>,
    at: &[f64; N],
) -> Result<(f64, f64), IdentificationError> {
    let samples = waveform.recording.samples;
    let largest_kpa = samples.iter().fold(0.0, |most: f64, sample| most.max(sample.pressure_kpa.abs()));
    let sum_kpa2 = waveform.sum(at)?;
    // Rounding may repeat itself as the pressure does, but it says nothing of noise.
    if sqrt(sum_kpa2 / samples.len() as f64) <= ROUNDING * largest_kpa {
        return Ok((1.0, sum_kpa2));
    }
    let correlated = correlated_samples(waveform.residuals(&line_of(at), at)?);
    Ok((correlated.ok_or(IdentificationError::Alike { samples: LAGS })?, sum_kpa2))
}

/// Returns the error for a parameter that the samples do not determine.
pub(super) fn undetermined(n: usize, why: &'static str) -> IdentificationError {
    IdentificationError::Undetermined { of: Readings::Samples, parameter: SEARCHED[n], why }
}

/// Returns the explained part of the variance, 1 - (rms/spread)². Equal samples have nothing to be explained.
fn explained(rms_kpa: f64, spread_kpa: f64) -> f64 {
    if spread_kpa > 0.0 { 1.0 - (rms_kpa / spread_kpa) * (rms_kpa / spread_kpa) } else { 0.0 }
}
