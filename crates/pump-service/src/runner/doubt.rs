//! Faults of an entry that only the service's configuration can tell.

use pump_bench::units::dose_amount;

use crate::schedule::{Action, Entry};
use crate::service::Service;

/// Returns the reason why the runs of an entry would be refused: a pump or a rack that the configuration does not have,
/// or a volume that nobody can read. `None` if none is known.
pub(super) fn doubt(entry: &Entry, service: &Service) -> Option<String> {
    let (pump, volume) = match entry.action() {
        Action::Dose { pump, volume, .. } | Action::Prime { pump, volume } => (pump, volume),
        Action::Rack { rack } => {
            let racks = service.config().racks();
            let known: Vec<&str> = racks.keys().map(String::as_str).collect();
            return (!racks.contains_key(rack))
                .then(|| format!("the configuration has no rack `{rack}`; it has {}", list(&known)));
        }
    };
    if let Err(refusal) = service.pump(pump) {
        return Some(refusal.to_string());
    }
    dose_amount(volume).err().map(|error| error.to_string())
}

/// Returns the key whose value is in doubt.
pub(super) fn doubted_key(entry: &Entry, service: &Service) -> &'static str {
    match entry.action() {
        Action::Rack { .. } => "rack",
        Action::Dose { pump, .. } | Action::Prime { pump, .. } if service.pump(pump).is_err() => "pump",
        Action::Dose { .. } => "dose",
        Action::Prime { .. } => "prime",
    }
}

fn list(names: &[&str]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
