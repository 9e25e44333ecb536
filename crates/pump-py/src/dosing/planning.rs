//! The planning of a dose: Python's keywords become a request, and the request a plan.

use pump_bench::calibration::Weighing;
use pump_bench::record::Purpose;
use pump_bench::{DoseRequest, units};
use pump_ctl::plan::{Finish, Phase, Ramps};
use pyo3::prelude::*;

use super::doser::Doser;
use super::plan::Plan;
use crate::argument::told;
use crate::argument::{Argument, cruise, finish_named, flag, optional, quantity, ramps_named, retracted_ml};
use crate::python::errors::value;

#[pymethods]
impl Doser {
    /// Plan a dose and predict its pressures. Nothing moves. Other Python threads run meanwhile.
    ///
    /// Parameters
    /// ----------
    /// volume : str
    ///     Volume or mass with its unit, as "25mL", "0.025 L", "250uL", "25 g"; negative in reverse.
    /// rate : str, optional
    ///     Average flow while cruising, as "10 mL/s"; "max" is the fastest flow that holds every limit.
    /// speed : str, optional
    ///     Speed of the pump head while cruising, as "100rpm".
    /// within : str, optional
    ///     Total time with ramps and settling, as "10s"; the plan takes the slowest cruise that meets it. Give at most
    ///     one of `rate`, `speed` and `within`. The default is the pump's `default_rate_ml_s`.
    /// smooth : bool
    ///     Let the speed follow the rollers' angle, so that the flow at the outlet is as smooth as the motor's speed
    ///     and acceleration allow. Rate and speed are then means over whole pitches.
    /// finish : {"any", "low-flow"}
    ///     Places in a pitch where the dose may end. At "low-flow" the outlet's flow is at most half of the flow
    ///     between pulses. The plan takes the nearest such end and carries the difference.
    /// ramps : {"line", "fastest"}
    ///     Ramps in which the dose starts and stops. Line-aware ramps leave the outlet's line nearly at rest, so that
    ///     it settles soonest and takes little back. "fastest" is the motor's largest acceleration.
    /// retract : str, optional
    ///     Volume that is sucked back after the dose, as "0.1mL", so that nothing drips. `carry_ml` includes it, so the
    ///     next dose repays it.
    /// start_angle_rad : float, optional
    ///     Angle of the rollers at the start, rad; by default 0. Only the angle within a pitch matters.
    /// start_half_width_rad : float
    ///     Half width of the start angle, rad: the true angle lies within it on either side. Half a pitch and more, as
    ///     `math.pi`, means an unknown angle. The plan then has the smallest worst case over all angles, and whole
    ///     pitches are exact.
    /// carry_in_ml : float
    ///     Carry from earlier doses, mL, positive toward the outlet: `carry_ml` of the previous plan.
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
    ///     If a text is not the expected quantity, or a number is outside its range.
    /// PlanError
    ///     If the pump cannot make the dose, for example because its rate or pressure is beyond a limit.
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    #[pyo3(signature = (
        volume, *, rate=None, speed=None, within=None, smooth=None, finish=None, ramps=None, retract=None,
        start_angle_rad=None, start_half_width_rad=None, carry_in_ml=None
    ), text_signature = "($self, volume, *, rate=None, speed=None, within=None, smooth=False, finish=\"any\", \
        ramps=\"line\", retract=None, start_angle_rad=None, start_half_width_rad=0.0, carry_in_ml=0.0)")]
    fn plan(
        slf: &Bound<'_, Self>,
        volume: &Bound<'_, PyAny>,
        rate: Option<&Bound<'_, PyAny>>,
        speed: Option<&Bound<'_, PyAny>>,
        within: Option<&Bound<'_, PyAny>>,
        smooth: Argument<'_, '_>,
        finish: Argument<'_, '_>,
        ramps: Argument<'_, '_>,
        retract: Option<&Bound<'_, PyAny>>,
        start_angle_rad: Argument<'_, '_>,
        start_half_width_rad: Argument<'_, '_>,
        carry_in_ml: Argument<'_, '_>,
    ) -> PyResult<Plan> {
        let start_angle_rad = optional("start_angle_rad", start_angle_rad)?.unwrap_or_default();
        let start_half_width_rad =
            optional("start_half_width_rad", start_half_width_rad)?.unwrap_or_default();
        let carry_in_ml = optional("carry_in_ml", carry_in_ml)?.unwrap_or_default();
        let doser = slf.get();
        let amount = quantity("volume", "25mL", volume, units::dose_amount)?;
        let request = DoseRequest::new(
            Purpose::Dose,
            Weighing::of(&doser.pump.get().file).amount_ml(amount).map_err(value)?,
        )
        .with_cruise(cruise(rate, speed, within)?)
        .with_smooth(flag("smooth", smooth)?)
        .with_finish(finish.map_or(Ok(Finish::Any), |finish| finish_named(told("finish", finish)?))?)
        .with_ramps(ramps.map_or(Ok(Ramps::LineAware), |ramps| ramps_named(told("ramps", ramps)?))?)
        .with_retraction(retracted_ml(retract)?)
        .with_pressures(doser.limits.pressures())
        .with_start_angle(start_angle_rad, start_half_width_rad);
        let start = Phase::within(start_angle_rad, start_half_width_rad);
        Plan::new(slf, request, start, carry_in_ml)
    }
}
