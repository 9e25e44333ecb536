//! Plans doses of one pump within its limits.

use pump_bench::record::Purpose;
use pump_bench::{DoseRequest, units};
use pump_ctl::plan::{Cruise, Finish, Limits as CtlLimits, Phase};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::asked::retracted_ml;
use crate::calibration::Calibration;
use crate::errors::{self, value};
use crate::limits::Limits;
use crate::plan::Plan;
use crate::pump::Pump;

/// Plans doses of a pump.
///
/// Parameters
/// ----------
/// pump : Pump
///     The pump.
/// limits : Limits, optional
///     Pressures to keep in place of the pump file's.
/// calibration : Calibration, optional
///     What the pump really displaces. Without one the model says it, and the uncertainty is the model's.
///
/// Raises
/// ------
/// ValueError
///     If a limit means nothing.
///
/// Examples
/// --------
/// >>> import pumpmodel as pm
/// >>> plan = pm.Doser(pm.Pump.three_roller()).plan("25mL", rate="10 mL/s")
/// >>> plan.steps
/// 15480
#[pyclass(frozen, get_all, module = "pumpmodel")]
pub(crate) struct Doser {
    /// The pump.
    pub(crate) pump: Py<Pump>,
    /// Pressures to keep in place of the pump file's.
    pub(crate) limits: Limits,
    /// What the pump really displaces, or None.
    pub(crate) calibration: Option<Py<Calibration>>,
}

#[pymethods]
impl Doser {
    #[new]
    #[pyo3(signature = (pump, limits=None, calibration=None))]
    fn new(
        pump: Py<Pump>,
        limits: Option<Py<Limits>>,
        calibration: Option<Py<Calibration>>,
    ) -> PyResult<Self> {
        let limits = limits.map_or(Limits::default(), |limits| *limits.get());
        let doser = Self { pump, limits, calibration };
        doser.ctl_limits().validate().map_err(errors::plan)?;
        Ok(doser)
    }

    /// Plans a dose and predicts its pressures. Moves nothing. Other threads run meanwhile.
    ///
    /// Parameters
    /// ----------
    /// volume : str
    ///     Volume or mass with its unit, as "25mL", "0.025 L", "250uL", "25 g"; negative in reverse.
    /// rate : str, optional
    ///     Average flow while cruising, as "10 mL/s"; "max" is the fastest that holds every limit.
    /// speed : str, optional
    ///     Speed of the pump head while cruising, as "100rpm".
    /// within : str, optional
    ///     Total time with ramps and settling, as "10s": the slowest cruise that meets it.
    ///     At most one of these three is given; without any, the rate is the pump's `default_rate_ml_s`.
    /// smooth : bool
    ///     Let the speed follow the rollers' angle, so that the flow at the outlet is as smooth as the motor's speed and
    ///     acceleration allow. Rate and speed are then means over whole pitches.
    /// finish : str
    ///     "any" or "low-flow": where in a pitch the dose may end. At "low-flow" the outlet's flow is at most half of what it is
    ///     between pulses; the plan takes the nearest such end and carries the difference.
    /// retract : str, optional
    ///     What is sucked back after the dose, as "0.1mL", so that nothing drips; `carry_ml` has the next dose repay it.
    /// start_angle_rad : float
    ///     Where the rollers stand, rad. Only the angle within a pitch matters.
    /// start_half_width_rad : float
    ///     The true angle lies within this of it, rad. Half a pitch and more is any angle, as `math.pi`: the plan is then the
    ///     one whose worst case over all angles is smallest, and whole pitches are exact.
    /// carry_in_ml : float
    ///     What earlier doses owe, mL, positive toward the outlet: `carry_ml` of the plan before.
    ///
    /// Returns
    /// -------
    /// Plan
    ///     Steps, times and predicted pressures.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If a quantity is a bare number.
    /// ValueError
    ///     If a text is no such quantity, or a number is outside its range.
    /// PlanError
    ///     If the pump cannot do it, as a rate above its fastest or a pressure beyond a limit.
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (volume, *, rate=None, speed=None, within=None, smooth=false, finish="any", retract=None, start_angle_rad=0.0, start_half_width_rad=0.0, carry_in_ml=0.0))]
    fn plan(
        slf: &Bound<'_, Self>,
        volume: &Bound<'_, PyAny>,
        rate: Option<&Bound<'_, PyAny>>,
        speed: Option<&Bound<'_, PyAny>>,
        within: Option<&Bound<'_, PyAny>>,
        smooth: bool,
        finish: &str,
        retract: Option<&Bound<'_, PyAny>>,
        start_angle_rad: f64,
        start_half_width_rad: f64,
        carry_in_ml: f64,
    ) -> PyResult<Plan> {
        let doser = slf.get();
        let amount = units::amount(text("volume", "25mL", volume)?).map_err(value)?;
        let request = DoseRequest {
            purpose: Purpose::Dose,
            volume_ml: amount.volume_ml(doser.pump.get().file.fluid.density_kg_m3),
            cruise: cruise(rate, speed, within)?,
            smooth,
            finish: finish_named(finish)?,
            start_angle_rad: Some(start_angle_rad),
            whole_ml: None,
            retract_ml: retracted_ml(retract)?,
            max_outlet_kpa: doser.limits.max_outlet_kpa,
            min_inlet_kpa: doser.limits.min_inlet_kpa,
        };
        let start = Phase { angle_rad: start_angle_rad, half_width_rad: start_half_width_rad };
        Plan::new(slf, request, start, carry_in_ml)
    }

    pub(crate) fn __eq__(&self, other: &Self) -> bool {
        let calibrations = [self, other].map(|doser| doser.calibration.as_ref().map(Py::get));
        self.limits == other.limits
            && self.pump.get() == other.pump.get()
            && calibrations[0] == calibrations[1]
    }

    pub(crate) fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        let parts = (self.pump.get().__hash__(py)?, self.limits.__hash__(py)?);
        parts.into_pyobject(py)?.into_any().hash()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let calibration = match &self.calibration {
            Some(calibration) => format!(", {}", calibration.bind(py).repr()?),
            None => String::new(),
        };
        Ok(format!("Doser({}, {}{calibration})", self.pump.bind(py).repr()?, self.limits.__repr__()))
    }

    #[allow(clippy::type_complexity, reason = "a class and what it is called with")]
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyAny>, (Py<Pump>, Limits, Option<Py<Calibration>>)) {
        let calibration = self.calibration.as_ref().map(|calibration| calibration.clone_ref(py));
        (py.get_type::<Self>().into_any(), (self.pump.clone_ref(py), self.limits, calibration))
    }
}

impl Doser {
    /// Those of the pump file, with the pressures given here in place of its `[limits]`.
    pub(crate) fn ctl_limits(&self) -> CtlLimits {
        self.pump.get().file.limits_with(self.limits.max_outlet_kpa, self.limits.min_inlet_kpa)
    }
}

/// Where in a pitch a dose may end.
pub(crate) fn finish_named(name: &str) -> PyResult<Finish> {
    match name {
        "any" => Ok(Finish::Any),
        "low-flow" => Ok(Finish::LowFlow),
        _ => Err(value(format_args!("finish is '{name}'; allowed: 'any', 'low-flow'"))),
    }
}

/// The one of the three that is given.
pub(crate) fn cruise(
    rate: Option<&Bound<'_, PyAny>>,
    speed: Option<&Bound<'_, PyAny>>,
    within: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<Cruise>> {
    match (rate, speed, within) {
        (None, None, None) => Ok(None),
        (Some(rate), None, None) => Ok(Some(units::rate(text("rate", "10 mL/s", rate)?).map_err(value)?)),
        (None, Some(speed), None) => {
            let rad_s = units::speed_rad_s(text("speed", "100rpm", speed)?).map_err(value)?;
            Ok(Some(Cruise::Speed { rad_s }))
        }
        (None, None, Some(within)) => {
            let time_s = units::time_s(text("within", "10s", within)?).map_err(value)?;
            Ok(Some(Cruise::Within { time_s }))
        }
        _ => Err(value("rate, speed and within exclude each other; give one at most")),
    }
}

/// A quantity's text; a bare number has no unit.
pub(crate) fn text<'a>(name: &str, example: &str, argument: &'a Bound<'_, PyAny>) -> PyResult<&'a str> {
    match argument.cast::<PyString>() {
        Ok(text) => text.to_str(),
        Err(_) => Err(PyTypeError::new_err(format!(
            "{name} must be text with its unit, as \"{example}\", not {}",
            argument.get_type().name()?
        ))),
    }
}
