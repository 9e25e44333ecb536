//! A line as a linear system, as SciPy and python-control take it.

use numpy::{IntoPyArray, PyArray1, PyArray2};
use pump_model::Port;
use pyo3::prelude::*;

use super::line::Line;
use crate::argument::port_named;

/// Matrices A, B, C and D.
type Matrices<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
);

#[pymethods]
impl Line {
    /// Return the matrices A, B, C and D of the line: dx/dt = A x + B u, y = C x + D u.
    ///
    /// The input u is the flow at the rollers, mL/s, and the output y the pressure at the port above the reservoir's,
    /// kPa. The states x are that pressure, kPa, and the flow in the line, mL/s. `scipy.signal.StateSpace(*matrices)`
    /// and `control.ss(*matrices)` take them.
    ///
    /// Parameters
    /// ----------
    /// port : {"outlet", "inlet"}
    ///     Port of the line. The rollers push into the outlet's line and suck from the inlet's.
    ///
    /// Returns
    /// -------
    /// tuple of numpy.ndarray
    ///     Arrays of float64 of the shapes (2, 2), (2, 1), (1, 2) and (1, 1).
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no port has this name.
    ///
    /// Examples
    /// --------
    /// >>> import pumpmodel as pm
    /// >>> a, b, c, d = pm.Pump.three_roller().outlet.state_space()
    /// >>> a.shape, b.shape, c.shape, d.shape
    /// ((2, 2), (2, 1), (1, 2), (1, 1))
    #[pyo3(signature = (port="outlet"))]
    fn state_space<'py>(&self, py: Python<'py>, port: &str) -> PyResult<Matrices<'py>> {
        let sign = sign_of(port)?;
        let line = &self.0;
        let (filled, driven) = (sign / line.compliance_ml_kpa, sign / line.inertance_kpa_s2_ml);
        let decay = -line.resistance_kpa_s_ml / line.inertance_kpa_s2_ml;
        let matrix = |rows: &[Vec<f64>]| PyArray2::from_vec2(py, rows).map_err(PyErr::from);
        Ok((
            matrix(&[vec![0.0, -filled], vec![driven, decay]])?,
            matrix(&[vec![filled], vec![0.0]])?,
            matrix(&[vec![1.0, 0.0]])?,
            matrix(&[vec![0.0]])?,
        ))
    }

    /// Return numerator and denominator of the transfer function from the flow at the rollers, mL/s, to the pressure at
    /// the port above the reservoir's, kPa: +-(L s + R) / (L C s² + R C s + 1), highest power of s first.
    ///
    /// `scipy.signal.TransferFunction(*both)` and `control.tf(*both)` take them.
    ///
    /// Parameters
    /// ----------
    /// port : {"outlet", "inlet"}
    ///     Port of the line. At the inlet the sign is negative: a flow into the pump lowers the pressure.
    ///
    /// Returns
    /// -------
    /// tuple of numpy.ndarray
    ///     Arrays of float64 of the shapes (2,) and (3,).
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no port has this name.
    ///
    /// Examples
    /// --------
    /// >>> import pumpmodel as pm
    /// >>> numerator, denominator = pm.Pump.three_roller().outlet.transfer_function()
    /// >>> float(denominator[-1])
    /// 1.0
    #[pyo3(signature = (port="outlet"))]
    #[allow(clippy::type_complexity, reason = "a pair of arrays")]
    fn transfer_function<'py>(
        &self,
        py: Python<'py>,
        port: &str,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
        let sign = sign_of(port)?;
        let (r, c, l) = (self.0.resistance_kpa_s_ml, self.0.compliance_ml_kpa, self.0.inertance_kpa_s2_ml);
        Ok((vec![sign * l, sign * r].into_pyarray(py), vec![l * c, r * c, 1.0].into_pyarray(py)))
    }
}

/// Returns the sign of the pressure that a flow at the rollers makes at a port.
fn sign_of(port: &str) -> PyResult<f64> {
    Ok(match port_named(port)? {
        Port::Inlet => -1.0,
        Port::Outlet => 1.0,
    })
}
