//! Doses with the Pico's firmware in an emulator, by the drive that the command uses, in the board's own time. The
//! edges of the step and direction pins are held against the plan.
//!
//! `check-node FIRMWARE.elf` holds all. `check-node FIRMWARE.elf MINUTES` makes a slow dose of so many minutes alone.
#![allow(clippy::print_stdout, reason = "this program prints what it measured")]

mod cuts;
mod emulator;
mod host;
mod ripple;
mod size;
mod slow;
mod together;
mod usb;

use std::error::Error;
use std::path::Path;

use emulator::{Edge, Emulator};
use pump_bench::drives::{Drive, Leave, Node, Opening};
use pump_bench::pump_file::{Axis, DriveTable, DriverName};
use pump_bench::{PumpFile, built_in};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request};
use pump_model::Pump;

/// Returns the step pin of an axis (firmware/pico). The next pin is that of the direction.
fn step_pin(axis: u8) -> u8 {
    2 + 4 * axis
}

/// Largest distance of a rise from its time in the plan, in µs: half a tick of the board's timer each way for the
/// rounding of deadlines, a tenth for that of the link, and the rest for the interrupt.
const MOST_OFF_US: f64 = 1.0;

/// Angle of the rotor before a dose.
const START_RAD: f64 = 0.3;

fn main() -> Result<(), Box<dyn Error>> {
    let Some(firmware) = std::env::args().nth(1) else {
        return Err("name the firmware, an ELF file".into());
    };
    let firmware = Path::new(&firmware);
    if let Some(minutes) = std::env::args().nth(2) {
        return slow::slow(firmware, minutes.parse()?);
    }
    for (volume_ml, ml_s, smooth) in
        [(1.0, 4.0, false), (0.5, 1.0, true), (2.0, 4.0, true), (10.0, 8.0, true), (-1.0, 4.0, true)]
    {
        dose(firmware, Axis::X, volume_ml, ml_s, smooth)?;
    }
    dose(firmware, Axis::A, 1.0, 4.0, true)?;
    stop(firmware)?;
    reset(firmware)?;
    let stack_bytes = usb::dose(firmware)?;
    size::hold(firmware, stack_bytes)?;
    together::even(firmware, 1_000, 0)?;
    together::smooth(firmware)?;
    together::fastest(firmware)?;
    together::refused(firmware)?;
    cuts::stops(firmware, 30)?;
    cuts::cuts(firmware, CUTS)?;
    slow::slow(firmware, SLOW_MIN)
}

/// Number of cuts of the link and kills of the host.
const CUTS: u32 = 200;

/// Minutes of the slow dose. `check-node FIRMWARE.elf 60` takes an hour's.
const SLOW_MIN: f64 = 5.0;

/// A board that was met, with the pump of the plans.
struct Met {
    file: PumpFile,
    pump: Pump,
    emulator: Emulator,
    node: Node,
}

fn meet(firmware: &Path, axis: Axis) -> Result<Met, Box<dyn Error>> {
    meet_at(Emulator::new(firmware)?, axis, &Opening::default())
}

fn meet_at(emulator: Emulator, axis: Axis, opening: &Opening) -> Result<Met, Box<dyn Error>> {
    let file = built_in("three-roller").ok_or("no such pump")?;
    let pump = file.model()?;
    let table = DriveTable::of(DriverName::Node).with_axis(axis);
    let mut node = Node::over(Box::new(emulator.clone()), &table, &file.motor, opening)?;
    node.connect()?;
    emulator.take_edges();
    Ok(Met { file, pump, emulator, node })
}

impl Met {
    fn plan(&self, volume_ml: f64, ml_s: f64, smooth: bool) -> Result<Plan, Box<dyn Error>> {
        let doser = Doser::new(&self.pump, self.file.limits())?;
        let request = Request::new(volume_ml, Cruise::Flow { ml_s }).with_smooth(smooth);
        Ok(doser.plan(Phase::known(START_RAD), &request)?)
    }
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
    if smooth && volume_ml >= 10.0 {
        ripple::hold(&met.pump, &plan, &rises)?;
    }
    let direction = step_pin(axis as u8) + 1;
    let forward = edges.iter().rev().find(|edge| edge.pin == direction).is_none_or(|edge| edge.level == 1);
    check(forward == (volume_ml > 0.0), "the direction")
}

/// Stops a dose on its way.
fn stop(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, Axis::X)?;
    let plan = met.plan(5.0, 4.0, true)?;
    let made = met.node.run(&plan, &mut |made, _| if made > 3_000 { Leave::Stop } else { Leave::Go })?;
    let rises = rises(&met.emulator.take_edges(), Axis::X as u8).len();
    println!("stopped after {made} steps of {}; the pin rose {rises} times", plan.steps());
    check(rises as u64 == made && made < plan.steps().unsigned_abs(), "the count of a stop")
}

/// Resets the board in mid-dose: nothing moves afterwards, and the bounds contain the truth.
fn reset(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, Axis::X)?;
    let plan = met.plan(5.0, 4.0, false)?;
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

/// Returns the times of the rises of an axis's step pin, in ns. A pin that becomes an output is no rise.
pub(crate) fn rises(edges: &[Edge], axis: u8) -> Vec<f64> {
    let pin = step_pin(axis);
    edges.iter().filter(|edge| edge.pin == pin && edge.level == 1).map(|edge| edge.at_ns).collect()
}

/// Returns the time of each rise after its step in the plan, in µs, up to a constant.
fn distances_us(plan: &Plan, rises: &[f64]) -> Vec<f64> {
    plan.each_step().zip(rises).map(|(step, at_ns)| 1e-3 * at_ns - 1e6 * step.time_s).collect()
}

fn check(holds: bool, what: &str) -> Result<(), Box<dyn Error>> {
    if holds { Ok(()) } else { Err(format!("{what} does not hold").into()) }
}
