//! Two pumps on the axes X and Y of one board in virtual time.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use pump_bench::drives::{Drive, Grbl, Opening, StopRequest};
use pump_bench::pump_file::{Axis, DriveTable};
use pump_bench::rack::{Rack, RackFile, RackProgress, RackReport};
use pump_bench::record::PumpState;
use pump_bench::{Bench, PumpFile, Session, built_in};

use crate::rig::table;
use crate::simulated::options::Options;
use crate::virtual_time::board::Board;

/// Names of the pumps, that on the axis X first.
pub(crate) const NAMES: [&str; 2] = ["acid", "base"];

/// Head of a rack of both.
const HEAD: &str = "schema = \"rack/1\"\n[pumps]\nacid = \"acid\"\nbase = \"base\"\n";

/// Steps per mm of both axes.
const STEPS_MM: f64 = 250.0;

/// Returns the file of a pump like `head` on an axis, and the table of its drive.
fn file(head: &PumpFile, name: &str, axis: Axis) -> (PumpFile, DriveTable) {
    let mut file = head.clone();
    name.clone_into(&mut file.pump.id);
    let table = table().with_port(Path::new("/dev/ttyUSB7")).with_axis(axis);
    file.drive = Some(table.clone());
    (file, table)
}

/// Two pumps with their records, and their board.
pub(crate) struct Pair {
    pub(crate) board: Board,
    head: PumpFile,
    folder: tempfile::TempDir,
}

impl Pair {
    pub(crate) fn new(options: Options) -> Self {
        Self::of(built_in("three-roller").unwrap(), options)
    }

    /// Makes a pair of two pumps like `head`.
    pub(crate) fn of(head: PumpFile, options: Options) -> Self {
        Self { board: Board::start(options), head, folder: tempfile::tempdir().unwrap() }
    }

    /// Opens both axes.
    pub(crate) fn drives(&self) -> (Vec<Grbl>, Vec<Bench>) {
        let shared = self.board.shared();
        let each = NAMES.iter().zip([Axis::X, Axis::Y]).map(|(name, axis)| {
            let (file, table) = file(&self.head, name, axis);
            let drive = shared.axis(&table, &file.motor, &Opening::default()).unwrap();
            let bench = Bench::new(file, None, self.folder.path()).unwrap();
            let bench = bench.driven_by(&drive).unwrap().at_port(table.port).confirming_pump(true);
            (drive, bench)
        });
        each.unzip()
    }

    /// Runs a rack of these steps until somebody asks for a stop. `heard` is called with each progress.
    pub(crate) fn run(
        &self,
        steps: &str,
        stopped: &'static AtomicBool,
        heard: &(dyn Fn(RackProgress<'_>) + Sync),
    ) -> RackReport {
        let (mut drives, benches) = self.drives();
        let file = RackFile::parse(&format!("{HEAD}{steps}"), Path::new("mix.toml")).unwrap();
        let asked = StopRequest::new(|| stopped.load(Ordering::SeqCst));
        let rack = Rack::new(file, benches).unwrap().stopping_on(asked);
        let drives = drives.iter_mut().map(|drive| Some(Box::new(drive) as Box<dyn Drive>)).collect();
        rack.run_with(drives, heard).unwrap()
    }

    /// Opens a session of one pump.
    pub(crate) fn with_session<T>(&self, pump: usize, act: impl FnOnce(&mut Session<'_>) -> T) -> T {
        let (mut drives, benches) = self.drives();
        let mut session = Session::with_drive(&benches[pump], Box::new(&mut drives[pump])).unwrap();
        act(&mut session)
    }

    /// Returns the recorded states of both.
    pub(crate) fn states(&self) -> [PumpState; 2] {
        NAMES.map(|name| {
            let bench = Bench::new(file(&self.head, name, Axis::X).0, None, self.folder.path()).unwrap();
            bench.story().unwrap().state.unwrap()
        })
    }

    /// Returns the steps that the motors have made.
    pub(crate) fn places(&self) -> [i64; 2] {
        let truth = self.board.truth();
        [truth.steps, truth.others[0]]
    }

    pub(crate) fn journal(&self, name: &str) -> PathBuf {
        self.folder.path().join(name).join("grbl").join("journal.jsonl")
    }

    /// Returns the jogs that the board has read.
    pub(crate) fn jogs(&self) -> Vec<String> {
        self.board.truth().lines.into_iter().filter(|line| line.starts_with("$J=")).collect()
    }

    /// Returns the steps at which the last of these jogs ends.
    pub(crate) fn ends_of_line(&self, jogs: &[String]) -> [i64; 2] {
        let line = jogs.last().unwrap();
        ['X', 'Y'].map(|letter| {
            let (_, rest) = line.split_once(letter).unwrap();
            let end = rest.find(|c: char| c.is_ascii_alphabetic()).unwrap();
            (rest[..end].parse::<f64>().unwrap() * STEPS_MM).round() as i64
        })
    }
}
