//! Faults of an entry that its command tells before the night in which it is due.

use std::time::Duration;

use super::run::order;
use crate::order::Order;
use crate::schedule::{Action, Entry};
use crate::service::Service;
use crate::worker::message_of;

/// Longest time that a trial takes.
const LONGEST: Duration = Duration::from_secs(60);

/// Options of an order that are a batch.
const BATCH: [&str; 2] = ["repeat", "every"];

/// Returns the reason why the runs of an entry would be refused, as their command says that is tried out and moves
/// nothing. `None` if they would not be. The trial leaves the pump's record out: a pump that is in use, stands or has
/// an unfinished dose is ready again some day, and a wrong entry never is.
pub(super) async fn doubt(entry: &Entry, service: &Service) -> Option<String> {
    refused(&order(entry), service).await
}

/// Returns the key whose value is in doubt: the first one without which the trial finds nothing.
pub(super) async fn doubted_key(entry: &Entry, service: &Service) -> &'static str {
    let with = async |options: &[&str]| {
        let mut order = order(entry);
        order.options.retain(|name, _| options.contains(&name.as_str()));
        refused(&order, service).await.is_some()
    };
    match entry.action() {
        Action::Dose { pump, .. } | Action::Prime { pump, .. } if service.pump(pump).is_err() => "pump",
        Action::Dose { .. } if with(&[]).await => "dose",
        Action::Dose { batch: Some(_), .. } if with(&BATCH).await => "batch",
        Action::Prime { .. } if with(&[]).await => "prime",
        Action::Rack { .. } if with(&[]).await => "rack",
        _ => "options",
    }
}

/// Returns the reason why an order would be refused.
async fn refused(order: &Order, service: &Service) -> Option<String> {
    let tried = match tokio::time::timeout(LONGEST, service.try_out(order)).await {
        Ok(tried) => tried,
        Err(_) => return Some(format!("it could not be tried out within {LONGEST:?}")),
    };
    match tried {
        Err(refusal) => Some(refusal.to_string()),
        Ok(ended) if ended.code == 0 => None,
        Ok(ended) => Some(match &ended.error {
            Some(report) => message_of(report).to_owned(),
            None => format!("its trial gave exit code {} and no reason", ended.code),
        }),
    }
}
