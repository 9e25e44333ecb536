//! The calibrations of a bench: runs to weigh, and fits to their readings.

use pump_bench::DoseRequest;
use pump_bench::calibration::{
    Calibration as DoseCalibration, Earlier, Expected, PhaseFit, ShortDose, Source, Stored, now_utc,
};
use pump_bench::record::Purpose;
use pump_bench::units::stated_reading;
use pump_ctl::plan::Cruise;
use pump_model::units::{degrees, rpm};
use pyo3::prelude::*;

use super::bench::{Bench, deliver};
use super::worker::Named;
use crate::argument::{Argument, Floats, speed, whole};
use crate::calibration::{Calibration, expected_of, fit_named, reading_ml, runs_of, scale_of};
use crate::python::advice;
use crate::python::errors::{self, value};

/// A run: speed (r/min), start angle (deg, or None), turned angle (deg), time, true if it was completed, and warnings.
type TurnedRun = (f64, Option<f64>, f64, String, bool, Vec<String>);

#[pymethods]
impl Bench {
    /// Makes a run of whole pitches, to be weighed.
    #[pyo3(signature = (speed_rpm, speed_rad_s, pitches, progress))]
    fn calibration_run<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
        pitches: &Bound<'py, PyAny>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<TurnedRun> {
        let (name, unit_rad_s) = speed::given(speed_rpm);
        let rad_s = match speed::speeds_rad_s(speed_rpm, speed_rad_s)? {
            Floats::One(rad_s) if rad_s > 0.0 => rad_s,
            Floats::One(rad_s) => {
                let given = rad_s / unit_rad_s;
                return Err(value(format_args!("{name} is {given}; allowed: a speed of more than 0")));
            }
            Floats::Many { shape, .. } => {
                return Err(value(format_args!(
                    "{name} is an array of shape {shape:?}; allowed: one number"
                )));
            }
        };
        let pitches: u32 = whole("pitches", pitches, 1, 100_000)?;
        self.worker.call(
            py,
            Named::Motion("calibration_run"),
            progress,
            |_| "the run was stopped and is on record; do not weigh a part of a run".to_owned(),
            move |held, signal| {
                let model = held.bench.model();
                let request = DoseRequest::new(
                    Purpose::Calibrate,
                    f64::from(pitches) * model.outlet_curve().pitch_ml(),
                )
                .with_cruise(Cruise::Speed { rad_s });
                let pitch_rad = model.pitch_rad();
                let session = held.session()?;
                let prepared = session.prepare(request)?;
                let delivered = deliver(session, &prepared, signal)?;
                let plan = &prepared.plan;
                let start = plan.start().is_known(pitch_rad).then_some(degrees(plan.start().angle_rad()));
                let turned_deg = degrees(plan.steps() as f64 * plan.step_rad());
                let warnings = advice::worded(&[prepared.warnings, delivered.warnings].concat());
                Ok((rpm(rad_s), start, turned_deg, now_utc(), delivered.completed, warnings))
            },
        )
    }

    /// Fits weighed runs, keeps the calibration and uses it from now on.
    #[pyo3(signature = (runs, fit, scale, tube, note))]
    fn calibrate(
        &self,
        py: Python<'_>,
        runs: &Bound<'_, PyAny>,
        fit: &str,
        scale: Option<&Bound<'_, PyAny>>,
        tube: Option<String>,
        note: Option<String>,
    ) -> PyResult<Calibration> {
        let (runs, fit) = (runs_of(runs)?, fit_named(fit)?);
        let expected = expected_of(scale, self.bench.file(), &runs)?;
        let expected = self.bench.with_drop(&expected).map_err(|error| errors::dose(py, error))?;
        self.kept(py, "calibrate", move |file, before| {
            let mut calibration =
                DoseCalibration::of_runs(file, Source::Guided, runs, fit, &expected, before)?;
            (calibration.tube, calibration.note) = (tube, note);
            Ok((calibration, ()))
        })
        .map(|(stored, ())| stored)
    }

    /// Calibrates by the reading of the last dose.
    #[pyo3(signature = (reading, add, anew, anyway, scale, tube, note))]
    #[expect(clippy::too_many_arguments, reason = "the arguments of the Python method")]
    fn calibrate_last(
        &self,
        py: Python<'_>,
        reading: &str,
        add: bool,
        anew: bool,
        anyway: bool,
        scale: Option<&Bound<'_, PyAny>>,
        tube: Option<String>,
        note: Option<String>,
    ) -> PyResult<Calibration> {
        let earlier = match (add, anew) {
            (true, true) => return Err(value("add and anew exclude each other; give one of them")),
            (true, false) => Earlier::Added,
            (false, true) => Earlier::Left,
            (false, false) => Earlier::Joined,
        };
        let reading = stated_reading(reading).map_err(|error| value(format_args!("reading: {error}")))?;
        let scale = scale.map(scale_of).transpose()?;
        let (name, degc) = self.fluid.clone();
        let stored = self.worker.call(
            py,
            Named::Entry("calibrate_last"),
            None,
            |stored: &Stored| format!("calibration {} is kept", stored.version),
            move |held, _| {
                held.session()?;
                let file = held.bench.file_of_last_dose(name.as_deref(), degc)?;
                let expected = match scale {
                    Some(scale) => Expected::of(&file, scale.volume_ml(file.fluid.density_kg_m3)),
                    None => Expected::of_digits(&file, &reading),
                };
                let weighed = held.bench.weigh_last_dose(&file, &reading, earlier, &expected)?;
                if !anyway {
                    weighed.check_likely()?;
                }
                let mut weighed = weighed.calibration;
                weighed.tube = tube.or(weighed.tube);
                weighed.note = note;
                held.bench.keep_weighing(weighed)
            },
        )?;
        Ok(Calibration(stored))
    }

    /// Fits short doses, keeps the zero angle that they show and uses it from now on.
    ///
    /// Returns the calibration, and roller volume (mL), engagement angle (rad) and zero (rad), each with its standard
    /// uncertainty.
    #[pyo3(signature = (doses, scale, tube, note))]
    fn calibrate_phase(
        &self,
        py: Python<'_>,
        doses: Vec<(f64, f64, f64, Option<f64>)>,
        scale: Option<&Bound<'_, PyAny>>,
        tube: Option<String>,
        note: Option<String>,
    ) -> PyResult<(Calibration, [(f64, f64); 3])> {
        let doses: Vec<ShortDose> = doses
            .into_iter()
            .map(|(start_angle_deg, turned_deg, volume_ml, speed_rpm)| ShortDose {
                start_angle_deg,
                turned_deg,
                volume_ml,
                speed_rpm,
            })
            .collect();
        let expected = Expected::of(self.bench.file(), reading_ml(scale, self.bench.file())?);
        self.kept(py, "calibrate_phase", move |file, before| {
            let (mut calibration, found) = DoseCalibration::of_short_doses(file, doses, &expected, before)?;
            calibration.tube = tube.or(calibration.tube);
            calibration.note = note;
            Ok((calibration, numbers(&found)))
        })
    }

    /// Returns every calibration of this bench, oldest first.
    fn calibrations(&self) -> PyResult<Vec<Calibration>> {
        let all = self.bench.calibrations().list().map_err(errors::calibration)?;
        Ok(all.into_iter().map(Calibration).collect())
    }

    /// Calibration that doses use.
    #[getter]
    fn calibration(&self) -> PyResult<Option<Calibration>> {
        let active = self.bench.calibrations().active().map_err(errors::calibration)?;
        Ok(active.map(Calibration))
    }

    /// Makes doses use another calibration, or none, from now on.
    #[pyo3(signature = (version))]
    fn use_calibration(&self, py: Python<'_>, version: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let version = version.map(|version| whole("version", version, 1, u32::MAX.into())).transpose()?;
        self.worker.call(
            py,
            Named::Entry("use_calibration"),
            None,
            |()| "the call was completed".to_owned(),
            move |held, _| {
                held.session()?;
                held.bench.use_calibration(version)
            },
        )
    }
}

impl Bench {
    /// Keeps the calibration that `make` returns, with the pump held. `make` gets the calibration in use.
    fn kept<T: Send + 'static>(
        &self,
        py: Python<'_>,
        name: &'static str,
        make: impl FnOnce(
            &pump_bench::pump_file::PumpFile,
            Option<&DoseCalibration>,
        ) -> Result<(DoseCalibration, T), pump_bench::calibration::CalibrationError>
        + Send
        + 'static,
    ) -> PyResult<(Calibration, T)> {
        let (stored, more): (Stored, T) = self.worker.call(
            py,
            Named::Entry(name),
            None,
            |(stored, _): &(Stored, T)| format!("calibration {} is kept and used", stored.version),
            move |held, _| {
                held.session()?;
                let before = held.bench.calibrations().active()?.map(|active| active.calibration);
                let (calibration, more) = make(held.bench.file(), before.as_ref())?;
                Ok((held.bench.keep_calibration(calibration)?, more))
            },
        )?;
        Ok((Calibration(stored), more))
    }
}

/// Returns roller volume (mL), engagement angle (rad) and zero (rad), each with its standard uncertainty.
fn numbers(found: &PhaseFit) -> [(f64, f64); 3] {
    let rad = pump_model::units::radians;
    let PhaseFit { roller_volume_ml, engagement_deg, zero_deg, .. } = found;
    [
        (roller_volume_ml.value, roller_volume_ml.standard),
        (rad(engagement_deg.value), rad(engagement_deg.standard)),
        (rad(zero_deg.value), rad(zero_deg.standard)),
    ]
}
