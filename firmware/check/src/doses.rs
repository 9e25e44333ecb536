//! Doses by the drive, one board each: whole ones, one that is stopped on its way, and one whose board is reset.

use std::error::Error;
use std::ops::RangeInclusive;
use std::path::Path;
use std::time::Duration;

use pump_bench::drives::wire::Wire;
use pump_bench::drives::{Drive, Leave, Node, Opening};
use pump_bench::pump_file::{Axis, DriveTable, DriverName};
use pump_bench::{PumpFile, built_in};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request};
use pump_model::Pump;

use crate::board::emulator::{Edge, Emulator};
use crate::board::motor::{rises, step_pin};
use crate::{check, ripple};

/// Pins of the axes, their sensors and the emergency stop.
const AXIS_PINS: RangeInclusive<u8> = 2..=22;

/// Largest distance of a rise from its time in the plan, in µs: half a tick of the board's timer each way for the
/// rounding of deadlines, a tenth for that of the link, and the rest for the interrupt.
pub(crate) const MOST_OFF_US: f64 = 1.0;

/// Most instructions of a millisecond in which the board rests. The firmware makes 632, and has made twice as many.
const MOST_IDLE_PER_MS: f64 = 800.0;

/// Angle of the rotor before a dose.
pub(crate) const START_RAD: f64 = 0.3;

/// Doses with axis X: mL, mL/s, and true if smooth.
const DOSES: [(f64, f64, bool); 5] =
    [(1.0, 4.0, false), (8.0, 1.0, true), (8.0, 4.0, true), (10.0, 8.0, true), (-1.0, 4.0, true)];

/// Least volume of a smooth dose that has a whole pitch of cruise, mL.
const PITCH_ML: f64 = 8.0;

/// Makes whole doses, stops one and resets the board in another.
pub(crate) fn doses(firmware: &Path) -> Result<(), Box<dyn Error>> {
    idle(firmware)?;
    for (volume_ml, ml_s, smooth) in DOSES {
        dose(firmware, Axis::X, volume_ml, ml_s, smooth)?;
    }
    dose(firmware, Axis::A, 1.0, 4.0, true)?;
    stop(firmware)?;
    reset(firmware)
}

/// Makes one dose.
pub(crate) fn one(firmware: &Path) -> Result<(), Box<dyn Error>> {
    dose(firmware, Axis::X, 2.0, 4.0, true)
}

/// Board that was met, with the pump of the plans.
pub(crate) struct Met {
    file: PumpFile,
    pub(crate) pump: Pump,
    pub(crate) emulator: Emulator,
    pub(crate) node: Node,
    /// Edges until the axis was configured.
    configured: Vec<Edge>,
}

pub(crate) fn meet(firmware: &Path, axis: Axis) -> Result<Met, Box<dyn Error>> {
    meet_at(Emulator::new(firmware)?, axis, &Opening::default())
}

pub(crate) fn meet_at(emulator: Emulator, axis: Axis, opening: &Opening) -> Result<Met, Box<dyn Error>> {
    let file = built_in("three-roller").ok_or("no such pump")?;
    let pump = file.model()?;
    let table = DriveTable::of(DriverName::Node).with_axis(axis);
    let mut node = Node::over(Box::new(emulator.clone()), &table, &file.motor, opening)?;
    node.connect()?;
    let configured = emulator.take_edges();
    check(rises(&configured, axis as u8).is_empty(), "that nothing moves before a dose")?;
    Ok(Met { file, pump, emulator, node, configured })
}

impl Met {
    pub(crate) fn plan(&self, volume_ml: f64, ml_s: f64, smooth: bool) -> Result<Plan, Box<dyn Error>> {
        let doser = Doser::new(&self.pump, self.file.limits())?;
        let request = Request::new(volume_ml, Cruise::Flow { ml_s }).with_smooth(smooth);
        Ok(doser.plan(Phase::known(START_RAD), &request)?)
    }
}

/// Leaves a board alone whose axis is configured, and holds the instructions that it makes at rest.
fn idle(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, Axis::X)?;
    let time = Duration::from_secs(1);
    let before = met.emulator.counts()?;
    met.emulator.sleep(time);
    let after = met.emulator.counts()?;
    let per_ms = (after.all - before.all) / (1e3 * time.as_secs_f64());
    println!("at rest the board makes {per_ms:.0} instructions a ms");
    check(per_ms > 0.0 && per_ms <= MOST_IDLE_PER_MS, "the instructions of a board at rest")
}

/// Makes a dose, and holds each rise of the step pin against the plan.
fn dose(firmware: &Path, axis: Axis, volume_ml: f64, ml_s: f64, smooth: bool) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, axis)?;
    let plan = met.plan(volume_ml, ml_s, smooth)?;
    met.node.check(&plan)?;
    let made = met.node.run(&plan, &mut |_, _| Leave::Go)?;
    let edges = met.emulator.take_edges();
    let rises = rises(&edges, axis as u8);
    let counts = met.emulator.counts()?;
    let off_us = distances_us(&plan, &rises);
    let (least, most) = off_us.iter().fold((f64::MAX, f64::MIN), |(a, b), off| (a.min(*off), b.max(*off)));
    let half_us = 0.5 * (most - least);
    println!(
        "{volume_ml} mL at {ml_s} mL/s, smooth {smooth}, axis {axis}: {} steps, rises within {half_us:.3} us of the \
         plan; \
         {:.0} instructions an interrupt, {:.0} at most",
        rises.len(),
        counts.instructions / counts.interrupts.max(1.0),
        counts.most
    );
    check(made == plan.steps().unsigned_abs() && rises.len() as u64 == made, "the number of steps")?;
    check(half_us <= MOST_OFF_US, "the times of the steps")?;
    // A whole pitch of cruise.
    if smooth && volume_ml >= PITCH_ML {
        ripple::hold(&met.pump, &plan, &rises)?;
    }
    let direction = step_pin(axis as u8) + 1;
    // A direction pin that does not change points where it did since its axis was configured.
    let mut since_start = edges.iter().rev().chain(met.configured.iter().rev());
    let forward = since_start.find(|edge| edge.pin == direction).map(|edge| edge.level);
    check(forward == Some(u8::from(volume_ml > 0.0)), "the direction")?;
    let of_axes = edges.iter().filter(|edge| AXIS_PINS.contains(&edge.pin));
    let others = of_axes.filter(|edge| ![step_pin(axis as u8), direction].contains(&edge.pin)).count();
    check(others == 0, "that no other pin changes")
}

/// Stops a dose on its way.
fn stop(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, Axis::X)?;
    let plan = met.plan(10.0, 4.0, true)?;
    let made = met.node.run(&plan, &mut |made, _| if made > 3_000 { Leave::Stop } else { Leave::Go })?;
    let rises = rises(&met.emulator.take_edges(), Axis::X as u8).len();
    println!("stopped after {made} steps of {}; the pin rose {rises} times", plan.steps());
    check(rises as u64 == made && made < plan.steps().unsigned_abs(), "the count of a stop")
}

/// Resets the board in mid-dose: nothing moves afterwards, and the bounds contain the truth.
fn reset(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, Axis::X)?;
    let plan = met.plan(10.0, 4.0, false)?;
    let (emulator, mut is_reset) = (met.emulator.clone(), false);
    let fault = met.node.run(&plan, &mut |made, _| {
        if made > 2_000 && !is_reset {
            is_reset = emulator.reset().is_ok();
        }
        Leave::Go
    });
    let Err(fault) = fault else { return Err("a reset in mid-dose went unnoticed".into()) };
    let rises = rises(&met.emulator.take_edges(), Axis::X as u8).len() as i64;
    println!(
        "reset: {} to {} steps are stated, the pin rose {rises} times",
        fault.made_least, fault.made_most
    );
    check((fault.made_least..=fault.made_most).contains(&rises), "the bounds after a reset")
}

/// Returns the time of each rise after its step in the plan, in µs, up to a constant.
pub(crate) fn distances_us(plan: &Plan, rises: &[f64]) -> Vec<f64> {
    plan.each_step().zip(rises).map(|(step, at_ns)| 1e-3 * at_ns - 1e6 * step.time_s).collect()
}
