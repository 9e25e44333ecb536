//! A pump is put to stand: by an order, as often as it takes until that is on the pump's record.

use std::time::Duration;

use pump_bench::report::ErrorKind;
use tokio::time::{Instant, sleep};

use super::command;
use crate::history::{OrderRecord, OrderState};
use crate::order::{Order, OrderId, Origin, Task};
use crate::service::{Pump, Refusal, Service, error_report};

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
                tell("another process has the pump and may move it; stop that one");
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

/// Runs the configuration's `on_fail` for a pump that was put to stand. Its own failure is told.
pub(super) async fn tell_of_stand(service: &Service, pump: &str, reason: &str) {
    let Some(on_fail) = service.config().on_fail().map(str::to_owned) else { return };
    let kind = ErrorKind::Safety.to_string();
    let message = format!("the guard has put pump {pump} to stand: {reason}");
    let input = format!("{}\n", error_report(5, &kind, &message));
    let (named, ending) = (pump.to_owned(), service.clone());
    let ran = tokio::task::spawn_blocking(move || {
        let variables = [
            ("DOSE_FAIL_PUMP", named.as_str()),
            ("DOSE_FAIL_RACK", ""),
            ("DOSE_FAIL_CODE", "5"),
            ("DOSE_FAIL_KIND", kind.as_str()),
            ("DOSE_FAIL_LEAST_ML", ""),
            ("DOSE_FAIL_MOST_ML", ""),
        ];
        command::run(&on_fail, &variables, &input, || ending.is_ending())
    });
    let failed = match ran.await {
        Ok(Ok(ended)) => match ended.status {
            Some(status) if status.success() => return,
            Some(status) => format!("ended with {status}: {}", ended.line),
            None => format!("was ended after {:?}", command::LONGEST),
        },
        Ok(Err(error)) => format!("could not be run: {error}"),
        Err(error) => format!("could not be run: {error}"),
    };
    service.note(KIND, Some(pump), &format!("the command `on_fail` of the configuration {failed}"));
}
