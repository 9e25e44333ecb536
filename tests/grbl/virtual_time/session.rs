//! A session on a board in virtual time, with a disk that takes its time on the same clock.

use std::fs::File;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use pump_bench::drives::{
    Abilities, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Gate, Grbl, Leave, Watch,
};
use pump_bench::notice::Notice;
use pump_bench::record::Storage;
use pump_ctl::plan::Plan;

use super::board::Board;
use crate::rig::open;

/// Real time between two looks at a clock that another thread drives.
const LOOK: Duration = Duration::from_micros(100);

/// Clock of a board that the drive and the journal's thread share: it does not pass the end of a sync under way before
/// that sync has ended.
#[derive(Debug, Clone)]
struct SharedClock {
    board: Board,
    /// Time at which the sync under way ends.
    syncs_until: Arc<Mutex<Option<Duration>>>,
    /// True while the drive makes a motion, and the clock goes on.
    moves: Arc<AtomicBool>,
}

impl SharedClock {
    /// Waits for a disk that is due.
    fn wait_for_disk(&self) {
        while self.syncs_until.lock().unwrap().is_some_and(|until| self.board.now() >= until) {
            std::thread::sleep(LOOK);
        }
    }

    /// Takes `time` for a sync.
    fn sync(&self, time: Duration) {
        let until = self.board.now() + time;
        *self.syncs_until.lock().unwrap() = Some(until);
        while self.board.now() < until {
            if self.moves.load(Ordering::SeqCst) {
                std::thread::sleep(LOOK);
            } else {
                self.board.pass(until.saturating_sub(self.board.now()));
            }
        }
    }

    fn synced(&self) {
        *self.syncs_until.lock().unwrap() = None;
    }
}

/// Disk that takes its time, and tells up to which step the last synced entry announces.
#[derive(Debug)]
pub(crate) struct SlowDisk {
    clock: SharedClock,
    takes: Duration,
    /// Real time of a sync, in which the clock stands still.
    really: Duration,
    journal: PathBuf,
    announced: Arc<AtomicU64>,
}

impl SlowDisk {
    /// Returns the disk with syncs that take their time on the computer's clock too, which the session reads.
    pub(crate) fn really(self) -> Self {
        Self { really: self.takes, ..self }
    }
}

impl Storage for SlowDisk {
    fn sync(&mut self, file: &File) -> io::Result<()> {
        self.clock.sync(self.takes);
        std::thread::sleep(self.really);
        let synced = file.sync_data();
        let text = std::fs::read_to_string(&self.journal)?;
        let last = text.lines().last().unwrap_or_default();
        let may = last.split_once(r#""may":"#).and_then(|(_, rest)| rest.split('}').next()?.parse().ok());
        self.announced.fetch_max(may.unwrap_or(0), Ordering::SeqCst);
        self.clock.synced();
        synced
    }
}

/// The grbl driver as the drive of a program, in virtual time.
#[derive(Debug)]
pub(crate) struct VirtualDrive {
    grbl: Grbl,
    clock: SharedClock,
    took: Duration,
}

impl VirtualDrive {
    pub(crate) fn new(board: &Board) -> Self {
        let clock = SharedClock { board: board.clone(), syncs_until: Arc::default(), moves: Arc::default() };
        Self { grbl: open(board), clock, took: Duration::ZERO }
    }

    /// Returns a disk on the same clock whose syncs take so long, and the last step that it has announced.
    pub(crate) fn disk(&self, takes: Duration, journal: PathBuf) -> (SlowDisk, Arc<AtomicU64>) {
        let announced = Arc::<AtomicU64>::default();
        let (clock, told) = (self.clock.clone(), Arc::clone(&announced));
        (SlowDisk { clock, takes, really: Duration::ZERO, journal, announced }, told)
    }
}

impl Drive for VirtualDrive {
    fn id(&self) -> &str {
        "virtual-board"
    }

    fn abilities(&self) -> Abilities {
        self.grbl.abilities()
    }

    fn limits(&self) -> Option<DriveLimits> {
        self.grbl.limits()
    }

    fn count(&self) -> Option<i64> {
        self.grbl.count()
    }

    fn disturbed(&mut self) -> Option<Disturbance> {
        self.grbl.disturbed()
    }

    fn holds_at_rest(&self) -> bool {
        self.grbl.holds_at_rest()
    }

    fn rests(&self) -> u32 {
        self.grbl.rests()
    }

    fn check(&mut self, plan: &Plan) -> Result<(), DriveError> {
        self.grbl.check(plan)
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let mut begun = None;
        self.clock.moves.store(true, Ordering::SeqCst);
        let made = self.grbl.run(plan, &mut |made, about_to| {
            self.clock.wait_for_disk();
            let leave = gate(made, about_to);
            if leave == Leave::Go {
                begun.get_or_insert(self.clock.board.now());
            }
            leave
        });
        self.clock.moves.store(false, Ordering::SeqCst);
        self.took = begun.map_or(Duration::ZERO, |begun| self.clock.board.now() - begun);
        made
    }

    fn settle(&mut self, settle_s: f64, watch: &mut Watch<'_>) -> Result<Option<f64>, DriveError> {
        self.grbl.settle(settle_s, watch)
    }

    fn simulated_s(&self) -> Option<f64> {
        Some(self.took.as_secs_f64())
    }

    fn notes(&mut self) -> Vec<Notice> {
        self.grbl.notes()
    }

    fn release(&mut self) -> Result<(), DriveError> {
        self.grbl.release()
    }
}
