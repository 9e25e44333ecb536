//! A board, a pump at it with its record, and plans.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_bench::drives::{Drive, DriveError, DriveFault, Klipper, Leave, Opening};
use pump_bench::pump_file::{DriveTable, DriverName, KlipperTable, MotorTable, PumpFile, TmcTable};
use pump_bench::record::PumpState;
use pump_bench::{Bench, built_in};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request};
use tempfile::TempDir;

use crate::simulated_klipper::{Character, SimulatedKlipper};

/// Longest wait for a motor that comes to rest.
const REST: Duration = Duration::from_secs(30);

/// Rig of one board.
pub(crate) struct Rig {
    pub(crate) folder: TempDir,
    pub(crate) board: SimulatedKlipper,
    pins: KlipperTable,
}

/// Returns the pins of a socket of an SKR Mini E3 V2.0: step, direction and enable.
pub(crate) fn socket(name: &str) -> KlipperTable {
    let [step, dir, enable] = match name {
        "X" => ["PB13", "PB12", "!PB14"],
        "Y" => ["PB10", "PB2", "!PB11"],
        "Z" => ["PB0", "PC5", "!PB1"],
        _ => ["PB3", "PB4", "!PD2"],
    };
    KlipperTable::new(step.parse().unwrap(), dir.parse().unwrap()).with_enable(enable.parse().unwrap())
}

/// Returns the pins of a socket with the line to the TMC2209 at an address.
pub(crate) fn with_driver(name: &str, address: u8) -> KlipperTable {
    let mut tmc = TmcTable::new("PC11".parse().unwrap(), 0.8).with_tx("PC10".parse().unwrap());
    tmc.address = address;
    socket(name).with_tmc(tmc)
}

pub(crate) fn motor() -> MotorTable {
    built_in("three-roller").unwrap().motor
}

impl Rig {
    /// Switches a board on whose steps go to a file.
    pub(crate) fn new(character: Character) -> Self {
        Self::of(character, socket("X"))
    }

    /// Switches a board on at which the pump has these pins.
    pub(crate) fn of(character: Character, pins: KlipperTable) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let record = Some(folder.path().join("steps.txt"));
        let board = SimulatedKlipper::start_as(Character { record, ..character }).unwrap();
        Self { folder, board, pins }
    }

    pub(crate) fn table(&self) -> DriveTable {
        DriveTable::of(DriverName::Klipper).with_port(self.board.path()).with_klipper(self.pins.clone())
    }

    pub(crate) fn opening(&self) -> Opening {
        let record = self.folder.path().join("pump/klipper/board-settings.json");
        std::fs::create_dir_all(record.parent().unwrap()).unwrap();
        Opening { settings_record: Some(record), ..Opening::default() }
    }

    pub(crate) fn open_by(&self, table: &DriveTable) -> Result<Klipper, DriveError> {
        Klipper::open(table, &motor(), &self.opening())
    }

    pub(crate) fn open(&self) -> Klipper {
        self.open_by(&self.table()).unwrap()
    }

    /// Returns the error with which the board is refused, in words.
    pub(crate) fn refusal(&self, table: &DriveTable) -> String {
        said(&self.open_by(table).map(drop).unwrap_err())
    }

    /// Returns the steps of a socket by the board's record: tick of its clock, and 1 or -1.
    pub(crate) fn steps_of(&self, socket: &str) -> Vec<(u64, i64)> {
        let text = std::fs::read_to_string(self.folder.path().join("steps.txt")).unwrap();
        let steps = text.lines().filter_map(|line| {
            let mut words = line.split(' ');
            let is_of = words.next() == Some(socket);
            let (tick, way) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
            is_of.then_some((tick, way))
        });
        steps.collect()
    }

    /// Waits until the motor stands.
    pub(crate) fn comes_to_rest(&self) {
        sleep(Duration::from_millis(50));
        let until = Instant::now() + REST;
        while self.board.truth().moving {
            assert!(Instant::now() < until, "the motor turns for ever without its host");
            sleep(Duration::from_millis(5));
        }
    }

    /// Writes the pump file of the published pump at these pins, and returns its path.
    pub(crate) fn pump(&self) -> PathBuf {
        self.pump_at("red", self.pins.clone())
    }

    /// Writes a pump file of the published pump under another name, at these pins of the board. Returns its path.
    pub(crate) fn pump_at(&self, id: &str, pins: KlipperTable) -> PathBuf {
        let path = self.folder.path().join(format!("{id}.toml"));
        let mut file = built_in("three-roller").unwrap();
        file.pump.id = id.to_owned();
        file.drive = Some(DriveTable::of(DriverName::Klipper).with_klipper(pins));
        std::fs::write(&path, file.to_toml()).unwrap();
        PumpFile::read(&path).unwrap();
        path
    }

    /// Returns the pump's state on record.
    pub(crate) fn state(&self) -> Option<PumpState> {
        let file = PumpFile::read(&self.pump()).unwrap();
        let bench = Bench::new(file, Some(DriverName::Klipper), &self.folder.path().join("state")).unwrap();
        bench.story().unwrap().state
    }

    /// Returns the command with these words, for the pump at the board.
    pub(crate) fn command(&self, words: &[&str]) -> Command {
        command(self.folder.path(), &self.pump(), self.board.path(), words)
    }

    /// Starts the command with these words.
    pub(crate) fn starts(&self, words: &[&str]) -> Child {
        self.command(words).spawn().unwrap()
    }

    /// Runs the command with these words. Returns its exit code and what it said.
    pub(crate) fn runs(&self, words: &[&str]) -> (Option<i32>, String) {
        ended(self.starts(words))
    }
}

/// Returns the command with these words, for a pump at a port.
pub(crate) fn command(folder: &Path, pump: &Path, port: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
    for name in ["DOSE_PUMP", "DOSE_CONFIG"] {
        command.env_remove(name);
    }
    command.env("XDG_CONFIG_HOME", folder).env("DOSE_STATE_DIR", folder.join("state"));
    command.args(words).arg("--pump").arg(pump).arg("--port").arg(port);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Returns the exit code of a command that ends, and what it said.
pub(crate) fn ended(process: Child) -> (Option<i32>, String) {
    let Output { status, stdout, stderr } = process.wait_with_output().unwrap();
    (status.code(), String::from_utf8_lossy(&[stdout, stderr].concat()).into_owned())
}

/// Returns an error with its sources, in words.
pub(crate) fn said(error: &(dyn std::error::Error + 'static)) -> String {
    let mut words = error.to_string();
    let mut source = error.source();
    while let Some(error) = source {
        words += &format!(": {error}");
        source = error.source();
    }
    words
}

/// Plans a dose of the published pump.
pub(crate) fn dose(volume_ml: f64, ml_s: f64, smooth: bool) -> Plan {
    let file = built_in("three-roller").unwrap();
    let pump = file.model().unwrap();
    let request = Request::new(volume_ml, Cruise::Flow { ml_s }).with_smooth(smooth);
    Doser::new(&pump, file.limits()).unwrap().plan(Phase::known(0.3), &request).unwrap()
}

/// Plans so many steps of the published pump.
pub(crate) fn turn(steps: i64) -> Plan {
    let file = built_in("three-roller").unwrap();
    let pump = file.model().unwrap();
    Doser::new(&pump, file.limits()).unwrap().turn(Phase::known(0.3), steps, 1.0).unwrap()
}

/// Runs a plan with leave for all.
pub(crate) fn run(drive: &mut Klipper, plan: &Plan) -> Result<u64, DriveFault> {
    drive.check(plan).unwrap();
    drive.run(plan, &mut |_, _| Leave::Go)
}
