//! The likelihood of lines for a waveform that was measured.

use pump_bench::identification::{Begin, Turning};
use pump_model::identification::{IdentificationError, PressureSample, Recording};
use pump_model::{Leg, Line as Model, Port};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::answer;
use super::column::column;
use super::points::{ARGUMENTS, NAMES, Points, positive};
use super::waveform::{BEGINS, turning};
use crate::argument::{Argument, number, optional, port_named, speed};
use crate::line::{Line, named};
use crate::pump::{Pump, pump_given};
use crate::python::errors::value;
use crate::python::{SignalCheck, collected, frozen};

/// Likelihood of lines, for the pressure over time while a pump turns, with white noise of the sensor.
///
/// The measurement is read once, so that a call is quick: it is made for samplers and minimizers. Samples at equal
/// intervals take least. It can be pickled, as pools of processes need it.
///
/// Parameters
/// ----------
/// pump : Pump
///     Pump of the line. Its flow counts as known, and its line stands where a call gives no other value.
/// time_s : array_like
///     Times, s, rising, shape (n,).
/// pressure_kpa : array_like
///     Pressures at the port, kPa absolute, shape (n,).
/// standard_kpa : float
///     Standard deviation of the noise, kPa, more than zero.
/// port : {"outlet", "inlet"}
///     Port whose pressure was measured.
/// speed_rpm : float
///     Speed of the pump head, r/min; negative in reverse; not zero.
/// speed_rad_s : float
///     Speed of the pump head, rad/s. Give exactly one of `speed_rpm` and `speed_rad_s`.
/// begin : {"ramp", "step", "steady"}
///     Motion at the start of the record: from rest with the pump's acceleration, from rest at full speed, or turning
///     long before.
/// start_s : float, optional
///     Time at which the pump began to turn, s; by default 0.
/// start_angle_rad : float, optional
///     Angle at the start, or at time 0 of a steady record, rad; by default 0.
///
/// Raises
/// ------
/// ValueError
///     If an argument is not allowed, or if the samples are not finite or not in order of time.
/// MemoryError
///     If there is no room for the samples.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> pump = pm.Pump.three_roller()
/// >>> run = pump.simulate(speed_rpm=100, duration_s=1)
/// >>> likelihood = pm.LineLikelihood(
/// ...     pump, time_s=run.time_s, pressure_kpa=run.outlet_kpa, standard_kpa=0.1, speed_rpm=100, begin="step"
/// ... )
/// >>> likelihood.log_likelihood() > likelihood.log_likelihood(inertance_kpa_s2_ml=0.006)
/// True
#[pyclass(frozen, module = "pumpmodel")]
pub(crate) struct LineLikelihood {
    pump: Py<Pump>,
    port: Port,
    samples: Vec<PressureSample>,
    turning: Turning,
    legs: Vec<Leg>,
    standard_kpa: f64,
}

#[pymethods]
impl LineLikelihood {
    #[new]
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (
        pump, *, time_s, pressure_kpa, standard_kpa, port="outlet", speed_rpm=None, speed_rad_s=None, begin="ramp",
        start_s=None, start_angle_rad=None
    ))]
    fn new<'py>(
        #[pyo3(from_py_with = pump_given)] pump: Py<Pump>,
        time_s: &Bound<'py, PyAny>,
        pressure_kpa: &Bound<'py, PyAny>,
        standard_kpa: &Bound<'py, PyAny>,
        port: &str,
        speed_rpm: Argument<'_, 'py>,
        speed_rad_s: Argument<'_, 'py>,
        begin: &str,
        start_s: Argument<'_, 'py>,
        start_angle_rad: Argument<'_, 'py>,
    ) -> PyResult<Self> {
        let port = port_named(port)?;
        let speed_rad_s = speed::speed_rad_s(speed_rpm, speed_rad_s)?;
        let (start_s, start_angle_rad) =
            (optional("start_s", start_s)?, optional("start_angle_rad", start_angle_rad)?);
        let standard_kpa = positive(number("standard_kpa", standard_kpa)?)?;
        let turning = turning(pump.get(), begin, start_s, start_angle_rad, speed_rad_s)?;
        let times = column("time_s", time_s, None)?;
        let pressures = column("pressure_kpa", pressure_kpa, Some(times.len()))?;
        let samples = times.into_iter().zip(pressures);
        let samples =
            collected(samples.map(|(time_s, pressure_kpa)| PressureSample { time_s, pressure_kpa }))?;
        let legs = turning.legs();
        let likelihood = Self { pump, port, samples, turning, legs, standard_kpa };
        if likelihood.samples.is_empty() {
            return Err(value("time_s is empty; allowed: one time at least"));
        }
        let model = likelihood.pump.get().model();
        likelihood.recording().residual_squares_kpa2(model, model.line(port), 0.0, 0.0).map_err(refused)?;
        Ok(likelihood)
    }

    /// Return the natural logarithm of the likelihood of a line. Other Python threads run meanwhile.
    ///
    /// It is -S/(2 standard²) - n/2 ln(2 pi standard²), where S is the sum of the squares of measured less model.
    ///
    /// Arguments may be arrays, as of the walkers of a sampler: they are broadcast.
    ///
    /// Parameters
    /// ----------
    /// resistance_kpa_s_ml : float or array_like, optional
    ///     R, kPa s/mL, 0 to 1e6; by default that of the pump's line.
    /// compliance_ml_kpa : float or array_like, optional
    ///     C, mL/kPa, 1e-6 to 1e6; by default that of the pump's line.
    /// inertance_kpa_s2_ml : float or array_like, optional
    ///     L, kPa s²/mL, 1e-6 to 1e6; by default that of the pump's line.
    /// reservoir_kpa : float or array_like, optional
    ///     Pressure of the reservoir, kPa absolute, 0.001 to 1e6; by default that of the pump's line.
    /// start_angle_rad : float or array_like, optional
    ///     Angle at the start, or at time 0 of a steady record, rad; by default as given at the beginning.
    /// start_s : float or array_like, optional
    ///     Time at which the pump began to turn, s; by default as given at the beginning.
    /// standard_kpa : float or array_like, optional
    ///     Standard deviation of the noise, kPa, more than zero; by default as given at the beginning.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    ///     Logarithm of the likelihood. Array input gives an array of float64 of the arguments' common shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is outside its range, or if a line without resistance resonates at a steady speed.
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (
        *, resistance_kpa_s_ml=None, compliance_ml_kpa=None, inertance_kpa_s2_ml=None, reservoir_kpa=None,
        start_angle_rad=None, start_s=None, standard_kpa=None
    ))]
    fn log_likelihood<'py>(
        &self,
        py: Python<'py>,
        resistance_kpa_s_ml: Argument<'_, 'py>,
        compliance_ml_kpa: Argument<'_, 'py>,
        inertance_kpa_s2_ml: Argument<'_, 'py>,
        reservoir_kpa: Argument<'_, 'py>,
        start_angle_rad: Argument<'_, 'py>,
        start_s: Argument<'_, 'py>,
        standard_kpa: Argument<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let given = [
            resistance_kpa_s_ml,
            compliance_ml_kpa,
            inertance_kpa_s2_ml,
            reservoir_kpa,
            start_angle_rad,
            start_s,
            standard_kpa,
        ];
        let points = self.points(py, given)?;
        let values = SignalCheck::each(py, points.count(), |n| self.logarithm(&points, n))?;
        points.shaped(values).into_object(py)
    }

    /// Return the logarithm of the likelihood with its derivatives, which are exact. Other Python threads run
    /// meanwhile.
    ///
    /// Where a sample stands at an edge of the flow, its derivative by the angle is that toward the direction of the
    /// motion.
    ///
    /// Parameters
    /// ----------
    /// resistance_kpa_s_ml : float or array_like, optional
    ///     R; this and the others are those of `log_likelihood`.
    /// compliance_ml_kpa : float or array_like, optional
    ///     C.
    /// inertance_kpa_s2_ml : float or array_like, optional
    ///     L.
    /// reservoir_kpa : float or array_like, optional
    ///     Pressure of the reservoir.
    /// start_angle_rad : float or array_like, optional
    ///     Angle at the start.
    /// start_s : float or array_like, optional
    ///     Time at which the pump began to turn.
    /// standard_kpa : float or array_like, optional
    ///     Standard deviation of the noise.
    ///
    /// Returns
    /// -------
    /// tuple of (float or numpy.ndarray, dict)
    ///     Logarithm of the likelihood as `log_likelihood` returns it, and its derivatives by the names of the seven
    ///     arguments, over their units: floats, or arrays of its shape.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is outside its range, or if a line without resistance resonates at a steady speed.
    ///
    /// Examples
    /// --------
    /// >>> import pumpmodel as pm
    /// >>> pump = pm.Pump.three_roller()
    /// >>> run = pump.simulate(speed_rpm=100, duration_s=1)
    /// >>> likelihood = pm.LineLikelihood(
    /// ...     pump, time_s=run.time_s, pressure_kpa=run.outlet_kpa, standard_kpa=0.1, speed_rpm=100, begin="step"
    /// ... )
    /// >>> value, gradient = likelihood.value_and_gradient(inertance_kpa_s2_ml=0.0045)
    /// >>> gradient["inertance_kpa_s2_ml"] < 0
    /// True
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (
        *, resistance_kpa_s_ml=None, compliance_ml_kpa=None, inertance_kpa_s2_ml=None, reservoir_kpa=None,
        start_angle_rad=None, start_s=None, standard_kpa=None
    ))]
    fn value_and_gradient<'py>(
        &self,
        py: Python<'py>,
        resistance_kpa_s_ml: Argument<'_, 'py>,
        compliance_ml_kpa: Argument<'_, 'py>,
        inertance_kpa_s2_ml: Argument<'_, 'py>,
        reservoir_kpa: Argument<'_, 'py>,
        start_angle_rad: Argument<'_, 'py>,
        start_s: Argument<'_, 'py>,
        standard_kpa: Argument<'_, 'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let given = [
            resistance_kpa_s_ml,
            compliance_ml_kpa,
            inertance_kpa_s2_ml,
            reservoir_kpa,
            start_angle_rad,
            start_s,
            standard_kpa,
        ];
        let points = self.points(py, given)?;
        let rows = SignalCheck::each(py, points.count(), |n| self.with_slopes(&points, n))?;
        let gradient = PyDict::new(py);
        for (n, name) in NAMES.into_iter().enumerate() {
            let slopes = collected(rows.iter().map(|(_, slopes)| slopes[n]))?;
            gradient.set_item(name, points.shaped(slopes).into_object(py)?)?;
        }
        let logarithms = collected(rows.iter().map(|(logarithm, _)| *logarithm))?;
        Ok((points.shaped(logarithms).into_object(py)?, gradient))
    }

    /// Line of the pump, whose values stand where a call gives no other.
    #[getter]
    fn line(&self) -> Line {
        Line(*self.pump.get().model().line(self.port))
    }

    fn __len__(&self) -> usize {
        self.samples.len()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let Turning { begin, start_s, angle_rad, speed_rad_s } = self.turning;
        let [by_ramp, by_step, steady] = BEGINS;
        let (begin, start_s) = match begin {
            Begin::Ramp { .. } => (by_ramp, Some(start_s)),
            Begin::Step => (by_step, Some(start_s)),
            Begin::Steady => (steady, None),
        };
        let times = frozen(py, collected(self.samples.iter().map(|sample| sample.time_s))?)?;
        let pressures = frozen(py, collected(self.samples.iter().map(|sample| sample.pressure_kpa))?)?;
        let measured = (times, pressures, self.standard_kpa, self.port.name()).into_bound_py_any(py)?;
        let motion = (speed_rad_s, begin, start_s, angle_rad).into_bound_py_any(py)?;
        let parts = PyTuple::new(py, [self.pump.bind(py).clone().into_any(), measured, motion])?;
        Ok((py.get_type::<Self>().getattr("_rebuild")?, parts))
    }

    #[staticmethod]
    #[allow(clippy::needless_pass_by_value, reason = "read from Python")]
    fn _rebuild<'py>(pump: Py<Pump>, measured: Measured<'py>, motion: Moved<'py>) -> PyResult<Self> {
        let (times, pressures, standard_kpa, port) = measured;
        let (speed_rad_s, begin, start_s, angle_rad) = motion;
        let (speed, start, angle) = (Some(&speed_rad_s), start_s.as_ref(), Some(&angle_rad));
        Self::new(pump, &times, &pressures, &standard_kpa, &port, None, speed, &begin, start, angle)
    }
}

/// Times, pressures, noise and port, as they are pickled.
type Measured<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, String);
/// Speed, kind of beginning, start and angle, as they are pickled.
type Moved<'py> = (Bound<'py, PyAny>, String, Option<Bound<'py, PyAny>>, Bound<'py, PyAny>);

impl LineLikelihood {
    /// Returns the arguments of a call. Those that are left out have their values of the beginning.
    fn points(&self, py: Python<'_>, given: [Argument<'_, '_>; ARGUMENTS]) -> PyResult<Points> {
        let line = self.pump.get().model().line(self.port);
        let own = [
            line.resistance_kpa_s_ml,
            line.compliance_ml_kpa,
            line.inertance_kpa_s2_ml,
            line.reservoir_kpa,
            self.turning.angle_rad,
            self.turning.start_s,
            self.standard_kpa,
        ];
        Points::read(py, given, own)
    }

    /// Returns the logarithm of the likelihood at a point.
    fn logarithm(&self, points: &Points, n: usize) -> PyResult<f64> {
        let (line, angle_rad, later_s, standard_kpa) = self.point(points, n);
        let model = self.pump.get().model();
        let squares = self.recording().residual_squares_kpa2(model, &line, angle_rad, later_s);
        Ok(self.logarithm_of(squares.map_err(refused)?, standard_kpa))
    }

    /// Returns the logarithm of the likelihood at a point, with its derivatives by the arguments.
    fn with_slopes(&self, points: &Points, n: usize) -> PyResult<(f64, [f64; ARGUMENTS])> {
        let (line, angle_rad, later_s, standard_kpa) = self.point(points, n);
        let model = self.pump.get().model();
        let found = self.recording().residual_squares_with_slopes(model, &line, angle_rad, later_s);
        let (squares_kpa2, slopes) = found.map_err(refused)?;
        let variance = standard_kpa * standard_kpa;
        let [by_r, by_c, by_l, by_angle, by_start, by_reservoir] =
            slopes.map(|slope| -0.5 * slope / variance);
        let by_standard = (squares_kpa2 / variance - self.samples.len() as f64) / standard_kpa;
        let slopes = [by_r, by_c, by_l, by_reservoir, by_angle, by_start, by_standard];
        Ok((self.logarithm_of(squares_kpa2, standard_kpa), slopes))
    }

    /// Returns the line, the angle and the start beyond those of the beginning, and the noise at a point.
    fn point(&self, points: &Points, n: usize) -> (Model, f64, f64, f64) {
        let (line, [angle_rad, start_s, standard_kpa]) = points.at(n);
        (line, angle_rad - self.turning.angle_rad, start_s - self.turning.start_s, standard_kpa)
    }

    /// Returns the logarithm of the likelihood for a sum of squares.
    fn logarithm_of(&self, squares_kpa2: f64, standard_kpa: f64) -> f64 {
        let variance = standard_kpa * standard_kpa;
        let count = self.samples.len() as f64;
        -0.5 * (squares_kpa2 / variance + count * (std::f64::consts::TAU * variance).ln())
    }

    /// Returns the measurement with its motion.
    fn recording(&self) -> Recording<'_> {
        let motion = self.turning.motion(&self.legs);
        Recording { port: self.port, samples: &self.samples, motion }
    }
}

/// Maps a refusal in the words of the arguments.
fn refused(error: IdentificationError) -> PyErr {
    match error {
        IdentificationError::Model(error) => named(error),
        _ => answer::refused(error),
    }
}
