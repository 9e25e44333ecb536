//! The likelihood of lines for a waveform that was measured.

use pump_bench::identification::Turning;
use pump_model::identification::{IdentificationError, PressureSample, Recording};
use pump_model::{Leg, Line as Model, Port};
use pyo3::prelude::*;

use super::answer::refused;
use super::column::column;
use super::waveform::turning;
use crate::argument::{Argument, number, optional, port_named, speed};
use crate::line::Line;
use crate::pump::Pump;
use crate::python::collected;
use crate::python::errors::value;

/// Likelihood of lines, for the pressure over time while a pump turns, with white noise of the sensor.
///
/// The measurement is read once, so that a call is quick: it is made for samplers and minimizers. Samples at equal
/// intervals take least.
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
    pump: pump_model::Pump,
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
        pump: &Pump,
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
        let turning = turning(pump, begin, start_s, start_angle_rad, speed_rad_s)?;
        let times = column("time_s", time_s, None)?;
        let pressures = column("pressure_kpa", pressure_kpa, Some(times.len()))?;
        let samples = times.into_iter().zip(pressures);
        let samples =
            collected(samples.map(|(time_s, pressure_kpa)| PressureSample { time_s, pressure_kpa }))?;
        let legs = turning.legs();
        let likelihood = Self { pump: *pump.model(), port, samples, turning, legs, standard_kpa };
        if likelihood.samples.is_empty() {
            return Err(value("time_s is empty; allowed: one time at least"));
        }
        likelihood.squares_kpa2(pump.model().line(port), 0.0, 0.0).map_err(refused)?;
        Ok(likelihood)
    }

    /// Return the natural logarithm of the likelihood of a line. Other Python threads run meanwhile.
    ///
    /// It is -S/(2 standard²) - n/2 ln(2 pi standard²), where S is the sum of the squares of measured less model.
    ///
    /// Parameters
    /// ----------
    /// resistance_kpa_s_ml : float, optional
    ///     R, kPa s/mL, 0 to 1e6; by default that of the pump's line.
    /// compliance_ml_kpa : float, optional
    ///     C, mL/kPa, 1e-6 to 1e6; by default that of the pump's line.
    /// inertance_kpa_s2_ml : float, optional
    ///     L, kPa s²/mL, 1e-6 to 1e6; by default that of the pump's line.
    /// reservoir_kpa : float, optional
    ///     Pressure of the reservoir, kPa absolute, 0.001 to 1e6; by default that of the pump's line.
    /// start_angle_rad : float, optional
    ///     Angle at the start, or at time 0 of a steady record, rad; by default as given at the beginning.
    /// start_s : float, optional
    ///     Time at which the pump began to turn, s; by default as given at the beginning.
    /// standard_kpa : float, optional
    ///     Standard deviation of the noise, kPa, more than zero; by default as given at the beginning.
    ///
    /// Returns
    /// -------
    /// float
    ///     Logarithm of the likelihood.
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
    fn log_likelihood(
        &self,
        py: Python<'_>,
        resistance_kpa_s_ml: Argument<'_, '_>,
        compliance_ml_kpa: Argument<'_, '_>,
        inertance_kpa_s2_ml: Argument<'_, '_>,
        reservoir_kpa: Argument<'_, '_>,
        start_angle_rad: Argument<'_, '_>,
        start_s: Argument<'_, '_>,
        standard_kpa: Argument<'_, '_>,
    ) -> PyResult<f64> {
        let own = self.pump.line(self.port);
        let or = |name, given, own| Ok::<_, PyErr>(optional(name, given)?.unwrap_or(own));
        let line = Model {
            resistance_kpa_s_ml: or("resistance_kpa_s_ml", resistance_kpa_s_ml, own.resistance_kpa_s_ml)?,
            compliance_ml_kpa: or("compliance_ml_kpa", compliance_ml_kpa, own.compliance_ml_kpa)?,
            inertance_kpa_s2_ml: or("inertance_kpa_s2_ml", inertance_kpa_s2_ml, own.inertance_kpa_s2_ml)?,
            reservoir_kpa: or("reservoir_kpa", reservoir_kpa, own.reservoir_kpa)?,
        };
        let start_angle_rad = optional("start_angle_rad", start_angle_rad)?;
        let start_s = optional("start_s", start_s)?;
        for (name, number) in [("start_angle_rad", start_angle_rad), ("start_s", start_s)] {
            if let Some(number) = number.filter(|number| !number.is_finite()) {
                return Err(value(format_args!("{name} is {number}; allowed: a finite number")));
            }
        }
        let angle_rad = start_angle_rad.map_or(0.0, |angle_rad| angle_rad - self.turning.angle_rad);
        let later_s = start_s.map_or(0.0, |start_s| start_s - self.turning.start_s);
        let standard_kpa = optional("standard_kpa", standard_kpa)?.map_or(Ok(self.standard_kpa), positive)?;
        let squares_kpa2 = py.detach(|| self.squares_kpa2(&line, angle_rad, later_s)).map_err(refused)?;
        let variance = standard_kpa * standard_kpa;
        let count = self.samples.len() as f64;
        Ok(-0.5 * (squares_kpa2 / variance + count * (std::f64::consts::TAU * variance).ln()))
    }

    /// Line of the pump, whose values stand where a call gives no other.
    #[getter]
    fn line(&self) -> Line {
        Line(*self.pump.line(self.port))
    }

    fn __len__(&self) -> usize {
        self.samples.len()
    }
}

impl LineLikelihood {
    /// Returns the sum of the squares of measured less model, kPa².
    fn squares_kpa2(&self, line: &Model, angle_rad: f64, start_s: f64) -> Result<f64, IdentificationError> {
        let motion = self.turning.motion(&self.legs);
        let recording = Recording { port: self.port, samples: &self.samples, motion };
        recording.residual_squares_kpa2(&self.pump, line, angle_rad, start_s)
    }
}

/// Reads the standard deviation of the noise, kPa.
fn positive(standard_kpa: f64) -> PyResult<f64> {
    if standard_kpa > 0.0 && standard_kpa.is_finite() {
        return Ok(standard_kpa);
    }
    Err(value(format_args!("standard_kpa is {standard_kpa}; allowed: a positive number")))
}
