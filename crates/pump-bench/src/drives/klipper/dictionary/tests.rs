//! Dictionaries as boards send them, and as no board should.

use miniz_oxide::deflate::compress_to_vec_zlib;
use serde_json::{Value as Json, json};

use super::dictionary::Dictionary;
use super::download::Download;
use super::error::DictionaryError;
use crate::drives::klipper::protocol::Value;

/// Dictionary of `samples/board.json`, compressed by zlib itself at level 9.
const BOARD: &[u8] = include_bytes!("samples/board.zlib");

fn board() -> Dictionary {
    Dictionary::of_compressed(BOARD).unwrap()
}

fn of(document: &Json) -> Result<Dictionary, DictionaryError> {
    Dictionary::of_compressed(&compress_to_vec_zlib(document.to_string().as_bytes(), 9))
}

/// Least dictionary, with `entries` in place of the object of `key`.
fn with(key: &str, entries: &Json) -> Json {
    let mut document = json!({ "commands": {}, "responses": {} });
    document[key] = entries.clone();
    document
}

/// Downloads `bytes` in pieces, the board's answers being doubled and one answer being late.
fn download(bytes: &[u8]) -> Result<Dictionary, DictionaryError> {
    let mut download = Download::default();
    let mut before = (0_u32, Vec::new());
    loop {
        let (place, count) = download.wanted();
        assert_eq!(count, 40);
        let start = bytes.len().min(place as usize);
        let piece = bytes[start..bytes.len().min(start + usize::from(count))].to_vec();
        assert!(before.1.is_empty() || download.take(before.0, &before.1)?.is_none());
        if let Some(dictionary) = download.take(place, &piece)? {
            return Ok(dictionary);
        }
        before = (place, piece);
    }
}

#[test]
fn a_dictionary_of_zlib_comes_in_pieces_of_40_bytes() {
    let dictionary = download(BOARD).unwrap();
    assert_eq!(dictionary, board());
    assert_eq!((dictionary.app(), dictionary.version()), (Some("Klipper"), "sample-1"));
    let ours = compress_to_vec_zlib(include_bytes!("samples/board.json"), 9);
    assert_eq!(download(&ours).unwrap(), dictionary);
}

#[test]
fn commands_are_found_by_name_and_parameters() {
    let board = board();
    let step = board.command("queue_step oid=%c interval=%u count=%hu add=%hi").unwrap();
    let bytes = step.encode(&[1_u8, 2, 3, 4].map(Value::from)).unwrap();
    assert_eq!(bytes[1..], [1, 2, 3, 4]);
    // The size of a number differs between versions, and says nothing of its bytes.
    assert!(board.command("queue_step oid=%u interval=%u count=%u add=%i").is_ok());
    assert!(board.has_command("reset") && !board.has_command("sing"));
    let error = board.command("config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c").unwrap_err();
    assert_eq!(
        error.to_string(),
        "the board's firmware (sample-1) has `config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c \
         step_pulse_ticks=%u`, and this program knows it as `config_stepper oid=%c step_pin=%c dir_pin=%c \
         invert_step=%c`; load firmware of another version"
    );
    assert!(matches!(board.command("spi_send oid=%c data=%u"), Err(DictionaryError::Differs { .. })));
    let error = board.command("sing song=%u").unwrap_err().to_string();
    let lacks = "the board's firmware (sample-1) lacks the command `sing song=%u`; load firmware that has it";
    assert_eq!(error, lacks);
    let error = board.response("song volume=%c").unwrap_err();
    assert!(matches!(error, DictionaryError::Lacks { entry: "message", .. }), "{error}");
}

#[test]
fn messages_are_read_by_number() {
    let board = board();
    let position = board.response("stepper_position oid=%c pos=%i").unwrap();
    let clock = board.response("clock clock=%u").unwrap();
    let content = [position.encode(&[3_u8.into(), (-7).into()]), clock.encode(&[5_u8.into()])];
    let content: Vec<u8> = content.into_iter().flat_map(Result::unwrap).collect();
    let messages = board.read(&content).unwrap();
    assert_eq!((messages[0].name(), messages[0].number("pos")), ("stepper_position", Ok(-7)));
    assert_eq!((messages[1].name(), messages[1].unsigned("clock")), ("clock", Ok(5)));
    assert_eq!(messages.len(), 2);
    // An output has the number 127.
    let output = board.read(&[0x80, 0x7f, 0x7d]).unwrap();
    assert_eq!((output[0].name(), output[0].text().as_str()), ("", "timer -3 late"));
    let error = board.read(&[94]).unwrap_err().to_string();
    assert_eq!(error, "the board sent message 94, which its dictionary lacks; load its firmware anew");
    // The board reads commands, and sends none.
    assert!(board.read(&[2]).is_err());
}

#[test]
fn pins_are_found_by_name() {
    let board = board();
    for (name, number) in
        [("PA0", 0), ("PA15", 15), ("PB0", 16), ("PC13", 45), ("PC15", 47), ("ADC_TEMPERATURE", 254)]
    {
        assert_eq!(board.pin(name), Ok(number), "{name}");
    }
    for name in ["PA16", "PC12", "PC0", "PA", "PA01", "", "pa0", "PA4294967296", "ADC_TEMPERATURE0"] {
        assert!(matches!(board.pin(name), Err(DictionaryError::Pin { .. })), "{name}");
    }
    let error = board.pin("PD1").unwrap_err().to_string();
    let pins = "ADC_TEMPERATURE, PA0 to PA15, PB0 to PB15, PC13 to PC15";
    assert_eq!(error, format!("the board (stm32g0b1xx) has no pin `PD1`; its pins are {pins}"));
    let error = board.pin("PA10").unwrap_err().to_string();
    assert_eq!(error, "the board's firmware uses the pin `PA10` as serial; name another pin");
    let error = board.pin("PA12").unwrap_err().to_string();
    assert_eq!(error, "the board's firmware uses the pin `PA12` as USB; name another pin");
    assert_eq!(board.choice("spi_bus", "spi2"), Ok(1));
    let error = board.choice("spi_bus", "spi3").unwrap_err().to_string();
    assert_eq!(error, "the board has no spi_bus `spi3`; it has spi1, spi2");
}

#[test]
fn constants_are_numbers_even_as_text_and_have_a_range() {
    let board = board();
    assert_eq!(board.constant("CLOCK_FREQ", 1_000_000..=1_000_000_000), Ok(64_000_000));
    assert_eq!(board.constant("SERIAL_BAUD", 1..=u32::MAX), Ok(250_000));
    assert_eq!(board.constant_text("MCU").as_deref(), Some("stm32g0b1xx"));
    let error = board.constant("CLOCK_FREQ", 1..=1000).unwrap_err().to_string();
    let allowed =
        "the board's firmware says CLOCK_FREQ = 64000000, and it must be 1 to 1000; load its firmware anew";
    assert_eq!(error, allowed);
    for name in ["MCU", "ADC_MAX"] {
        let error = board.constant(name, 0..=u32::MAX).unwrap_err();
        assert!(matches!(error, DictionaryError::Constant { .. }), "{error}");
    }
    let error = board.constant("STEP_RATE", 0..=u32::MAX).unwrap_err();
    assert!(matches!(error, DictionaryError::Lacks { entry: "constant", .. }), "{error}");
}

#[test]
fn reasons_are_text() {
    assert_eq!(board().firmware_text(2), "Timer too close");
    assert_eq!(board().firmware_text(99), "reason 99, which its dictionary does not word");
}

#[test]
fn a_dictionary_that_is_cut_off_anywhere_is_refused() {
    for bytes in 0..BOARD.len() {
        let error = download(&BOARD[..bytes]).unwrap_err();
        assert_eq!(error, DictionaryError::Damaged { bytes }, "{error}");
    }
}

#[test]
fn no_flipped_bit_changes_a_dictionary_that_is_taken() {
    let (board, mut taken) = (board(), 0);
    for at in 0..8 * BOARD.len() {
        let mut bytes = BOARD.to_vec();
        bytes[at / 8] ^= 1 << (at % 8);
        if let Ok(read) = Dictionary::of_compressed(&bytes) {
            assert_eq!(read, board, "bit {at}");
            taken += 1;
        }
    }
    // A few bits name the window, or fill up the last byte before the checksum.
    assert!(taken < 16, "{taken}");
}

#[test]
fn a_huge_dictionary_is_refused_before_it_takes_the_memory() {
    let bomb = compress_to_vec_zlib(&vec![b' '; 40 << 20], 9);
    assert!(bomb.len() < 1 << 16, "{} bytes", bomb.len());
    let error = download(&bomb).unwrap_err().to_string();
    assert_eq!(
        error,
        "the board's dictionary has more than 1048576 uncompressed bytes; load its firmware anew"
    );
    let error = download(&vec![7; 1 << 20]).unwrap_err().to_string();
    assert_eq!(error, "the board's dictionary has more than 65536 compressed bytes; load its firmware anew");
}

#[test]
fn a_dictionary_of_wrong_form_is_refused() {
    let unreadable = |text: &str| {
        let error = Dictionary::of_compressed(&compress_to_vec_zlib(text.as_bytes(), 9)).unwrap_err();
        assert!(matches!(error, DictionaryError::Unreadable { .. }), "{text}: {error}");
    };
    for text in
        ["", "ok", "[]", "{}", "null", "{\"commands\":{}}", "{\"commands\":[],\"responses\":{}}", "\u{fffd}"]
    {
        unreadable(text);
    }
    unreadable(&"[".repeat(100_000));
    unreadable(&with("commands", &json!({ "get_clock": "1" })).to_string());
    unreadable(&with("commands", &json!({ "get_clock": 1e99 })).to_string());
    unreadable(&with("commands", &json!({ "get_clock": 4_294_967_296_u64 })).to_string());
    unreadable(&with("enumerations", &json!({ "pin": 3 })).to_string());
    unreadable(&with("config", &json!([1])).to_string());
    unreadable(&with("version", &json!(1)).to_string());
    for (key, entries) in [
        ("commands", json!({ "get_clock clock=%q": 1 })),
        ("commands", json!({ "": 1 })),
        ("responses", json!({ "clock clock": 1 })),
        ("output", json!({ "%y": 1 })),
        ("config", json!({ "MCU": ["a"] })),
        ("enumerations", json!({ "pin": { "PA0": -1 } })),
        ("enumerations", json!({ "pin": { "PA0": [0] } })),
        ("enumerations", json!({ "pin": { "PA0": [1, 4_294_967_295_u32] } })),
        ("enumerations", json!({ "pin": { "PA0": "0" } })),
    ] {
        let error = of(&with(key, &entries)).unwrap_err();
        assert!(matches!(error, DictionaryError::Entry { .. }), "{entries}: {error}");
    }
    let twice = json!({ "clock clock=%u": 1, "clock time=%u": 2 });
    let error = of(&with("responses", &twice)).unwrap_err().to_string();
    assert_eq!(error, "the board's dictionary has the name `clock` twice; load its firmware anew");
    let twice = json!({ "clock clock=%u": 1, "uptime time=%u": 1 });
    let error = of(&with("responses", &twice)).unwrap_err().to_string();
    assert_eq!(error, "the board's dictionary has the number `1` twice; load its firmware anew");
}

#[test]
fn a_run_of_four_billion_pins_takes_no_memory() {
    let pins = json!({ "pin": { "P0": [0, 4_294_967_295_u32], "Q4294967295": [0, 9] } });
    let dictionary = of(&with("enumerations", &pins)).unwrap();
    assert_eq!(dictionary.pin("P4294967294"), Ok(4_294_967_294));
    assert!(dictionary.pin("P4294967295").is_err());
    assert_eq!(dictionary.pin("Q4294967295"), Ok(0));
}

#[test]
fn no_names_are_listed_without_end() {
    let pins: serde_json::Map<_, _> = (0..100).map(|pin| (format!("P{pin:02}"), json!(pin))).collect();
    let dictionary = of(&with("enumerations", &json!({ "pin": pins }))).unwrap();
    let error = dictionary.pin("Q").unwrap_err().to_string();
    let list = "P00, P01, P02, P03, P04, P05, P06, P07 and 92 more";
    assert_eq!(error, format!("the board (of an unknown kind) has no pin `Q`; its pins are {list}"));
}
