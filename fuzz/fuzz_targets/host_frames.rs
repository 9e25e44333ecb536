//! Any bytes to a host: raw, or as bodies of frames whose checksum fits.

#![no_main]

mod framing;

use libfuzzer_sys::fuzz_target;
use pump_ctl::step::Segment;
use pump_link::frame::{AnswerHeader, Deframer, body};
use pump_link::message::{Answer, Request};
use pump_link::packing::{Codec, Grain};
use pump_link::sender::{Bracket, Clocks, Stream, Window};

fuzz_target!(|data: &[u8]| {
    let mut deframer = Deframer::new();
    let mut window = Window::<4>::new(1);
    let mut stream = Stream::<16>::new(0);
    let mut clocks = Clocks::new(1_000_000);
    let mut bracket = Bracket::new(0, 1000, 5);
    let mut now_ns = 0_u64;
    let mut rest = data;
    while let [kind, len, others @ ..] = rest {
        let len = usize::from(*len).min(others.len()).min(220);
        let (bytes, others) = others.split_at(len);
        rest = others;
        now_ns += u64::from(*kind) * 1_000_000;
        let _ = stream.push(Segment { count: 3, interval: 500 + u64::from(*kind), add: 0, frac: 0 });
        let mut packed = [0; 30];
        if let Some(chunk) = stream.chunk(&mut packed) {
            let packed = &packed[..chunk.bytes];
            bracket.sent(chunk.end);
            let request = Request::Segments { axis: 0, move_number: 1, first: chunk.first, packed };
            let _ = window.request(&request, Some(0));
        }
        let _ = window.request(&Request::Status { axis: 0 }, None);
        while window.next_to_send(now_ns).is_some() {}
        let number = u16::from(*kind >> 3);
        let frame = match kind % 4 {
            0 => bytes.to_vec(),
            1 => framing::framed(*kind, number, 1, Some(now_ns / 1000), bytes),
            _ => framing::framed(1, number, 1, Some(now_ns / 1000), bytes),
        };
        for byte in frame {
            let Some(Ok(payload)) = deframer.push(byte) else { continue };
            let Ok((header, rest)) = AnswerHeader::split(payload) else { continue };
            let Ok(answer) = body::<Answer>(rest) else { continue };
            match answer {
                Answer::Accepted { next, room } if kind % 2 == 0 => {
                    let _ = stream.accepted(next, room);
                }
                Answer::Accepted { next, room } => {
                    let _ = stream.resume(next, room);
                }
                Answer::Refused(_) => window.gap(header.number),
                Answer::Status(status) => bracket.reported(status.position),
                _ => {}
            }
            if let Some(sent_ns) = window.answered(header.number).and_then(|answered| answered.sent_at_ns) {
                clocks.observe(sent_ns, now_ns, header.received_at);
            }
            if let Some(relation) = clocks.relation(now_ns) {
                let _ = (relation.tick_at(now_ns), relation.ns_at(header.received_at));
            }
            let (least, most) = bracket.range();
            assert!(least <= most);
        }
        if window.expire(now_ns).is_err() {
            window.clear();
        }
        for grain in [Grain::Fine, Grain::Exact] {
            let (mut codec, mut packed) = (Codec::new(grain), bytes);
            while let Ok(segment) = codec.read(&mut packed) {
                assert!(segment.is_valid());
                let mut again = [0; 64];
                Codec::new(grain)
                    .write(&segment, &mut &mut again[..])
                    .expect("a segment that was read can be written");
            }
        }
    }
});
