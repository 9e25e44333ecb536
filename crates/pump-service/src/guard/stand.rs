//! A pump is put to stand: by an order, as often as it takes until that is on the pump's record.

use std::time::Duration;

use pump_bench::report::ErrorKind;
use tokio::time::{Instant, sleep};

use crate::history::{OrderRecord, OrderState};
use crate::order::{Order, OrderId, Origin, Task};
use crate::service::{Pump, Refusal, Service, error_report};
use crate::shell::Failed;

/// Kind of the notes of the guard.
pub(super) const KIND: &str = "guard";

/// Time between two looks at a pump that is to be put to stand.
const LOOK: Duration = Duration::from_millis(20);

/// Time after which people are told that a stand is not on record yet.
const TOLD_AFTER: Duration = Duration::from_secs(5);

/// Times between two orders to stand that failed.
const FIRST_PAUSE: Duration = Duration::from_secs(1);
const LONGEST_PAUSE: Duration = Duration::from_secs(60);

/// Puts the pump to stand. Returns true once that is on record, and false if the service ends before.
pub(super) async fn put_to_stand(service: &Service, pump: &Pump, reason: &str) -> bool {
    let tell_at = Instant::now() + TOLD_AFTER;
    let (mut is_told, mut pause) = (false, FIRST_PAUSE);
    let mut tell = |why: &str| {
        if !std::mem::replace(&mut is_told, true) {
            let name = pump.name();
            let text =
                format!("{name} does not stand on record yet, and this is tried again until it does: {why}");
            service.note(KIND, Some(name), &text);
        }
    };
    while !service.is_ending() {
        // The order that was stopped ends first. Nothing else begins: the service keeps the pump still.
        if service.is_ordered(pump) || pump.bench().is_held() {
            if Instant::now() >= tell_at {
                tell(if service.is_ordered(pump) {
                    "the order that was stopped for it has not ended yet; the service ends its process if that does \
                     not answer"
                } else {
                    "another process has the pump and may move it; stop that one"
                });
            }
            sleep(LOOK).await;
            continue;
        }
        match ordered(service, pump, reason).await {
            Ok(record) if record.state == OrderState::Done => return true,
            // Another process was faster.
            Ok(OrderRecord { code: Some(3), .. }) | Err(Refusal::Busy { .. }) => sleep(LOOK).await,
            Ok(record) => {
                let error = record.error.as_ref().and_then(|error| error.get("message")?.as_str());
                tell(error.unwrap_or("the order to stand failed"));
                sleep(pause).await;
                pause = LONGEST_PAUSE.min(2 * pause);
            }
            Err(refusal) => {
                tell(&refusal.to_string());
                sleep(pause).await;
                pause = LONGEST_PAUSE.min(2 * pause);
            }
        }
    }
    false
}

/// Orders the pump to stand, and returns the order once it has ended.
async fn ordered(service: &Service, pump: &Pump, reason: &str) -> Result<OrderRecord, Refusal> {
    let order = Order::new(pump.name(), Task::Stand { reason: reason.to_owned() });
    let mut record = service.place(order, &Origin::Guard, None).await?;
    while record.record.state == OrderState::Running {
        sleep(LOOK).await;
        let id: OrderId = record.record.id.clone();
        match service.order(&id)? {
            Some(found) => record.record = found,
            None => break,
        }
    }
    Ok(record.record)
}

/// Runs the configuration's `on_fail` for a pump that was put to stand, with what the orders have delivered that were
/// `stopped` for it.
pub(super) async fn tell_of_stand(service: &Service, pump: &Pump, reason: &str, stopped: &[OrderId]) {
    let message = format!("the guard has put pump {} to stand: {reason}", pump.name());
    let mut report = error_report(5, ErrorKind::Safety.as_str(), &message);
    let delivered_ml = delivered_ml(pump, stopped);
    report["moved"] = delivered_ml.is_none_or(|(_, most_ml)| most_ml != 0.0).into();
    let (pump, rack) = (pump.name().to_owned(), String::new());
    service.on_fail(KIND, Failed { pump, rack, report, delivered_ml }).await;
}

/// Returns the smallest and largest volume that these orders have delivered with a pump, in mL. `None` if its record
/// cannot be read.
fn delivered_ml(pump: &Pump, orders: &[OrderId]) -> Option<(f64, f64)> {
    orders.iter().try_fold((0.0, 0.0), |(least_ml, most_ml), order| {
        let ((least, most), _) = pump.bench().delivered_by(order.as_str())?;
        Some((least_ml + least, most_ml + most))
    })
}
