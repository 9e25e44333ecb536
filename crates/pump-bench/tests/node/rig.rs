//! A drive, its board, and plans of a pump.

use std::error::Error;
use std::path::PathBuf;

use pump_bench::built_in;
use pump_bench::drives::{Drive, DriveError, Leave, Node, NodeError, Opening};
use pump_bench::pump_file::{DriveTable, DriverName};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request};
use pump_ctl::step::{Segment, TickRate};

use crate::world::{SharedWorld, TICK_HZ};

/// Board, and the folder of the pump's record.
pub(crate) struct Rig {
    pub(crate) world: SharedWorld,
    folder: tempfile::TempDir,
}

impl Rig {
    pub(crate) fn new() -> Self {
        Self { world: SharedWorld::new(), folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn record(&self) -> PathBuf {
        self.folder.path().join("board-settings.json")
    }

    pub(crate) fn table() -> DriveTable {
        DriveTable::of(DriverName::Node).with_port("/dev/ttyACM0")
    }

    pub(crate) fn opening(&self) -> Opening {
        Opening { settings_record: Some(self.record()), ..Opening::default() }
    }

    pub(crate) fn open_by(&self, table: &DriveTable, opening: &Opening) -> Result<Node, DriveError> {
        let motor = built_in("three-roller").unwrap().motor;
        Node::over(Box::new(self.world.clone()), table, &motor, opening)
    }

    pub(crate) fn open(&self) -> Node {
        self.open_by(&Self::table(), &self.opening()).unwrap()
    }
}

/// Plans a dose of the built-in pump.
pub(crate) fn dose(volume_ml: f64, ml_s: f64, smooth: bool) -> Plan {
    let file = built_in("three-roller").unwrap();
    let pump = file.model().unwrap();
    let request = Request::new(volume_ml, Cruise::Flow { ml_s }).with_smooth(smooth);
    Doser::new(&pump, file.limits()).unwrap().plan(Phase::known(0.3), &request).unwrap()
}

pub(crate) fn go(_made: u64, _about_to: u64) -> Leave {
    Leave::Go
}

/// Returns the times of the plan's steps after its begin, in ticks.
pub(crate) fn times(plan: &Plan) -> Vec<f64> {
    times_of(plan.segments(TickRate::from_hz(TICK_HZ).unwrap()))
}

/// Returns the times of the steps of segments after their begin, in ticks.
pub(crate) fn times_of(segments: impl Iterator<Item = Segment>) -> Vec<f64> {
    let mut at = 0.0;
    let mut times = Vec::new();
    for segment in segments {
        for step in 1..=segment.steps() {
            let ticks = segment.interval_before(step);
            at += ticks.whole as f64 + f64::from(ticks.frac) / 4_294_967_296.0;
            times.push(at);
        }
    }
    times
}

/// Returns the largest distance of a rise from the plan's time, in ticks, after the begin from which it is smallest.
pub(crate) fn worst(rises: &[u64], plan: &Plan) -> f64 {
    worst_of(rises, &times(plan))
}

/// Returns the largest distance of a rise from its time, in ticks, after the begin from which it is smallest.
pub(crate) fn worst_of(rises: &[u64], times: &[f64]) -> f64 {
    assert_eq!(rises.len(), times.len());
    let late = rises.iter().zip(times).map(|(rise, time)| *rise as f64 - time);
    let (least, most) =
        late.fold((f64::MAX, f64::MIN), |(least, most), late| (late.min(least), late.max(most)));
    (most - least) / 2.0
}

/// Returns the drive's own error.
pub(crate) fn node_error(error: &DriveError) -> &NodeError {
    error.source().and_then(|source| source.downcast_ref()).unwrap()
}

/// Runs a plan with leave for all.
pub(crate) fn run(drive: &mut Node, plan: &Plan) -> u64 {
    drive.check(plan).unwrap();
    drive.run(plan, &mut go).unwrap()
}
