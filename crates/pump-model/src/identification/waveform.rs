//! Recorded waveforms as least-squares problems: residuals, their derivatives, and the search from many
//! starts.

use libm::{exp, log};

use crate::error::{Allowed, ModelError, Parameter, within};
use crate::line::line::Line;
use crate::pump::pump::Pump;

use super::error::IdentificationError;
use super::least_squares::{Found, Residuals, Triangle, search};
use super::recording::Recording;
use super::sought::{ANGLE, N, PRESSURE, START};
use super::watch::Watch;

/// Number of angles over a pitch from which the search may start.
///
/// The search also starts from natural frequencies beside the given line's. The sum of squares has other
/// minima where the line swings too often or too late.
pub(super) const ANGLES: u32 = 12;
pub(super) const FREQUENCIES: [f64; 5] = [1.0, 0.6, 0.8, 1.25, 1.7];

/// Number of starts that are followed to their minimum.
const FOLLOWED: usize = 3;

/// Recording whose line is sought.
pub(super) struct WaveformResiduals<'a> {
    pub(super) recording: &'a Recording<'a>,
    /// Pump whose rollers drive the line.
    pub(super) pump: &'a Pump,
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
        let model = self.recording.model_kpa(
            self.pump.curve(self.recording.port),
            line,
            at[ANGLE],
            at[START],
            Some(self.watch),
        )?;
        let reservoir_kpa = line.reservoir_kpa;
        let pairs = self.recording.samples.iter().zip(model);
        Ok(pairs.map(move |(sample, kpa)| sample.pressure_kpa - reservoir_kpa - kpa))
    }

    /// Returns the mean of the residuals and the sum of their squares about it.
    pub(super) fn spread(&self, at: &[f64; N]) -> Result<(f64, f64), ModelError> {
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
            let angle_rad = f64::from(angle) / f64::from(angles) * self.pump.pitch_rad();
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
        let line = line_of(at);
        let place = (at[ANGLE], at[START]);
        let model = self.recording.slopes_kpa(self.pump, &line, place, self.watch)?;
        // The search seeks the logarithms of R, C and L.
        let units = [line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml, 1.0, 1.0];
        let mut triangle = Triangle::holding(self.flags);
        for (sample, (kpa, slopes)) in self.recording.samples.iter().zip(model) {
            let [by_resistance, by_compliance, by_inertance, by_angle, by_start] =
                core::array::from_fn(|n| units[n] * slopes[n]);
            let all = [by_resistance, by_compliance, by_inertance, by_angle, by_start, 1.0];
            let row = core::array::from_fn(|n| if self.flags[n] { all[n] } else { 0.0 });
            triangle.push(row, sample.pressure_kpa - line.reservoir_kpa - kpa);
        }
        Ok(triangle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::recording::{PressureSample, RotorMotion};
    use crate::motion::leg::Leg;
    use crate::port::Port;

    #[test]
    fn the_slopes_of_a_record_are_those_of_differences() {
        let pump = Pump::three_roller();
        let samples: [PressureSample; 40] =
            core::array::from_fn(|n| PressureSample { time_s: 0.0171 * (n + 1) as f64, pressure_kpa: 90.0 });
        let ramp = Leg { duration_s: 0.2, acceleration_rad_s2: 45.0, ..Leg::constant_speed(0.3, 0.0) };
        let cruise = Leg { start_s: 0.2, ..Leg::constant_speed(ramp.end_angle_rad(), 9.0) };
        let legs = [ramp, cruise];
        let motions =
            [RotorMotion::FromRest(&legs), RotorMotion::Steady { angle_rad: 0.4, speed_rad_s: -8.0 }];
        for (port, motion) in [Port::Inlet, Port::Outlet].into_iter().zip(motions) {
            let recording = Recording { port, samples: &samples, motion };
            let goes_on = || true;
            let watch = Watch::new(&goes_on);
            let waveform =
                WaveformResiduals { recording: &recording, pump: &pump, flags: [true; N], watch: &watch };
            let at = [log(0.12), log(0.03), log(0.005), 0.15, 0.011, 88.0];
            let line = line_of(&at);
            let place = (at[ANGLE], at[START]);
            let mut slopes = recording.slopes_kpa(&pump, &line, place, &watch).unwrap();
            let mut exact = [[0.0; PRESSURE]; 40];
            for (place, (_, by)) in exact.iter_mut().zip(&mut slopes) {
                *place = by;
            }
            let units =
                [line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml, 1.0, 1.0];
            for (n, unit) in units.into_iter().enumerate() {
                let side = |step: f64| {
                    let mut beside = at;
                    beside[n] += step;
                    let line = line_of(&beside);
                    let mut residuals = [0.0; 40];
                    let found = waveform.residuals(&line, &beside).unwrap();
                    for (place, residual) in residuals.iter_mut().zip(found) {
                        *place = residual;
                    }
                    residuals
                };
                let (more, less) = (side(1e-5), side(-1e-5));
                let mut worst = 0.0_f64;
                let mut near_edges = 0;
                for (k, exact) in exact.iter().enumerate() {
                    let error = (unit * exact[n] - (less[k] - more[k]) / 2e-5).abs();
                    // A sample that an edge passes meanwhile has no such difference.
                    if error > 0.1 { near_edges += 1 } else { worst = worst.max(error) }
                }
                assert!(worst < 1e-4 && near_edges == 0, "{port} {n}: {worst:e} {near_edges}");
            }
        }
    }
}
