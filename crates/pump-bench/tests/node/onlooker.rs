//! An onlooker at the line, who reads how long the board's queues last.

use pump_link::frame::{Deframer, RequestHeader, body};
use pump_link::message::Request;
use pump_link::packing::{Codec, Grain};

/// Queue of an axis, by the segments of its last move that have arrived.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Queue {
    number: u32,
    /// Number of segments.
    segments: u32,
    /// Ticks after which they end.
    ticks: u64,
    /// Tick of the begin.
    begins: Option<u64>,
    /// Shortest time that the queue had left when further segments came, ticks.
    pub(crate) least: u64,
}

/// Onlooker at the line.
#[derive(Debug)]
pub(crate) struct Onlooker {
    deframer: Deframer,
    pub(crate) queues: [Queue; 4],
}

impl Default for Onlooker {
    fn default() -> Self {
        let queue = Queue { number: 0, segments: 0, ticks: 0, begins: None, least: u64::MAX };
        Self { deframer: Deframer::new(), queues: [queue; 4] }
    }
}

impl Onlooker {
    /// Sees a byte that reaches the board at tick `now`.
    pub(crate) fn sees(&mut self, byte: u8, now: u64) {
        let Some(Ok(payload)) = self.deframer.push(byte) else { return };
        let request = RequestHeader::split(payload).and_then(|(_, rest)| body::<Request<'_>>(rest));
        match request {
            Ok(Request::Prepare { axis, move_number, .. }) => {
                let queue = &mut self.queues[usize::from(axis)];
                if queue.number != move_number {
                    *queue = Queue { number: move_number, segments: 0, ticks: 0, begins: None, ..*queue };
                }
            }
            Ok(Request::Begin { at, moves }) => {
                for (queue, _) in self.queues.iter_mut().zip(moves).filter(|(_, number)| *number != 0) {
                    queue.begins = Some(at);
                }
            }
            Ok(Request::Segments { axis, first, packed, .. }) => {
                self.queues[usize::from(axis)].takes(first, packed, now);
            }
            _ => {}
        }
    }
}

impl Queue {
    fn takes(&mut self, first: u32, packed: &[u8], now: u64) {
        if let Some(begins) = self.begins.filter(|begins| *begins <= now && first == self.segments) {
            self.least = self.least.min((begins + self.ticks).saturating_sub(now));
        }
        let (mut codec, mut rest, mut number) = (Codec::new(Grain::Fine), packed, first);
        while !rest.is_empty() {
            let segment = codec.read(&mut rest).unwrap();
            if number == self.segments {
                self.ticks += segment.duration().whole;
                self.segments += 1;
            }
            number += 1;
        }
    }
}
