//! The begin of an order: refused, known by its key, or recorded and started.

use jiff::Timestamp;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use super::live::{Live, Orders};
use super::placing::Refusal;
use super::service::Service;
use crate::history::{Key, OrderRecord, OrderState};
use crate::order::{Choice, Order, OrderId, Origin, Task, option};
use crate::worker::{Ended, Line, Seat, Stop, Worker};

/// An order as it was asked for.
pub(super) struct Asked<'a> {
    pub(super) order: Order,
    pub(super) origin: &'a Origin,
    pub(super) key: Option<Key>,
    pub(super) seat: Seat,
    pub(super) hearer: Option<UnboundedSender<(Line, String)>>,
}

/// An order that was begun, now or before by the same key.
pub(super) enum Begun {
    New { id: OrderId, stops: UnboundedReceiver<Stop>, worker: Box<Worker> },
    Before(Box<OrderRecord>),
}

impl Service {
    /// Records an order and starts its command, unless its key was used before. Holds the list of orders meanwhile, so
    /// that a pump has one at most, and a key begins one.
    pub(super) fn begin(&self, asked: Asked<'_>) -> Result<Begun, Refusal> {
        let Asked { order, origin, key, mut seat, hearer } = asked;
        let mut live = self.live();
        if self.is_ending() {
            return Err(Refusal::Ending);
        }
        let now = Timestamp::now();
        if let Some(key) = &key
            && let Some(before) = self.of_key(&live, key, now)?
        {
            return Ok(Begun::Before(Box::new(before)));
        }
        let words = self.words(&order)?;
        self.check_free(&live, &order)?;
        let id = OrderId::random()?;
        seat.order = Some(id.as_str().to_owned());
        self.history().begin(&id, &order, &origin.to_string(), key.as_ref(), now)?;
        let record = OrderRecord::begun(id.clone(), order, origin.to_string(), now);
        let worker = match Worker::start(self.program(), &words, &seat) {
            Ok(worker) => Box::new(worker),
            Err(error) => return Err(self.not_started(record, Refusal::Start(error))?),
        };
        let (stop, stops) = unbounded_channel();
        let order = Live::new(record, stop, hearer);
        self.tell("order", &order.record);
        live.insert(id.clone(), order);
        Ok(Begun::New { id, stops, worker })
    }

    /// Returns the order of a key that was used before.
    fn of_key(&self, live: &Orders, key: &Key, now: Timestamp) -> Result<Option<OrderRecord>, Refusal> {
        let Some((id, body)) = self.history().of_key(&key.text, now)? else { return Ok(None) };
        if body != key.body {
            return Err(Refusal::KeyReused { key: key.text.clone() });
        }
        let running = live.get(&id).map(Live::shown);
        Ok(match running {
            Some(order) => Some(order),
            None => self.history().order(&id)?,
        })
    }

    /// Refuses an order of a pump that is kept still or carries out another one.
    fn check_free(&self, live: &Orders, order: &Order) -> Result<(), Refusal> {
        self.check_still(order)?;
        let is_of_it = |other: &&Live| !order.pump.is_empty() && other.record.order.pump == order.pump;
        live.values().find(is_of_it).map_or(Ok(()), |other| {
            let (doing, origin) = (other.record.order.task.doing(), other.record.origin.clone());
            Err(Refusal::Busy { pump: order.pump.clone(), doing, origin })
        })
    }

    /// Has the command of an order plan it, whatever the pump's record says now. Moves nothing and leaves no trace.
    /// Returns how it ended.
    ///
    /// # Errors
    ///
    /// [`Refusal`] if the order cannot be put into words, or its command cannot be run.
    pub(crate) async fn try_out(&self, order: &Order) -> Result<Ended, Refusal> {
        let mut order = order.clone();
        order.options.insert("dry-run".to_owned(), Choice::Switch(true));
        let seat = Seat { is_answered: true, is_trial: true, ..Seat::default() };
        let worker = Worker::start(self.program(), &self.words(&order)?, &seat).map_err(Refusal::Start)?;
        let (_never, stops) = unbounded_channel();
        worker.run(stops, |_, _| {}).await.map_err(Refusal::Start)
    }

    /// Returns the words of an order's command.
    fn words(&self, order: &Order) -> Result<Vec<String>, Refusal> {
        let mut words = order.words()?;
        let is_typed = matches!(order.task, Task::Command { .. });
        if order.pump.is_empty() && (is_typed || matches!(order.task, Task::Rack { .. })) {
            return Ok(words);
        }
        let pump = self.pump(&order.pump)?;
        let pace = option("pace", "");
        let has_pace = words.iter().any(|word| word.starts_with(pace.trim_end_matches('=')));
        if order.task.moves() && !has_pace && pump.bench().is_simulated() {
            // Behind two dashes it would be no option.
            let at = words.iter().position(|word| word == "--").unwrap_or(words.len());
            words.insert(at, option("pace", self.pace()));
        }
        Ok(words)
    }

    /// Records that the command of an order could not be started.
    fn not_started(&self, record: OrderRecord, refusal: Refusal) -> Result<Refusal, Refusal> {
        let (ended, code) = (Some(Timestamp::now()), Some(i32::from(refusal.code())));
        let (state, error) = (OrderState::Refused, Some(refusal.report()));
        self.history().end(&OrderRecord { state, ended, code, error, ..record })?;
        Ok(refusal)
    }
}
