//! The rig of these tests: a board, a balance under the vessel of its pump, and somebody who types commands.

use std::cell::Cell;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process::{Child, Command, Output, Stdio};
use std::sync::Arc;
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use pump_bench::built_in;
use pump_bench::pump_file::{DriveTable, DriverName, OutletEnd};
use serde_json::Value;

use crate::balance::{Defect, SimulatedBalance, Speech, Truth, Vessel};
use crate::simulated::Simulated;
use crate::simulated::options::Options;

/// Density of water at 25 °C, kg/m³ (Kell, 1975), the fluid of the built-in pump.
const WATER_KG_M3: f64 = 997.047;

/// Density of the air at the pump file's 85.7 kPa, and of a balance's weights (OIML R 111-1), kg/m³.
const AIR_KG_M3: f64 = 1.0;
const WEIGHTS_KG_M3: f64 = 8000.0;

/// Angle of the rotor at first, deg.
const ZERO_DEG: f64 = 20.0;

/// Truth of a pump that delivers 3 % more than its model, in drops of 40 µL.
pub(crate) fn truth() -> Truth {
    let buoyant = (1.0 - AIR_KG_M3 / WATER_KG_M3) / (1.0 - AIR_KG_M3 / WEIGHTS_KG_M3);
    Truth {
        factor: 1.03,
        zero_rad: ZERO_DEG.to_radians(),
        steps_per_rev: 12_800.0,
        g_ml: 1e-3 * WATER_KG_M3 * buoyant,
        drop_ml: 0.04,
        fall_s: 0.15,
        lag_s: 0.3,
        decimals: 3,
        vessel_g: 50.0,
        defect: Defect::None,
        defect_from_ml: 0.0,
    }
}

/// Truth with a balance that fails once the pump has delivered so much.
pub(crate) fn failing(defect: Defect, defect_from_ml: f64) -> Truth {
    Truth { defect, defect_from_ml, ..truth() }
}

/// End of a command.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl From<Output> for Ended {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

/// A board and a balance.
pub(crate) struct Rig {
    folder: tempfile::TempDir,
    pub(crate) board: Arc<Simulated>,
    pub(crate) balance: SimulatedBalance,
    speech: Speech,
}

impl Rig {
    pub(crate) fn new(speech: Speech, truth: Truth) -> Self {
        let rig = Self::from_unknown_angle(speech, truth);
        let homed = rig.types(&["home", "--set", &format!("{ZERO_DEG}deg+-0deg")]);
        assert_eq!(homed.code, Some(0), "{homed:?}");
        rig
    }

    /// Makes a rig whose pump has never told its angle.
    pub(crate) fn from_unknown_angle(speech: Speech, truth: Truth) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let board = Arc::new(Simulated::start(Options::default()).unwrap());
        let mut file = built_in("three-roller").unwrap();
        file.outlet.end = Some(OutletEnd::Air);
        file.outlet.nozzle_bore_mm = Some(1.6);
        file.drive = Some(DriveTable::of(DriverName::Grbl).with_port(board.path()));
        file.motor.confirmed = None;
        fs::write(folder.path().join("pump.toml"), file.to_toml()).unwrap();
        let vessel = Vessel::new(file.model().unwrap(), truth);
        let turned = Arc::clone(&board);
        let balance = SimulatedBalance::start(speech, vessel, move || turned.truth().steps).unwrap();
        Self { folder, board, balance, speech }
    }

    /// A file in the folder of the rig.
    pub(crate) fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dose"));
        command.args(words).args(["--pump", "pump.toml"]).current_dir(self.folder.path());
        command.env_remove("DOSE_PUMP").env_remove("DOSE_CONFIG").env("COLUMNS", "1000");
        command.env("XDG_CONFIG_HOME", self.folder.path().join("config"));
        command.env("DOSE_STATE_DIR", self.folder.path().join("state"));
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Types a command to its end.
    pub(crate) fn types(&self, words: &[&str]) -> Ended {
        self.command(words).output().unwrap().into()
    }

    /// Types a command whose JSON is wanted.
    pub(crate) fn json(&self, words: &[&str]) -> Value {
        let ended = self.types(&[words, &["--format", "json"]].concat());
        assert_eq!(ended.code, Some(0), "{words:?}: {}", ended.err);
        serde_json::from_str(&ended.out).unwrap()
    }

    /// The words of a dose by weight on this balance.
    pub(crate) fn by_weight<'a>(&'a self, words: &[&'a str]) -> Vec<&'a str> {
        let port = self.balance.path().to_str().unwrap();
        let protocol = if self.speech == Speech::Sbi { "sbi" } else { "mt-sics" };
        let scale = ["--until-scale", "--scale-port", port, "--scale-protocol", protocol];
        [words, &scale].concat()
    }

    /// Begins a command, and returns once the motor has made so many steps in all.
    pub(crate) fn begins(&self, words: &[&str], steps: i64) -> Child {
        let mut child = self.command(words).spawn().unwrap();
        let deadline = Instant::now() + Duration::from_secs(60);
        while self.board.truth().steps < steps {
            assert!(Instant::now() < deadline, "the moment never came");
            assert!(child.try_wait().unwrap().is_none(), "the command ended before");
            sleep(Duration::from_millis(2));
        }
        child
    }

    /// Steps of the motor once it stands.
    pub(crate) fn steps(&self) -> i64 {
        self.board.rest().steps
    }

    /// Mass in the vessel once every drop has landed, g.
    pub(crate) fn landed_g(&self) -> f64 {
        sleep(Duration::from_millis(50));
        self.balance.vessel().landed_g()
    }
}

/// Interrupts a command as Ctrl-C does, and returns its end.
pub(crate) fn interrupted(child: Child) -> Ended {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    child.wait_with_output().unwrap().into()
}

pub(crate) fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap_or_else(|| panic!("{key} in {report}"))
}

/// Pause of a simulated device from which on a command may take it for silent: a question to the balance is given up
/// after 1 s, one to the board after 2 s.
const STARVED: Duration = Duration::from_secs(1);

/// Most runs of a test whose devices nobody ran in time.
const MOST_RUNS: u32 = 4;

thread_local! {
    /// Longest pause of the devices of this thread's rigs.
    static LONGEST_PAUSE: Cell<Duration> = const { Cell::new(Duration::ZERO) };
}

impl Drop for Rig {
    fn drop(&mut self) {
        let pause = self.board.truth().longest_pause.max(self.balance.longest_pause());
        LONGEST_PAUSE.set(LONGEST_PAUSE.get().max(pause));
    }
}

/// Runs a test. A failure is void, and the test runs again, if the machine was so busy that a device was silent.
pub(crate) fn heard(test: impl Fn()) {
    for run in 1..=MOST_RUNS {
        LONGEST_PAUSE.set(Duration::ZERO);
        let Err(failure) = catch_unwind(AssertUnwindSafe(&test)) else { return };
        let pause = LONGEST_PAUSE.get();
        if pause <= STARVED || run == MOST_RUNS {
            resume_unwind(failure);
        }
        eprintln!("run {run} is void: nobody ran a device of the rig for {pause:?}");
    }
}

/// Runs `test` on every case, all at a time, since tests mostly wait.
pub(crate) fn each<T: Copy + Send>(cases: impl IntoIterator<Item = T>, test: impl Fn(T) + Sync) {
    scope(|scope| {
        for case in cases {
            let test = &test;
            scope.spawn(move || heard(|| test(case)));
        }
    });
}
