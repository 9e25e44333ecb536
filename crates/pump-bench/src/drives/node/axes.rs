//! Several axes of one board, whose plans begin at one tick.

use pump_ctl::plan::Plan;

use super::error::NodeError;
use super::motion::{self, AHEAD, Fault, Task};
use super::node::Node;
use super::node_board::NodeBoard;
use crate::drives::sent_lead::SentLead;
use crate::drives::stepped::Lead;
use crate::drives::wire::Wire;
use crate::drives::{DriveError, DriveFault, Gate, Opening};
use crate::pump_file::{DriveTable, MotorTable};

/// Most axes of a board.
const MOST: usize = pump_link::message::AXES;

/// Axis of a board and the pump that it turns.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct NodeAxis<'a> {
    /// Drive table of the pump, which names the axis.
    pub table: &'a DriveTable,
    /// Motor of the pump.
    pub motor: &'a MotorTable,
    /// Terms on which the axis is opened, with the records of the pump.
    pub opening: &'a Opening,
}

impl<'a> NodeAxis<'a> {
    /// Names an axis by the drive table of its pump, its motor and the terms of its opening.
    pub const fn new(table: &'a DriveTable, motor: &'a MotorTable, opening: &'a Opening) -> Self {
        Self { table, motor, opening }
    }
}

/// Plan that an axis is to make, with the gate that gives leave for its steps.
#[non_exhaustive]
pub struct AxisRun<'a, 'g> {
    /// Place of the axis among those that were opened, from 0.
    pub place: usize,
    /// Plan from the place at which the axis stands.
    pub plan: &'a Plan,
    /// Gate of the plan. One thread asks the gates of all axes by turns.
    pub gate: &'a mut Gate<'g>,
}

impl<'a, 'g> AxisRun<'a, 'g> {
    /// Has the axis at `place` make `plan`, with leave of `gate`.
    pub fn new(place: usize, plan: &'a Plan, gate: &'a mut Gate<'g>) -> Self {
        Self { place, plan, gate }
    }
}

impl std::fmt::Debug for AxisRun<'_, '_> {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        to.debug_struct("AxisRun").field("place", &self.place).finish_non_exhaustive()
    }
}

/// Several axes of one board.
///
/// Each axis is a [`Node`], a drive of its own for one pump at a time. [`Self::run`] makes plans of several axes that
/// begin at one tick of the board. It writes no journal: whoever calls it gives leave only for steps that are on
/// record.
#[derive(Debug)]
pub struct NodeAxes {
    nodes: Vec<Node>,
}

impl NodeAxes {
    /// Opens axes of the board at the port of the first. Moves nothing.
    ///
    /// # Errors
    ///
    /// [`DriveError`] as [`Node::open`], and for an axis that is named twice or at another port.
    pub fn open(axes: &[NodeAxis<'_>]) -> Result<Self, DriveError> {
        check(axes)?;
        let first = axes.first().map(|axis| axis.table);
        let rate_baud = first.map_or(0, DriveTable::rate_baud);
        Self::of(&NodeBoard::open(first.and_then(|table| table.port.as_deref()), rate_baud)?, axes)
    }

    /// Opens axes of the board at the other end of `wire`, as [`Self::open`] does.
    #[doc(hidden)]
    pub fn over(wire: Box<dyn Wire>, axes: &[NodeAxis<'_>]) -> Result<Self, DriveError> {
        check(axes)?;
        Self::of(&NodeBoard::over(wire), axes)
    }

    fn of(board: &NodeBoard, axes: &[NodeAxis<'_>]) -> Result<Self, DriveError> {
        let nodes = axes.iter().map(|axis| board.axis(axis.table, axis.motor, axis.opening));
        Ok(Self { nodes: nodes.collect::<Result<_, _>>()? })
    }

    /// Returns the drive of the axis at `place`, from 0, for one pump at a time.
    pub fn drive(&mut self, place: usize) -> Option<&mut Node> {
        self.nodes.get_mut(place)
    }

    /// Makes plans that begin at one tick, or none of them. Returns the steps that each made, in the order of `runs`.
    ///
    /// A plan that is stopped or fails after the begin leaves the others alone.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if a plan cannot be made, the axes together need more steps or bytes a second than board and
    /// link make, or a place is not there or named twice. Nothing has moved.
    pub fn run(&mut self, runs: &mut [AxisRun<'_, '_>]) -> Result<Vec<Result<u64, DriveFault>>, DriveError> {
        let tasks = self.tasks(runs);
        if tasks.is_err() {
            self.nodes.iter_mut().for_each(Node::needs_nothing);
        }
        let tasks = tasks?;
        let leads: Vec<SentLead<'_>> = runs
            .iter()
            .zip(&tasks)
            .map(|(run, task)| SentLead::new(run.plan.into(), AHEAD, task.brake_steps))
            .collect();
        let frees: Vec<Lead> = runs.iter().map(|_| Lead::free()).collect();
        let mut nodes: Vec<Option<&mut Node>> = self.nodes.iter_mut().map(Some).collect();
        let mut motions = Vec::new();
        for (((run, task), lead), free) in runs.iter().zip(&tasks).zip(&leads).zip(&frees) {
            let node = nodes.get_mut(run.place).and_then(Option::take);
            if let Some(node) = node {
                node.be_deaf(true);
                motions.extend(node.motion(run.plan.into(), *task, (lead, free), false));
            }
        }
        let mut gates: Vec<&mut Gate<'_>> = runs.iter_mut().map(|run| &mut *run.gate).collect();
        let outcomes = motion::run(motions, &leads, &mut gates, None);
        let mut outcomes = outcomes.into_iter();
        let made = runs.iter().map(|run| {
            let outcome = outcomes.next().unwrap_or(Err(Fault::at_rest(NodeError::Reset)));
            match self.nodes.get_mut(run.place) {
                Some(node) => node.after(run.plan.into(), outcome).map(|made| made.steps),
                None => outcome.map(|made| made.steps).map_err(Fault::of_drive),
            }
        });
        Ok(made.collect())
    }
}

impl NodeAxes {
    /// Returns the tasks of plans that share the line.
    fn tasks(&mut self, runs: &[AxisRun<'_, '_>]) -> Result<Vec<Task>, NodeError> {
        let mut tasks = Vec::new();
        for (n, run) in runs.iter().enumerate() {
            let is_free = runs.iter().take(n).all(|other| other.place != run.place);
            let missing = NodeError::Place { place: run.place, axes: self.nodes.len() };
            let node = self.nodes.get_mut(run.place).filter(|_| is_free).ok_or(missing)?;
            tasks.push(node.task(run.plan.into())?);
        }
        Ok(tasks)
    }
}

/// Refuses axes that are named twice, or at different ports, and too many.
fn check(axes: &[NodeAxis<'_>]) -> Result<(), NodeError> {
    if axes.len() > MOST {
        return Err(NodeError::Place { place: axes.len() - 1, axes: MOST });
    }
    for (n, axis) in axes.iter().enumerate() {
        let before = axes.iter().take(n);
        let clash = before.clone().find(|other| other.table.axis == axis.table.axis);
        let elsewhere = before.clone().find(|other| other.table.port != axis.table.port);
        if clash.is_some() {
            return Err(NodeError::Twice { axis: axis.table.axis });
        }
        if elsewhere.is_some() {
            let port = axis.table.port.clone().unwrap_or_default();
            return Err(NodeError::Elsewhere { axis: axis.table.axis, port });
        }
    }
    Ok(())
}
