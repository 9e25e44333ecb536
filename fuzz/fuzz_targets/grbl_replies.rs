//! Fuzzes the reader of a board's replies: no text panics, the division of the bytes makes no difference,
//! and numbers are finite.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pump_bench::drives::grbl_reply::{Replies, Reply};

fn read(pieces: &[&[u8]]) -> Vec<Reply> {
    let (mut reader, mut replies) = (Replies::default(), Vec::new());
    for piece in pieces {
        reader.feed(piece, &mut replies);
    }
    replies
}

fuzz_target!(|input: (u16, &[u8])| {
    let (cut, bytes) = input;
    let whole = read(&[bytes]);
    let (before, after) = bytes.split_at(usize::from(cut).min(bytes.len()));
    assert_eq!(whole, read(&[before, after]));
    for reply in whole {
        match reply {
            Reply::Setting { value, .. } => assert!(value.is_finite()),
            Reply::Probe { position, .. } => assert!(position.iter().all(|place| place.is_finite())),
            Reply::Status(status) => {
                let places = [status.machine, status.work, status.offset].into_iter().flatten().flatten();
                assert!(places.into_iter().all(|place| place.is_finite()));
            }
            _ => {}
        }
    }
});
