//! Resistance, compliance and inertance of one line from several recordings of its pressure.

use libm::{exp, sqrt};

use super::super::error::IdentificationError;
use super::super::estimate::Estimate;
use super::super::line_fit::{converged, correlated, undetermined};
use super::super::readings::Readings;
use super::super::recording::RotorMotion;
use super::super::sought::{ANGLE, PRESSURE, SEARCHED, START, Sought};
use super::super::student::widening;
use super::super::watch::Watch;
use super::blocks::{OWN, SHARED, joined};
use super::recording::{JointRecording, RecordingFit};
use super::search::{End, Search, own_count};
use crate::error::{self, Allowed, Parameter};
use crate::line::line::Line;
use crate::pump::pump::Pump;
use crate::units::wrap;

/// Line that was fitted to several recordings at once. R, C, L and the reservoir are those of all recordings; each
/// recording has its own angle and start.
///
/// The information of the recordings adds, so a parameter that one recording leaves open is found in another.
/// Uncertainties come from the Jacobian of all samples and from their residuals together, and count correlated
/// samples of each recording as [`super::super::LineFit`] does.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct JointFit {
    /// Resistance R, kPa s/mL.
    pub resistance_kpa_s_ml: Estimate,
    /// Compliance C, mL/kPa.
    pub compliance_ml_kpa: Estimate,
    /// Inertance L, kPa s²/mL.
    pub inertance_kpa_s2_ml: Estimate,
    /// Reservoir pressure P_res, kPa absolute.
    pub reservoir_kpa: Estimate,
    /// Root of the mean square of the residuals of all samples, kPa.
    pub rms_kpa: f64,
    /// Root of the mean square of all samples about the mean of their recording, kPa.
    pub spread_kpa: f64,
    /// Number of independent samples.
    pub independent_samples: f64,
    /// Number of steps of the search.
    pub steps: u32,
    /// Covariances of resistance, compliance, inertance and reservoir in their units and in this order, widened as
    /// the standard uncertainties are; 0 for what was held.
    pub covariance: [[f64; SHARED]; SHARED],
}

impl JointFit {
    /// Fits the line of the recordings' port, starting from the line of `pump` at the port of the first. Recordings of
    /// both ports share one line, as hoses that are alike have. The fit takes R, C, L and the pressure
    /// from `sought`; each recording says itself whether its angle and its start are sought. What the fit finds of a
    /// recording alone is its [`JointRecording::found`].
    ///
    /// ```
    /// use pump_model::identification::{JointFit, JointRecording, PressureSample, Recording, RotorMotion, Sought};
    /// use pump_model::{ExactRun, Leg, Line, Port, Pump};
    /// // Readings at two speeds on a line with other L and C than the pump's.
    /// let other = Line { inertance_kpa_s2_ml: 0.006, compliance_ml_kpa: 0.03, ..Line::PUBLISHED };
    /// let pump = Pump::three_roller();
    /// let real = Pump::new(*pump.geometry(), *pump.roller_volume(), other, other)?;
    /// let motions = [6.0, 10.0].map(|speed_rad_s| [Leg::constant_speed(0.0, speed_rad_s)]);
    /// let samples = motions.map(|legs| {
    ///     let mut run = ExactRun::from_rest(&real, Port::Outlet, legs);
    ///     let sample = |time_s| PressureSample { time_s, pressure_kpa: run.pressure_kpa(time_s) };
    ///     (0..400).map(|n| f64::from(n) * 2e-3).map(sample).collect::<Vec<_>>()
    /// });
    /// let recording = |n: usize| Recording {
    ///     port: Port::Outlet,
    ///     samples: &samples[n],
    ///     motion: RotorMotion::FromRest(&motions[n]),
    /// };
    /// let mut recordings = [0, 1].map(|n| JointRecording::new(recording(n)).with_angle(true));
    /// let fit = JointFit::of(&pump, &mut recordings, Sought::LINE)?;
    /// assert!((fit.inertance_kpa_s2_ml.value - 0.006).abs() < 1e-8);
    /// assert!(recordings[1].found().is_some_and(|found| found.angle_rad.value.abs() < 1e-6));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Refuses no recordings, and what [`super::super::LineFit::of`] refuses.
    pub fn of(
        pump: &Pump,
        recordings: &mut [JointRecording<'_>],
        sought: Sought,
    ) -> Result<Self, IdentificationError> {
        Self::of_while(pump, recordings, sought, &|| true)
    }

    /// Fits the line as [`Self::of`] does, and asks `goes_on` many times a millisecond whether to go on.
    ///
    /// # Errors
    ///
    /// Returns [`IdentificationError::Stopped`] once `goes_on` returned false, and otherwise the errors of
    /// [`Self::of`].
    pub fn of_while(
        pump: &Pump,
        recordings: &mut [JointRecording<'_>],
        sought: Sought,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Self, IdentificationError> {
        let watch = Watch::new(goes_on);
        recordings.iter_mut().for_each(|recording| recording.found = None);
        let fit = Self::watched(pump, recordings, sought, &watch);
        if watch.is_stopped() { Err(IdentificationError::Stopped) } else { fit }
    }

    fn watched(
        pump: &Pump,
        records: &mut [JointRecording<'_>],
        sought: Sought,
        watch: &Watch<'_>,
    ) -> Result<Self, IdentificationError> {
        let flags = [sought.resistance, sought.compliance, sought.inertance, sought.pressure];
        let parameters = checked(records, flags)?;
        let port = records.first().map_or(crate::Port::Outlet, |record| record.recording.port);
        let line = pump.line(port);
        line.validate()?;
        if sought.resistance {
            // The search seeks the logarithm of R.
            error::within(Parameter::StartLineResistance, line.resistance_kpa_s_ml, Allowed::POSITIVE)?;
        }
        let mut search = Search { pump, records, flags, watch };
        let found = search
            .best(line)?
            .ok_or(IdentificationError::NotConverged { steps: 0, rms_kpa: f64::INFINITY })?;
        let all = Samples::of(&mut search, &found)?;
        let (rms_kpa, spread_kpa) = all.of_mean();
        let is_of_shape = sought.with_angle(search.records.iter().any(|record| record.seeks_angle));
        converged(is_of_shape, (found.steps, found.converged()), rms_kpa, spread_kpa)?;
        let certainty = Certainty::of(&search, &found, all.independent - parameters as f64)?;
        let given = [line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml];
        // Parameters R, C and L that were held keep their bits.
        let estimates: [Estimate; SHARED] = core::array::from_fn(|n| Estimate {
            value: match given.get(n) {
                Some(given) if !flags[n] => *given,
                Some(_) => certainty.units[n],
                None => found.shared[n],
            },
            standard: sqrt(certainty.covariance[n][n]),
        });
        for (n, estimate) in estimates.iter().enumerate().take(3) {
            if flags[n] && !estimate.differs_from_zero() {
                let why = "twice its standard error exceeds it; record where it matters, or hold it";
                return Err(undetermined(n, why));
            }
        }
        search.records.iter_mut().for_each(|record| certainty.tell(record, pump.pitch_rad()));
        let [resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa] = estimates;
        Ok(Self {
            resistance_kpa_s_ml,
            compliance_ml_kpa,
            inertance_kpa_s2_ml,
            reservoir_kpa,
            rms_kpa,
            spread_kpa,
            independent_samples: all.independent,
            steps: found.steps,
            covariance: certainty.covariance,
        })
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

    /// Returns the covariances of angle and start of a recording with resistance, compliance, inertance and reservoir.
    pub fn covariance_with_line(&self, one: &RecordingFit) -> [[f64; SHARED]; OWN] {
        one.responses.map(|by| {
            core::array::from_fn(|k| by.iter().zip(&self.covariance).map(|(by, row)| by * row[k]).sum())
        })
    }

    /// Returns the covariances of angle and start of one recording with those of another. They have the line in
    /// common.
    pub fn covariance_between(&self, one: &RecordingFit, other: &RecordingFit) -> [[f64; OWN]; OWN] {
        self.covariance_with_line(one).map(|row| {
            core::array::from_fn(|n| row.iter().zip(&other.responses[n]).map(|(row, by)| row * by).sum())
        })
    }
}

/// Places of the shared parameters in the order of the search for one recording.
const PLACES: [usize; SHARED] = [0, 1, 2, PRESSURE];

/// Sums over the samples of all recordings.
#[derive(Default)]
struct Samples {
    count: f64,
    independent: f64,
    squares_kpa2: f64,
    spread_kpa2: f64,
}

impl Samples {
    /// Returns the sums where the search ended, and tells each record its own.
    fn of(search: &mut Search<'_, '_>, found: &End) -> Result<Self, IdentificationError> {
        let mut all = Self::default();
        for n in 0..search.records.len() {
            let record = search.records[n];
            let at = joined(&found.shared, &record.room.own);
            let (correlated, sum_kpa2) = correlated(&search.waveform(&record), &at)?;
            let count = record.recording.samples.len() as f64;
            let spread_kpa = record.recording.spread_kpa();
            all.count += count;
            all.independent += count / correlated;
            all.squares_kpa2 += sum_kpa2;
            all.spread_kpa2 += count * spread_kpa * spread_kpa;
            search.records[n].found = Some(RecordingFit {
                angle_rad: Estimate { value: at[ANGLE], standard: 0.0 },
                start_s: Estimate { value: at[START], standard: 0.0 },
                rms_kpa: sqrt(sum_kpa2 / count),
                spread_kpa,
                correlated_samples: correlated,
                responses: [[0.0; SHARED]; OWN],
                covariance: [[0.0; OWN]; OWN],
            });
        }
        Ok(all)
    }

    /// Returns the RMS of the residuals, and that of the samples about the means of their recordings, kPa.
    fn of_mean(&self) -> (f64, f64) {
        (sqrt(self.squares_kpa2 / self.count), sqrt(self.spread_kpa2 / self.count))
    }
}

/// Uncertainty of the parameters where the search ended.
struct Certainty {
    /// Covariances of R, C, L and the reservoir in their units.
    covariance: [[f64; SHARED]; SHARED],
    /// Units of the search: R, C and L, whose logarithms it seeks, and 1 kPa.
    units: [f64; SHARED],
    /// Factor of the covariances if each residual had its variance.
    scale: f64,
}

impl Certainty {
    fn of(search: &Search<'_, '_>, found: &End, free: f64) -> Result<Self, IdentificationError> {
        let (flags, rows) = (search.flags, search.shared());
        let first = flags.iter().position(|is_sought| *is_sought).map_or(ANGLE, |n| PLACES[n]);
        if free < 1.0 {
            let why = "the residuals of the fit are so alike that they say no more than a few would; check \
                       speeds, angles and what is held, or record for longer";
            return Err(undetermined(first, why));
        }
        let own = search.records.iter().find_map(|record| record.room.block.singular());
        let singular = own.or(rows.singular().map(|n| PLACES[n]));
        let Some(covariances) = rows.covariances().filter(|_| singular.is_none()) else {
            let why = "it has no effect on them that others do not have; seek fewer parameters";
            return Err(undetermined(singular.unwrap_or(first), why));
        };
        let wider = widening(free as u32);
        let scale = wider * wider * found.sum / free;
        let units = [exp(found.shared[0]), exp(found.shared[1]), exp(found.shared[2]), 1.0];
        let covariance = core::array::from_fn(|n| {
            core::array::from_fn(|k| {
                let is_sought = flags[n] && flags[k];
                if is_sought { scale * units[n] * units[k] * covariances[n][k] } else { 0.0 }
            })
        });
        Ok(Self { covariance, units, scale })
    }

    /// Tells a record what was found of it alone.
    fn tell(&self, record: &mut JointRecording<'_>, pitch_rad: f64) {
        let (block, own) = (record.room.block, record.room.own);
        let alone = block.own_covariances();
        let responses = block.responses().map(|row| core::array::from_fn(|k| row[k] / self.units[k]));
        let covariance: [[f64; OWN]; OWN] = core::array::from_fn(|n| {
            core::array::from_fn(|m| {
                self.scale * alone[n][m] + product(&responses[n], &self.covariance, &responses[m])
            })
        });
        let angle_rad = wrap(own[0] + 0.5 * pitch_rad, pitch_rad) - 0.5 * pitch_rad;
        let angle_rad = if record.seeks_angle { angle_rad } else { 0.0 };
        if let Some(found) = &mut record.found {
            found.angle_rad = Estimate { value: angle_rad, standard: sqrt(covariance[0][0]) };
            found.start_s = Estimate { value: own[1], standard: sqrt(covariance[1][1]) };
            found.responses = responses;
            found.covariance = covariance;
        }
    }
}

/// Returns x M y.
fn product(x: &[f64; SHARED], matrix: &[[f64; SHARED]; SHARED], y: &[f64; SHARED]) -> f64 {
    let dot = |row: &[f64; SHARED]| row.iter().zip(y).map(|(m, y)| m * y).sum::<f64>();
    x.iter().zip(matrix).map(|(x, row)| x * dot(row)).sum()
}

/// Returns the number of parameters. Refuses recordings that are no records, parameters that cannot be told apart, and
/// fewer samples than parameters.
fn checked(records: &[JointRecording<'_>], flags: [bool; SHARED]) -> Result<usize, IdentificationError> {
    let of = Readings::Samples;
    for record in records {
        record.recording.validate()?;
        error::within(Parameter::PressureUncertainty, record.standard_kpa, Allowed::POSITIVE)?;
        let is_steady = matches!(record.recording.motion, RotorMotion::Steady { .. });
        if record.seeks_angle && record.seeks_start && is_steady {
            return Err(IdentificationError::Same { first: SEARCHED[ANGLE], second: SEARCHED[START] });
        }
        let (parameters, given) = (own_count(record), record.recording.samples.len());
        if given <= parameters {
            return Err(IdentificationError::TooFew { given, of, needed: parameters + 1, parameters });
        }
    }
    let own: usize = records.iter().map(own_count).sum();
    let parameters = own + flags.into_iter().filter(|is_sought| *is_sought).count();
    let given: usize = records.iter().map(|record| record.recording.samples.len()).sum();
    if given <= parameters || parameters == 0 {
        return Err(IdentificationError::TooFew { given, of, needed: parameters + 1, parameters });
    }
    Ok(parameters)
}
