//! A pump's flows and volumes over angle and speed.

use pump_bench::displacement::SpeedLawError;
use pump_ctl::plan::speed_for_flow;
use pump_model::FlowCurve;
use pyo3::prelude::*;

use crate::errors;
use crate::floats::Floats;
use crate::interrupt::Interrupt;
use crate::pump::Pump;
use crate::speed::{self, Argument};

/// Angles beyond this, rad, are no longer known to a motor step.
const MAX_ANGLE_RAD: f64 = 1e9;
/// Largest flow, mL/s, that is turned into a speed.
const MAX_FLOW_ML_S: f64 = 1e6;

#[pymethods]
impl Pump {
    /// Flow averaged over whole pitches, mL/s; negative in reverse.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float or array_like
    ///     Speed of the pump head, r/min.
    /// speed_rad_s : float or array_like
    ///     The same in rad/s; exactly one of both is given.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     mL/s; of arrays an array of float64 of the same shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one speed is given, or it is not finite or beyond 1e4 rad/s.
    #[pyo3(signature = (*, speed_rpm=None, speed_rad_s=None))]
    fn average_flow<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let speeds = speed::speeds_rad_s(speed_rpm, speed_rad_s)?;
        let Some(law) = self.law else {
            return speeds.map(|rad_s| self.model.average_flow_ml_s(rad_s)).into_object(py);
        };
        over(py, &speeds, |rad_s| law.average_flow_ml_s(&self.model, rad_s))
    }

    /// Speed of the pump head, r/min, whose average flow is `flow_ml_s`: the inverse of `average_flow(speed_rpm=...)`.
    ///
    /// Parameters
    /// ----------
    /// flow_ml_s : float or array_like
    ///     Average flow, mL/s; negative in reverse.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     r/min; of arrays an array of float64 of the same shape. It may be more than `max_speed_rpm`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the flow is not finite or beyond 1e6 mL/s.
    #[pyo3(signature = (*, flow_ml_s))]
    fn speed_for_flow<'py>(&self, flow_ml_s: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let flows = Floats::read("flow_ml_s", flow_ml_s, MAX_FLOW_ML_S)?;
        let py = flow_ml_s.py();
        let Some(law) = self.law else {
            return flows.map(|flow| speed::rpm(speed_for_flow(&self.model, flow))).into_object(py);
        };
        over(py, &flows, |flow| Ok(speed::rpm(law.speed_for_flow(&self.model, flow)?)))
    }

    /// Volume that the outlet rollers deliver from angle 0 to `angle_rad`, mL.
    ///
    /// Parameters
    /// ----------
    /// angle_rad : float or array_like
    ///     Angle of the pump head, rad, unwrapped.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     mL; of arrays an array of float64 of the same shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or beyond 1e9 rad.
    fn outlet_volume<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        over_angle(angle_rad, self.model.outlet_curve(), FlowCurve::volume_ml)
    }

    /// Flow at the outlet rollers per angle, mL/rad; times the speed in rad/s it is the flow.
    ///
    /// Parameters, returns and errors are those of `outlet_volume`, in mL/rad.
    fn outlet_flow_per_rad<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        over_angle(angle_rad, self.model.outlet_curve(), FlowCurve::flow_ml_rad)
    }

    /// Volume that the inlet rollers take in from angle 0 to `angle_rad`, mL.
    ///
    /// Parameters, returns and errors are those of `outlet_volume`.
    fn inlet_volume<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        over_angle(angle_rad, self.model.inlet_curve(), FlowCurve::volume_ml)
    }

    /// Flow at the inlet rollers per angle, mL/rad.
    ///
    /// Parameters, returns and errors are those of `outlet_volume`, in mL/rad.
    fn inlet_flow_per_rad<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        over_angle(angle_rad, self.model.inlet_curve(), FlowCurve::flow_ml_rad)
    }
}

/// What a speed law says of each number.
fn over<'py>(
    py: Python<'py>,
    of: &Floats,
    law: impl Fn(f64) -> Result<f64, SpeedLawError> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let numbers = py.detach(|| -> PyResult<Vec<f64>> {
        let mut interrupt = Interrupt::new();
        let mut numbers = Vec::new();
        for number in of.values() {
            interrupt.check()?;
            numbers.push(law(*number).map_err(errors::speed_law)?);
        }
        Ok(numbers)
    })?;
    of.with_values(numbers).into_object(py)
}

fn over_angle<'py>(
    angle_rad: &Bound<'py, PyAny>,
    curve: &FlowCurve,
    of: impl Fn(&FlowCurve, f64) -> f64 + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let py = angle_rad.py();
    let angles = Floats::read("angle_rad", angle_rad, MAX_ANGLE_RAD)?;
    let result = py.detach(|| angles.map(|angle| of(curve, angle)));
    result.into_object(py)
}
