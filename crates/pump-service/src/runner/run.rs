//! One run of an entry.

use std::time::Duration;

use jiff::Timestamp;
use serde_json::Value;

use crate::history::{OrderRecord, OrderState};
use crate::order::{Choice, Options, Order, OrderId, Origin, Task};
use crate::schedule::{Action, Due, Entry, Setting};
use crate::service::{Refusal, Service, error_report};
use crate::shell::Failed;
use crate::worker::message_of;

/// Time between two tries of a run that waits for its pump.
const APART: Duration = Duration::from_secs(1);

/// Time between two looks at an order that runs.
const LOOK: Duration = Duration::from_millis(100);

/// Kind of the notes of the schedule.
pub(super) const KIND: &str = "schedule";

/// A run of an entry as an order, and until when it waits for its pump.
#[derive(Debug)]
pub(super) struct Run {
    order: Order,
    origin: Origin,
    /// The run in words: the entry, and its planned time.
    words: String,
    waits_until: Option<Timestamp>,
}

impl Run {
    /// The run of an entry that is due. One that was missed is made up for at `now`.
    pub(super) fn of(due: &Due<'_>, now: Timestamp) -> Self {
        Self {
            order: order(due.entry),
            origin: Origin::Schedule(due.entry.name().to_owned()),
            words: due.to_string(),
            waits_until: due.entry.waits_until(due.planned.max(now)),
        }
    }

    /// Gives the order, waits for a pump in use as the entry says, and then for the end. Returns true if all was done.
    /// Tells everything that was not made or not done.
    async fn make(&self, service: &Service, now: fn() -> Timestamp) -> bool {
        let Self { order, origin, words, waits_until } = self;
        let told = |text: &str| service.note(KIND, Some(&order.pump), &format!("{words}: {text}"));
        let report = loop {
            let (is_busy, report) = match service.place(order.clone(), origin, None).await {
                Ok(placed) if placed.record.state != OrderState::Refused => {
                    told("begun");
                    match ended(service, &placed.record.id).await {
                        Ok(record) if record.state == OrderState::Done => return true,
                        Ok(record) if record.state == OrderState::Refused => break reason(record),
                        Ok(record) => {
                            // The command, or the one who saw it killed, has told the failure to `on_fail`.
                            told(&format!("{}: {}", record.state.word(), message_of(&reason(record))));
                        }
                        Err(refusal) => told(&format!("its end cannot be read: {refusal}")),
                    }
                    return false;
                }
                Ok(placed) => (placed.record.code == Some(3), reason(placed.record)),
                Err(refusal) => (matches!(refusal, Refusal::Busy { .. }), refusal.report()),
            };
            if !is_busy || waits_until.is_none_or(|until| now() >= until) {
                break report;
            }
            tokio::time::sleep(APART).await;
        };
        told(&format!("not made: {}", message_of(&report)));
        service.on_fail(KIND, Failed::of(order, report, Some((0.0, 0.0)))).await;
        false
    }
}

/// Makes runs of one pump one after the other, the earliest first. The runs behind one that did not end as it should
/// are left out and told: a person stopped it, or something is wrong.
pub(super) async fn in_turn(runs: Vec<Run>, service: Service, now: fn() -> Timestamp) {
    let mut runs = runs.into_iter();
    while let Some(run) = runs.next() {
        if !run.make(&service, now).await {
            for left in runs {
                let text = format!("{}: left out, because {} was not made to its end", left.words, run.words);
                service.note(KIND, Some(&left.order.pump), &text);
            }
            return;
        }
    }
}

/// Waits for the end of an order, which the end of the service brings too.
async fn ended(service: &Service, order: &OrderId) -> Result<OrderRecord, Refusal> {
    loop {
        match service.order(order)? {
            Some(record) if record.state != OrderState::Running => return Ok(record),
            _ => tokio::time::sleep(LOOK).await,
        }
    }
}

/// The reason why an order was refused or failed, `error/1`.
fn reason(record: OrderRecord) -> Value {
    let code = record.code.and_then(|code| u8::try_from(code).ok()).unwrap_or(1);
    let unknown =
        || error_report(code, "command", &format!("the command gave no reason, and exit code {code}"));
    record.error.unwrap_or_else(unknown)
}

/// The order of an entry.
pub(super) fn order(entry: &Entry) -> Order {
    let mut options: Options = entry
        .options()
        .iter()
        .map(|(name, setting)| {
            let choice = match setting {
                Setting::Text(text) => Choice::Text(text.clone()),
                Setting::On => Choice::Switch(true),
            };
            (name.clone(), choice)
        })
        .collect();
    let mut text = |name: &str, value: String| drop(options.insert(name.to_owned(), Choice::Text(value)));
    text("unfinished", entry.unfinished().as_str().to_owned());
    let (pump, task) = match entry.action() {
        Action::Dose { pump, volume, batch } => {
            if let Some(batch) = batch {
                text("repeat", batch.repeat.to_string());
                batch.every.iter().for_each(|every| text("every", every.as_str().to_owned()));
            }
            (pump.as_str(), Task::Dose { volume: volume.clone() })
        }
        Action::Prime { pump, volume } => (pump.as_str(), Task::Prime { volume: volume.clone() }),
        Action::Rack { rack } => ("", Task::Rack { rack: rack.clone() }),
    };
    Order { options, ..Order::new(pump, task) }
}
