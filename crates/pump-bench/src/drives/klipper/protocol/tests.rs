//! The examples of the documentation byte for byte, and blocks on a bad line.

use std::sync::Arc;

use super::block::{Block, BlockReader, CONTENT_MOST, SYNC, block};
use super::error::MessageError;
use super::format::Format;
use super::message::Value;

/// Checksum of a block bit by bit, for a second opinion: polynomial x^16 + x^12 + x^5 + 1, low bit first, from 0xffff.
fn checksum(bytes: &[u8]) -> [u8; 2] {
    let bits = bytes.iter().flat_map(|byte| (0..8).map(move |bit| u16::from(byte >> bit & 1)));
    let divide = |sum: u16, bit: u16| (sum >> 1) ^ if (sum ^ bit) & 1 == 1 { 0x8408 } else { 0 };
    bits.fold(0xffff, divide).to_be_bytes()
}

/// Block of `docs/Protocol.md`: length, sequence, content, checksum, 0x7e.
fn documented(sequence: u8, content: &[u8]) -> Vec<u8> {
    let head = [&[content.len() as u8 + 5, 0x10 + sequence], content].concat();
    [&head[..], &checksum(&head), &[0x7e]].concat()
}

fn encoded(id: i32, string: &str, values: &[i64]) -> Vec<u8> {
    let values: Vec<_> = values.iter().map(|value| Value::Number(*value)).collect();
    Format::new(id, string).unwrap().encode(&values).unwrap()
}

/// Bytes, as the blocks that a reader finds in them.
fn read(bytes: &[u8], piece: usize) -> (Vec<Block>, BlockReader) {
    let mut reader = BlockReader::default();
    let mut blocks = Vec::new();
    for bytes in bytes.chunks(piece) {
        reader.push(bytes);
        blocks.extend(std::iter::from_fn(|| reader.next()));
    }
    (blocks, reader)
}

fn of(sequence: u8, content: &[u8]) -> Block {
    Block { sequence, content: content.to_vec() }
}

/// `docs/Protocol.md`, "Message Block Contents": four commands become eight numbers of one block.
#[test]
fn four_commands_of_the_documentation_are_eight_numbers_of_one_block() {
    let (update, config, clock) = (20, 21, 22);
    let format = "update_digital_out oid=%c value=%c";
    let content = [
        encoded(update, format, &[6, 1]),
        encoded(update, format, &[5, 0]),
        encoded(config, "get_config", &[]),
        encoded(clock, "get_clock", &[]),
    ]
    .concat();
    assert_eq!(content, [20, 6, 1, 20, 5, 0, 21, 22]);
    let bytes = block(9, &content);
    assert_eq!(bytes, documented(9, &[20, 6, 1, 20, 5, 0, 21, 22]));
    assert_eq!(read(&bytes, 64).0, [of(9, &content)]);
}

/// `docs/Protocol.md`, the example at the top. The numbers as bytes are worked by hand.
#[test]
fn the_commands_at_the_top_of_the_documentation_have_the_bytes_of_its_rules() {
    let schedule = "schedule_digital_out oid=%c clock=%u value=%c";
    assert_eq!(encoded(3, schedule, &[8, 4_000_000, 0]), [3, 8, 0x81, 0xf4, 0x92, 0x00, 0]);
    let step = "queue_step oid=%c interval=%u count=%hu add=%hi";
    assert_eq!(encoded(4, step, &[7, 7458, 10, 331]), [4, 7, 0xba, 0x22, 10, 0x82, 0x4b]);
    assert_eq!(encoded(4, step, &[7, 11717, 4, 1281]), [4, 7, 0xdb, 0x45, 4, 0x8a, 0x01]);
    assert_eq!(encoded(4, step, &[7, 11717, 4, -33]), [4, 7, 0xdb, 0x45, 4, 0xff, 0x5f]);
    assert_eq!(encoded(5, "set_digital_out pin=%u value=%c", &[86, 1]), [5, 86, 1]);
}

/// `docs/Protocol.md`, "Data Dictionary": the numbers of identify and of its answer are fixed.
#[test]
fn the_first_exchange_has_the_bytes_of_the_documentation() {
    let identify = encoded(1, "identify offset=%u count=%c", &[0, 40]);
    assert_eq!(block(1, &identify), [0x08, 0x11, 0x01, 0x00, 0x28, 0x42, 0x24, 0x7e]);
    let answer = documented(2, &[0, 0, 3, b'a', SYNC, b'c']);
    let (blocks, _) = read(&answer, 1);
    let mut content = blocks[0].content.as_slice();
    assert_eq!((blocks.len(), Format::take_id(&mut content).unwrap()), (1, 0));
    let format = Arc::new(Format::new(0, "identify_response offset=%u data=%.*s").unwrap());
    let message = format.take(&mut content).unwrap();
    assert_eq!((message.name(), message.unsigned("offset").unwrap()), ("identify_response", 0));
    assert_eq!(message.bytes("data").unwrap(), b"a~c");
    assert_eq!(message.text(), "identify_response offset=0 data=a~c");
    assert!(content.is_empty());
    let error = message.number("clock").unwrap_err().to_string();
    assert_eq!(
        error,
        "the board's message `identify_response` has no number `clock`; load its firmware anew"
    );
}

/// `docs/Protocol.md`, "Message flow": an acknowledgement is a block of 5 bytes.
#[test]
fn an_acknowledgement_has_five_bytes() {
    assert_eq!(block(0, &[]), [0x05, 0x10, 0x9e, 0x81, 0x7e]);
    assert_eq!(block(17, &[]), [0x05, 0x11, 0x8f, 0x08, 0x7e]);
    assert_eq!(block(15, &[]), documented(15, &[]));
}

/// `docs/Protocol.md`, "Output responses".
#[test]
fn an_output_for_people_is_worded() {
    let format = Format::output(7, "The value of %u is %s with size %u, 100%%.").unwrap();
    let message = Arc::new(format).take(&mut &[5, 2, b'h', b'i', 2][..]).unwrap();
    assert_eq!(message.text(), "The value of 5 is hi with size 2, 100%.");
    assert_eq!(Format::output(7, "a %x"), None);
}

#[test]
fn signs_of_a_message_follow_its_format() {
    let position = Arc::new(Format::new(9, "stepper_position oid=%c pos=%i").unwrap());
    let message = position.take(&mut &[3, 0x7f][..]).unwrap();
    assert_eq!(message.number("pos"), Ok(-1));
    let clock = Arc::new(Format::new(9, "clock clock=%u").unwrap());
    assert_eq!(clock.take(&mut &[0x7f][..]).unwrap().number("clock"), Ok(i64::from(u32::MAX)));
}

#[test]
fn a_command_refuses_values_that_do_not_fit() {
    let step = Format::new(4, "queue_step oid=%c interval=%u count=%hu add=%hi").unwrap();
    let with = |values: [i64; 4]| step.encode(&values.map(Value::Number)).unwrap_err().to_string();
    assert_eq!(with([256, 1, 1, 1]), "`queue_step` takes 0 to 255 as `oid`, and 256 was given");
    assert_eq!(with([1, -1, 1, 1]), "`queue_step` takes 0 to 4294967295 as `interval`, and -1 was given");
    assert_eq!(with([1, 1, 65536, 1]), "`queue_step` takes 0 to 65535 as `count`, and 65536 was given");
    assert_eq!(with([1, 1, 1, -32769]), "`queue_step` takes -32768 to 32767 as `add`, and -32769 was given");
    let few = step.encode(&[Value::from(1_u8)]).unwrap_err();
    assert_eq!(few, MessageError::Values { format: step.string().to_owned(), given: 1 });
    let send = Format::new(5, "spi_send oid=%c data=%*s").unwrap();
    assert!(send.encode(&[1_u8.into(), 2_u8.into()]).is_err());
    let long = send.encode(&[1_u8.into(), Value::from(&[0; 57][..])]).unwrap_err();
    assert_eq!(long.to_string(), "`spi_send` has 60 bytes, and a block takes 59 at most");
    assert_eq!(send.encode(&[1_u8.into(), Value::from(&[0; 56][..])]).unwrap().len(), CONTENT_MOST);
}

#[test]
fn a_string_that_is_no_format_is_refused() {
    for string in ["", "a b", "a b=%x", "a b=%hc", "a =%", "a b=%u c"] {
        assert_eq!(Format::new(1, string), None, "{string}");
    }
}

#[test]
fn a_message_that_is_cut_off_is_an_error_and_no_panic() {
    let format = Arc::new(Format::new(0, "identify_response offset=%u data=%.*s").unwrap());
    for cut in [&[][..], &[0x80], &[0], &[0, 3, 1, 2], &[0, 0x8f, 0xff, 0xff, 0xff, 0x7f]] {
        assert_eq!(format.take(&mut { cut }), Err(MessageError::CutOff), "{cut:?}");
    }
}

#[test]
fn blocks_come_whole_however_the_line_tears_them() {
    let contents: Vec<Vec<u8>> = (0..20).map(|n| vec![SYNC.wrapping_add(n); usize::from(n) * 3]).collect();
    let bytes: Vec<u8> = (0..).zip(&contents).flat_map(|(n, content)| block(n, content)).collect();
    for piece in [1, 2, 3, 5, 7, 63, 64, 65, 5000] {
        let (blocks, reader) = read(&bytes, piece);
        let sent = (0..).zip(&contents).map(|(n, content)| of(n & 15, content));
        assert!(blocks.into_iter().eq(sent), "{piece}");
        assert_eq!((reader.skipped(), reader.corrupt()), (0, 0));
    }
}

#[test]
fn a_doubled_block_and_a_leading_end_mark_are_read() {
    let one = block(3, b"one");
    let (blocks, reader) = read(&[&[SYNC, SYNC], &one[..], &[SYNC], &one].concat(), 4);
    assert_eq!(blocks, [of(3, b"one"), of(3, b"one")]);
    assert_eq!(reader.skipped(), 0);
}

#[test]
fn a_block_after_garbage_is_read() {
    let good = block(5, b"good");
    let boot = b"\r\nGrbl 1.1h ['$' for help]\r\nok\r\n";
    for garbage in [&boot[..], &[0xff; 300], &[0; 7], &[SYNC; 9], &[0x7d; 64], &[0x40; 3], &[0x20; 70]] {
        let (blocks, _) = read(&[garbage, &good[..]].concat(), 11);
        assert_eq!(blocks, [of(5, b"good")], "{garbage:?}");
    }
    // A header that promises 64 bytes holds the reader until they have come.
    let (blocks, reader) = read(&[&[64, 0x10][..], &good.repeat(7)].concat(), 11);
    assert_eq!(blocks.len(), 7);
    assert_eq!(reader.skipped(), 2);
}

#[test]
fn each_flipped_bit_and_each_lost_byte_costs_its_block_alone() {
    let (bad, good) = (block(1, b"first\x7eblock"), block(2, b"second"));
    for at in 0..bad.len() {
        for bit in 0..8 {
            let mut bytes = [&bad[..], &good.repeat(9)].concat();
            bytes[at] ^= 1 << bit;
            let (blocks, _) = read(&bytes, 16);
            assert_eq!(blocks.len(), 9, "{at} {bit}");
            assert!(blocks.iter().all(|block| *block == of(2, b"second")), "{at} {bit}");
        }
        let mut bytes = [&bad[..], &good.repeat(9)].concat();
        bytes.remove(at);
        let (blocks, _) = read(&bytes, 16);
        assert!(blocks.iter().all(|block| *block == of(2, b"second")), "{at}");
        assert_eq!(blocks.len(), 9, "{at}");
    }
}

#[test]
fn no_bytes_make_a_reader_keep_more_than_a_block_or_panic() {
    let mut state = 1_u64;
    let mut reader = BlockReader::default();
    for _ in 0..20_000 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let byte = (state >> 33) as u8;
        // Half of the bytes are such that a header is found often.
        reader.push(&[if state >> 63 == 1 { byte } else { 0x10 | byte & 0x2f }]);
        while reader.next().is_some() {}
        assert!(reader.waiting() < 64);
    }
}
