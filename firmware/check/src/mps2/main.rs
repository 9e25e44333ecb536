//! Doses with the node's firmware for the mps2-an386 in QEMU, by the drive that the command uses, in the board's own
//! time. The edges of the step and direction pins are held against the plan.
//!
//! `check-node-mps2 FIRMWARE.elf [one]`: with `one` it makes one dose.
#![allow(clippy::print_stdout, reason = "this program prints what it measured")]

#[path = "../board/lockstep.rs"]
mod lockstep;
mod qemu;
mod scope;

use std::error::Error;
use std::path::Path;
use std::thread;
use std::time::Duration;

use pump_bench::drives::{CommonBegin, Drive, Leave, Node, NodeBoard, Opening};
use pump_bench::pump_file::{Axis, DriveTable, DriverName};
use pump_bench::{PumpFile, built_in};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request};
use pump_model::Pump;

use qemu::Qemu;
use scope::Edge;

/// Step pin of axis X (firmware/emulated), and number of pins from a step pin to its direction pin.
const FIRST_STEP: u8 = 0;
const TO_DIRECTION: u8 = 4;

/// Largest distance of a rise from its time in the plan, in us: half a tick of the board's timer each way for the
/// rounding of deadlines, a tenth for that of the link, and the rest for the interrupt.
const MOST_OFF_US: f64 = 1.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let (Some(firmware), one) = (words.next(), words.next()) else {
        return Err("name the firmware, an ELF file".into());
    };
    let firmware = Path::new(&firmware);
    dose(firmware, Axis::X, 0.5, 1.0, true)?;
    match one.as_deref() {
        Some("one") => return Ok(()),
        Some(other) => return Err(format!("'{other}' is not known; 'one' is").into()),
        None => {}
    }
    for (volume_ml, ml_s, smooth) in
        [(1.0, 4.0, false), (2.0, 4.0, true), (3.0, 8.0, true), (-1.0, 4.0, true)]
    {
        dose(firmware, Axis::X, volume_ml, ml_s, smooth)?;
    }
    dose(firmware, Axis::A, 1.0, 4.0, true)?;
    axes(firmware)?;
    stop(firmware)?;
    reset(firmware)
}

/// A board that was met, with the pump of the plans.
struct Met {
    file: PumpFile,
    pump: Pump,
    qemu: Qemu,
    node: Node,
    /// Edges while the axis was configured.
    configured: Vec<Edge>,
}

fn meet(firmware: &Path, axis: Axis) -> Result<Met, Box<dyn Error>> {
    let file = built_in("three-roller").ok_or("no such pump")?;
    let pump = file.model()?;
    let qemu = Qemu::new(firmware)?;
    let table = DriveTable::of(DriverName::Node).with_axis(axis);
    let mut node = Node::over(Box::new(qemu.clone()), &table, &file.motor, &Opening::default())?;
    node.connect()?;
    let configured = qemu.take_edges();
    check(rises(&configured, axis).is_empty(), "that nothing moves before a dose")?;
    Ok(Met { file, pump, qemu, node, configured })
}

impl Met {
    fn plan(&self, volume_ml: f64, ml_s: f64, smooth: bool) -> Result<Plan, Box<dyn Error>> {
        let doser = Doser::new(&self.pump, self.file.limits())?;
        let request = Request::new(volume_ml, Cruise::Flow { ml_s }).with_smooth(smooth);
        Ok(doser.plan(Phase::known(0.3), &request)?)
    }
}

/// Makes a dose, and holds each rise of the step pin against the plan.
fn dose(firmware: &Path, axis: Axis, volume_ml: f64, ml_s: f64, smooth: bool) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, axis)?;
    let plan = met.plan(volume_ml, ml_s, smooth)?;
    met.node.check(&plan)?;
    let made = met.node.run(&plan, &mut |_, _| Leave::Go)?;
    let edges = met.qemu.take_edges();
    let rises = rises(&edges, axis);
    let off_us = plan.each_step().zip(&rises).map(|(step, at_ns)| 1e-3 * at_ns - 1e6 * step.time_s);
    let (least, most) = off_us.fold((f64::MAX, f64::MIN), |(a, b), off| (a.min(off), b.max(off)));
    let half_us = 0.5 * (most - least);
    println!(
        "{volume_ml} mL at {ml_s} mL/s, smooth {smooth}, axis {axis}: {} steps, rises within {half_us:.3} us of the \
         plan",
        rises.len(),
    );
    check(made == plan.steps().unsigned_abs() && rises.len() as u64 == made, "the number of steps")?;
    check(half_us <= MOST_OFF_US, "the times of the steps")?;
    let direction = step_pin(axis) + TO_DIRECTION;
    // A direction pin that does not change points where it did since its axis was configured.
    let mut since_start = edges.iter().rev().chain(met.configured.iter().rev());
    let forward = since_start.find(|edge| edge.pin == direction).and_then(|edge| edge.level);
    check(forward == Some(volume_ml > 0.0), "the direction")?;
    let others = edges.iter().any(|edge| ![step_pin(axis), direction].contains(&edge.pin));
    check(!others, "that no other pin changes")
}

/// Makes doses with two axes that begin at one tick, each by a drive in a thread of its own.
fn axes(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let file = built_in("three-roller").ok_or("no such pump")?;
    let (pump, qemu) = (file.model()?, Qemu::new(firmware)?);
    let board = NodeBoard::over(Box::new(qemu.clone()));
    let doser = Doser::new(&pump, file.limits())?;
    let mut drives = Vec::new();
    for (axis, volume_ml) in [(Axis::X, 0.5), (Axis::Z, -0.4)] {
        let table = DriveTable::of(DriverName::Node).with_axis(axis);
        let request = Request::new(volume_ml, Cruise::Flow { ml_s: 2.0 }).with_smooth(true);
        let plan = doser.plan(Phase::known(0.3), &request)?;
        drives.push((axis, board.axis(&table, &file.motor, &Opening::default())?, plan));
    }
    qemu.take_edges();
    let mut places = CommonBegin::places(drives.len(), Duration::from_secs(600));
    let made: Vec<Option<u64>> = thread::scope(|scope| {
        let threads: Vec<_> = drives
            .iter_mut()
            .map(|(_, node, plan)| {
                let place = places.pop();
                scope.spawn(move || {
                    place.map(|place| node.begin_with(place));
                    node.run(plan, &mut |_, _| Leave::Go).ok()
                })
            })
            .collect();
        threads.into_iter().map(|thread| thread.join().ok().flatten()).collect()
    });
    let edges = qemu.take_edges();
    let mut off_us = Vec::new();
    for ((axis, _, plan), made) in drives.iter().zip(made) {
        let rises = rises(&edges, *axis);
        check(
            made == Some(plan.steps().unsigned_abs()) && made == Some(rises.len() as u64),
            "the number of steps",
        )?;
        off_us.extend(plan.each_step().zip(&rises).map(|(step, at_ns)| 1e-3 * at_ns - 1e6 * step.time_s));
    }
    let (least, most) = off_us.iter().fold((f64::MAX, f64::MIN), |(a, b), off| (a.min(*off), b.max(*off)));
    let half_us = 0.5 * (most - least);
    println!(
        "two axes in threads of their own, begun at one tick: all rises within {half_us:.3} us of the plans"
    );
    // Two axes that are due together have 2 us each.
    check(half_us <= 2.0 * MOST_OFF_US, "the times of the steps of two axes")
}

/// Stops a dose on its way.
fn stop(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, Axis::X)?;
    let plan = met.plan(10.0, 4.0, true)?;
    let made = met.node.run(&plan, &mut |made, _| if made > 3_000 { Leave::Stop } else { Leave::Go })?;
    let rises = rises(&met.qemu.take_edges(), Axis::X).len();
    println!("stopped after {made} steps of {}; the pin rose {rises} times", plan.steps());
    check(made > 3_000 && made < plan.steps().unsigned_abs(), "the place of a stop")?;
    check(rises as u64 == made, "the count of a stop")
}

/// Resets the board in mid-dose: nothing moves afterwards, and the bounds contain the truth.
fn reset(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, Axis::X)?;
    let plan = met.plan(10.0, 4.0, false)?;
    let (qemu, mut before) = (met.qemu.clone(), None);
    let fault = met.node.run(&plan, &mut |made, _| {
        if made > 2_000 && before.is_none() {
            before = Some(rises(&qemu.take_edges(), Axis::X).len() as i64);
            if qemu.reset().is_err() {
                return Leave::Stop;
            }
        }
        Leave::Go
    });
    let Err(fault) = fault else { return Err("a reset in mid-dose went unnoticed".into()) };
    let before = before.ok_or("the board was not reset")?;
    let after = rises(&met.qemu.take_edges(), Axis::X).len();
    println!(
        "reset: {} to {} steps are stated, the pin rose {before} times before and {after} after",
        fault.made_least, fault.made_most
    );
    check((fault.made_least..=fault.made_most).contains(&before), "the bounds after a reset")?;
    check(fault.made_most < plan.steps(), "that no more is stated than was sent")?;
    check(after == 0, "that nothing moves after a reset")
}

/// Returns the step pin of an axis.
fn step_pin(axis: Axis) -> u8 {
    FIRST_STEP + axis as u8
}

/// Returns the times of the rises of an axis's step pin, in ns. A pin that becomes an output is no rise.
fn rises(edges: &[Edge], axis: Axis) -> Vec<f64> {
    let pin = step_pin(axis);
    edges.iter().filter(|edge| edge.pin == pin && edge.level == Some(true)).map(|edge| edge.at_ns).collect()
}

fn check(holds: bool, what: &str) -> Result<(), Box<dyn Error>> {
    if holds { Ok(()) } else { Err(format!("{what} does not hold").into()) }
}
