//! A node without a line: each request has its answer at once.

use std::cell::RefCell;
use std::rc::Rc;

use pump_ctl::plan::Motor;
use pump_ctl::step::{Segment, TickRate};
use pump_link::frame::{AnswerHeader, Deframer, Encoded, RequestHeader, body};
use pump_link::message::{Answer, AxisConfig, AxisStatus, MAX_PACKED, MoveOrder, Refusal, Request};
use pump_link::packing::{Codec, Grain, Rounder};
use pump_node::{Axes, Axis, Board, Edge as PinEdge, Levels, Node, Pins, identity};

pub(crate) const TICK_HZ: u32 = 1_000_000;
pub(crate) const SESSION: u64 = 42;

/// An edge or a change of pins: tick, axis, what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Edge {
    Outputs(Levels),
    Step(bool),
    Direction(bool),
    Enable(bool),
}

#[derive(Debug, Default)]
pub(crate) struct Hardware {
    pub(crate) now: u64,
    pub(crate) estop: bool,
    pub(crate) index: [bool; 4],
    pub(crate) driver_fault: [bool; 4],
    pub(crate) edges: Vec<(u64, usize, Edge)>,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Shared(Rc<RefCell<Hardware>>);

impl Board for Shared {
    fn now(&mut self) -> u64 {
        self.0.borrow().now
    }

    fn wait_until(&mut self, tick: u64) {
        let now = &mut self.0.borrow_mut().now;
        *now = tick.max(*now);
    }

    fn set_steps(&mut self, edge: PinEdge) {
        for axis in 0..4 {
            for (pins, high) in [(edge.high, true), (edge.low, false)] {
                if pins & 1 << axis != 0 {
                    AxisPins(self.clone(), axis).note(Edge::Step(high));
                }
            }
        }
    }

    fn estop_is_pressed(&mut self) -> bool {
        self.0.borrow().estop
    }
}

#[derive(Debug)]
pub(crate) struct AxisPins(Shared, usize);

impl AxisPins {
    fn note(&mut self, edge: Edge) {
        let hardware = &mut *self.0.0.borrow_mut();
        hardware.edges.push((hardware.now, self.1, edge));
    }
}

impl Pins for AxisPins {
    fn make_outputs(&mut self, levels: Levels) {
        self.note(Edge::Outputs(levels));
    }

    fn step_pin(&self) -> u32 {
        1 << self.1
    }

    fn set_direction(&mut self, high: bool) {
        self.note(Edge::Direction(high));
    }

    fn set_enable(&mut self, high: bool) {
        self.note(Edge::Enable(high));
    }

    fn index_is_high(&mut self) -> bool {
        self.0.0.borrow().index[self.1]
    }

    fn driver_fault_is_high(&mut self) -> bool {
        !self.0.0.borrow().driver_fault[self.1]
    }
}

pub(crate) struct Direct {
    pub(crate) hardware: Shared,
    pub(crate) node: Node,
    pub(crate) axes: Axes<'static, AxisPins, Shared, 32, 4>,
    number: u16,
    revision: u32,
    /// Port over which the node is asked.
    pub(crate) port: usize,
}

/// Even steps, 1 ms apart.
pub(crate) const EVEN: Segment = Segment { count: 10, interval: 1000, add: 0, frac: 0 };

pub(crate) fn order(from: i64, last: i64) -> MoveOrder {
    MoveOrder { from, last, shortest_interval: 900 }
}

/// Returns the default configuration with a change.
pub(crate) fn config_with(change: impl FnOnce(&mut AxisConfig)) -> AxisConfig {
    let mut config = AxisConfig::new(1);
    change(&mut config);
    config
}

impl Direct {
    pub(crate) fn new() -> Self {
        let hardware = Shared::default();
        let axes = [0, 1, 2, 3].map(|axis| Axis::new(AxisPins(hardware.clone(), axis), TICK_HZ));
        let axes = Axes::new(Box::leak(Box::new(axes)), hardware.clone(), TICK_HZ);
        let node = Node::new(identity::<32, 4>(7, [1, 2, 3], TICK_HZ));
        Self { hardware, node, axes, number: 0, revision: 0, port: 0 }
    }

    /// Makes a node whose session is [`SESSION`] and whose first axes are configured.
    pub(crate) fn configured(axes: u8) -> Self {
        let mut direct = Self::new();
        assert_eq!(direct.ask(&Request::Adopt { dead_man_ms: 500 }), Answer::Adopted);
        (0..axes).for_each(|axis| direct.configure(axis, AxisConfig::new(0)));
        direct
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) -> Vec<Answer> {
        let now = self.now();
        let mut answers = Vec::new();
        for byte in bytes {
            let Some(frame) = self.node.on_byte_of(self.port, *byte, now, &mut self.axes) else { continue };
            let mut deframer = Deframer::new();
            let said =
                frame.bytes().iter().filter_map(|byte| deframer.push(*byte).map(|s| s.map(<[u8]>::to_vec)));
            let payload = said.last().unwrap().unwrap();
            let (header, rest) = AnswerHeader::split(&payload).unwrap();
            assert_eq!((header.received_at, header.session), (now, self.node.session()));
            answers.push(body(rest).unwrap());
        }
        answers
    }

    pub(crate) fn ask_as(&mut self, session: u64, request: &Request<'_>) -> Answer {
        self.number += 1;
        let frame = Encoded::request(RequestHeader { number: self.number, session }, request).unwrap();
        let answers = self.bytes(frame.bytes());
        let [answer] = answers[..] else { panic!("{answers:?}") };
        answer
    }

    pub(crate) fn ask(&mut self, request: &Request<'_>) -> Answer {
        self.ask_as(SESSION, request)
    }

    pub(crate) fn refused(&mut self, request: &Request<'_>) -> Refusal {
        match self.ask(request) {
            Answer::Refused(refusal) => refusal,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn configure(&mut self, axis: u8, config: AxisConfig) {
        self.revision += 1;
        let revision = self.revision;
        let motor = Motor::new(3_200.0, 17.8, 20.0);
        let brake = motor.brake(TickRate::from_hz(TICK_HZ).unwrap()).unwrap();
        let climb: Vec<_> = brake.climb().copied().collect();
        let mut config = config;
        config.brake_entries = climb.len() as u8;
        assert_eq!(
            self.ask(&Request::Configure { axis, revision, config }),
            Answer::Configured { brake_entries: 0 }
        );
        let mut first = 0;
        while first < climb.len() {
            let mut packed = [0; MAX_PACKED];
            let mut room = &mut packed[..];
            let mut codec = Codec::new(Grain::Exact);
            let written =
                climb[first..].iter().take_while(|entry| codec.write(entry, &mut room).is_ok()).count();
            let used = MAX_PACKED - room.len();
            let request = Request::Brake { axis, revision, first: first as u8, entries: &packed[..used] };
            first += written;
            assert_eq!(self.ask(&request), Answer::Configured { brake_entries: first as u8 });
        }
    }

    pub(crate) fn segments(
        &mut self,
        axis: u8,
        move_number: u32,
        first: u32,
        segments: &[Segment],
    ) -> Answer {
        let mut packed = [0; MAX_PACKED];
        let mut room = &mut packed[..];
        let (mut codec, mut rounder) = (Codec::new(Grain::Fine), Rounder::default());
        for segment in segments {
            codec.write(&rounder.round(*segment).unwrap(), &mut room).unwrap();
        }
        let used = MAX_PACKED - room.len();
        self.ask(&Request::Segments { axis, move_number, first, packed: &packed[..used] })
    }

    /// Prepares a move of some even segments and begins it. Returns the tick at which it begins.
    pub(crate) fn go(&mut self, axis: u8, move_number: u32, segments: u32) -> u64 {
        let from = self.status(axis).position;
        let order = order(from, from + 10 * i64::from(segments));
        let prepared = self.ask(&Request::Prepare { axis, move_number, order });
        assert_eq!(prepared, Answer::Accepted { next: 0, room: 32 });
        for first in 0..segments {
            assert!(matches!(self.segments(axis, move_number, first, &[EVEN]), Answer::Accepted { .. }));
        }
        let mut moves = [0; 4];
        moves[usize::from(axis)] = move_number;
        let at = self.now() + 5_000;
        assert_eq!(self.ask(&Request::Begin { at, moves }), Answer::Begun);
        at
    }

    pub(crate) fn status(&mut self, axis: u8) -> AxisStatus {
        self.axes.status(axis).unwrap()
    }

    pub(crate) fn now(&self) -> u64 {
        self.hardware.0.borrow().now
    }

    pub(crate) fn with<R>(&self, act: impl FnOnce(&mut Hardware) -> R) -> R {
        act(&mut self.hardware.0.borrow_mut())
    }

    /// Goes on to this tick: the timer fires when it is due, and the node is polled every ms.
    pub(crate) fn run_to(&mut self, tick: u64) {
        while self.now() < tick {
            let poll = (self.now() / 1000 + 1) * 1000;
            let next = self.axes.next_alarm().unwrap_or(u64::MAX).min(poll).min(tick);
            self.with(|hardware| hardware.now = next.max(hardware.now));
            while self.axes.next_alarm().is_some_and(|due| due <= self.now()) {
                let _ = self.axes.on_timer();
            }
            if self.now() >= poll {
                let now = self.now();
                self.node.poll(now, &mut self.axes);
            }
        }
    }

    /// Goes on for a while with a host that asks for the status.
    pub(crate) fn run_with_host(&mut self, ticks: u64) {
        let end = self.now() + ticks;
        while self.now() < end {
            let _ = self.ask(&Request::Status { axis: 0 });
            self.run_to(end.min(self.now() + 50_000));
        }
    }

    /// Returns the ticks at which the step pin of an axis rose.
    pub(crate) fn rises(&self, axis: usize) -> Vec<u64> {
        let rose =
            |(at, n, edge): &(u64, usize, Edge)| (*n == axis && *edge == Edge::Step(true)).then_some(*at);
        self.with(|hardware| hardware.edges.iter().filter_map(rose).collect())
    }
}
