//! R, C and L of one line from several pressure waveforms, with their warnings.

use pump_model::identification::{
    Estimate, IdentificationError, JointFit, JointRecording, PressureSample, Recording, RecordingFit, Sought,
};
use pump_model::units::degrees;
use pump_model::{Line, Port, Pump, metrics};

use super::WEAK_PEARSON;
use super::identified::Parameter;
use super::pressure_record::{ResidualSize, Turning, doubts, moved, swing_s};
use super::thinned::Thinned;
use crate::export::Fitted;

/// A pressure waveform, one of several of a line.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureRecord {
    /// Samples in order of time.
    pub samples: Vec<PressureSample>,
    /// Motion of the rotor meanwhile.
    pub turning: Turning,
    /// True if the angle at the start is sought.
    pub seeks_angle: bool,
    /// Standard deviation of the noise of a sample, in kPa. Only ratios between records count.
    pub standard_kpa: f64,
}

/// A waveform of several, with its fit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct JointlyRecorded {
    /// Start angle and start, found or held.
    pub parameters: [Parameter; 2],
    /// Number of samples that were given. The fit uses fewer of a long recording.
    pub rows: usize,
    /// Samples that the fit uses, and their fit, in kPa.
    pub points: Vec<Fitted>,
    /// Number of independent samples.
    pub independent: f64,
}

/// A line that was identified from several waveforms.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct JointlyIdentified {
    /// R, C, L and the reservoir's pressure, found or held.
    pub parameters: [Parameter; 4],
    /// Each waveform, in the order in which they were given.
    pub recordings: Vec<JointlyRecorded>,
    /// Covariances of the parameters that were sought, row by row: those of the line, then those of each recording, in
    /// their order and units.
    pub covariance: Vec<f64>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// Line with the parameters that were found.
    pub line: Line,
}

/// Fits the line of a port to several waveforms, starting from the line of `pump`, and asks `goes_on` many times a
/// millisecond whether to go on. R, C, L and the reservoir are those of all records. Each has its own start angle, and
/// its own start if that is sought.
///
/// # Errors
/// Returns the [`IdentificationError`] of records that determine no line, and [`IdentificationError::Stopped`] once
/// `goes_on` returned false.
pub fn identified_jointly_while(
    pump: &Pump,
    port: Port,
    records: &[PressureRecord],
    sought: Sought,
    goes_on: &dyn Fn() -> bool,
) -> Result<JointlyIdentified, IdentificationError> {
    let legs: Vec<_> = records.iter().map(|record| record.turning.legs()).collect();
    let thinned: Vec<_> = records
        .iter()
        .map(|record| {
            let pitch_s = pump.pitch_rad() / record.turning.speed_rad_s.abs();
            Thinned::of(&record.samples, f64::min(swing_s(pump.line(port)), pitch_s))
        })
        .collect();
    let mut recordings: Vec<_> = records
        .iter()
        .zip(&legs)
        .zip(&thinned)
        .map(|((record, legs), thinned)| {
            let motion = record.turning.motion(legs);
            JointRecording::new(Recording { port, samples: &thinned.samples, motion })
                .with_angle(record.seeks_angle)
                .with_start(sought.start)
                .with_standard_kpa(record.standard_kpa)
        })
        .collect();
    let fit = JointFit::of_while(pump, &mut recordings, sought, goes_on)?;
    let line = fit.line();
    let (mut told, mut warnings, mut fits) = (Vec::new(), Vec::new(), Vec::new());
    for (n, (recording, record)) in recordings.iter().zip(records).enumerate() {
        let Some(found) = recording.found() else { continue };
        let recorded = recorded(pump, (recording, found), record, &line)?;
        let place = format!("recording {} of {}", n + 1, records.len());
        warnings.extend(warned(found, &recorded, &line, recording.recording.samples, &place));
        told.push(recorded);
        fits.push(*found);
    }
    let parameter =
        |key, name, unit, found, is_sought: bool| Parameter { key, name, unit, found, is_held: !is_sought };
    Ok(JointlyIdentified {
        parameters: [
            parameter(
                "resistance_kpa_s_ml",
                "resistance",
                "kPa s/mL",
                fit.resistance_kpa_s_ml,
                sought.resistance,
            ),
            parameter("compliance_ml_kpa", "compliance", "mL/kPa", fit.compliance_ml_kpa, sought.compliance),
            parameter(
                "inertance_kpa_s2_ml",
                "inertance",
                "kPa s²/mL",
                fit.inertance_kpa_s2_ml,
                sought.inertance,
            ),
            parameter("reservoir_kpa", "reservoir", "kPa absolute", fit.reservoir_kpa, sought.pressure),
        ],
        covariance: covariance(&fit, &fits, &told, sought),
        recordings: told,
        warnings,
        line,
    })
}

/// Returns a recording with its fit.
fn recorded(
    pump: &Pump,
    (recording, found): (&JointRecording<'_>, &RecordingFit),
    record: &PressureRecord,
    line: &Line,
) -> Result<JointlyRecorded, IdentificationError> {
    let samples = recording.recording.samples;
    let fitted = found.pressures_kpa(pump, &recording.recording, line)?;
    let points = samples.iter().zip(fitted).map(|(sample, fitted)| Fitted {
        x: sample.time_s,
        measured: sample.pressure_kpa,
        fitted,
    });
    let angle: Estimate = moved(found.angle_rad, record.turning.angle_rad).times(degrees(1.0));
    let start = moved(found.start_s, record.turning.start_s);
    Ok(JointlyRecorded {
        parameters: [
            Parameter {
                key: "start_angle_deg",
                name: "start angle",
                unit: "°",
                found: angle,
                is_held: !recording.seeks_angle,
            },
            Parameter {
                key: "start_s",
                name: "start",
                unit: "s",
                found: start,
                is_held: !recording.seeks_start,
            },
        ],
        rows: record.samples.len(),
        points: points.collect(),
        independent: samples.len() as f64 / found.correlated_samples,
    })
}

/// Warns of a recording as of a fit to it alone.
fn warned(
    found: &RecordingFit,
    recorded: &JointlyRecorded,
    line: &Line,
    samples: &[PressureSample],
    place: &str,
) -> Vec<String> {
    let residuals = ResidualSize {
        rms_kpa: found.rms_kpa,
        spread_kpa: found.spread_kpa,
        correlated_samples: found.correlated_samples,
    };
    let mut warnings = doubts(&residuals, line, samples);
    let pearson = metrics::pearson(recorded.points.iter().map(|point| (point.fitted, point.measured)));
    if pearson.is_none_or(|pearson| pearson < WEAK_PEARSON) {
        let pearson = pearson.map_or("none".to_owned(), |pearson| format!("{pearson:.2}"));
        warnings.push(format!(
            "the model explains less than half of what was measured: Pearson {pearson}, below {WEAK_PEARSON}; check \
             its speed, angle and start"
        ));
    }
    warnings.iter().map(|warning| format!("{place}: {warning}")).collect()
}

/// Returns the covariances of the parameters that were sought: those of the line, then those of each recording.
fn covariance(fit: &JointFit, fits: &[RecordingFit], told: &[JointlyRecorded], sought: Sought) -> Vec<f64> {
    let line = [sought.resistance, sought.compliance, sought.inertance, sought.pressure];
    let shared: Vec<_> = (0..line.len()).filter(|n| line[*n]).collect();
    // Recording, place of its parameter, and the report's unit.
    let own: Vec<_> = told
        .iter()
        .enumerate()
        .flat_map(|(n, recorded)| {
            [degrees(1.0), 1.0]
                .into_iter()
                .enumerate()
                .filter(|(place, _)| !recorded.parameters[*place].is_held)
                .map(move |(place, unit)| (n, place, unit))
        })
        .collect();
    let with_line: Vec<_> = fits.iter().map(|found| fit.covariance_with_line(found)).collect();
    let mut all = Vec::new();
    for row in &shared {
        all.extend(shared.iter().map(|column| fit.covariance[*row][*column]));
        all.extend(own.iter().map(|(n, place, unit)| unit * with_line[*n][*place][*row]));
    }
    for (n, place, unit) in &own {
        all.extend(shared.iter().map(|column| unit * with_line[*n][*place][*column]));
        all.extend(own.iter().map(|(m, other, other_unit)| {
            let covariances =
                if n == m { fits[*n].covariance } else { fit.covariance_between(&fits[*n], &fits[*m]) };
            unit * other_unit * covariances[*place][*other]
        }));
    }
    all
}
