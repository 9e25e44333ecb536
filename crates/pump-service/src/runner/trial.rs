//! The trials of entries, and the files that they read: a change of one has its entries tried again.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::SystemTime;

use pump_bench::config::Config;

use crate::schedule::{Action, Entry};
use crate::service::{Pump, Service};

/// Trial of an entry.
#[derive(Debug, Clone)]
pub(super) struct Trial {
    /// Files as they were before it.
    pub(super) seen: Seen,
    /// Reason why the runs of the entry would be refused. `None` if they would not be.
    pub(super) doubt: Option<String>,
}

impl Trial {
    /// Returns true while the trial says what it would say of the files as they are `now`.
    pub(super) fn holds(&self, now: &Seen) -> bool {
        // A person may have confirmed the pump, or accepted its board, which the rest of its record says.
        self.seen.files == now.files && (self.doubt.is_none() || self.seen.records == now.records)
    }
}

/// State of a file: when it was written, and its size in bytes. `None` if it is not there.
type Stamp = Option<(SystemTime, u64)>;

/// State of the files on which a trial depends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Seen {
    /// Stamps of the configuration, of pump files and racks, and of calibrations and settings of boards.
    files: Vec<Stamp>,
    /// Times at which records of pumps were written last.
    records: Vec<Option<SystemTime>>,
}

/// Files of a service as they are now. Each pump and rack is looked at once.
#[derive(Debug)]
pub(super) struct Files<'a> {
    service: &'a Service,
    /// Configuration as it is now: it may name other files since the service began.
    config: Config,
    /// Files that were looked at: those of pumps, and those of racks.
    seen: BTreeMap<(bool, String), Seen>,
}

impl<'a> Files<'a> {
    /// Reads the configuration of the service. One that cannot be read is told by the trials, and leaves the files
    /// that it named before.
    pub(super) fn of(service: &'a Service) -> Self {
        let path = service.config().path().filter(|path| path.exists());
        let config = path.and_then(|path| Config::read(path).ok());
        let config = config.unwrap_or_else(|| service.config().clone());
        Self { service, config, seen: BTreeMap::new() }
    }

    /// Looks at the files of an entry.
    pub(super) fn seen(&mut self, entry: &Entry) -> Seen {
        let (is_rack, name) = match entry.action() {
            Action::Dose { pump, .. } | Action::Prime { pump, .. } => (false, pump),
            Action::Rack { rack } => (true, rack),
        };
        let known = (is_rack, name.clone());
        if let Some(seen) = self.seen.get(&known) {
            return seen.clone();
        }
        let seen = if is_rack { self.of_rack(name) } else { self.of_pumps(self.service.pump(name).ok()) };
        self.seen.insert(known, seen.clone());
        seen
    }

    /// A rack names its pumps in its file, which may change: each pump may be one of them.
    fn of_rack(&self, name: &str) -> Seen {
        let mut seen = self.of_pumps(self.service.pumps());
        seen.files.push(self.config.find_rack(name).ok().and_then(|path| stamp(&path)));
        seen
    }

    fn of_pumps<'p>(&self, pumps: impl IntoIterator<Item = &'p Pump>) -> Seen {
        let mut seen = Seen { files: Vec::new(), records: Vec::new() };
        seen.files.push(self.config.path().and_then(stamp));
        for pump in pumps {
            let place = self.config.find(pump.name()).ok();
            seen.files.push(place.and_then(|place| stamp(place.file()?)));
            seen.files.extend(pump.bench().read_afresh().iter().map(|path| stamp(path)));
            seen.records.push(pump.bench().record_written());
        }
        seen
    }
}

fn stamp(path: &Path) -> Stamp {
    let file = path.metadata().ok()?;
    Some((file.modified().ok()?, file.len()))
}
