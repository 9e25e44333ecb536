//! The speed of a flow.

use pump_model::Pump;
use pump_model::units::TURN_RAD;

/// Returns the speed, rad/s, whose mean flow over whole pitches is `flow_ml_s`. It is the inverse of
/// [`Pump::average_flow_ml_s`].
///
/// ```
/// let pump = pump_model::Pump::three_roller();
/// let speed = pump_ctl::plan::speed_for_flow(&pump, 5.0);
/// assert!((pump.average_flow_ml_s(speed) - 5.0).abs() < 1e-12);
/// ```
pub fn speed_for_flow(pump: &Pump, flow_ml_s: f64) -> f64 {
    flow_ml_s * TURN_RAD / pump.revolution_ml()
}
