//! One run of an entry.

use std::time::Duration;

use jiff::Timestamp;

use crate::history::OrderState;
use crate::order::{Choice, Options, Order, Origin, Task};
use crate::schedule::{Action, Due, Entry, Setting};
use crate::service::{Refusal, Service};

/// Time between two tries of a run that waits for its pump.
const APART: Duration = Duration::from_secs(1);

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
    /// The run of an entry that is due.
    pub(super) fn of(due: &Due<'_>) -> Self {
        Self {
            order: order(due.entry),
            origin: Origin::Schedule(due.entry.name().to_owned()),
            words: due.to_string(),
            waits_until: due.entry.waits_until(due.planned),
        }
    }

    /// Gives the order, and waits for a pump in use as the entry says. What was not made is told.
    pub(super) async fn make(self, service: Service, now: fn() -> Timestamp) {
        let Self { order, origin, words, waits_until } = self;
        let pump = order.pump.clone();
        let told = |text: &str| service.note("schedule", Some(&pump), &format!("{words}: {text}"));
        loop {
            let placed = service.place(order.clone(), &origin, None).await;
            let (is_busy, why) = match placed {
                Ok(placed) if placed.record.state == OrderState::Refused => {
                    let error = placed.record.error.as_ref().and_then(|error| error.get("message"));
                    let why =
                        error.and_then(|message| message.as_str()).unwrap_or("it was refused").to_owned();
                    (placed.record.code == Some(3), why)
                }
                Ok(_) => return told("begun"),
                Err(refusal @ Refusal::Busy { .. }) => (true, refusal.to_string()),
                Err(refusal) => (false, refusal.to_string()),
            };
            if !is_busy || waits_until.is_none_or(|until| now() >= until) {
                return told(&format!("not made: {why}"));
            }
            tokio::time::sleep(APART).await;
        }
    }
}

/// The order of an entry.
fn order(entry: &Entry) -> Order {
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
