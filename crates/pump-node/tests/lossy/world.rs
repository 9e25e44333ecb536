//! A host and a node with a line between them, on one clock.

use std::cell::RefCell;
use std::rc::Rc;
use std::slice::IterMut;

use pump_node::{Axes, Axis, Node, identity};

use crate::board::{Hardware, SharedHardware, SimulatedPins};
use crate::host::{Host, Phase};
use crate::line::{Badness, Line};
use crate::plans::TICK_HZ;
use crate::rng::Rng;

/// Segments in the queue of an axis.
pub(crate) const QUEUE: usize = 64;

type NodeAxes<'w> = Axes<'w, SimulatedPins, SharedHardware, QUEUE, 4>;

/// Place for the axes of a board.
pub(crate) type Place = Option<[Axis<SimulatedPins, QUEUE>; 4]>;

pub(crate) struct World<'w> {
    /// Time of the world, us.
    pub(crate) now_us: u64,
    /// Time at which the board was switched on. Its ticks count from there.
    booted_us: u64,
    pub(crate) hardware: SharedHardware,
    pub(crate) node: Node,
    pub(crate) axes: NodeAxes<'w>,
    /// Places for boards that are switched on later.
    places: IterMut<'w, Place>,
    pub(crate) to_node: Line,
    pub(crate) to_host: Line,
    pub(crate) badness: Badness,
    pub(crate) rng: Rng,
    next_poll_us: u64,
    next_act_us: u64,
    /// Time until which the host is held up. Its input waits.
    pub(crate) held_up_until_us: u64,
}

fn board<'w>(hardware: &SharedHardware, place: Option<&'w mut Place>) -> (Node, NodeAxes<'w>) {
    let axes = [0, 1, 2, 3].map(|axis| Axis::new(SimulatedPins(hardware.clone(), axis), TICK_HZ));
    let axes = place.expect("a place for each board").insert(axes);
    let node = Node::new(identity::<QUEUE, 4>(0xb0a2d, [0, 1, 0], TICK_HZ));
    (node, Axes::new(axes, hardware.clone(), TICK_HZ))
}

impl<'w> World<'w> {
    /// Makes a world with a place for each time that the board is switched on.
    pub(crate) fn new(rng: Rng, badness: Badness, places: &'w mut [Place]) -> Self {
        let hardware = SharedHardware(Rc::new(RefCell::new(Hardware::default())));
        let mut places = places.iter_mut();
        let (node, axes) = board(&hardware, places.next());
        Self {
            now_us: 5_000_000,
            booted_us: 4_000_000,
            hardware,
            node,
            axes,
            places,
            to_node: Line::default(),
            to_host: Line::default(),
            badness,
            rng,
            next_poll_us: 0,
            next_act_us: 0,
            held_up_until_us: 0,
        }
    }

    /// Switches the board off and on. The motors keep their places.
    pub(crate) fn reset_board(&mut self) {
        {
            let hardware = &mut *self.hardware.0.borrow_mut();
            for axis in &mut hardware.axes {
                (axis.outputs, axis.levels) = (false, None);
                axis.rises.clear();
            }
            hardware.now = 0;
        }
        self.booted_us = self.now_us;
        (self.node, self.axes) = board(&self.hardware, self.places.next());
    }

    /// Returns the steps that the motor of an axis has made.
    pub(crate) fn count(&self, axis: usize) -> i64 {
        self.hardware.0.borrow().axes[axis].count
    }

    pub(crate) fn tick(&self) -> u64 {
        self.now_us - self.booted_us
    }

    fn now_ns(&self) -> u64 {
        // The host's clock has an origin of its own.
        self.now_us * 1000 + 777_000_000_000
    }

    /// Goes on to the next event, at `until_us` at the latest.
    pub(crate) fn go_on(&mut self, host: Option<&mut Host>, until_us: u64) {
        let timer_us = self.axes.next_alarm().map(|tick| tick + self.booted_us);
        let events = [self.to_node.next_at(), timer_us, Some(self.next_poll_us), Some(until_us)];
        let awake = host.is_some() && self.now_us >= self.held_up_until_us;
        let hosts = if awake { [self.to_host.next_at(), Some(self.next_act_us)] } else { [None; 2] };
        let next = events.into_iter().chain(hosts).flatten().min().unwrap_or(until_us);
        self.now_us = self.now_us.max(next);
        self.hardware.0.borrow_mut().now = self.tick();
        if timer_us.is_some_and(|at| at <= self.now_us) {
            let _ = self.axes.on_timer();
            // Pulses take time.
            self.now_us = self.now_us.max(self.hardware.0.borrow().now + self.booted_us);
        }
        while let Some(byte) = self.to_node.take(self.now_us) {
            if let Some(answer) = self.node.on_byte(byte, self.tick(), &mut self.axes) {
                self.to_host.send(answer.bytes(), self.now_us, self.badness, &mut self.rng);
            }
        }
        if self.now_us >= self.next_poll_us {
            self.next_poll_us = self.now_us + 1000;
            self.node.poll(self.tick(), &mut self.axes);
        }
        let now_ns = self.now_ns();
        if let Some(host) = host.filter(|_| self.now_us >= self.held_up_until_us) {
            while let Some(byte) = self.to_host.take(self.now_us) {
                host.on_byte(byte, now_ns);
            }
            if self.now_us >= self.next_act_us {
                self.next_act_us = self.now_us + 1000;
                host.act(now_ns);
                for frame in host.out.drain(..) {
                    self.to_node.send(&frame, self.now_us, self.badness, &mut self.rng);
                }
            }
        }
    }

    /// Runs for so long, or until the host is done.
    pub(crate) fn run(&mut self, host: &mut Host, for_us: u64) {
        let end = self.now_us + for_us;
        while self.now_us < end && !matches!(host.phase, Phase::Over | Phase::Reset) {
            self.go_on(Some(host), end);
        }
    }

    /// Runs without a host.
    pub(crate) fn run_alone(&mut self, for_us: u64) {
        let end = self.now_us + for_us;
        while self.now_us < end {
            self.go_on(None, end);
        }
    }
}
