//! An order from its begin to its end: what its command tells, and what becomes of that.

use jiff::Timestamp;
use tokio::sync::mpsc::UnboundedReceiver;

use super::pump::{Pump, Refreshed};
use super::service::Service;
use crate::history::{Marks, OrderRecord, OrderState};
use crate::order::{OrderId, Origin, Task};
use crate::shell::{Failed, on_fail};
use crate::worker::{Ended, Line, Stop, Worker, message_of};

impl Service {
    /// Carries an order out to its end, and records that.
    pub(super) async fn carry_out(&self, id: OrderId, worker: Worker, stops: UnboundedReceiver<Stop>) {
        let (hear, heed) =
            (|line: &Line, text: &str| self.hear(&id, line, text), |sign| self.heed(&id, sign));
        let ended = worker.run_watched(stops, hear, heed).await;
        let ended = ended.unwrap_or_else(|error| {
            let text = format!("the end of the command cannot be learned: {error}");
            self.hear(&id, &Line::Message(text.clone()), &text);
            Ended { code: 1, error: None, was_killed: false }
        });
        let Some(mut record) = self.live().get(&id).map(|live| live.record.clone()) else { return };
        record.ended = Some(Timestamp::now());
        record.code = Some(ended.code);
        record.state = OrderState::ended(ended.code, record.error.as_ref());
        let (order, killed) = (record.order.clone(), ended.error.filter(|_| ended.was_killed));
        let is_killed = killed.is_some();
        let service = self.clone();
        let done = tokio::task::spawn_blocking(move || {
            let recorded = service.history().end(&record);
            if let Err(error) = recorded {
                service.note("service", Some(&record.order.pump), &error.to_string());
            }
            let of_pump = service.pump(&record.order.pump).ok();
            let of_rack = of_pump.is_none().then(|| service.pumps()).into_iter().flatten();
            let changed: Vec<&Pump> = of_pump.into_iter().chain(of_rack).collect();
            let delivered_ml = is_killed.then(|| service.delivered_ml(&record, &changed)).flatten();
            let come: Vec<bool> = changed.iter().map(|pump| service.refresh(pump).limit.is_some()).collect();
            service.live().remove(&record.id);
            service.note_word(&record);
            service.mark_dose(&record);
            // The command tells of its own failures, and leaves a refusal to the one who is answered.
            let is_answered =
                [Origin::Http, Origin::Page].iter().any(|origin| origin.to_string() == record.origin);
            let is_refused = is_answered && record.state == OrderState::Refused;
            let stands = record.error.clone().filter(|_| is_refused && come.contains(&true));
            service.tell("order", &record.brief());
            changed.iter().for_each(|pump| service.tell("pump", &service.view(pump)));
            (delivered_ml, stands)
        });
        let (delivered_ml, stands) = done.await.unwrap_or_else(|error| {
            self.note("service", None, &format!("the end of order {id} was not recorded: {error}"));
            (None, None)
        });
        if let Some(report) = stands {
            self.on_fail("safety", Failed::of(&order, report, Some((0.0, 0.0)))).await;
        }
        // The command could not tell its end itself.
        if let Some(report) = killed {
            let bounds = delivered_ml.map_or(String::new(), |(least_ml, most_ml)| {
                format!("; it has delivered {least_ml:.4} to {most_ml:.4} mL")
            });
            let text = format!("order {id}: {}{bounds}", message_of(&report));
            self.note("service", Some(&order.pump), &text);
            self.on_fail("service", Failed::of(&order, report, delivered_ml)).await;
        }
    }

    /// Reads the record of a pump anew, and notes a limit at which it has come to stand.
    pub(super) fn refresh(&self, pump: &Pump) -> Refreshed {
        let refreshed = pump.refresh();
        if let Some(limit) = &refreshed.limit {
            let text = format!("{} stands until a person clears it: {limit}", pump.name());
            self.note("safety", Some(pump.name()), &text);
        }
        refreshed
    }

    /// Reads what the limits count of a pump whose motion begins, and tells it.
    fn refresh_counted(&self, name: String) {
        let service = self.clone();
        tokio::task::spawn_blocking(move || {
            if let Ok(pump) = service.pump(&name) {
                pump.refresh_counted();
                service.tell("pump", &service.view(pump));
            }
        });
    }

    /// Notes who has cleared a pump, and why, or who has accepted its interrupted dose.
    fn note_word(&self, record: &OrderRecord) {
        let OrderRecord { order, origin, state: OrderState::Done, .. } = record else { return };
        if let Some((reason, by)) = order.task.clearing() {
            self.note("safety", Some(&order.pump), &format!("{} was cleared by {by}: {reason}", order.pump));
        } else if order.task.accepts() {
            self.note(
                "dose",
                Some(&order.pump),
                &format!("the interrupted dose of {} was accepted, by {origin}", order.pump),
            );
        }
    }

    /// Marks the last dose of a pump that was weighed for a calibration, or accepted.
    fn mark_dose(&self, record: &OrderRecord) {
        let OrderRecord { order, origin, state: OrderState::Done, .. } = record else { return };
        let accepted = order.task.accepts().then(|| origin.clone());
        let weighed = matches!(order.task, Task::Calibrate { .. }) && !order.is_dry();
        let number = self.pump(&order.pump).map_or(0, Pump::last_number);
        if number == 0 || (!weighed && accepted.is_none()) {
            return;
        }
        if let Err(error) = self.history().mark(&order.pump, number, &Marks { weighed, accepted }) {
            self.note("service", Some(&order.pump), &error.to_string());
        }
    }

    /// Returns the smallest and largest volume that an order has delivered, in mL, by the journals and logs of those of
    /// its `pumps` that it has told of. `None` if they cannot be read.
    fn delivered_ml(&self, record: &OrderRecord, pumps: &[&Pump]) -> Option<(f64, f64)> {
        let begun_s = u64::try_from(record.begun.as_second()).unwrap_or(0);
        let mut sum_ml = (0.0, 0.0);
        for pump in pumps.iter().filter(|pump| self.is_ordered(pump)) {
            let (least_ml, most_ml) = pump.bench().delivered_since(begun_s, pump.last_number())?;
            sum_ml = (sum_ml.0 + least_ml, sum_ml.1 + most_ml);
        }
        Some(sum_ml)
    }

    /// Takes a line of an order's command, and tells it.
    fn hear(&self, id: &OrderId, line: &Line, text: &str) {
        let mut live = self.live();
        let Some(order) = live.get_mut(id) else { return };
        let begins = order.take(line, text);
        let pump = order.record.order.pump.clone();
        match line {
            Line::Progress(value) => {
                let mut value = value.clone();
                if let Some(object) = value.as_object_mut() {
                    object.insert("order".to_owned(), id.as_str().into());
                    let name = self.name_of(object.get("pump").and_then(|id| id.as_str()), &pump);
                    if begins {
                        self.refresh_counted(name.clone());
                    }
                    object.insert("name".to_owned(), name.into());
                }
                self.tell("progress", &value);
            }
            Line::Ending => {}
            Line::Report(_) | Line::Words(_) | Line::Message(_) | Line::Error(_) | Line::Failed(_) => {
                self.tell("order", &order.shown().brief());
            }
        }
    }

    /// Returns the name of the pump that a line is about: a rack's lines are about several.
    fn name_of(&self, id: Option<&str>, ordered: &str) -> String {
        let named = |pump: &&Pump| id.is_some_and(|id| pump.bench().file().pump.id == id);
        let of_id = || self.pumps().find(named).map(|pump| pump.name().to_owned());
        if self.pump(ordered).is_ok() { ordered.to_owned() } else { of_id().unwrap_or_default() }
    }

    /// Runs the configuration's `on_fail` beside what else goes on.
    pub(crate) fn alarm(&self, kind: &'static str, failed: Failed) {
        if self.config().on_fail().is_some() {
            let service = self.clone();
            tokio::spawn(async move { service.on_fail(kind, failed).await });
        }
    }

    /// Runs the configuration's `on_fail` for a failure that no process of the command tells. A failure of its own is
    /// a note of this kind.
    pub(crate) async fn on_fail(&self, kind: &str, failed: Failed) {
        let Some(command) = self.config().on_fail().filter(|_| !self.is_ending()) else { return };
        let (service, pump) = (self.clone(), failed.pump.clone());
        if let Some(text) = on_fail(command.to_owned(), failed, move || service.is_ending()).await {
            self.note(kind, Some(&pump), &text);
        }
    }
}
