//! Flows and volumes of a pump over angle and speed.

use pump_bench::displacement::DisplacementError;
use pump_model::FlowCurve;
use pyo3::prelude::*;

use super::pump::Pump;
use crate::argument::{Argument, Floats, speed};
use crate::python::errors::value;
use crate::python::{SignalCheck, errors};

/// Largest angle, rad, either way: larger angles are no longer known to a motor step.
const MAX_ANGLE_RAD: f64 = 1e9;
/// Largest flow, mL/s, that is turned into a speed.
const MAX_FLOW_ML_S: f64 = 1e6;
/// Largest volume, mL, either way, whose angle is sought.
const MAX_VOLUME_ML: f64 = 1e9;

#[pymethods]
impl Pump {
    /// Return the flow averaged over whole pitches.
    ///
    /// Parameters
    /// ----------
    /// speed_rpm : float or array_like
    ///     Speed of the pump head, r/min; negative in reverse.
    /// speed_rad_s : float or array_like
    ///     Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Flow, mL/s, negative in reverse. Array input gives an array of float64 of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If not exactly one speed is given, or a speed is not finite or beyond 1e4 rad/s.
    #[pyo3(signature = (*, speed_rpm=None, speed_rad_s=None))]
    pub(super) fn average_flow_ml_s<'py>(
        &self,
        py: Python<'py>,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let speeds = speed::speeds_rad_s(speed_rpm, speed_rad_s)?;
        over(py, &speeds, |rad_s| self.by_speed.average_flow_ml_s(rad_s))
    }

    /// Return the speed of the pump head for an average flow: the inverse of `average_flow_ml_s(speed_rpm=...)`.
    ///
    /// Parameters
    /// ----------
    /// flow_ml_s : float or array_like
    ///     Average flow, mL/s; negative in reverse.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Speed, r/min, which may exceed `max_speed_rpm`. Array input gives an array of float64 of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the flow is not finite or beyond 1e6 mL/s.
    #[pyo3(signature = (*, flow_ml_s))]
    pub(super) fn speed_for_flow_rpm<'py>(
        &self,
        flow_ml_s: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let flows = Floats::read("flow_ml_s", flow_ml_s, MAX_FLOW_ML_S)?;
        over(flow_ml_s.py(), &flows, |flow| Ok(speed::rpm(self.by_speed.speed_for_flow(flow)?)))
    }

    /// Return the volume that the outlet rollers deliver from angle 0 to `angle_rad`.
    ///
    /// Parameters
    /// ----------
    /// angle_rad : float or array_like
    ///     Angle of the pump head, rad, unwrapped.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Volume, mL. Array input gives an array of float64 of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or beyond 1e9 rad.
    pub(super) fn outlet_volume_ml<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        over_angle(angle_rad, self.model().outlet_curve(), FlowCurve::volume_ml)
    }

    /// Return the angle at which a turn has delivered a volume at the outlet rollers: the inverse of
    /// `outlet_volume_ml`.
    ///
    /// With it `outlet_volume_ml(angle) - outlet_volume_ml(start_angle_rad)` is `volume_ml`. Where the flow of a head
    /// reverses, several angles have this volume. The result is the first of them on the way.
    ///
    /// Parameters
    /// ----------
    /// volume_ml : float or array_like
    ///     Volume, mL, up to 1e9 either way; negative for a turn in reverse.
    /// start_angle_rad : float or array_like
    ///     Angle of the pump head at the start, rad, unwrapped; by default 0. Shapes broadcast as NumPy's do.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Angle at the end, rad, unwrapped. Array input gives an array of float64 of the common shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a number is not finite or beyond its range, or if the shapes do not broadcast.
    ///
    /// Examples
    /// --------
    /// >>> import pumpmodel as pm
    /// >>> pump = pm.Pump.three_roller()
    /// >>> end_rad = pump.angle_for_volume(10.0, start_angle_rad=0.4)
    /// >>> round(pump.outlet_volume_ml(end_rad) - pump.outlet_volume_ml(0.4), 9)
    /// 10.0
    #[pyo3(signature = (volume_ml, start_angle_rad=None), text_signature = "($self, volume_ml, start_angle_rad=0.0)")]
    fn angle_for_volume<'py>(
        &self,
        volume_ml: &Bound<'py, PyAny>,
        start_angle_rad: Argument<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = volume_ml.py();
        let volumes = Floats::read("volume_ml", volume_ml, MAX_VOLUME_ML)?;
        let starts = match start_angle_rad {
            Some(starts) => Floats::read("start_angle_rad", starts, MAX_ANGLE_RAD)?,
            None => Floats::One(0.0),
        };
        let ([volumes, starts], _) =
            Floats::broadcast(py, [("volume_ml", volumes), ("start_angle_rad", starts)])?;
        let curve = self.model().outlet_curve();
        // Both have one shape, unless one of them is a single number.
        let shape = if matches!(volumes, Floats::One(_)) { &starts } else { &volumes };
        let angles =
            SignalCheck::quick(py, shape.values().len(), |n| angle_for(curve, volumes.at(n), starts.at(n)))?;
        shape.with_values(angles).into_object(py)
    }

    /// Return the flow at the outlet rollers per angle, mL/rad.
    ///
    /// The product with the speed in rad/s is the flow in mL/s.
    ///
    /// Parameters
    /// ----------
    /// angle_rad : float or array_like
    ///     Angle of the pump head, rad, unwrapped.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Flow per angle, mL/rad. Array input gives an array of float64 of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or beyond 1e9 rad.
    pub(super) fn outlet_flow_ml_rad<'py>(
        &self,
        angle_rad: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        over_angle(angle_rad, self.model().outlet_curve(), FlowCurve::flow_ml_rad)
    }

    /// Return the volume that the inlet rollers take in from angle 0 to `angle_rad`, mL.
    ///
    /// Parameters
    /// ----------
    /// angle_rad : float or array_like
    ///     Angle of the pump head, rad, unwrapped.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Volume, mL. Array input gives an array of float64 of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or beyond 1e9 rad.
    pub(super) fn inlet_volume_ml<'py>(&self, angle_rad: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        over_angle(angle_rad, self.model().inlet_curve(), FlowCurve::volume_ml)
    }

    /// Return the flow at the inlet rollers per angle, mL/rad.
    ///
    /// Parameters
    /// ----------
    /// angle_rad : float or array_like
    ///     Angle of the pump head, rad, unwrapped.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Flow per angle, mL/rad. Array input gives an array of float64 of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or beyond 1e9 rad.
    pub(super) fn inlet_flow_ml_rad<'py>(
        &self,
        angle_rad: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        over_angle(angle_rad, self.model().inlet_curve(), FlowCurve::flow_ml_rad)
    }
}

/// Returns the angle at which a turn from `start_rad` has delivered a volume.
fn angle_for(curve: &FlowCurve, volume_ml: f64, start_rad: f64) -> PyResult<f64> {
    if volume_ml == 0.0 {
        return Ok(start_rad);
    }
    if !curve.reverses() {
        return Ok(curve.angle_rad(curve.volume_ml(start_rad) + volume_ml));
    }
    let reach = curve.reaches(start_rad, volume_ml, 0.0).next().map(|reach| reach.angle_rad);
    reach.ok_or_else(|| {
        value(format_args!("volume_ml is {volume_ml}, which no turn of 1e12 pitches delivers"))
    })
}

/// Applies a property of the pump to each speed or flow, while other Python threads run.
fn over<'py>(
    py: Python<'py>,
    of: &Floats,
    property: impl Fn(f64) -> Result<f64, DisplacementError> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let numbers = SignalCheck::map(py, of.values(), |number| property(number).map_err(errors::displacement))?;
    of.with_values(numbers).into_object(py)
}

/// Applies a property of the flow curve to each angle.
fn over_angle<'py>(
    angle_rad: &Bound<'py, PyAny>,
    curve: &FlowCurve,
    of: impl Fn(&FlowCurve, f64) -> f64 + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let py = angle_rad.py();
    let angles = Floats::read("angle_rad", angle_rad, MAX_ANGLE_RAD)?;
    angles.map(py, |angle| of(curve, angle))?.into_object(py)
}
