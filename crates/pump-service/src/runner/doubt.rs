//! Faults of an entry that its command tells before the night in which it is due.

use std::time::Duration;

use super::run::order;
use crate::order::{Order, OrderError};
use crate::schedule::{Action, Entry, NO_OPTIONS};
use crate::service::{Refusal, Service};
use crate::worker::message_of;

/// Longest time that a trial takes.
const LONGEST: Duration = Duration::from_secs(60);

/// Options of an order that are a batch.
const BATCH: [&str; 2] = ["repeat", "every"];

/// Kind of the errors of a pump file, and of a pump that nobody has confirmed.
const OF_PUMP: &str = "pump_file";

/// Refusal of an order that was tried out.
struct Refused {
    /// Fault and way out, in words.
    why: String,
    /// True if no order of the pump would be taken.
    is_of_pump: bool,
}

/// Returns the reason why the runs of an entry would be refused, as their command says that is tried out and moves
/// nothing. `None` if they would not be. The trial leaves the pump's record out: a pump that is in use, stands or has
/// an unfinished dose is ready again some day, and a wrong entry never is.
pub(super) async fn doubt(entry: &Entry, service: &Service) -> Option<String> {
    Some(refused(&order(entry), service).await?.why)
}

/// Returns the key whose value is in doubt: the first one without which the trial finds nothing.
pub(super) async fn doubted_key(entry: &Entry, service: &Service) -> &'static str {
    let with = async |options: &[&str]| {
        let mut order = order(entry);
        order.options.retain(|name, _| options.contains(&name.as_str()));
        refused(&order, service).await
    };
    let bare = with(&[]).await;
    match entry.action() {
        Action::Rack { .. } if bare.is_some() => "rack",
        _ if bare.as_ref().is_some_and(|refused| refused.is_of_pump) => "pump",
        Action::Dose { .. } if bare.is_some() => "dose",
        Action::Prime { .. } if bare.is_some() => "prime",
        Action::Dose { batch: Some(_), .. } if with(&BATCH).await.is_some() => "batch",
        _ => "options",
    }
}

/// Returns the refusal of an option that no order has. It names the options of an entry, which `allowed` has among
/// those of an order.
fn no_option(option: String, allowed: &str) -> String {
    let is_own = |name: &&str| !NO_OPTIONS.iter().any(|(known, _)| known == name);
    let allowed = allowed.split(", ").filter(is_own).collect::<Vec<_>>().join(", ");
    OrderError::Option { option, allowed }.to_string()
}

/// Returns the reason why an order would be refused.
async fn refused(order: &Order, service: &Service) -> Option<Refused> {
    let plain = |why: String| Some(Refused { why, is_of_pump: false });
    let tried = match tokio::time::timeout(LONGEST, service.try_out(order)).await {
        Ok(tried) => tried,
        Err(_) => return plain(format!("it could not be tried out within {LONGEST:?}")),
    };
    match tried {
        Err(Refusal::Order(OrderError::Option { option, allowed })) => plain(no_option(option, &allowed)),
        Err(refusal) => {
            let is_of_pump = matches!(refusal, Refusal::UnknownPump { .. });
            Some(Refused { why: refusal.to_string(), is_of_pump })
        }
        Ok(ended) if ended.code == 0 => None,
        Ok(ended) => match &ended.error {
            Some(report) => {
                let is_of_pump = report["kind"] == OF_PUMP;
                Some(Refused { why: message_of(report).to_owned(), is_of_pump })
            }
            None => plain(format!("its trial gave exit code {} and no reason", ended.code)),
        },
    }
}
