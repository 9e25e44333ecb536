//! The rig of these tests: a simulated board, a driver and a plan. Boards are in memory with a clock of their own,
//! except those that are plugged into a port of this computer.

use pump_bench::built_in;
use pump_bench::drives::GrblError;
use pump_bench::drives::{Drive, DriveError, DriveFault, Grbl, Leave, Opening};
use pump_bench::pump_file::{DriveTable, DriverName, MotorTable};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request};

use crate::simulated::options::{Defects, Options};
use crate::simulated::{Simulated, Truth};
use crate::virtual_time::board::Board;

/// Returns the published pump's motor.
pub(crate) fn motor() -> MotorTable {
    built_in("three-roller").unwrap().motor
}

/// Switches a board on, in virtual time.
pub(crate) fn start(options: Options) -> Board {
    Board::start(options)
}

/// Starts a board with these defects, in virtual time.
pub(crate) fn defective(defects: Defects) -> Board {
    start(Options { defects, ..Options::default() })
}

/// Switches a board on that is plugged into a port of this computer, and runs in real time.
pub(crate) fn plug(options: Options) -> Simulated {
    Simulated::start(options).unwrap()
}

/// Plugs a board with these defects in.
pub(crate) fn plug_defective(defects: Defects) -> Simulated {
    plug(Options { defects, ..Options::default() })
}

/// Returns the table of the port of a board that is plugged in.
pub(crate) fn port(board: &Simulated) -> DriveTable {
    table().with_port(board.path())
}

/// Opens the port of a board that is plugged in.
pub(crate) fn open_port(board: &Simulated) -> Grbl {
    Grbl::open(&port(board), &motor(), &Opening::default()).unwrap()
}

/// Returns the table of a board without a port.
pub(crate) fn table() -> DriveTable {
    DriveTable::of(DriverName::Grbl)
}

pub(crate) fn open(board: &Board) -> Grbl {
    board.open(&table(), &Opening::default()).unwrap()
}

/// Returns the error with which a board is refused.
pub(crate) fn refusal(options: Options) -> DriveError {
    start(options).open(&table(), &Opening::default()).map(drop).unwrap_err()
}

/// Plans a dose as a session does for this driver, with the board's own ramps.
pub(crate) fn dose(grbl: &Grbl, volume_ml: f64, ml_s: f64) -> Plan {
    let file = built_in("three-roller").unwrap();
    let mut limits = file.limits();
    limits.motor.max_acceleration_rad_s2 = grbl.limits().unwrap().acceleration_rad_s2.unwrap();
    let request = Request::new(volume_ml, Cruise::Flow { ml_s });
    Doser::new(&file.model().unwrap(), limits).unwrap().plan(Phase::known(0.4), &request).unwrap()
}

/// Plans a turn of half a revolution at `steps_s`, whatever the board allows.
pub(crate) fn turn_at(grbl: &Grbl, steps_s: f64) -> Plan {
    let file = built_in("three-roller").unwrap();
    let mut limits = file.limits();
    limits.motor.max_acceleration_rad_s2 = grbl.limits().unwrap().acceleration_rad_s2.unwrap();
    limits.motor.max_speed_rad_s = 100.0;
    let speed_rad_s = steps_s * limits.motor.step_rad();
    Doser::new(&file.model().unwrap(), limits).unwrap().turn(Phase::known(0.4), 64_000, speed_rad_s).unwrap()
}

/// Board whose truth a test can look at.
pub(crate) trait Watched {
    /// Returns the truth about the board now.
    fn truth(&self) -> Truth;
}

impl Watched for Board {
    fn truth(&self) -> Truth {
        self.truth()
    }
}

impl Watched for Simulated {
    fn truth(&self) -> Truth {
        self.truth()
    }
}

/// Runs a plan to its end, and checks that no step is made before it is announced. Returns the result and the
/// last step that was announced.
pub(crate) fn run(grbl: &mut Grbl, board: &impl Watched, plan: &Plan) -> (Result<u64, DriveFault>, u64) {
    run_until(grbl, board, plan, |_, _| false)
}

/// Runs a plan until `stop` returns true, with the checks and results of [`run`].
pub(crate) fn run_until(
    grbl: &mut Grbl,
    board: &impl Watched,
    plan: &Plan,
    mut stop: impl FnMut(u64, u64) -> bool,
) -> (Result<u64, DriveFault>, u64) {
    let from = board.truth().steps;
    let mut announced = 0;
    let result = grbl.run(plan, &mut |made, about_to| {
        let turned = board.truth().steps.abs_diff(from);
        assert!(turned <= announced, "{turned} steps made and {announced} announced");
        assert!(made <= turned, "{made} said to be made and {turned} are");
        if stop(made, about_to) {
            return Leave::Stop;
        }
        announced = announced.max(about_to);
        Leave::Go
    });
    (result, announced)
}

/// Runs a plan to its end on a board that may move by itself.
pub(crate) fn run_unwatched(grbl: &mut Grbl, plan: &Plan) -> Result<u64, DriveFault> {
    grbl.run(plan, &mut |_, _| Leave::Go)
}

/// Runs a dose of 2 mL on a board with these defects. Checks that the net steps made lie between the bounds
/// of the fault, and returns the fault.
pub(crate) fn fault(defects: Defects) -> DriveFault {
    let board = defective(defects);
    let mut grbl = open(&board);
    let plan = dose(&grbl, 2.0, 5.0);
    let (result, announced) = run(&mut grbl, &board, &plan);
    let fault = result.unwrap_err();
    let made = board.rest().steps;
    let is_count = pump_bench::report::with_sources(&fault.error).contains("steps where");
    assert!(is_count || fault.made_most <= announced as i64, "{fault:?}: {announced} announced");
    assert!((fault.made_least..=fault.made_most).contains(&made), "{made} made: {fault:?}");
    fault
}

/// Returns the board's error behind a drive's error.
pub(crate) fn grbl_error(error: DriveError) -> GrblError {
    match error {
        DriveError::Device(error) | DriveError::Refused(error) => *error.downcast().unwrap(),
        other => panic!("{other}"),
    }
}

/// Runs `test` on every case, all at a time.
pub(crate) fn each<T: Send>(cases: impl IntoIterator<Item = T>, test: impl Fn(T) + Sync) {
    std::thread::scope(|scope| {
        for case in cases {
            scope.spawn(|| test(case));
        }
    });
}
