//! Faults of an entry that its command tells before the night in which it is due.

use std::time::Duration;

use pump_bench::units::dose_amount;

use crate::order::Choice;
use crate::schedule::{Action, Entry};
use crate::service::Service;
use crate::worker::message_of;

use super::run::order;

/// Longest time that a trial takes.
const LONGEST: Duration = Duration::from_secs(60);

/// Returns the reason why the runs of an entry would be refused, as their command says that is tried out and moves
/// nothing. `None` if it would not be, or for what passes: a pump that is in use, stands or has an unfinished dose.
pub(super) async fn doubt(entry: &Entry, service: &Service) -> Option<String> {
    let mut order = order(entry);
    order.options.insert("dry-run".to_owned(), Choice::Switch(true));
    let tried = match tokio::time::timeout(LONGEST, service.try_out(&order)).await {
        Ok(tried) => tried,
        Err(_) => return Some(format!("it could not be tried out within {LONGEST:?}")),
    };
    match tried {
        Err(refusal) => Some(refusal.to_string()),
        Ok(ended) if matches!(ended.code, 0 | 3..=5) => None,
        Ok(ended) => Some(match &ended.error {
            Some(report) => message_of(report).to_owned(),
            None => format!("its trial gave exit code {} and no reason", ended.code),
        }),
    }
}

/// Returns the key whose value is in doubt.
pub(super) fn doubted_key(entry: &Entry, service: &Service) -> &'static str {
    match entry.action() {
        Action::Rack { .. } => "rack",
        Action::Dose { pump, .. } | Action::Prime { pump, .. } if service.pump(pump).is_err() => "pump",
        Action::Dose { volume, .. } if dose_amount(volume).is_err() => "dose",
        Action::Prime { volume, .. } if dose_amount(volume).is_err() => "prime",
        Action::Dose { .. } | Action::Prime { .. } => "options",
    }
}
