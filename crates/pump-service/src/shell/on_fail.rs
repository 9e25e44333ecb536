//! The command that tells a person of a failure which nobody watched.

use serde_json::Value;

use super::command;
use crate::order::{Order, Task};

/// Failure that a person is told of.
#[derive(Debug, Clone)]
pub(crate) struct Failed {
    /// Name of the pump; empty for a rack.
    pub(crate) pump: String,
    /// Name of the rack; empty for a pump.
    pub(crate) rack: String,
    /// Reason, `error/1`.
    pub(crate) report: Value,
    /// Smallest and largest volume that was delivered, mL. `None` if nobody knows.
    pub(crate) delivered_ml: Option<(f64, f64)>,
}

impl Failed {
    /// The failure of an order that has delivered so much, for this reason.
    pub(crate) fn of(order: &Order, report: Value, delivered_ml: Option<(f64, f64)>) -> Self {
        let rack = if let Task::Rack { rack } = &order.task { rack.clone() } else { String::new() };
        Self { pump: order.pump.clone(), rack, report, delivered_ml }
    }
}

/// Runs the command `on_fail` with a failure. Returns words about the command if that fails itself.
pub(crate) async fn on_fail(
    on_fail: String,
    failed: Failed,
    is_ending: impl Fn() -> bool + Send + 'static,
) -> Option<String> {
    let ran = tokio::task::spawn_blocking(move || {
        let Failed { pump, rack, report, delivered_ml } = &failed;
        let code = report.get("code").map(Value::to_string).unwrap_or_default();
        let kind = report.get("kind").and_then(Value::as_str).unwrap_or_default();
        let bounds = delivered_ml.map(|(least_ml, most_ml)| (least_ml.to_string(), most_ml.to_string()));
        let (least_ml, most_ml) = bounds.unwrap_or_default();
        let variables = [
            ("DOSE_FAIL_PUMP", pump.as_str()),
            ("DOSE_FAIL_RACK", rack.as_str()),
            ("DOSE_FAIL_CODE", code.as_str()),
            ("DOSE_FAIL_KIND", kind),
            ("DOSE_FAIL_LEAST_ML", least_ml.as_str()),
            ("DOSE_FAIL_MOST_ML", most_ml.as_str()),
        ];
        command::run(&on_fail, &variables, &format!("{report}\n"), is_ending)
    });
    let failed = match ran.await {
        Ok(Ok(ended)) => match ended.status {
            Some(status) if status.success() => return None,
            Some(status) => format!("ended with {status}: {}", ended.line),
            None => format!("was ended after {:?}", command::LONGEST),
        },
        Ok(Err(error)) => format!("could not be run: {error}"),
        Err(error) => format!("could not be run: {error}"),
    };
    Some(format!("the command `on_fail` of the configuration {failed}"))
}
