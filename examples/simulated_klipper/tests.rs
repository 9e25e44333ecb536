//! The board at its pseudo-terminal, in real time.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::time::Duration;

use crate::simulated_klipper::{Character, SimulatedKlipper};

/// Port of a host.
struct Port(File);

impl Port {
    fn open(board: &SimulatedKlipper) -> Self {
        Self(OpenOptions::new().read(true).write(true).open(board.path()).unwrap())
    }

    /// Reads until `enough` says so.
    fn read(&mut self, enough: impl Fn(&[u8]) -> bool) -> Vec<u8> {
        let mut heard = Vec::new();
        while !enough(&heard) {
            let mut bytes = [0; 256];
            let count = self.0.read(&mut bytes).unwrap();
            heard.extend(&bytes[..count]);
        }
        heard
    }
}

/// `identify` with offset 0 and 40 bytes, in the block with sequence number 0. Its checksum is from another program,
/// which shifts the mirrored bits the other way.
const IDENTIFY: [u8; 8] = [8, 0x10, 1, 0, 40, 0x5e, 0x9f, 0x7e];

#[test]
fn a_host_asks_and_the_board_answers_and_acknowledges() {
    let board = SimulatedKlipper::start_as(Character::default()).unwrap();
    let mut port = Port::open(&board);
    port.0.write_all(&IDENTIFY).unwrap();
    // The response, whose content begins with its number, offset and length, and a block without content.
    let is_whole = |heard: &[u8]| heard.windows(2).any(|pair| pair == [5, 0x11]);
    let heard = port.read(is_whole);
    assert!(heard.windows(5).any(|bytes| bytes == [48, 0x11, 0, 0, 40]), "{heard:02x?}");
}

#[test]
fn a_clock_that_jumps_a_pulled_cable_and_a_reset_are_at_hand() {
    let board = SimulatedKlipper::start_as(Character::default()).unwrap();
    board.touch("jump 720000000000").unwrap();
    std::thread::sleep(Duration::from_millis(20));
    assert!(board.truth().now > 720_000_000_000);
    board.touch("reset").unwrap();
    std::thread::sleep(Duration::from_millis(20));
    assert!(board.truth().now < 72_000_000_000);
    board.touch("fault X ot").unwrap();
    assert!(board.touch("fault E ot").unwrap_err().contains("no driver"));
    assert!(board.touch("dance").is_err());
    board.touch("pull").unwrap();
    let mut port = Port::open(&board);
    port.0.write_all(&IDENTIFY).unwrap();
    std::thread::sleep(Duration::from_millis(50));
    board.touch("plug").unwrap();
    port.0.write_all(&IDENTIFY).unwrap();
    assert!(port.read(|heard| !heard.is_empty()).len() > 4);
    assert!(!board.truth().configured && !board.truth().moving);
}

#[test]
fn noise_is_on_the_line_both_ways() {
    let mut character = Character { baud: 0, ..Character::default() };
    character.noise.lost = 1.0;
    let board = SimulatedKlipper::start_as(character).unwrap();
    let mut port = Port::open(&board);
    port.0.write_all(&IDENTIFY).unwrap();
    std::thread::sleep(Duration::from_millis(50));
    drop(board);
    // The other end is closed, and nothing has come.
    let mut bytes = [0; 16];
    assert!(matches!(port.0.read(&mut bytes), Ok(0) | Err(_)));
}
