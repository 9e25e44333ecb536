//! Commands that come as messages, and the answers to them.

use std::collections::BTreeMap;
use std::future::ready;
use std::sync::Arc;

use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::{Publish, SubAck, SubscribeReasonCode};
use rumqttc::v5::{AsyncClient, Event, Incoming};
use serde_json::{Value, json};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::asked::Asked;
use super::kept::{keep, kept};
use super::topics::{Command, STOP, Topics};
use crate::guard::Guard;
use crate::history::{Key, OrderState};
use crate::order::{Order, OrderId, Origin, Task};
use crate::service::{Placed, Refusal, Service, error_report};
use crate::shell::Failed;

/// Answers that wait at a time. Commands beyond them are not carried out; stops are.
const WAITING: usize = 64;

/// Reasons of the stops, as the logs keep them.
const STOPPED: &str = "a stop by MQTT";
const ALL_STOPPED: &str = "a stop of all pumps by MQTT";

/// Payloads of retained commands that were told of, by their topics.
pub(super) type Retained = BTreeMap<String, Vec<u8>>;

/// Hearer of the commands of one connection.
pub(super) struct Hearer<'a> {
    service: &'a Service,
    guard: &'a Guard,
    topics: &'a Topics,
    client: AsyncClient,
    retained: &'a mut Retained,
    room: Arc<Semaphore>,
    alarms: Arc<Semaphore>,
    has_told_flood: bool,
}

impl<'a> Hearer<'a> {
    pub(super) fn new(
        service: &'a Service,
        guard: &'a Guard,
        topics: &'a Topics,
        client: AsyncClient,
        retained: &'a mut Retained,
    ) -> Self {
        let (room, alarms) = (Arc::new(Semaphore::new(WAITING)), Arc::new(Semaphore::new(1)));
        Self { service, guard, topics, client, retained, room, alarms, has_told_flood: false }
    }

    /// Takes what has happened on the connection.
    pub(super) async fn take(&mut self, event: Event) {
        match event {
            Event::Incoming(Incoming::Publish(message)) => self.hear(&message).await,
            Event::Incoming(Incoming::SubAck(SubAck { return_codes, .. })) => {
                let is_taken = |code: &SubscribeReasonCode| matches!(code, SubscribeReasonCode::Success(_));
                let filters = self.topics.filters().into_iter().chain(self.guard.topics());
                let refused = filters.zip(&return_codes).filter(|(_, code)| !is_taken(code));
                let refused: Vec<String> = refused.map(|(filter, _)| filter).collect();
                if !refused.is_empty() {
                    let refused = refused.join(" and ");
                    let text = "the MQTT broker does not let this service subscribe to all of its topics; allow it to";
                    self.service.note("mqtt", None, &format!("{text} subscribe to {refused}"));
                }
            }
            _ => {}
        }
    }

    /// Carries out a message. An order has begun, or was refused, before the next message is heard, so that a stop
    /// finds it.
    async fn hear(&mut self, message: &Publish) {
        let Ok(topic) = std::str::from_utf8(&message.topic) else { return };
        if self.guard.hear_message(topic, &message.payload, message.retain) {
            return;
        }
        let Some(command) = self.topics.command(topic) else { return };
        let is_stop = command.word == STOP;
        let is_new = !message.retain || self.is_new_retained(topic, command, &message.payload);
        if !is_new || message.retain && message.payload.is_empty() {
            return;
        }
        let Ok(room) = self.room.clone().try_acquire_owned() else {
            if is_stop {
                self.stop(command);
            } else if !self.has_told_flood {
                self.has_told_flood = true;
                let text = "commands come by MQTT faster than they can be answered; some are not carried out";
                self.service.note("mqtt", None, text);
            }
            return;
        };
        let mut answer = Answer::new(self, command, room);
        if message.retain && !is_stop {
            return answer.refuse("retained", &retained_words(topic));
        }
        if let Some(Err(refusal)) = command.pump.map(|pump| self.service.pump(pump)) {
            return answer.fail(refusal.report());
        }
        let asked = match Asked::read(command.word, &message.payload) {
            Ok(asked) => asked,
            Err(wrong) => return answer.refuse("usage", &wrong),
        };
        answer.key = asked.key().map(str::to_owned);
        if message.dup && answer.key.is_none() && !is_stop {
            return answer.refuse("key", "the broker sends this command a second time, and it has no key");
        }
        self.carry_out(command, asked, answer).await;
    }

    /// Carries out what a message asks.
    async fn carry_out(&mut self, command: Command<'_>, asked: Asked, answer: Answer) {
        let pump = command.pump.unwrap_or_default().to_owned();
        match asked {
            Asked::Stop => {
                let (service, asked) = (self.service.clone(), self.stop(command));
                tokio::spawn(async move { answer.give(service.stopped(&asked).await) });
            }
            Asked::Volume(volume_ml) => match keep(self.service.history(), &pump, volume_ml) {
                Ok(text) => {
                    let topic = self.topics.of(&pump, "volume");
                    answer.give_beside(json!({"volume_ml": volume_ml}), Some((topic, text)));
                }
                Err(error) => answer.give(Refusal::History(error).report()),
            },
            Asked::KeptDose => match kept(self.service.history(), &pump) {
                Ok(Some(volume_ml)) => {
                    let task = Task::Dose { volume: format!("{volume_ml}mL") };
                    self.place(Order::new(&pump, task), answer).await;
                }
                Ok(None) => {
                    let topic = self.topics.set(&pump, "volume");
                    answer.refuse("usage", &format!("no volume is kept; send one in mL to {topic} first"));
                }
                Err(error) => answer.give(Refusal::History(error).report()),
            },
            Asked::Order { task, options, .. } => {
                let order = Order { pump, task, options };
                self.place(order, answer).await;
            }
        }
    }

    /// Returns true for a retained command that was not told of. A stop is always new: it stops again.
    fn is_new_retained(&mut self, topic: &str, command: Command<'_>, payload: &[u8]) -> bool {
        if payload.is_empty() {
            // The retained message was deleted.
            self.retained.remove(topic);
            return false;
        }
        let told = self.retained.insert(topic.to_owned(), payload.to_owned());
        let is_new = told.as_deref() != Some(payload);
        if is_new {
            let pump = command.pump.filter(|pump| self.service.pump(pump).is_ok());
            let text = if command.word == STOP {
                format!("the stop at {topic} is retained: it stops again at each connection; {DELETE}")
            } else {
                retained_words(topic)
            };
            self.service.note("mqtt", pump, &text);
        }
        is_new || command.word == STOP
    }

    fn stop(&self, command: Command<'_>) -> Vec<OrderId> {
        self.service.stop(command.pump, if command.pump.is_some() { STOPPED } else { ALL_STOPPED })
    }

    /// Gives an order, and has it answered once it moves.
    async fn place(&self, order: Order, answer: Answer) {
        let service = self.service.clone();
        let key = answer.key.clone().map(|text| Key { text, body: json!(order).to_string() });
        let mut placing = Box::pin(async move { service.place(order, &Origin::Mqtt, key).await });
        // The first poll records the order and starts its command; the rest waits for its first motion.
        tokio::select! {
            biased;
            placed = &mut placing => answer.tell(placed),
            () = ready(()) => drop(tokio::spawn(async move { answer.tell(placing.await) })),
        }
    }
}

/// How a retained message is deleted.
const DELETE: &str = "delete it with an empty retained message";

fn retained_words(topic: &str) -> String {
    format!(
        "the command at {topic} is retained and is not carried out: a retained command would dose again after each \
         restart; send it without the retain flag, and {DELETE}"
    )
}

/// Returns the answer to an order: `order/1`, or the `error/1` of one that was refused before anything moved.
fn told(Placed { record, repeated }: Placed) -> Value {
    if record.state == OrderState::Refused {
        let code = record.code.and_then(|code| u8::try_from(code).ok()).unwrap_or(2);
        let unknown = || error_report(code, "command", "the command was refused without a reason");
        return record.error.unwrap_or_else(unknown);
    }
    let mut answer = json!(record.brief());
    if let Some(answer) = answer.as_object_mut() {
        answer.insert("repeated".to_owned(), repeated.into());
    }
    answer
}

/// Answer to one command.
struct Answer {
    client: AsyncClient,
    topic: String,
    word: String,
    key: Option<String>,
    room: OwnedSemaphorePermit,
    service: Service,
    pump: String,
    /// Room of the one refusal that a person is told of at a time: a broken program may send many.
    alarms: Arc<Semaphore>,
}

impl Answer {
    fn new(hearer: &Hearer<'_>, command: Command<'_>, room: OwnedSemaphorePermit) -> Self {
        let (client, topic) = (hearer.client.clone(), hearer.topics.answer(command));
        let (word, pump) = (command.word.to_owned(), command.pump.unwrap_or_default().to_owned());
        let (service, alarms) = (hearer.service.clone(), hearer.alarms.clone());
        Self { client, topic, word, key: None, room, service, pump, alarms }
    }

    fn refuse(self, kind: &str, message: &str) {
        self.fail(error_report(2, kind, message));
    }

    /// Answers with the refusal of an order that no command was begun for, and tells a person of it.
    fn fail(self, report: Value) {
        if self.word != "volume"
            && let Ok(permit) = self.alarms.clone().try_acquire_owned()
        {
            let (service, pump) = (self.service.clone(), self.pump.clone());
            let (report, delivered_ml) = (report.clone(), Some((0.0, 0.0)));
            let failed = Failed { pump, rack: String::new(), report, delivered_ml };
            tokio::spawn(async move {
                service.on_fail("mqtt", failed).await;
                drop(permit);
            });
        }
        self.give(report);
    }

    /// Answers with an order, or its refusal. The command of one that was begun has told a person itself.
    fn tell(self, placed: Result<Placed, Refusal>) {
        match placed {
            Ok(placed) => self.give(told(placed)),
            Err(refusal) => self.fail(refusal.report()),
        }
    }

    fn give(self, answer: Value) {
        self.give_beside(answer, None);
    }

    /// Sends the answer with its command and its key, and a retained message beside it.
    fn give_beside(self, mut answer: Value, beside: Option<(String, String)>) {
        let Self { client, topic, word, key, room, .. } = self;
        if let Some(answer) = answer.as_object_mut() {
            answer.insert("command".to_owned(), word.into());
            answer.insert("key".to_owned(), key.into());
        }
        tokio::spawn(async move {
            // A connection that has ended takes no answer; the history has the order.
            if let Some((topic, text)) = beside {
                let _ = client.publish(topic, QoS::AtLeastOnce, true, text).await;
            }
            let _ = client.publish(topic, QoS::AtLeastOnce, false, answer.to_string()).await;
            drop(room);
        });
    }
}
