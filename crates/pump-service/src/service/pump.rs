//! One pump of the service.

use std::error::Error;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use pump_bench::Bench;
use pump_bench::config::Config;
use pump_bench::report::{Status, log_json, with_sources};
use pump_bench::safety::SafetyLimit;
use pump_bench::units::flow_ml_s;
use serde_json::Value;

use super::error::ServiceError;
use super::view::PumpView;
use super::whole::WholeDose;

/// Pump of a service: its bench, and what was last read of its record.
#[derive(Debug)]
pub struct Pump {
    name: String,
    bench: Bench,
    default_flow_ml_s: f64,
    read: Mutex<Read>,
}

/// Values that were last read of a record.
#[derive(Debug, Default)]
struct Read {
    status: Option<Status>,
    error: Option<String>,
    /// Last dose of the log, `log/1`.
    last: Option<Value>,
    /// Dose that the last one of the log has ended, as a whole, if it was the rest of it.
    whole: Option<WholeDose>,
    /// Time at which the record was written last.
    written: Option<SystemTime>,
    /// True if another process held the pump.
    is_held: bool,
    /// Volume that the tube has pumped, as it was counted, in mL.
    tube_ml: f64,
}

impl Read {
    /// Counts what the tube has pumped. A motion that was stopped has pumped a little less than it may have before,
    /// and a counter never goes back: it begins anew with another tube.
    fn count_tube(&mut self) {
        let Some(status) = &self.status else { return };
        let now_ml = status.wear.volume_ml;
        let is_another = now_ml < 0.5 * self.tube_ml;
        self.tube_ml = if is_another { now_ml } else { self.tube_ml.max(now_ml) };
    }
}

impl Pump {
    /// Takes the pump of this name of the configuration.
    pub(super) fn of(name: &str, config: &Config, state_dir: &Path) -> Result<Self, ServiceError> {
        let failed =
            |error: &dyn Error| ServiceError::Pump { name: name.to_owned(), message: with_sources(error) };
        let file = config.pump(name).map_err(|error| failed(&error))?;
        let bench = Bench::new(file, None, state_dir).map_err(|error| failed(&error))?;
        let configured = config.defaults().rate.as_deref().and_then(|rate| flow_ml_s(rate).ok());
        let default_flow_ml_s = configured.unwrap_or(bench.file().pump.default_rate_ml_s);
        let pump = Self { name: name.to_owned(), bench, default_flow_ml_s, read: Mutex::default() };
        pump.refresh();
        Ok(pump)
    }

    /// Returns the name of the pump in the configuration.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the pump's bench.
    pub fn bench(&self) -> &Bench {
        &self.bench
    }

    /// Returns the flow that a dose takes if nobody names one, in mL/s.
    pub(super) fn default_flow_ml_s(&self) -> f64 {
        self.default_flow_ml_s
    }

    /// Reads the record if it has changed since it was read last.
    pub(super) fn refresh(&self) -> Refreshed {
        let written = self.bench.record_written();
        let is_held = self.bench.is_held();
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let is_read = read.status.is_some() || read.error.is_some();
        if is_read && read.written == written && read.is_held == is_held {
            return Refreshed::default();
        }
        (read.written, read.is_held) = (written, is_held);
        let stood = read.status.as_ref().map(|status| limit_of(status).is_some());
        (read.status, read.error) = match Status::of(&self.bench) {
            Ok(status) => (Some(status), None),
            Err(error) => (None, Some(with_sources(&error))),
        };
        read.count_tube();
        (read.last, read.whole) = self.last_logged();
        let limit = read.status.as_ref().and_then(limit_of).filter(|_| stood == Some(false));
        Refreshed { has_changed: true, limit }
    }

    /// Reads what the limits and the tube count by now: a motion goes on, and the day forgets. Returns true if that has
    /// changed.
    pub(super) fn refresh_counted(&self) -> bool {
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let (Some(known), Ok(now)) = (&mut read.status, Status::of(&self.bench)) else { return false };
        // A stand is new to the reading after the motion, which tells it.
        let mut safety = now.safety;
        safety.stand = known.safety.stand;
        let has_changed = (known.safety, known.wear) != (safety, now.wear);
        (known.safety, known.wear) = (safety, now.wear);
        read.count_tube();
        has_changed
    }

    /// Returns the last dose of the log, and the whole of which it is a rest. A log that cannot be read is told by
    /// whoever asks for it.
    fn last_logged(&self) -> (Option<Value>, Option<WholeDose>) {
        let Ok(Some(entry)) = self.bench.last_logged() else { return (None, None) };
        let line = log_json(&self.bench.file().pump.id, self.bench.drive_id(), &entry, false);
        (serde_json::from_str(&line).ok(), WholeDose::of(&self.bench, &entry))
    }

    /// Returns the volume that the tube has pumped, in mL: a counter, which begins anew with each tube.
    pub(crate) fn tube_ml(&self) -> f64 {
        self.read.lock().unwrap_or_else(PoisonError::into_inner).tube_ml
    }

    /// Returns the number of the last dose of the log, as it was read last.
    pub(super) fn last_number(&self) -> u64 {
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        read.last.as_ref().and_then(|last| last.get("number")?.as_u64()).unwrap_or(0)
    }

    /// Returns true if the record that was read last has the pump stand by an order.
    pub(crate) fn stands_by_order(&self) -> bool {
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let stand = read.status.as_ref().and_then(|status| status.safety.stand);
        stand.is_some_and(|stand| stand.limit == SafetyLimit::Ordered.as_str())
    }

    /// Returns what people are shown of the pump while nothing moves.
    pub fn view(&self) -> PumpView {
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let view = PumpView::of(self, read.status.clone(), read.error.clone(), read.last.clone());
        PumpView { whole: read.whole, ..view }
    }
}

/// Change of a record that was read anew.
#[derive(Debug, Default)]
pub(super) struct Refreshed {
    pub(super) has_changed: bool,
    /// Limit at which the pump has come to stand, in words.
    pub(super) limit: Option<String>,
}

/// Returns the limit at which a pump stands, in words. `None` for one that stands by order.
fn limit_of(status: &Status) -> Option<String> {
    let stand = status.safety.stand?;
    (stand.limit != SafetyLimit::Ordered.as_str()).then(|| stand.words())
}
