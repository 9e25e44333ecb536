//! Harmonics of the pulsation at constant speed.

use numpy::{Complex64, IntoPyArray};
use pump_model::Port;
use pump_model::units::TURN_RAD;
use pyo3::prelude::*;

use super::pump::Pump;
use crate::argument::{Argument, port_named, speed, whole};
use crate::python::errors::{self, value};
use crate::python::{SignalCheck, collected, try_collected};

/// Most harmonics.
const MOST: u32 = 10_000;

fn count_given(given: &Bound<'_, PyAny>) -> PyResult<u32> {
    whole("count", given, 1, MOST.into())
}

#[pymethods]
impl Pump {
    /// Return the harmonics of the pulsation in the periodic steady state at constant speed, exact for every number.
    ///
    /// Flow and pressure at a port are their means plus the real part of the sum of `amplitude * exp(1j * rad_s * t)`,
    /// with angle 0 at t = 0. A line that is a hose has its resistance at the pump's default rate.
    ///
    /// Parameters
    /// ----------
    /// count : int
    ///     Number of harmonics, 1 to 10,000. The first has the frequency at which rollers pass.
    /// speed_rpm : float
    ///     Speed of the pump head, r/min; negative in reverse; not zero.
    /// speed_rad_s : float
    ///     Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
    /// port : {"outlet", "inlet"}
    ///     Port whose pulsation is returned.
    ///
    /// Returns
    /// -------
    /// Harmonics
    ///     Frequencies `rad_s`, and complex amplitudes `flow_ml_s` of the flow at the rollers and `pressure_kpa` of the
    ///     pressure, of shape (count,), with the means `mean_flow_ml_s` and `mean_kpa`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an argument is not allowed, or if a line without resistance resonates at one of the frequencies.
    ///
    /// Examples
    /// --------
    /// >>> import pumpmodel as pm
    /// >>> found = pm.Pump.three_roller().harmonics(5, speed_rpm=100)
    /// >>> round(float(found.rad_s.min()), 4), found.pressure_kpa.shape
    /// (31.4159, (5,))
    #[pyo3(signature = (count=20, *, speed_rpm=None, speed_rad_s=None, port="outlet"))]
    fn harmonics<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = count_given)] count: u32,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
        port: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let port = port_named(port)?;
        let rad_s = speed::speed_rad_s(speed_rpm, speed_rad_s)?;
        let model = self.by_speed.at(rad_s).map_err(errors::displacement)?;
        let (curve, line) = (model.curve(port), model.line(port));
        let (r, c, l) = (line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml);
        let sign = if port == Port::Inlet { -1.0 } else { 1.0 };
        let frequency = |n: u32| f64::from(n) * TURN_RAD / curve.pitch_rad() * rad_s.abs();
        let flows = SignalCheck::each(py, count as usize, |n| {
            let (cosine, sine) = curve.harmonic_ml_rad(n as u32 + 1);
            Ok(rad_s * Complex64::new(cosine, -sine * rad_s.signum()))
        })?;
        let pressures = try_collected(flows.iter().enumerate().map(|(index, flow)| {
            let n = index as u32 + 1;
            let w = frequency(n);
            let per_flow = Complex64::new(r, w * l) / Complex64::new(1.0 - w * w * l * c, w * r * c);
            let kpa = sign * per_flow * flow;
            if kpa.is_finite() {
                return Ok(kpa);
            }
            Err(value(format_args!(
                "the line without resistance resonates at harmonic {n} of {rad_s} rad/s; allowed: a line with \
                 resistance, or another speed"
            )))
        }))?;
        let frequencies = collected((0..count).map(|n| frequency(n + 1)))?;
        let mean_flow_ml_s = model.average_flow_ml_s(rad_s);
        let mean_kpa = line.reservoir_kpa + sign * r * mean_flow_ml_s;
        let numbers = (
            frequencies.into_pyarray(py),
            flows.into_pyarray(py),
            pressures.into_pyarray(py),
            mean_flow_ml_s,
            mean_kpa,
        );
        py.import("pumpmodel")?.getattr("Harmonics")?.call1(numbers)
    }
}
