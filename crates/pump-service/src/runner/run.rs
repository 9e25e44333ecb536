//! One run of an entry.

use std::time::Duration;

use jiff::Timestamp;

use crate::history::OrderState;
use crate::order::{Choice, Options, Order, OrderId, Origin, Task};
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
    /// The run of an entry that is due. One that was missed is made up for at `now`.
    pub(super) fn of(due: &Due<'_>, now: Timestamp) -> Self {
        Self {
            order: order(due.entry),
            origin: Origin::Schedule(due.entry.name().to_owned()),
            words: due.to_string(),
            waits_until: due.entry.waits_until(due.planned.max(now)),
        }
    }

    /// Gives the order, and waits for a pump in use as the entry says. What was not made is told. Returns the order
    /// that was begun.
    async fn make(&self, service: &Service, now: fn() -> Timestamp) -> Option<OrderId> {
        let Self { order, origin, words, waits_until } = self;
        let pump = order.pump.clone();
        let told = |text: &str| service.note("schedule", Some(&pump), &format!("{words}: {text}"));
        loop {
            let placed = service.place(order.clone(), origin, None).await;
            let (is_busy, why) = match placed {
                Ok(placed) if placed.record.state == OrderState::Refused => {
                    let error = placed.record.error.as_ref().and_then(|error| error.get("message"));
                    let why =
                        error.and_then(|message| message.as_str()).unwrap_or("it was refused").to_owned();
                    (placed.record.code == Some(3), why)
                }
                Ok(placed) => {
                    told("begun");
                    return Some(placed.record.id);
                }
                Err(refusal @ Refusal::Busy { .. }) => (true, refusal.to_string()),
                Err(refusal) => (false, refusal.to_string()),
            };
            if !is_busy || waits_until.is_none_or(|until| now() >= until) {
                told(&format!("not made: {why}"));
                return None;
            }
            tokio::time::sleep(APART).await;
        }
    }
}

/// Makes runs of one pump one after the other, the earliest first. The runs behind one that did not end as it should
/// are left out and told: a person stopped it, or something is wrong.
pub(super) async fn in_turn(runs: Vec<Run>, service: Service, now: fn() -> Timestamp) {
    let mut runs = runs.into_iter().peekable();
    while let Some(run) = runs.next() {
        let begun = run.make(&service, now).await;
        if runs.peek().is_none() {
            return;
        }
        let is_done = match begun {
            Some(order) => ended(&service, &order).await == Some(OrderState::Done),
            None => false,
        };
        if !is_done {
            for left in runs {
                let text = format!("{}: left out, because {} was not made to its end", left.words, run.words);
                service.note("schedule", Some(&left.order.pump), &text);
            }
            return;
        }
    }
}

/// Waits for the end of an order. `None` if the service ends before it, or cannot tell.
async fn ended(service: &Service, order: &OrderId) -> Option<OrderState> {
    while !service.is_ending() {
        match service.order(order).ok()??.state {
            OrderState::Running => tokio::time::sleep(APART).await,
            state => return Some(state),
        }
    }
    None
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
