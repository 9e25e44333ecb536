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
    /// True if nothing was delivered. Otherwise nobody knows the volume here: the pump's record has it.
    pub(crate) has_nothing: bool,
}

impl Failed {
    /// The failure of an order that may have delivered something, for this reason.
    pub(crate) fn of(order: &Order, report: Value) -> Self {
        let rack = if let Task::Rack { rack } = &order.task { rack.clone() } else { String::new() };
        Self { pump: order.pump.clone(), rack, report, has_nothing: false }
    }
}

/// Runs the command `on_fail` with a failure. Returns words about the command if that fails itself.
pub(crate) async fn on_fail(
    on_fail: String,
    failed: Failed,
    is_ending: impl Fn() -> bool + Send + 'static,
) -> Option<String> {
    let ran = tokio::task::spawn_blocking(move || {
        let Failed { pump, rack, report, has_nothing } = &failed;
        let code = report.get("code").map(Value::to_string).unwrap_or_default();
        let kind = report.get("kind").and_then(Value::as_str).unwrap_or_default();
        let volume = if *has_nothing { "0" } else { "" };
        let variables = [
            ("DOSE_FAIL_PUMP", pump.as_str()),
            ("DOSE_FAIL_RACK", rack.as_str()),
            ("DOSE_FAIL_CODE", code.as_str()),
            ("DOSE_FAIL_KIND", kind),
            ("DOSE_FAIL_LEAST_ML", volume),
            ("DOSE_FAIL_MOST_ML", volume),
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
