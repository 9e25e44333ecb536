//! Recorded waveforms as least-squares problems: residuals, their derivatives, and the search from many
//! starts.

use libm::{exp, log};

use crate::error::{Allowed, ModelError, Parameter, within};
use crate::head::flow_curve::FlowCurve;
use crate::line::line::Line;

use super::error::IdentificationError;
use super::least_squares::{Found, Residuals, Triangle, search};
use super::recording::Recording;
use super::sought::{ANGLE, N, PRESSURE, START};
use super::watch::Watch;

/// Change of each parameter by which its effect is measured. The effect of the pressure is known.
const PROBES: [f64; PRESSURE] = [1e-5, 1e-5, 1e-5, 1e-5, 1e-6];

/// Number of angles over a pitch from which the search may start.
///
/// The search also starts from natural frequencies beside the given line's. The sum of squares has other
/// minima where the line swings too often or too late.
const ANGLES: u32 = 12;
const FREQUENCIES: [f64; 5] = [1.0, 0.6, 0.8, 1.25, 1.7];

/// Number of starts that are followed to their minimum.
const FOLLOWED: usize = 3;

/// Recording whose line is sought.
pub(super) struct WaveformResiduals<'a> {
    pub(super) recording: &'a Recording<'a>,
    pub(super) curve: &'a FlowCurve,
    /// Parameters that are sought.
    pub(super) flags: [bool; N],
    /// Question whether the search goes on.
    pub(super) watch: &'a Watch<'a>,
}

/// Returns the line at these parameters.
pub(super) fn line_of(at: &[f64; N]) -> Line {
    Line {
        resistance_kpa_s_ml: exp(at[0]),
        compliance_ml_kpa: exp(at[1]),
        inertance_kpa_s2_ml: exp(at[2]),
        reservoir_kpa: at[PRESSURE],
    }
}

impl WaveformResiduals<'_> {
    /// Returns the residuals, measured less model, of the line and the motion at these parameters, kPa.
    pub(super) fn residuals<'b>(
        &'b self,
        line: &'b Line,
        at: &[f64; N],
    ) -> Result<impl Iterator<Item = f64> + use<'b>, ModelError> {
        let model = self.recording.model_kpa(self.curve, line, at[ANGLE], at[START], Some(self.watch))?;
        let reservoir_kpa = line.reservoir_kpa;
        let pairs = self.recording.samples.iter().zip(model);
        Ok(pairs.map(move |(sample, kpa)| sample.pressure_kpa - reservoir_kpa - kpa))
    }

    /// Returns the mean of the residuals and the sum of their squares about it.
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

    /// Returns the best of many starts with their sums of squares, the smallest first.
    fn starts(&self, line: &Line) -> Result<[([f64; N], f64); FOLLOWED], ModelError> {
        let logarithms =
            [line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml].map(log);
        let [resistance, compliance, inertance] = logarithms;
        let angles = if self.flags[ANGLE] { ANGLES } else { 1 };
        let (both, either) = (self.flags[1] && self.flags[2], self.flags[1] || self.flags[2]);
        let frequencies = if either { FREQUENCIES.len() } else { 1 };
        let mut starts = [([0.0; N], f64::INFINITY); FOLLOWED];
        for (angle, frequency) in (0..angles).flat_map(|angle| (0..frequencies).map(move |n| (angle, n))) {
            // A frequency f times as large takes an L C f² times as small.
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
        Ok(starts)
    }

    /// Returns the best minimum that the search reaches from the best of many starts.
    pub(super) fn best(&self, line: &Line) -> Result<Found<N>, IdentificationError> {
        if self.flags[0] {
            // The search seeks the logarithm of R.
            let parameter = Parameter::StartLineResistance;
            within(parameter, line.resistance_kpa_s_ml, Allowed::POSITIVE)?;
        }
        let starts = self.starts(line)?;
        let mut best: Option<Found<N>> = None;
        for (at, _) in starts.into_iter().filter(|(_, sum)| sum.is_finite()) {
            let found = search(self, at)?;
            if self.watch.is_stopped() {
                break;
            }
            if best.is_none_or(|best| found.sum < best.sum) {
                best = Some(found);
            }
        }
        best.ok_or(IdentificationError::NotConverged { steps: 0, rms_kpa: f64::INFINITY })
    }
}

impl Residuals<N> for WaveformResiduals<'_> {
    fn sum(&self, at: &[f64; N]) -> Result<f64, ModelError> {
        Ok(self.residuals(&line_of(at), at)?.map(|residual| residual * residual).sum())
    }

    fn rows(&self, at: &[f64; N]) -> Result<Triangle<N>, ModelError> {
        // Probes lie on either side of each parameter but the pressure, all in step with the residuals.
        let probes: [[f64; N]; 2 * PRESSURE] = core::array::from_fn(|k| {
            let mut probe = *at;
            probe[k / 2] += if k % 2 == 0 { PROBES[k / 2] } else { -PROBES[k / 2] };
            probe
        });
        let lines = probes.map(|probe| line_of(&probe));
        let mut sides = [const { None }; 2 * PRESSURE];
        for (k, side) in sides.iter_mut().enumerate().filter(|(k, _)| self.flags[k / 2]) {
            let (angle_rad, start_s) = (probes[k][ANGLE], probes[k][START]);
            *side = Some(self.recording.model_kpa(
                self.curve,
                &lines[k],
                angle_rad,
                start_s,
                Some(self.watch),
            )?);
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
