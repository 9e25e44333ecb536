//! Measured pressures, and those of the model at the same times.

use libm::sqrt;

use crate::error::{self, Allowed, ModelError, Parameter};
use crate::head::flow_curve::FlowCurve;
use crate::line::exact_run::ExactRun;
use crate::line::line::Line;
use crate::line::line_state::LineState;
use crate::line::periodic_state::periodic_state;
use crate::motion::leg::Leg;
use crate::port::Port;
use crate::pump::pump::Pump;
use crate::sensitivity::parameter::SensitivityParameter;
use crate::sensitivity::run::SensitiveRun;
use crate::sensitivity::samples::SensitiveColumns;
use crate::sensitivity::series::{LANES, SensitiveLanes};
use crate::sensitivity::state::SensitiveState;
use crate::units::wrap;

use super::error::{IdentificationError, refused, within};
use super::readings::Readings;
use super::sought::N;
use super::watch::Watch;

/// Number of samples that are computed at once.
const BLOCK: usize = 64;

/// Number of derivatives: by R, C, L, angle and start.
pub(super) const SLOPES: usize = 5;

/// Pressure at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureSample {
    /// Time of the sample, s.
    pub time_s: f64,
    /// Pressure at the port of the pump, kPa absolute.
    pub pressure_kpa: f64,
}

/// Motion of the rotor during a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RotorMotion<'a> {
    /// The rotor and the line started from rest. Each leg of constant acceleration starts when and where the
    /// one before ends.
    FromRest(&'a [Leg]),
    /// The rotor turned at constant speed for so long that start-up is forgotten.
    Steady {
        /// Angle at time 0, rad.
        angle_rad: f64,
        /// Speed, rad/s, other than 0; negative in reverse.
        speed_rad_s: f64,
    },
}

/// Recorded waveform of one port.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recording<'a> {
    /// Port at which the pressure was measured.
    pub port: Port,
    /// Samples in order of time.
    pub samples: &'a [PressureSample],
    /// Motion of the rotor during the recording, in the time of the samples.
    pub motion: RotorMotion<'a>,
}

impl<'a> Recording<'a> {
    /// Refuses what is no record.
    ///
    /// # Errors
    ///
    /// Refuses samples that are not finite or not in order of time, and motions without legs or speed.
    pub fn validate(&self) -> Result<(), IdentificationError> {
        let mut last_s = f64::NEG_INFINITY;
        for (n, sample) in self.samples.iter().enumerate() {
            within((Parameter::Time, Readings::Samples, n), sample.time_s, Allowed::FINITE)?;
            within(
                (Parameter::AbsolutePressure, Readings::Samples, n),
                sample.pressure_kpa,
                Allowed::FINITE,
            )?;
            if sample.time_s <= last_s {
                let allowed = "more than that of the sample before";
                return Err(refused((Parameter::Time, Readings::Samples, n), sample.time_s, allowed));
            }
            last_s = sample.time_s;
        }
        match self.motion {
            RotorMotion::FromRest(legs) => {
                let legs = legs.len() as f64;
                Ok(error::within(Parameter::Legs, legs, Allowed::POSITIVE)?)
            }
            RotorMotion::Steady { speed_rad_s, .. } => {
                let speed_rad_s = speed_rad_s.abs();
                Ok(error::within(Parameter::SpeedWithoutSign, speed_rad_s, Allowed::POSITIVE)?)
            }
        }
    }

    /// Returns the standard deviation of the samples about their mean, kPa.
    pub(super) fn spread_kpa(&self) -> f64 {
        let first_kpa = self.samples.first().map_or(0.0, |sample| sample.pressure_kpa);
        let (mut count, mut mean, mut square) = (0.0, 0.0, 0.0);
        for sample in self.samples {
            // Values count from the first sample, so equal samples have no spread at all.
            let value = sample.pressure_kpa - first_kpa;
            count += 1.0;
            let from = value - mean;
            mean += from / count;
            square += from * (value - mean);
        }
        sqrt(square / count)
    }

    /// Returns the legs of a motion at angles that are `angle_rad` larger and `start_s` later. That of a steady record
    /// begins where the angle was last a whole number of pitches, whose state is known, before the first sample.
    fn legs(&self, pitch_rad: f64, angle_rad: f64, start_s: f64) -> impl Iterator<Item = Leg> + use<'a> {
        let (legs, steady) = match self.motion {
            RotorMotion::FromRest(legs) => (legs, None),
            RotorMotion::Steady { angle_rad: at_0_rad, speed_rad_s } => {
                let first_s = self.samples.first().map_or(0.0, |sample| sample.time_s);
                let first_rad = at_0_rad + angle_rad + speed_rad_s * (first_s - start_s);
                let turned_rad = wrap(first_rad * speed_rad_s.signum(), pitch_rad);
                let leg = Leg {
                    start_s: first_s - turned_rad / speed_rad_s.abs(),
                    ..Leg::constant_speed(0.0, speed_rad_s)
                };
                (&[][..], Some(leg))
            }
        };
        let shifted = move |leg: &Leg| Leg {
            start_s: leg.start_s + start_s,
            angle_rad: leg.angle_rad + angle_rad,
            ..*leg
        };
        steady.into_iter().chain(legs.iter().map(shifted))
    }

    /// Returns the run of a line, which need not be the pump's, up to the first sample or before it. The motion is
    /// taken at angles that are `angle_rad` larger and `start_s` later.
    fn run(
        &self,
        curve: &'a FlowCurve,
        line: &'a Line,
        angle_rad: f64,
        start_s: f64,
    ) -> Result<ExactRun<'a, impl Iterator<Item = Leg> + use<'a>>, ModelError> {
        line.validate()?;
        let state = match self.motion {
            RotorMotion::FromRest(_) => LineState::AT_REST,
            RotorMotion::Steady { speed_rad_s, .. } => periodic_state(line, curve, self.port, speed_rad_s)?,
        };
        let legs = self.legs(curve.pitch_rad(), angle_rad, start_s);
        Ok(ExactRun::on(line, curve, self.port, legs, state))
    }

    /// Returns the model's pressures of [`Self::model_kpa`] with their exact derivatives by R, C, L, the angle and the
    /// start, kPa over the unit of each.
    pub(super) fn slopes_kpa<'b>(
        &self,
        pump: &'b Pump,
        line: &'b Line,
        (angle_rad, start_s): (f64, f64),
        watch: &'b Watch<'b>,
    ) -> Result<impl Iterator<Item = (f64, [f64; SLOPES])> + use<'a, 'b>, ModelError> {
        let mut run = self.sensitive_run(pump, line, (angle_rad, start_s))?;
        let begins_s = run.time_s();
        let goes_on = move || watch.goes_on();
        let state = move |sample: &PressureSample| {
            let state = if goes_on() { run.at_while(sample.time_s, &goes_on)? } else { return None };
            let [by_resistance, by_compliance, by_inertance, by_angle, ..] = state.pressure_by;
            // A later start has at each time the pressure of a little earlier, once it has begun.
            let by_start = if sample.time_s > begins_s { -run.pressure_rate_kpa_s() } else { 0.0 };
            let slopes = [by_resistance, by_compliance, by_inertance, by_angle, by_start];
            Some((state.state.above_reservoir_kpa, slopes))
        };
        Ok(self.samples.iter().map_while(state))
    }

    /// Returns the model's pressures above the reservoir at the times of the samples, kPa.
    ///
    /// The line need not be the pump's. The motion is taken at angles that are `angle_rad` larger and
    /// `start_s` later. The pressures end early once `watch` says so.
    pub(super) fn model_kpa(
        &self,
        curve: &'a FlowCurve,
        line: &'a Line,
        angle_rad: f64,
        start_s: f64,
        watch: Option<&'a Watch<'a>>,
    ) -> Result<impl Iterator<Item = f64> + use<'a>, ModelError> {
        let mut run = self.run(curve, line, angle_rad, start_s)?;
        let goes_on = move || watch.is_none_or(Watch::goes_on);
        let state = move |sample: &PressureSample| {
            if goes_on() { run.at_while(sample.time_s, &goes_on) } else { None }
        };
        Ok(self.samples.iter().map_while(state).map(|state| state.above_reservoir_kpa))
    }

    /// Returns the sum of the squares of the residuals of a line, measured less model, kPa². The line stands in place
    /// of that of `pump`, and the motion is taken at angles that are `angle_rad` larger and `start_s` later. It is
    /// what a likelihood needs, and takes least where the samples are at equal intervals and the speed is constant.
    /// Times that are rounded, and gaps, cost little more.
    ///
    /// # Errors
    ///
    /// Refuses a line that is not physical, samples or a motion that are not allowed, and an undamped resonance at a
    /// steady speed.
    pub fn residual_squares_kpa2(
        &self,
        pump: &'a Pump,
        line: &'a Line,
        angle_rad: f64,
        start_s: f64,
    ) -> Result<f64, IdentificationError> {
        self.validate()?;
        let mut squares = 0.0;
        let mut add = |measured_kpa: f64, above_kpa: f64| {
            let residual_kpa = measured_kpa - line.reservoir_kpa - above_kpa;
            squares += residual_kpa * residual_kpa;
        };
        let mut run = self.run(pump.curve(self.port), line, angle_rad, start_s)?;
        // Before the first leg the line is in its state at the start.
        let start_s = run.time_s();
        let (before, moving) = self.samples.split_at(self.samples.partition_point(|s| s.time_s < start_s));
        for sample in before {
            add(sample.pressure_kpa, run.state().above_reservoir_kpa);
        }
        match (self.interval_s(), moving.first()) {
            (Some(interval_s), Some(first)) => {
                run.at(first.time_s);
                let mut every = run.every(interval_s);
                let mut above_kpa = [0.0; BLOCK];
                for block in moving.chunks(BLOCK) {
                    every.fill_kpa(above_kpa.get_mut(..block.len()).unwrap_or_default());
                    for (sample, above_kpa) in block.iter().zip(above_kpa) {
                        add(sample.pressure_kpa, above_kpa);
                    }
                }
            }
            _ => {
                let mut series = run.in_series();
                let (mut times_s, mut above_kpa) = ([0.0; BLOCK], [0.0; BLOCK]);
                for block in moving.chunks(BLOCK) {
                    for (time_s, sample) in times_s.iter_mut().zip(block) {
                        *time_s = sample.time_s;
                    }
                    let times_s = times_s.get(..block.len()).unwrap_or_default();
                    series.fill_kpa(times_s, &mut above_kpa);
                    for (sample, above_kpa) in block.iter().zip(above_kpa) {
                        add(sample.pressure_kpa, above_kpa);
                    }
                }
            }
        }
        Ok(squares)
    }

    /// Returns the sum of [`Self::residual_squares_kpa2`] with its exact derivatives by R, C, L, the angle, the start
    /// and the pressure of the reservoir, kPa² over the unit of each. It takes several times as long.
    ///
    /// # Errors
    ///
    /// Refuses what [`Self::residual_squares_kpa2`] refuses.
    pub fn residual_squares_with_slopes(
        &self,
        pump: &Pump,
        line: &Line,
        angle_rad: f64,
        start_s: f64,
    ) -> Result<(f64, [f64; N]), IdentificationError> {
        self.validate()?;
        let (mut squares, mut slopes) = (0.0, [0.0; N]);
        let mut add = |measured_kpa: f64, above_kpa: f64, by: [f64; SLOPES]| {
            let residual_kpa = measured_kpa - line.reservoir_kpa - above_kpa;
            squares += residual_kpa * residual_kpa;
            let [by_r, by_c, by_l, by_angle, by_start] = by;
            for (slope, by) in slopes.iter_mut().zip([by_r, by_c, by_l, by_angle, by_start, 1.0]) {
                *slope -= 2.0 * residual_kpa * by;
            }
        };
        let mut run = self.sensitive_run(pump, line, (angle_rad, start_s))?;
        let begins_s = run.time_s();
        // Until the first leg the line is in its state at the start, which a later start leaves as it is.
        let moves = self.samples.partition_point(|sample| sample.time_s <= begins_s);
        let (before, moving) = self.samples.split_at(moves);
        let SensitiveState { state, pressure_by: [by_r, by_c, by_l, by_angle, ..], .. } = run.state();
        for sample in before {
            add(sample.pressure_kpa, state.above_reservoir_kpa, [by_r, by_c, by_l, by_angle, 0.0]);
        }
        let Some(first) = moving.first() else { return Ok((squares, slopes)) };
        run.at(first.time_s);
        let Some(interval_s) = self.interval_s() else {
            add_in_series(run, moving, add);
            return Ok((squares, slopes));
        };
        let mut every = run.every(interval_s);
        let (mut kpa, mut rate_kpa_s) = ([0.0; BLOCK], [0.0; BLOCK]);
        let mut kpa_by = [[0.0; BLOCK]; SensitivityParameter::COUNT];
        for block in moving.chunks(BLOCK) {
            let length = block.len();
            every.fill(SensitiveColumns {
                kpa: kpa.get_mut(..length).unwrap_or_default(),
                kpa_by: kpa_by.each_mut().map(|column| column.as_mut_slice()),
                flow_ml_rad: None,
                rate_kpa_s: Some(&mut rate_kpa_s),
            });
            for (n, sample) in block.iter().enumerate() {
                let [by_r, by_c, by_l, by_angle, _] = kpa_by.each_ref().map(|column| column[n]);
                add(sample.pressure_kpa, kpa[n], [by_r, by_c, by_l, by_angle, -rate_kpa_s[n]]);
            }
        }
        Ok((squares, slopes))
    }

    /// Returns the run of a line with its derivatives, as [`Self::run`] that of the line alone.
    fn sensitive_run<'b>(
        &self,
        pump: &'b Pump,
        line: &'b Line,
        (angle_rad, start_s): (f64, f64),
    ) -> Result<SensitiveRun<'b, impl Iterator<Item = Leg> + use<'a>>, ModelError> {
        line.validate()?;
        let start = match self.motion {
            RotorMotion::FromRest(_) => SensitiveState::AT_REST,
            RotorMotion::Steady { speed_rad_s, .. } => {
                SensitiveState::repeated(pump, line, self.port, speed_rad_s)?
            }
        };
        let legs = self.legs(pump.pitch_rad(), angle_rad, start_s);
        Ok(SensitiveRun::on(pump, line, self.port, legs, start))
    }

    /// Returns the interval of samples that are at equal intervals but for rounding, s.
    fn interval_s(&self) -> Option<f64> {
        let [first, .., last] = self.samples else { return None };
        let interval_s = (last.time_s - first.time_s) / (self.samples.len() - 1) as f64;
        let near_s = 1e-9 * interval_s;
        let mut numbered = self.samples.iter().enumerate();
        let is_equal = numbered
            .all(|(n, sample)| (sample.time_s - first.time_s - n as f64 * interval_s).abs() <= near_s);
        is_equal.then_some(interval_s)
    }

    /// Returns the pressures of the model of `pump` at the times of the samples, kPa absolute.
    ///
    /// # Errors
    ///
    /// Refuses samples or a motion that are not allowed, and an undamped resonance at a steady speed.
    pub fn predicted_kpa(
        &self,
        pump: &'a Pump,
    ) -> Result<impl Iterator<Item = f64> + use<'a>, IdentificationError> {
        self.validate()?;
        let line = pump.line(self.port);
        let above = self.model_kpa(pump.curve(self.port), line, 0.0, 0.0, None)?;
        Ok(above.map(|kpa| line.reservoir_kpa + kpa))
    }
}

/// Adds the pressures above the reservoir of `run` at samples of any times, with their derivatives.
fn add_in_series(
    run: SensitiveRun<'_, impl Iterator<Item = Leg>>,
    samples: &[PressureSample],
    mut add: impl FnMut(f64, f64, [f64; SLOPES]),
) {
    let (mut series, mut left) = (run.in_series(), samples);
    while !left.is_empty() {
        let mut times_s = [0.0; LANES];
        for (time_s, sample) in times_s.iter_mut().zip(left) {
            *time_s = sample.time_s;
        }
        let (count, lanes) = series.next(times_s.get(..left.len().min(LANES)).unwrap_or_default());
        let SensitiveLanes { kpa, kpa_by: [by_r, by_c, by_l, by_angle], rate_kpa_s } = lanes;
        let (now, later) = left.split_at(count);
        for (n, sample) in now.iter().enumerate() {
            add(sample.pressure_kpa, kpa[n], [by_r[n], by_c[n], by_l[n], by_angle[n], -rate_kpa_s[n]]);
        }
        left = later;
    }
}
