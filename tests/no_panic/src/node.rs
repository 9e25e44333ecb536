//! Both ends of the link, with bytes of which nothing is known.

use core::hint::black_box;

use pump_ctl::step::Segment;
use pump_link::frame::{AnswerHeader, Deframer, body};
use pump_link::message::{Answer, Request};
use pump_link::packing::{Codec, Grain};
use pump_link::sender::{Bracket, Clocks, Demand, Stream, Window};
use pump_node::{Axes, Axis, Board, Edge, Levels, Node, Pins, identity};

struct AnyPins;

impl Pins for AnyPins {
    fn make_outputs(&mut self, levels: Levels) {
        black_box(levels);
    }

    fn step_pin(&self) -> u32 {
        black_box(1)
    }

    fn set_direction(&mut self, high: bool) {
        black_box(high);
    }

    fn set_enable(&mut self, high: bool) {
        black_box(high);
    }

    fn index_is_high(&mut self) -> bool {
        black_box(true)
    }

    fn driver_fault_is_high(&mut self) -> bool {
        black_box(true)
    }
}

struct AnyBoard;

impl Board for AnyBoard {
    fn now(&mut self) -> u64 {
        black_box(0)
    }

    fn wait_until(&mut self, tick: u64) {
        black_box(tick);
    }

    fn set_steps(&mut self, edge: Edge) {
        black_box(edge);
    }

    fn estop_is_pressed(&mut self) -> bool {
        black_box(false)
    }
}

pub fn node() {
    let mut axes: [Axis<_, 256>; 4] = [0; 4].map(|_| Axis::new(AnyPins, black_box(1)));
    let mut axes = Axes::new(&mut axes, AnyBoard, black_box(1));
    let mut node = Node::new(identity::<256, 4>(black_box(1), black_box([1; 3]), black_box(1)));
    loop {
        let now = black_box(0);
        if let Some(answer) = node.on_byte(black_box(0), now, &mut axes) {
            black_box(answer.bytes());
        }
        node.poll(now, &mut axes);
        black_box((
            axes.on_timer(),
            axes.next_deadline(),
            axes.next_alarm(),
            axes.is_moving(),
            axes.status(black_box(1)),
            node.session(),
        ));
        if black_box(true) {
            break;
        }
    }
}

pub fn host() {
    let mut window = Window::<8>::new(black_box(1));
    let mut stream = Stream::<256>::new(black_box(1));
    let mut clocks = Clocks::new(black_box(1));
    let mut bracket = Bracket::new(black_box(1), black_box(1), black_box(1));
    let mut demand = Demand::<256>::new(black_box(1), black_box(1));
    let mut deframer = Deframer::new();
    let mut packed = [0; 200];
    loop {
        let segment =
            Segment { count: black_box(1), interval: black_box(1), add: black_box(1), frac: black_box(1) };
        let _ = black_box((stream.push(segment), demand.segment(&segment, black_box(1))));
        if let Some(chunk) = stream.chunk(&mut packed) {
            bracket.sent(chunk.end);
            let packed = packed.get(..chunk.bytes).unwrap_or_default();
            let request =
                Request::Segments { axis: black_box(1), move_number: 1, first: chunk.first, packed };
            let _ = black_box(window.request(&request, Some(0)));
        }
        let _ = black_box(window.expire(black_box(1)));
        black_box((window.next_to_send(black_box(1)), window.next_expiry_ns()));
        if let Some(Ok(payload)) = deframer.push(black_box(1))
            && let Ok((header, rest)) = AnswerHeader::split(payload)
        {
            if let Ok(Answer::Accepted { next, room }) = body(rest) {
                let _ = black_box((stream.accepted(next, room), stream.resume(next, room)));
            }
            window.gap(header.number);
            black_box(window.answered(header.number));
            clocks.observe(black_box(1), black_box(1), header.received_at);
            let mut entries = rest;
            let _ = black_box(Codec::new(Grain::Exact).read(&mut entries));
        }
        if let Some(relation) = clocks.relation(black_box(1)) {
            black_box((relation.tick_at(black_box(1)), relation.ns_at(black_box(1))));
        }
        bracket.reported(black_box(1));
        black_box(bracket.range());
        if black_box(true) {
            break;
        }
    }
}
