//! The records of pumps as they change: another process moves a pump, or an order does, or a day passes.

use std::time::Duration;

use super::pump::Pump;
use super::service::Service;

/// Time between two looks.
const APART: Duration = Duration::from_secs(1);

/// Number of looks from one reading of a pump at rest to its next: volumes of the day before become free.
const AT_REST: u32 = 60;

/// Looks at the record of each pump, and tells those that have changed.
pub(super) async fn keep_fresh(service: Service) {
    for look in 1u32.. {
        tokio::time::sleep(APART).await;
        let service = service.clone();
        let looked = tokio::task::spawn_blocking(move || {
            let has_changed = |pump: &&Pump| {
                // The record of a pump that carries out an order is read whole once that has ended.
                let is_ordered = service.is_ordered(pump);
                let is_new = !is_ordered && service.refresh(pump).has_changed;
                is_new || ((is_ordered || look.is_multiple_of(AT_REST)) && pump.refresh_counted())
            };
            service.pumps().filter(has_changed).for_each(|pump| service.tell("pump", &service.view(pump)));
        });
        if looked.await.is_err() {
            return;
        }
    }
}
