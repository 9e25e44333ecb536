//! A planned dose.

use numpy::PyArray1;
use pump_bench::record::{PhaseSource, Purpose};
use pump_bench::{DoseError, DoseReport, DoseRequest, Prepared};
use pump_ctl::plan::{Cruise, Phase};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use super::doser::Doser;
use crate::argument::{finish_named, ramps_named};
use crate::pump::Pump;
use crate::python::advice;
use crate::python::errors::{self, value};
use crate::python::spare;

/// A cruise as plain data: which of rate (mL/s), speed (rad/s) and within (s), and its value.
type PlainCruise = Option<(String, f64)>;
/// Arguments from which a pickled plan is planned again.
type Plain = (Py<Doser>, f64, PlainCruise, f64, f64, f64, bool, String, String, Option<f64>);

/// A planned dose, made by `Doser.plan`.
///
/// Volumes are negative in reverse. Angles are of the pump head, unwrapped. Times count from the start of motion.
#[pyclass(frozen, module = "pumpmodel")]
pub(crate) struct Plan {
    pub(crate) doser: Py<Doser>,
    pub(crate) prepared: Prepared,
    pub(crate) report: DoseReport,
    pub(crate) step_times_s: PyOnceLock<Py<PyArray1<f64>>>,
}

#[pymethods]
impl Plan {
    /// Pump of the plan.
    #[getter]
    fn pump(&self, py: Python<'_>) -> Py<Pump> {
        self.doser.get().pump.clone_ref(py)
    }

    /// Requested volume, mL.
    #[getter]
    fn requested_ml(&self) -> f64 {
        self.report.requested_ml
    }

    /// Carry from earlier doses, mL, positive toward the outlet.
    #[getter]
    fn carry_in_ml(&self) -> f64 {
        self.report.carry_in_ml
    }

    /// Volume of the planned steps after the line has settled, mL.
    ///
    /// It is the middle of `volume_least_ml` and `volume_most_ml`.
    #[getter]
    fn planned_ml(&self) -> f64 {
        self.report.planned_ml
    }

    /// Smallest volume of the planned steps over all possible start angles, mL.
    #[getter]
    fn volume_least_ml(&self) -> f64 {
        self.report.volume_least_ml
    }

    /// Largest volume of the planned steps over all possible start angles, mL.
    #[getter]
    fn volume_most_ml(&self) -> f64 {
        self.report.volume_most_ml
    }

    /// Carry to the next dose, mL: requested + carry_in + retracted - planned, positive toward the outlet.
    #[getter]
    fn carry_ml(&self) -> f64 {
        self.report.carry_ml
    }

    /// Expanded uncertainty of the volume, mL: 95.45 % of doses lie within it.
    #[getter]
    fn expanded_uncertainty_ml(&self) -> f64 {
        self.report.expanded_uncertainty_ml
    }

    /// Sources of the volume's uncertainty: dicts of `source`, `standard_ml` (standard uncertainty, mL),
    /// `variance_percent` (share of the variance) and `remedy`.
    #[getter]
    fn uncertainty_budget<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.to_dict(py)?.get_item("uncertainty_budget")
    }

    /// Number of motor steps of the dose, negative in reverse; `retract_steps` has those of its retraction.
    #[getter]
    fn steps(&self) -> i64 {
        self.report.steps
    }

    /// Motor steps per revolution of the pump head.
    #[getter]
    fn steps_per_rev(&self) -> f64 {
        self.report.steps_per_rev
    }

    /// Angle of the rollers at the start, rad.
    #[getter]
    fn start_angle_rad(&self) -> f64 {
        self.prepared.plan.start().angle_rad()
    }

    /// Half width of the start angle, rad: the true angle lies within it on either side of `start_angle_rad`.
    #[getter]
    fn start_half_width_rad(&self) -> f64 {
        self.prepared.plan.start().half_width_rad()
    }

    /// Angle of the rollers at the end, before a retraction, rad, counted on from the start angle.
    #[getter]
    fn end_angle_rad(&self) -> f64 {
        self.prepared.plan.end_angle_rad()
    }

    /// Speed of the pump head while cruising, r/min. A smooth flow has its mean over time.
    #[getter]
    fn cruise_speed_rpm(&self) -> f64 {
        self.report.cruise_speed_rpm
    }

    /// Fastest speed of the pump head, r/min.
    #[getter]
    fn peak_speed_rpm(&self) -> f64 {
        self.report.peak_speed_rpm
    }

    /// Average flow at the cruise speed, mL/s.
    #[getter]
    fn cruise_flow_ml_s(&self) -> f64 {
        self.report.cruise_flow_ml_s
    }

    /// Planned volume over the time of motion, mL/s.
    #[getter]
    fn mean_flow_ml_s(&self) -> f64 {
        self.report.mean_flow_ml_s
    }

    /// Time from the start to the last step of the dose, s.
    #[getter]
    fn motion_s(&self) -> f64 {
        self.report.motion_s
    }

    /// Time from the last step of the dose until the undelivered volume stays below 1 µL, s. None if the outlet's
    /// line is not known.
    #[getter]
    fn settle_s(&self) -> Option<f64> {
        self.report.settle_s
    }

    /// Largest volume delivered less the final one, mL: the line swings at the stop. It is predicted.
    #[getter]
    fn backflow_ml(&self) -> Option<f64> {
        self.report.backflow_ml
    }

    /// All that the line takes back from the vessel on the way, mL.
    #[getter]
    fn reverse_flow_ml(&self) -> Option<f64> {
        self.report.reverse_flow_ml
    }

    /// Smallest predicted inlet pressure, kPa absolute. None if the line is not known.
    #[getter]
    fn inlet_min_kpa(&self) -> Option<f64> {
        self.report.inlet_min_kpa
    }

    /// Largest predicted inlet pressure, kPa absolute. None if the line is not known.
    #[getter]
    fn inlet_max_kpa(&self) -> Option<f64> {
        self.report.inlet_max_kpa
    }

    /// Smallest predicted outlet pressure, kPa absolute. None if the line is not known.
    #[getter]
    fn outlet_min_kpa(&self) -> Option<f64> {
        self.report.outlet_min_kpa
    }

    /// Largest predicted outlet pressure, kPa absolute. None if the line is not known.
    #[getter]
    fn outlet_max_kpa(&self) -> Option<f64> {
        self.report.outlet_max_kpa
    }

    /// Limit that keeps the dose from being faster.
    ///
    /// "none": the dose cruises as asked. "acceleration": the acceleration keeps it slower. The fastest dose also has
    /// "speed" and "torque", and the port at which a pressure binds: "inlet_suction" and "outlet_suction" by the
    /// smallest pressure allowed there, "inlet_pressure" and "outlet_pressure" by the largest.
    #[getter]
    fn limited_by(&self) -> &str {
        self.report.limited_by.name()
    }

    /// Ripple of the flow at the outlet's rollers at constant speed, over its mean: (peak to peak, root mean square).
    #[getter]
    fn ripple_before(&self) -> (f64, f64) {
        (self.report.ripple_before.peak_to_peak, self.report.ripple_before.rms)
    }

    /// Ripple of the flow at the outlet's rollers as planned, over its mean: (peak to peak, root mean square).
    ///
    /// It is less than `ripple_before` with a smooth flow.
    #[getter]
    fn ripple_after(&self) -> (f64, f64) {
        (self.report.ripple_after.peak_to_peak, self.report.ripple_after.rms)
    }

    /// Warnings to read before the plan is run.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.report.warnings.iter().map(ToString::to_string).collect()
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.prepared == other.prepared && self.doser.get().__eq__(other.doser.get())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        let pump = self.doser.get().pump.get().__hash__(py)?;
        (pump, self.report.requested_ml, self.report.steps).into_pyobject(py)?.into_any().hash()
    }

    fn __repr__(&self) -> String {
        let report = &self.report;
        let back = report.retract_steps.map_or(String::new(), |steps| {
            format!(", then retract_steps {steps} until settled_s {:.4}", self.prepared.settled_s())
        });
        format!(
            "<Plan of {:?} mL on '{}': planned_ml {:.6}, steps {}, cruise_speed_rpm {:.4}, motion_s {:.4}, \
             settle_s {}{back}>",
            report.requested_ml,
            report.pump,
            report.planned_ml,
            report.steps,
            report.cruise_speed_rpm,
            report.motion_s,
            report.settle_s.map_or("None".to_owned(), |settle_s| format!("{settle_s:.4}")),
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Plain)> {
        let request = &self.prepared.request;
        let cruise = request.cruise.map(|cruise| match cruise {
            Cruise::Flow { ml_s } => ("rate".to_owned(), ml_s),
            Cruise::Speed { rad_s } => ("speed".to_owned(), rad_s),
            Cruise::Within { time_s } => ("within".to_owned(), time_s),
            Cruise::Fastest => ("fastest".to_owned(), 0.0),
        });
        let plain = (
            self.doser.clone_ref(py),
            request.volume_ml,
            cruise,
            self.start_angle_rad(),
            self.start_half_width_rad(),
            self.report.carry_in_ml,
            request.smooth,
            request.finish.unwrap_or_default().to_string(),
            request.ramps.unwrap_or_default().to_string(),
            request.retract_ml,
        );
        Ok((py.get_type::<Self>().getattr("_rebuild")?, plain))
    }

    /// Plans a pickled request again. Equal requests on equal pumps give equal plans.
    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "all arguments of a plan, for pickle")]
    #[pyo3(signature = (
        doser, volume_ml, cruise, start_angle_rad, start_half_width_rad, carry_in_ml, smooth, finish, ramps, retract_ml
    ))]
    fn _rebuild(
        doser: &Bound<'_, Doser>,
        volume_ml: f64,
        cruise: PlainCruise,
        start_angle_rad: f64,
        start_half_width_rad: f64,
        carry_in_ml: f64,
        smooth: bool,
        finish: &str,
        ramps: &str,
        retract_ml: Option<f64>,
    ) -> PyResult<Self> {
        let cruise = match cruise {
            None => None,
            Some((name, ml_s)) if name == "rate" => Some(Cruise::Flow { ml_s }),
            Some((name, rad_s)) if name == "speed" => Some(Cruise::Speed { rad_s }),
            Some((name, time_s)) if name == "within" => Some(Cruise::Within { time_s }),
            Some((name, _)) if name == "fastest" => Some(Cruise::Fastest),
            Some((name, _)) => {
                return Err(value(format_args!(
                    "cruise is '{name}'; allowed: 'rate', 'speed', 'within', 'fastest'"
                )));
            }
        };
        let limits = doser.get().limits;
        let request = DoseRequest::new(Purpose::Dose, volume_ml)
            .with_cruise(cruise)
            .with_smooth(smooth)
            .with_finish(finish_named(finish)?)
            .with_ramps(ramps_named(ramps)?)
            .with_retraction(retract_ml)
            .with_pressures(limits.pressures())
            .with_start_angle(start_angle_rad, start_half_width_rad);
        let start = Phase::within(start_angle_rad, start_half_width_rad);
        Self::new(doser, request, start, carry_in_ml)
    }
}

impl Plan {
    /// Plans a request on a doser's pump, while other Python threads run.
    pub(crate) fn new(
        doser: &Bound<'_, Doser>,
        request: DoseRequest,
        start: Phase,
        carry_in_ml: f64,
    ) -> PyResult<Self> {
        spare::refill()?;
        let Doser { pump, calibration, .. } = doser.get();
        let (pump, py) = (pump.get(), doser.py());
        let (file, model) = (&pump.file, pump.model());
        let (stored, source) =
            (calibration.as_ref().map(|calibration| &calibration.get().0), PhaseSource::Given);
        let planned = py.detach(|| {
            let prepared = match stored {
                Some(stored) => {
                    Prepared::calibrated(file, model, stored, request, start, source, carry_in_ml)?
                }
                None => Prepared::new(file, model, request, start, source, carry_in_ml)?,
            };
            let report =
                DoseReport::without_bench(file, file.driver(), &prepared, None).worded(advice::words);
            Ok::<_, DoseError>((prepared, report))
        });
        let (prepared, report) = planned.map_err(|error| errors::dose(py, error))?;
        Ok(Self { report, doser: doser.clone().unbind(), prepared, step_times_s: PyOnceLock::new() })
    }
}
