//! An order that is carried out now.

use std::collections::{BTreeMap, BTreeSet};

use jiff::Timestamp;
use serde_json::Value;
use tokio::sync::mpsc::UnboundedSender;

use crate::history::OrderRecord;
use crate::order::OrderId;
use crate::worker::{Line, Stop};

/// Most messages of an order that are kept.
const MOST_MESSAGES: usize = 100;

/// Most reports of an order that are kept: a batch of more keeps its last ones, and the log of the pump has all.
const MOST_REPORTS: usize = 1000;

/// Id of the plan of a rack.
const RACK: &str = "";

/// The orders that are carried out now, by their names.
pub(super) type Orders = BTreeMap<OrderId, Live>;

/// An order that is carried out now, and the channel that stops it.
#[derive(Debug)]
pub(super) struct Live {
    pub(super) record: OrderRecord,
    /// Plan of each pump's present motion, by the pump's id, until its report comes. That of a rack has no id.
    plans: BTreeMap<String, Value>,
    /// Last line of progress of each pump, by the pump's id.
    progress: BTreeMap<String, Value>,
    /// Pumps whose motion was planned and has told nothing yet, by their ids.
    announced: BTreeSet<String>,
    stops: UnboundedSender<Stop>,
    /// Hearer of each line of a command, with its text.
    hearer: Option<UnboundedSender<(Line, String)>>,
    /// True once the first motion began, or the command told its end.
    pub(super) has_begun: bool,
    /// Time since which its process is silent although a motor turns.
    pub(super) silent_since: Option<Timestamp>,
    /// Time at which it was first asked to stop.
    pub(super) stop_asked: Option<Timestamp>,
}

impl Live {
    pub(super) fn new(
        record: OrderRecord,
        stops: UnboundedSender<Stop>,
        hearer: Option<UnboundedSender<(Line, String)>>,
    ) -> Self {
        let (plans, progress, announced, silent_since, stop_asked) = Default::default();
        Self { record, plans, progress, announced, stops, hearer, has_begun: false, silent_since, stop_asked }
    }

    /// Asks the command to stop.
    pub(super) fn stop(&mut self, stop: &Stop) {
        self.stop_asked.get_or_insert_with(Timestamp::now);
        // A command that has ended hears nothing any more.
        let _ = self.stops.send(stop.clone());
    }

    /// Returns true if the order is for a pump of this name and id, alone or in a rack.
    pub(super) fn is_of(&self, name: &str, id: &str) -> bool {
        let ordered = &self.record.order.pump;
        if ordered.is_empty() { self.has_told(id) } else { ordered == name }
    }

    /// Returns true if the order is for a pump of this name and id, or for a rack that has not told its pumps yet.
    pub(super) fn may_be_of(&self, name: &str, id: &str) -> bool {
        self.is_of(name, id)
            || (self.record.order.pump.is_empty() && self.progress.is_empty() && self.plans.is_empty())
    }

    /// Returns true if a line was about the pump with this id.
    fn has_told(&self, id: &str) -> bool {
        self.plans.contains_key(id) || self.progress.contains_key(id)
    }

    /// Returns the plan of the present motion, and the last line of progress, of the pump with this id.
    pub(super) fn of_pump(&self, id: &str) -> (Option<Value>, Option<Value>) {
        (self.plans.get(id).cloned(), self.progress.get(id).cloned())
    }

    /// Returns the record with the plan of the present motion, or of the whole rack, as its last report.
    pub(super) fn shown(&self) -> OrderRecord {
        let mut record = self.record.clone();
        let of_rack = self.plans.get(RACK);
        record.reports.extend(
            of_rack.map_or_else(|| self.plans.values().cloned().collect(), |plan| vec![plan.clone()]),
        );
        record
    }

    /// Takes a line of the command, and its text. Returns true for the first line of a motion.
    pub(super) fn take(&mut self, line: &Line, text: &str) -> bool {
        let mut begins = false;
        if let Some(hearer) = &self.hearer {
            // A command whose user has gone is stopped by the one who notices that.
            let _ = hearer.send((line.clone(), text.to_owned()));
        }
        match line {
            Line::Progress(value) => {
                self.has_begun = true;
                let id = value.get("pump").and_then(Value::as_str).unwrap_or_default().to_owned();
                match value.get("plan") {
                    Some(plan) => {
                        self.announced.insert(id.clone());
                        self.plans.insert(id, plan.clone());
                    }
                    None => {
                        // The record has a motion once it moves.
                        begins =
                            self.announced.remove(&id) | self.progress.insert(id, value.clone()).is_none();
                    }
                }
            }
            Line::Report(report) => {
                let id = report.get("pump").and_then(Value::as_str).unwrap_or_default();
                if self.plans.contains_key(RACK) {
                    // The report of a rack is that of all its pumps.
                    self.plans.clear();
                } else {
                    self.plans.remove(id);
                }
                if self.record.reports.len() == MOST_REPORTS {
                    self.record.reports.remove(0);
                }
                self.record.reports.push(report.clone());
            }
            Line::Ending => {}
            Line::Words(text) | Line::Message(text) if text.is_empty() => {}
            Line::Words(text) | Line::Message(text) => {
                if self.record.messages.len() == MOST_MESSAGES {
                    self.record.messages.remove(0);
                }
                self.record.messages.push(text.clone());
            }
            Line::Error(error) | Line::Failed(error) => self.record.error = Some(error.clone()),
        }
        begins
    }
}
