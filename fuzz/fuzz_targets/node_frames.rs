//! Any bytes to a node: raw, or as bodies of frames whose checksum fits. No pin is set before it is an output, and no
//! step is counted that had no edge.

#![no_main]

mod framing;

use std::cell::RefCell;
use std::rc::Rc;

use libfuzzer_sys::fuzz_target;
use pump_node::{Axes, Board, Levels, Node, Pins, identity};

#[derive(Default)]
struct Hardware {
    now: u64,
    estop: bool,
    outputs: [Option<Levels>; 2],
    count: [i64; 2],
}

#[derive(Clone)]
struct Shared(Rc<RefCell<Hardware>>);

impl Board for Shared {
    fn now(&mut self) -> u64 {
        self.0.borrow().now
    }

    fn wait_until(&mut self, tick: u64) {
        let now = &mut self.0.borrow_mut().now;
        *now = tick.max(*now);
    }

    fn wait_ns(&mut self, ns: u32) {
        self.0.borrow_mut().now += u64::from(ns) / 1000;
    }

    fn estop_is_pressed(&mut self) -> bool {
        self.0.borrow().estop
    }
}

struct AxisPins(Shared, usize);

impl AxisPins {
    fn change(&mut self, change: impl FnOnce(&mut Levels)) {
        let levels = &mut self.0.0.borrow_mut().outputs[self.1];
        change(levels.as_mut().expect("a pin that is an input was set"));
    }
}

impl Pins for AxisPins {
    fn make_outputs(&mut self, levels: Levels) {
        self.0.0.borrow_mut().outputs[self.1] = Some(levels);
    }

    fn set_step(&mut self, high: bool) {
        let before = self.0.0.borrow().outputs[self.1];
        self.change(|levels| levels.step = high);
        // The pin may be active high or low, so both edges of a pulse count.
        if before.is_some_and(|levels| levels.step != high) {
            self.0.0.borrow_mut().count[self.1] += 1;
        }
    }

    fn set_direction(&mut self, high: bool) {
        self.change(|levels| levels.direction = high);
    }

    fn set_enable(&mut self, high: bool) {
        self.change(|levels| levels.enable = high);
    }

    fn index_is_high(&mut self) -> bool {
        self.0.0.borrow().now % 3 == 0
    }

    fn driver_fault_is_high(&mut self) -> bool {
        self.0.0.borrow().now % 7 != 0
    }
}

fuzz_target!(|data: &[u8]| {
    let hardware = Shared(Rc::new(RefCell::new(Hardware::default())));
    let pins = [0, 1].map(|axis| AxisPins(hardware.clone(), axis));
    let mut axes: Axes<_, _, 8, 2> = Axes::new(pins, hardware.clone(), 1_000_000);
    let mut node = Node::new(identity::<8, 2>(1, [0, 1, 0], 1_000_000));
    let mut rest = data;
    let mut number = 0;
    let mut positions = [0; 2];
    while let [kind, len, others @ ..] = rest {
        let len = usize::from(*len).min(others.len()).min(220);
        let (body, others) = others.split_at(len);
        rest = others;
        number += 1;
        let session = u64::from(kind & 1) + 1;
        let bytes = match kind % 8 {
            0 => body.to_vec(),
            1 => framing::framed(*kind, number, session, None, body),
            _ => framing::framed(1, number, session, None, body),
        };
        let now = hardware.0.borrow().now;
        for byte in bytes {
            let _ = node.on_byte(byte, now, &mut axes);
        }
        hardware.0.borrow_mut().estop = *kind == 255;
        // Up to 20 steps, each at its time or late.
        for _ in 0..20 {
            let Some(due) = axes.next_alarm() else { break };
            let now = due.max(hardware.0.borrow().now) + u64::from(kind >> 6) * 50;
            if now > 1 << 40 {
                return;
            }
            hardware.0.borrow_mut().now = now;
            let _ = axes.on_timer();
        }
        hardware.0.borrow_mut().now += u64::from(*kind) * 100;
        let now = hardware.0.borrow().now;
        node.poll(now, &mut axes);
        for (axis, before) in positions.iter_mut().enumerate() {
            let position = axes.status(axis as u8).unwrap().position;
            let edges = core::mem::take(&mut hardware.0.borrow_mut().count[axis]);
            // A pulse has two edges; one may be open, or put to rest by a new configuration.
            assert!(
                position.abs_diff(*before) <= edges.unsigned_abs(),
                "{position} after {before}: {edges} edges"
            );
            *before = position;
        }
    }
});
