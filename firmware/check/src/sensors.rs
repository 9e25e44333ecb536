//! The inputs of the board: emergency stop, drivers' faults and index sensors, each at its own pin.

use std::error::Error;
use std::path::Path;
use std::time::Duration;

use pump_bench::built_in;
use pump_bench::drives::wire::Wire;
use pump_bench::drives::{Disturbance, Drive, Leave, Node, NodeError, Opening};
use pump_bench::pump_file::{Axis, DriveTable, DriverFault, DriverName, PinsTable};
use pump_ctl::plan::{Cruise, Doser, Phase, Plan, Request};

use crate::board::emulator::{Edge, Emulator};
use crate::board::motor::{rises, step_pin};
use crate::check;
use crate::doses::START_RAD;

/// Pin of the emergency stop, and of the light.
const STOP: u8 = 22;
const LIGHT: u8 = 25;

/// Axes of the board.
const AXES: [Axis; 4] = [Axis::X, Axis::Y, Axis::Z, Axis::A];

/// Steps after which an input changes.
const AFTER: u64 = 200;

/// Most steps after which the board sees an input, at some 1,200 steps/s: it looks every ms, and before each step.
const SEEN_WITHIN: u64 = 5;

/// Returns the pin of an axis's enable, of its index sensor and of its driver's fault (docs/node.md).
fn enable_pin(axis: u8) -> u8 {
    step_pin(axis) + 2
}

fn index_pin(axis: u8) -> u8 {
    step_pin(axis) + 3
}

fn fault_pin(axis: u8) -> u8 {
    18 + axis
}

/// Changes each input on the way of a dose, those of other axes before.
pub(crate) fn sensors(firmware: &Path) -> Result<(), Box<dyn Error>> {
    stop(firmware)?;
    for axis in AXES {
        fault(firmware, axis, DriverFault::Low)?;
        fault(firmware, axis, DriverFault::High)?;
        index(firmware, axis)?;
    }
    halt(firmware)
}

/// Board with an axis.
struct Scene {
    emulator: Emulator,
    node: Node,
    plan: Plan,
}

impl Scene {
    fn new(
        firmware: &Path,
        axis: Axis,
        change: impl FnOnce(DriveTable) -> DriveTable,
    ) -> Result<Self, Box<dyn Error>> {
        // The drivers' fault outputs are high, as their pull-ups leave them.
        Self::of(firmware, axis, true, change)
    }

    /// Makes a board whose drivers' fault outputs are all at this level.
    fn of(
        firmware: &Path,
        axis: Axis,
        faultless: bool,
        change: impl FnOnce(DriveTable) -> DriveTable,
    ) -> Result<Self, Box<dyn Error>> {
        let emulator = Emulator::new(firmware)?;
        for other in AXES {
            emulator.input(fault_pin(other as u8), faultless)?;
        }
        let file = built_in("three-roller").ok_or("no such pump")?;
        let table = change(DriveTable::of(DriverName::Node).with_axis(axis));
        let node = Node::over(Box::new(emulator.clone()), &table, &file.motor, &Opening::default())?;
        let request = Request::new(0.5, Cruise::Flow { ml_s: 1.0 });
        let pump = file.model()?;
        let plan = Doser::new(&pump, file.limits())?.plan(Phase::known(START_RAD), &request)?;
        emulator.take_edges();
        Ok(Self { emulator, node, plan })
    }
}

/// Returns true if the last level of a pin is this one.
fn ends_at(edges: &[Edge], pin: u8, level: u8) -> bool {
    edges.iter().rev().find(|edge| edge.pin == pin).is_some_and(|edge| edge.level == level)
}

/// Presses the emergency stop on the way of a dose.
fn stop(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let Scene { emulator, mut node, plan } = Scene::new(firmware, Axis::X, |table| table)?;
    let (board, mut pressed_at) = (emulator.clone(), None);
    let fault = node.run(&plan, &mut |made, _| {
        if made >= AFTER && pressed_at.is_none() && board.input(STOP, true).is_ok() {
            pressed_at = Some(made);
        }
        Leave::Go
    });
    let Err(fault) = fault else { return Err("an emergency stop went unnoticed".into()) };
    let is_told = matches!(node_error(&fault.error), Some(NodeError::Estop));
    check(is_told && fault.lost, "that the emergency stop is told, and the angle lost")?;
    let edges = emulator.take_edges();
    let made = rises(&edges, 0).len() as u64;
    println!("emergency stop after {AFTER} steps: {made} were made, and the motor is let go");
    check(fault.made_most as u64 == made && made < plan.steps().unsigned_abs(), "the count of the stop")?;
    check(ends_at(&edges, enable_pin(0), 1), "that the emergency stop lets the motor go")?;
    check(node.connect().is_err(), "that nothing moves while the stop is pressed")?;
    emulator.input(STOP, false)?;
    node.connect()?;
    check(node.disturbed() == Some(Disturbance::EmergencyStop), "that the emergency stop let the rotor go")?;
    check(ends_at(&emulator.take_edges(), enable_pin(0), 0), "that the motor is held again")
}

/// Has the drivers of all other axes report a fault, and then that of this one.
fn fault(firmware: &Path, axis: Axis, output: DriverFault) -> Result<(), Box<dyn Error>> {
    let mut pins = PinsTable::default();
    pins.driver_fault = Some(output);
    let is_high = output == DriverFault::High;
    let Scene { emulator, mut node, plan } =
        Scene::of(firmware, axis, !is_high, |table| table.with_pins(pins))?;
    for other in AXES.into_iter().filter(|other| *other != axis) {
        emulator.input(fault_pin(other as u8), is_high)?;
    }
    let (board, mut is_told, mut told_at) = (emulator.clone(), false, 0);
    let fault = node.run(&plan, &mut |made, _| {
        if made >= AFTER && !is_told {
            (is_told, told_at) = (board.input(fault_pin(axis as u8), is_high).is_ok(), made);
        }
        Leave::Go
    });
    let Err(fault) = fault else { return Err(format!("a fault of driver {axis} went unnoticed").into()) };
    let edges = emulator.take_edges();
    let made = rises(&edges, axis as u8).len() as u64;
    println!(
        "a fault of driver {axis}, {output:?}, after {told_at} steps: {made} were made, and the motor is let go"
    );
    let is_told = matches!(node_error(&fault.error), Some(NodeError::Driver)) && fault.lost;
    check(is_told, "that a driver's fault is told, and the angle lost")?;
    check(made >= AFTER && fault.made_most as u64 == made, "the count of a driver's fault")?;
    check(ends_at(&edges, enable_pin(axis as u8), 1), "that a driver's fault lets the motor go")
}

/// Has the index sensors of all other axes become active in a search, and then that of this one.
fn index(firmware: &Path, axis: Axis) -> Result<(), Box<dyn Error>> {
    let Scene { emulator, mut node, plan } =
        Scene::new(firmware, axis, |table| table.with_index_angle_deg(0.0))?;
    for other in AXES.into_iter().filter(|other| *other != axis) {
        emulator.input(index_pin(other as u8), true)?;
    }
    let (board, mut active_at) = (emulator.clone(), None);
    let found = node.seek(&plan, &mut |made, _| {
        if made >= AFTER && active_at.is_none() && board.input(index_pin(axis as u8), true).is_ok() {
            active_at = Some(rises_so_far(&board, axis));
        }
        Leave::Go
    })?;
    let (made, active_at) = (found.made, active_at.ok_or("the search ended before the sensor was active")?);
    let at = found.beyond.map(|beyond| made - beyond).ok_or("the index was not found")?;
    println!("the index of axis {axis} became active after step {active_at}, and was seen at {at} of {made}");
    check((active_at..=active_at + SEEN_WITHIN).contains(&at), "the step of the index")?;
    check(made < plan.steps().unsigned_abs(), "that the index ends the search")
}

/// Has the firmware stop for good while its light shines.
fn halt(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let Scene { mut emulator, node, .. } = Scene::new(firmware, Axis::X, |table| table)?;
    emulator.sleep(Duration::from_millis(200));
    emulator.halt()?;
    emulator.sleep(Duration::from_millis(500));
    let edges = emulator.take_edges();
    drop(node);
    println!("a firmware that has stopped for good: the light is dark");
    let dark = edges.iter().filter(|edge| edge.pin == LIGHT).map(|edge| edge.level).collect::<Vec<_>>();
    check(dark == [0], "that the light of a firmware that has stopped for good goes dark")
}

/// Returns the steps that the pins have made, and keeps their edges.
fn rises_so_far(board: &Emulator, axis: Axis) -> u64 {
    rises(&board.edges(), axis as u8).len() as u64
}

fn node_error(error: &pump_bench::drives::DriveError) -> Option<&NodeError> {
    error.source().and_then(|source| source.downcast_ref())
}
