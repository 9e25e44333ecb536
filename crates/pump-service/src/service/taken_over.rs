//! Orders of a history that was lost, from the log of their pump.

use std::error::Error;
use std::time::Duration;

use jiff::Timestamp;
use pump_bench::record::{LogEnd, LogEntry, LogLine, Purpose};
use pump_bench::report::with_sources;

use super::error::ServiceError;
use super::pump::Pump;
use crate::history::{OrderRecord, OrderState};
use crate::order::{Order, OrderId, Task};

/// Giver of these orders: the log does not tell who gave them.
const GIVER: &str = "the pump's log";

/// Returns the orders that the log of a pump tells, oldest first. Runs of a calibration, retractions and turns to a
/// mark are no orders.
pub(super) fn orders(pump: &Pump) -> Result<Vec<OrderRecord>, ServiceError> {
    let failed =
        |error: &dyn Error| ServiceError::Pump { name: pump.name().to_owned(), message: with_sources(error) };
    let mut orders = Vec::new();
    for line in pump.bench().log().map_err(|error| failed(&error))? {
        // A damaged line is told by whoever reads the log; the doses beside it are known.
        if let LogLine::Dose(entry) = line.map_err(|error| failed(&error))?
            && let Some(task) = task(&entry)
        {
            let id = OrderId::random().map_err(|error| failed(&error))?;
            orders.push(order(id, Order::new(pump.name(), task), &entry));
        }
    }
    Ok(orders)
}

fn order(id: OrderId, order: Order, entry: &LogEntry) -> OrderRecord {
    let seconds = i64::try_from(entry.time.unix_s).unwrap_or(i64::MAX);
    let begun = Timestamp::from_second(seconds).unwrap_or(Timestamp::MAX);
    let lasted = Duration::try_from_secs_f64(entry.motion_s.unwrap_or(0.0)).unwrap_or_default();
    let state = match entry.end {
        LogEnd::Done | LogEnd::Weighed => OrderState::Done,
        LogEnd::CutOff => OrderState::CutOff,
        _ => OrderState::Failed,
    };
    let mut record = OrderRecord::begun(id, order, GIVER.to_owned(), begun);
    record.state = state;
    record.ended = Some(begun.checked_add(lasted).unwrap_or(begun));
    record.messages = vec![delivered(entry)];
    record
}

/// Returns the thing that was asked for. The log has the volume as it was typed, and not the options.
fn task(entry: &LogEntry) -> Option<Task> {
    let volume =
        || entry.asked.map_or_else(|| format!("{}mL", entry.requested_ml), |asked| asked.as_str().to_owned());
    match entry.purpose {
        Purpose::Dose => Some(Task::Dose { volume: volume() }),
        Purpose::Prime => Some(Task::Prime { volume: volume() }),
        Purpose::Purge => Some(Task::Purge { volume: volume() }),
        Purpose::Run => Some(Task::Run),
        _ => None,
    }
}

fn delivered(entry: &LogEntry) -> String {
    let sure = entry.expanded_uncertainty_ml.map_or(String::new(), |sure_ml| format!(" ± {sure_ml:.3} mL"));
    format!("delivered {:.3} mL{sure}; the log of the pump has the rest", entry.delivered_ml)
}
