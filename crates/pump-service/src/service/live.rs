//! An order that is carried out now.

use serde_json::Value;
use tokio::sync::mpsc::UnboundedSender;

use crate::history::OrderRecord;
use crate::worker::Line;

/// Most messages of an order that are kept.
const MOST_MESSAGES: usize = 100;

/// Most reports of an order that are kept: a batch of more keeps its last ones, and the log of the pump has all.
const MOST_REPORTS: usize = 1000;

/// An order that is carried out now, and the channel that stops it.
#[derive(Debug)]
pub(super) struct Live {
    pub(super) record: OrderRecord,
    /// Plan of the present motion, until its report comes.
    pub(super) plan: Option<Value>,
    /// Last line of progress.
    pub(super) progress: Option<Value>,
    stops: UnboundedSender<String>,
    /// Hearer of each line of a command, with its text.
    hearer: Option<UnboundedSender<(Line, String)>>,
    /// True once the first motion began, or the command told its end.
    pub(super) has_begun: bool,
}

impl Live {
    pub(super) fn new(
        record: OrderRecord,
        stops: UnboundedSender<String>,
        hearer: Option<UnboundedSender<(Line, String)>>,
    ) -> Self {
        Self { record, plan: None, progress: None, stops, hearer, has_begun: false }
    }

    /// Asks the command to stop for this reason.
    pub(super) fn stop(&self, reason: &str) {
        // A command that has ended hears nothing any more.
        let _ = self.stops.send(reason.to_owned());
    }

    /// Returns the record with the plan of the present motion as its last report.
    pub(super) fn shown(&self) -> OrderRecord {
        let mut record = self.record.clone();
        record.reports.extend(self.plan.clone());
        record
    }

    /// Takes a line of the command, and its text.
    pub(super) fn take(&mut self, line: &Line, text: &str) {
        if let Some(hearer) = &self.hearer {
            // A command whose user has gone is stopped by the one who notices that.
            let _ = hearer.send((line.clone(), text.to_owned()));
        }
        match line {
            Line::Progress(value) => {
                self.has_begun = true;
                match value.get("plan") {
                    Some(plan) => self.plan = Some(plan.clone()),
                    None => self.progress = Some(value.clone()),
                }
            }
            Line::Report(report) => {
                self.plan = None;
                if self.record.reports.len() == MOST_REPORTS {
                    self.record.reports.remove(0);
                }
                self.record.reports.push(report.clone());
            }
            Line::Words(text) | Line::Message(text) => {
                if self.record.messages.len() == MOST_MESSAGES {
                    self.record.messages.remove(0);
                }
                self.record.messages.push(text.clone());
            }
            Line::Error(error) => self.record.error = Some(error.clone()),
        }
    }
}
