//! The records of pumps that another process moves.

use std::time::Duration;

use super::pump::Pump;
use super::service::Service;

/// Time between two looks.
const APART: Duration = Duration::from_secs(1);

/// Looks at the record of each pump, and tells those that have changed.
pub(super) async fn keep_fresh(service: Service) {
    loop {
        tokio::time::sleep(APART).await;
        let service = service.clone();
        let looked = tokio::task::spawn_blocking(move || {
            // The record of a pump that carries out an order is read once that has ended.
            let at_rest = service.pumps().filter(|pump| !service.is_ordered(pump));
            let changed: Vec<&Pump> = at_rest.filter(|pump| service.refresh(pump).has_changed).collect();
            changed.iter().for_each(|pump| service.tell("pump", &service.view(pump)));
        });
        if looked.await.is_err() {
            return;
        }
    }
}
