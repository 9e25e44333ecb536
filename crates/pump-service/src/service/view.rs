//! A pump as people and programs are shown it.

use jiff::Timestamp;
use pump_bench::report::Status;
use pump_model::units::degrees;
use serde::Serialize;
use serde_json::Value;

use super::pump::Pump;
use super::whole::WholeDose;
use crate::order::OrderId;

/// Pump as people and programs are shown it, `pump-view/1`.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct PumpView {
    /// `pump-view/1`.
    pub schema: &'static str,
    /// Name of the pump in the configuration.
    pub name: String,
    /// Id of the pump file, which reports name.
    pub id: String,
    /// Title of the pump file.
    pub title: String,
    /// True if no motor moves.
    pub simulated: bool,
    /// Driver of the motor.
    pub driver: String,
    /// Port of the motor's board; null without one.
    pub port: Option<String>,
    /// Number of rollers.
    pub rollers: u32,
    /// Angle from one roller to the next, deg.
    pub pitch_deg: f64,
    /// Flow that a dose takes if nobody names one, mL/s.
    pub default_flow_ml_s: f64,
    /// Record of the pump, `status/1`; null if it cannot be read.
    pub status: Option<Status>,
    /// Reason why the record cannot be read; null if it can.
    pub error: Option<String>,
    /// Last dose, prime, purge or run of the log, `log/1`; null without one.
    pub last: Option<Value>,
    /// Dose that was resumed, all its parts together, if `last` is its last part; null otherwise.
    pub whole: Option<WholeDose>,
    /// Order that is carried out now; null while there is none.
    pub order: Option<OrderId>,
    /// Word of the task that is carried out now.
    pub task: Option<&'static str>,
    /// Plan of the present motion, `dose/1`; null while none is known.
    pub plan: Option<Value>,
    /// Last line of progress, `progress/1`; null while none is known.
    pub progress: Option<Value>,
    /// Time since which the process of the order is silent although its motor turned; null while it speaks.
    pub silent_since: Option<Timestamp>,
    /// Time at which the order was asked to stop; null if it was not.
    pub stop_asked: Option<Timestamp>,
}

impl PumpView {
    /// The view of a pump that carries out nothing.
    pub(super) fn of(
        pump: &Pump,
        status: Option<Status>,
        error: Option<String>,
        last: Option<Value>,
    ) -> Self {
        let (bench, model) = (pump.bench(), pump.bench().model());
        let pitch_deg = rounded(degrees(model.pitch_rad()));
        Self {
            schema: "pump-view/1",
            name: pump.name().to_owned(),
            id: bench.file().pump.id.clone(),
            title: bench.file().pump.name.clone(),
            simulated: bench.is_simulated(),
            driver: bench.drive_id().to_owned(),
            port: bench.board_port().map(|port| port.display().to_string()),
            rollers: (360.0 / pitch_deg).round() as u32,
            pitch_deg,
            default_flow_ml_s: pump.default_flow_ml_s(),
            status,
            error,
            last,
            whole: None,
            order: None,
            task: None,
            plan: None,
            progress: None,
            silent_since: None,
            stop_asked: None,
        }
    }
}

/// Rounds an angle in deg to twelve digits: a pitch of a third of a turn is 120.
fn rounded(angle_deg: f64) -> f64 {
    let unit = 10f64.powi(11 - angle_deg.abs().log10().floor() as i32);
    (angle_deg * unit).round() / unit
}
