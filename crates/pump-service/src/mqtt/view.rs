//! The state of a pump as its topic has it.

use pump_bench::report::StandStatus;
use serde::Serialize;
use serde_json::Value;

use crate::order::OrderId;
use crate::service::PumpView;

/// Words of the states.
pub(super) const STATES: [&str; 6] = ["idle", "moving", "waiting", "unfinished", "stands", "unknown"];

/// Words of the states that somebody should look after.
pub(super) const PROBLEMS: [&str; 3] = ["unfinished", "stands", "unknown"];

/// State of a pump, `mqtt-pump/1`.
#[derive(Debug, Serialize)]
pub(super) struct State<'a> {
    schema: &'static str,
    state: &'static str,
    /// Angle of the rollers on record, deg; null if it is not known.
    angle_deg: Option<f64>,
    /// Carry to the next dose, mL.
    carry_ml: Option<f64>,
    /// Volume that the tube has pumped, mL.
    tube_ml: Option<f64>,
    /// Volumes that the safety limits count by now, and that of the motion under way, mL.
    day_ml: Option<f64>,
    received_ml: Option<f64>,
    under_way_ml: Option<f64>,
    /// Volume of the last dose, prime, purge or run on record, mL; the middle of its bounds while it is unfinished, and
    /// all its parts if it was resumed.
    delivered_ml: Option<f64>,
    /// Volume that it was asked for, mL; that of the whole dose while it is unfinished, or if it was resumed.
    asked_ml: Option<f64>,
    order: Option<&'a OrderId>,
    task: Option<&'static str>,
    /// Reason why the pump stands; null if it does not.
    reason: Option<String>,
    /// Reason why the record cannot be read.
    error: Option<&'a str>,
}

impl<'a> State<'a> {
    /// The state of a pump. `motion` is the word of a line of progress that is not in the view, as that of a rack.
    pub(super) fn of(view: &'a PumpView, motion: Option<&'static str>) -> Self {
        let status = view.status.as_ref();
        let of_last = |key: &str| view.last.as_ref()?.get(key)?.as_f64();
        let of_whole = view.whole.map(|whole| (whole.delivered_ml, whole.requested_ml));
        let unfinished = status.and_then(|status| status.unfinished.as_ref());
        let of_unfinished = unfinished
            .map(|dose| (0.5 * (dose.delivered_least_ml + dose.delivered_most_ml), dose.requested_ml))
            .or(of_whole);
        Self {
            schema: "mqtt-pump/1",
            state: motion.unwrap_or_else(|| word(view)),
            angle_deg: status.and_then(|status| status.angle_deg),
            carry_ml: status.map(|status| status.carry_ml),
            tube_ml: status.map(|status| status.wear.volume_ml),
            day_ml: status.map(|status| status.safety.day_ml),
            received_ml: status.map(|status| status.safety.received_ml),
            under_way_ml: status.map(|status| status.safety.under_way_ml),
            delivered_ml: of_unfinished.map(|dose| dose.0).or_else(|| of_last("delivered_ml")),
            asked_ml: of_unfinished.map(|dose| dose.1).or_else(|| of_last("requested_ml")),
            order: view.order.as_ref(),
            task: view.task,
            reason: status.and_then(|status| status.safety.stand.as_ref()).map(reason),
            error: view.error.as_deref(),
        }
    }

    /// Returns the state as one line of JSON.
    pub(super) fn text(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("plain data: {error}"))
    }
}

/// Returns the words of a stand: those of its order, or the limit with its volumes.
fn reason(stand: &StandStatus) -> String {
    match &stand.reason {
        Some(reason) => reason.as_str().to_owned(),
        None => {
            let StandStatus { limit, used_ml, allowed_ml, .. } = stand;
            format!("limit of the {limit}: {used_ml:.2} mL were pumped, {allowed_ml:.2} mL are allowed")
        }
    }
}

/// Returns the word of a line of progress: `waiting` between the doses of a batch, otherwise `moving`.
pub(super) fn word_of_progress(progress: &Value) -> &'static str {
    if progress.get("state").and_then(Value::as_str) == Some("waiting") { "waiting" } else { "moving" }
}

fn word(view: &PumpView) -> &'static str {
    match (&view.progress, &view.plan, &view.status) {
        (Some(progress), _, _) => word_of_progress(progress),
        (None, Some(_), _) => "moving",
        (None, None, None) => "unknown",
        (None, None, Some(status)) if status.in_use_by.is_some() => "moving",
        (None, None, Some(status)) if status.safety.stand.is_some() => "stands",
        (None, None, Some(status)) if status.unfinished.is_some() => "unfinished",
        (None, None, Some(_)) => "idle",
    }
}
