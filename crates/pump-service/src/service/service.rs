//! The service: its pumps, its history, and the orders that are carried out now.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use jiff::Timestamp;
use pump_bench::config::Config;
use serde_json::{Value, json};
use tokio::sync::broadcast::{self, Receiver, Sender};
use tokio::sync::mpsc::UnboundedSender;
use tokio::time::{Instant, sleep, sleep_until};

use super::begin::{Asked, Begun};
use super::error::ServiceError;
use super::event::Event;
use super::live::Orders;
use super::placing::{Placed, Refusal};
use super::pump::Pump;
use super::refresh;
use super::still::{Still, Stillness};
use super::taken_over;
use super::view::PumpView;
use crate::history::{EventRecord, History, Key, OrderRecord};
use crate::order::{Order, OrderId, Origin, Task};
use crate::worker::{Line, Program, Seat, Stop};

/// Events that a slow watcher may be behind before it is told everything anew.
const BEHIND: usize = 1024;

/// Longest wait for the begin of an order's first motion, before its taker is answered.
const BEGINS_WITHIN: Duration = Duration::from_secs(2);

/// Longest wait for the end of orders that were asked to stop, before whoever asked is answered.
const ANSWERED_WITHIN: Duration = Duration::from_secs(1);

/// Longest key, in bytes.
const LONGEST_KEY: usize = 200;

/// Parts of a service.
#[derive(Debug)]
pub struct Setup {
    /// Configuration that names the pumps and racks.
    pub config: Config,
    /// Folder of all records.
    pub state_dir: PathBuf,
    /// Command that carries out the orders.
    pub program: Program,
    /// True if simulated motors take no time.
    pub fast: bool,
    /// History of the orders.
    pub history: History,
    /// Hearer of each note, also of those of the service's begin.
    pub notes: UnboundedSender<EventRecord>,
}

/// Service of the pumps of one configuration. A copy is the same service.
#[derive(Debug, Clone)]
pub struct Service(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    config: Config,
    pumps: BTreeMap<String, Pump>,
    program: Program,
    fast: bool,
    history: Arc<History>,
    live: Mutex<Orders>,
    events: Sender<Event>,
    is_ending: AtomicBool,
    still: Still,
    notes: UnboundedSender<EventRecord>,
}

impl Service {
    /// Reads the pumps of the configuration, or the built-in default pump of one that names none. Orders that an
    /// earlier service did not see the end of are marked as cut off. A history that is new takes the doses of the
    /// pumps' logs over.
    ///
    /// # Errors
    ///
    /// [`ServiceError`] if a pump cannot be used or the history cannot be written.
    pub fn new(setup: Setup) -> Result<Self, ServiceError> {
        let Setup { config, state_dir, program, fast, history, notes } = setup;
        let mut names: Vec<String> = config.pumps().keys().cloned().collect();
        if names.is_empty() {
            names.push(config.default_pump().to_owned());
        }
        let pump = |name: String| Ok((name.clone(), Pump::of(&name, &config, &state_dir)?));
        let pumps = names.into_iter().map(pump).collect::<Result<_, ServiceError>>()?;
        let history = Arc::new(history);
        let (events, live) = (broadcast::channel(BEHIND).0, Mutex::default());
        let (is_ending, still) = (AtomicBool::new(false), Still::default());
        let inner = Inner { config, pumps, program, fast, history, live, events, is_ending, still, notes };
        let service = Self(Arc::new(inner));
        if service.history().is_new() {
            service.take_over()?;
        }
        for cut in service.history().cut_off(Timestamp::now())? {
            // The process of a service that was killed may still decelerate, and records its end then.
            let pump = service.pump(&cut.order.pump).ok().filter(|pump| !pump.bench().is_held());
            let delivered = pump.and_then(|pump| pump.bench().delivered_by(cut.id.as_str())).map_or_else(
                || "the pump's record has what was delivered".to_owned(),
                |((least_ml, most_ml), _)| format!("it has delivered {least_ml:.4} to {most_ml:.4} mL"),
            );
            let text = format!(
                "the service ended before order {} ({}) did; {delivered}",
                cut.id,
                cut.order.task.name()
            );
            service.note("service", Some(&cut.order.pump), &text);
        }
        Ok(service)
    }

    /// Records the doses that the pumps have in their logs, where the history has none.
    fn take_over(&self) -> Result<(), ServiceError> {
        let orders = self.pumps().map(taken_over::orders).collect::<Result<Vec<_>, _>>()?.concat();
        if orders.is_empty() {
            return Ok(());
        }
        self.history().take_over(&orders)?;
        let text = format!(
            "the history is new, and has the {} doses of the pumps' logs; keys of earlier orders and times of the \
             schedule are not among them",
            orders.len()
        );
        self.note("service", None, &text);
        Ok(())
    }

    /// Returns the configuration.
    pub fn config(&self) -> &Config {
        &self.0.config
    }

    /// Returns the history.
    pub fn history(&self) -> &Arc<History> {
        &self.0.history
    }

    /// Returns the command that carries out the orders.
    pub fn program(&self) -> &Program {
        &self.0.program
    }

    /// Returns the pumps by their names.
    pub fn pumps(&self) -> impl Iterator<Item = &Pump> {
        self.0.pumps.values()
    }

    /// Finds the pump of this name.
    ///
    /// # Errors
    ///
    /// [`Refusal::UnknownPump`] if the configuration has none.
    pub fn pump(&self, name: &str) -> Result<&Pump, Refusal> {
        self.0.pumps.get(name).ok_or_else(|| Refusal::UnknownPump {
            name: name.to_owned(),
            known: self.0.pumps.keys().cloned().collect::<Vec<_>>().join(", "),
        })
    }

    /// Returns what people are shown of a pump, with the order that it carries out.
    pub fn view(&self, pump: &Pump) -> PumpView {
        let mut view = pump.view();
        if let Some(last) = view.last.as_mut().and_then(Value::as_object_mut) {
            let order = last.get("order").and_then(Value::as_str);
            let origin = order.and_then(|order| self.history().origin(order).ok()?);
            last.insert("origin".to_owned(), origin.into());
        }
        let live = self.live();
        let id = &pump.bench().file().pump.id;
        if let Some(order) = live.values().find(|order| order.is_of(pump.name(), id)) {
            view.order = Some(order.record.id.clone());
            view.task = Some(order.record.order.task.name());
            (view.plan, view.progress) = order.of_pump(id);
            (view.silent_since, view.stop_asked) = (order.silent_since, order.stop_asked);
        }
        view
    }

    /// Returns true while a pump carries out an order.
    pub(crate) fn is_ordered(&self, pump: &Pump) -> bool {
        self.live().values().any(|order| order.is_of(pump.name(), &pump.bench().file().pump.id))
    }

    /// Returns true while the guard holds a pump still, also before that is on the pump's record.
    pub(crate) fn is_kept_still(&self, pump: &Pump) -> bool {
        self.0.still.has(pump.name())
    }

    /// Returns true while a pump carries out an order that turns its motor.
    pub(crate) fn is_moving(&self, pump: &Pump) -> bool {
        self.live()
            .values()
            .any(|live| live.record.order.pump == pump.name() && live.record.order.task.moves())
    }

    /// Takes no motion of these pumps from now on, and those of all others.
    pub(crate) fn keep_still(&self, pumps: BTreeMap<String, Stillness>) {
        self.0.still.set(pumps);
    }

    /// Returns a channel of what happens from now on.
    pub fn watch(&self) -> Receiver<Event> {
        self.0.events.subscribe()
    }

    /// Returns an order by its name, as it stands.
    ///
    /// # Errors
    ///
    /// [`Refusal::History`] if the history cannot be read.
    pub fn order(&self, id: &OrderId) -> Result<Option<OrderRecord>, Refusal> {
        if let Some(live) = self.live().get(id) {
            return Ok(Some(live.shown()));
        }
        Ok(self.history().order(id)?)
    }

    /// Takes an order, and waits until its first motion begins, it ends, or 2 s have passed. With a key, an order that
    /// was taken before is not begun again.
    ///
    /// # Errors
    ///
    /// [`Refusal`] if the order was not taken. Nothing has moved then.
    pub async fn place(&self, order: Order, origin: &Origin, key: Option<Key>) -> Result<Placed, Refusal> {
        if let Some(Key { text, .. }) = &key
            && (text.is_empty() || text.len() > LONGEST_KEY)
        {
            return Err(Refusal::Key(text.len()));
        }
        // A person who asks over HTTP is answered, and the schedule tells what it could not make.
        let is_answered = origin.is_answered() || matches!(origin, Origin::Schedule(_));
        let asked = Asked { order, origin, key, seat: Seat { is_answered, ..Seat::default() }, hearer: None };
        let (id, stops, worker) = match self.begin(asked)? {
            Begun::New { id, stops, worker } => (id, stops, worker),
            Begun::Before(record) => return Ok(Placed { record: *record, repeated: true }),
        };
        let mut watch = self.watch();
        let service = self.clone();
        let running = id.clone();
        tokio::spawn(async move { service.carry_out(running, *worker, stops).await });
        let until = Instant::now() + BEGINS_WITHIN;
        loop {
            let waits = self.live().get(&id).is_some_and(|live| !live.has_begun);
            if !waits {
                break;
            }
            tokio::select! {
                () = sleep_until(until) => break,
                _ = watch.recv() => {}
            }
        }
        let record = self.order(&id)?;
        let record = record.unwrap_or_else(|| unreachable!("the order {id} was recorded before it began"));
        Ok(Placed { record, repeated: false })
    }

    /// Carries out a command that this machine's user typed for `pump`. `hearer` hears each of its lines with its
    /// text; its end is that of the channel.
    ///
    /// # Errors
    ///
    /// [`Refusal`] if the command was not begun. Nothing has moved then.
    pub fn place_command(
        &self,
        pump: &str,
        words: Vec<String>,
        seat: Seat,
        hearer: UnboundedSender<(Line, String)>,
    ) -> Result<OrderId, Refusal> {
        let (order, origin) = (Order::new(pump, Task::Command { words }), &Origin::Command);
        let asked = Asked { order, origin, key: None, seat, hearer: Some(hearer) };
        match self.begin(asked)? {
            Begun::New { id, stops, worker } => {
                let (service, running) = (self.clone(), id.clone());
                tokio::spawn(async move { service.carry_out(running, *worker, stops).await });
                Ok(id)
            }
            Begun::Before(record) => Ok(record.id),
        }
    }

    /// Stops the orders of a pump, or all orders. Returns the orders that were asked to stop. Each motor decelerates,
    /// and stands with its volume on record. The process of an order that does not answer is ended.
    pub fn stop(&self, pump: Option<&str>, reason: &str) -> Vec<OrderId> {
        self.stop_by(pump, &Stop { reason: reason.to_owned(), is_seen: false })
    }

    /// Stops as [`Service::stop`] does, by a word that says whether a person sees the end.
    pub(crate) fn stop_by(&self, pump: Option<&str>, stop: &Stop) -> Vec<OrderId> {
        let mut live = self.live();
        let id = pump.and_then(|name| self.0.pumps.get(name)).map(|pump| &pump.bench().file().pump.id);
        let stopped = live
            .values_mut()
            .filter(|order| pump.is_none_or(|name| order.may_be_of(name, id.map_or(name, String::as_str))));
        stopped
            .map(|order| {
                order.stop(stop);
                order.record.id.clone()
            })
            .collect()
    }

    /// Stops one order. Returns false if it is not carried out now.
    pub fn stop_order(&self, id: &OrderId, reason: &str) -> bool {
        let stop = Stop { reason: reason.to_owned(), is_seen: false };
        self.live().get_mut(id).map(|order| order.stop(&stop)).is_some()
    }

    /// Waits until orders that were asked to stop have ended, 1 s at most. Returns the answer to a stop: the orders
    /// that were `asked`, and those that have `stopped`.
    pub(crate) async fn stopped(&self, asked: &[OrderId]) -> Value {
        let until = Instant::now() + ANSWERED_WITHIN;
        loop {
            let ended: Vec<OrderId> = {
                let live = self.live();
                asked.iter().filter(|id| !live.contains_key(*id)).cloned().collect()
            };
            if ended.len() == asked.len() || Instant::now() >= until {
                return json!({"asked": asked, "stopped": ended});
            }
            sleep(Duration::from_millis(10)).await;
        }
    }

    /// Begins nothing any more, stops every order, and waits until all motors stand, `longest` at most. Returns true if
    /// they do.
    pub async fn end(&self, reason: &str, longest: Duration) -> bool {
        self.0.is_ending.store(true, Ordering::SeqCst);
        self.stop(None, reason);
        let until = Instant::now() + longest;
        while !self.live().is_empty() {
            if Instant::now() >= until {
                return false;
            }
            sleep(Duration::from_millis(10)).await;
        }
        true
    }

    /// Looks at the records of the pumps until the program ends: another process may move a pump.
    pub async fn keep_fresh(self) {
        refresh::keep_fresh(self).await;
    }

    /// Records and tells something that a person should know.
    pub fn note(&self, kind: &str, pump: Option<&str>, text: &str) {
        let pump = pump.filter(|pump| !pump.is_empty()).map(str::to_owned);
        let mut event =
            EventRecord { time: Timestamp::now(), kind: kind.to_owned(), pump, text: text.to_owned() };
        if let Err(error) = self.history().note(&event) {
            event.text = format!("{} ({error})", event.text);
        }
        self.tell("note", &event);
        // A hearer that has gone hears nothing; the note is on record.
        let _ = self.0.notes.send(event);
    }

    /// Tells every watcher.
    pub(crate) fn tell(&self, name: &'static str, data: &impl serde::Serialize) {
        // Nobody watches: nobody is told.
        let _ = self.0.events.send(Event::new(name, data));
    }

    /// Returns the word of the pace of simulated motors.
    pub(super) fn pace(&self) -> &'static str {
        if self.0.fast { "fast" } else { "real" }
    }

    /// Refuses an order of a pump that the guard holds.
    pub(super) fn check_still(&self, order: &Order) -> Result<(), Refusal> {
        self.0.still.check(order)
    }

    /// Returns true once the service begins nothing any more.
    pub fn is_ending(&self) -> bool {
        self.0.is_ending.load(Ordering::SeqCst)
    }

    pub(super) fn live(&self) -> MutexGuard<'_, Orders> {
        self.0.live.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
