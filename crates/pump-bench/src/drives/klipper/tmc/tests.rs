//! A driver over a line, against a chip that is written here from the datasheet.

use std::collections::BTreeMap;

use super::*;

/// Returns bits of the wire, earliest first, as text: `0` and `1`.
fn wire(packed: &[u8]) -> String {
    packed.iter().map(|byte| format!("{byte:08b}").chars().rev().collect::<String>()).collect()
}

/// Returns the bytes between the start and stop bits of a wire's text.
fn bytes_of(wire: &str) -> Vec<u8> {
    let frames: Vec<&str> = (0..wire.len() / 10).map(|n| &wire[10 * n..10 * n + 10]).collect();
    frames
        .into_iter()
        .map(|frame| {
            assert!(frame.starts_with('0') && frame.ends_with('1'), "{frame}");
            let data: String = frame[1..9].chars().rev().collect();
            u8::from_str_radix(&data, 2).unwrap()
        })
        .collect()
}

/// Returns the remainder of the bits, from the lowest of each byte, by x^8 + x^2 + x + 1: a division on paper.
fn remainder(bytes: &[u8]) -> u8 {
    let mut bits: Vec<u8> = bytes.iter().flat_map(|byte| (0..8).map(move |n| byte >> n & 1)).collect();
    bits.extend([0; 8]);
    for at in 0..bits.len() - 8 {
        if bits[at] == 1 {
            for (place, factor) in [1, 0, 0, 0, 0, 0, 1, 1, 1].into_iter().enumerate() {
                bits[at + place] ^= factor;
            }
        }
    }
    bits[bits.len() - 8..].iter().fold(0, |sum, bit| sum << 1 | bit)
}

/// Defect of the chip or its wire.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Defect {
    /// The first so many requests are lost.
    Lost(u32),
    /// A bit of the first so many answers is wrong.
    Damaged(u32),
    /// Writes are not taken.
    Deaf,
    /// The chip is reset by the write of this register.
    ResetBy(u8),
    /// This register keeps another value.
    Forgets(u8),
    /// The chip is a TMC2208.
    OtherChip,
}

/// Chip at an address of a wire.
struct Chip {
    address: u8,
    registers: BTreeMap<u8, u32>,
    /// Writes that the chip took, in their order.
    written: Vec<(u8, u32)>,
    defect: Option<Defect>,
    requests: u32,
}

impl Chip {
    fn new(defect: Option<Defect>) -> Self {
        let version = if defect == Some(Defect::OtherChip) { 0x2000_0000 } else { 0x2100_0000 };
        // IOIN; GSTAT after power-up; IFCNT.
        let registers = BTreeMap::from([(0x06, version), (0x01, 1), (0x02, 100)]);
        Self { address: 2, registers, written: Vec::new(), defect, requests: 0 }
    }

    fn set(&mut self, register: u8, value: u32) {
        self.written.push((register, value));
        let kept = match (register, self.defect) {
            (0x01, _) => self.registers.get(&0x01).copied().unwrap_or(0) & !value,
            (_, Some(Defect::Forgets(forgotten))) if forgotten == register => value ^ 1,
            _ => value,
        };
        self.registers.insert(register, kept);
        let count = self.registers.entry(0x02).or_default();
        *count = (*count + 1) % 256;
        if self.defect == Some(Defect::ResetBy(register)) {
            self.registers.extend([(0x02, 0), (0x01, 1)]);
        }
    }
}

impl TmcLine for Chip {
    type Error = TmcError;

    fn exchange(&mut self, bits: &[u8], answer: usize) -> Result<Vec<u8>, TmcError> {
        // Datasheet, chapter 4.1: 4 bytes ask, 8 bytes write and are told by bit 7 of the register.
        let bytes = bytes_of(&wire(bits));
        let (sum, inner) = bytes.split_last().unwrap();
        assert_eq!(*sum, remainder(inner), "{bytes:02x?}");
        assert_eq!(inner[0] & 0x0f, 0x05);
        self.requests += 1;
        let is_lost = matches!(self.defect, Some(Defect::Lost(lost)) if self.requests <= lost);
        if inner[1] != self.address || is_lost {
            return Ok(Vec::new());
        }
        match inner[3..] {
            [] => assert_eq!((inner[2] & 0x80, answer), (0, 10)),
            [a, b, c, d] => {
                assert_eq!((inner[2] & 0x80, answer), (0x80, 0));
                if self.defect != Some(Defect::Deaf) {
                    self.set(inner[2] & 0x7f, u32::from_be_bytes([a, b, c, d]));
                }
                return Ok(Vec::new());
            }
            _ => panic!("{bytes:02x?}"),
        }
        let mut reply = vec![0x05, 0xff, inner[2]];
        reply.extend(self.registers.get(&inner[2]).copied().unwrap_or(0).to_be_bytes());
        reply.push(remainder(&reply));
        let wire: String = reply.iter().map(|byte| format!("0{}1", wire(&[*byte]))).collect();
        let mut packed: Vec<u8> = (0..10)
            .map(|n| {
                let bits: String = wire[8 * n..8 * n + 8].chars().rev().collect();
                u8::from_str_radix(&bits, 2).unwrap()
            })
            .collect();
        if matches!(self.defect, Some(Defect::Damaged(damaged)) if self.requests <= damaged) {
            packed[5] ^= 4;
        }
        Ok(packed)
    }
}

fn settings() -> TmcSettings {
    TmcSettings::new(2, (0.58, 0.3), 0.11, 16, Chopper::StealthChop).unwrap()
}

/// Returns the chip after its configuration, and how that ended.
fn configured(defect: Option<Defect>) -> (Chip, Result<TmcStatus, TmcError>) {
    configured_from(defect, 100)
}

/// Returns the chip after its configuration, and how that ended, from so many writes on that it had counted.
fn configured_from(defect: Option<Defect>, counted: u32) -> (Chip, Result<TmcStatus, TmcError>) {
    let mut chip = Chip::new(defect);
    chip.registers.insert(0x02, counted);
    let ended = Tmc::configure(&mut chip, &settings());
    (chip, ended)
}

/// Returns the message of a configuration that fails.
fn refused(defect: Defect) -> String {
    configured(Some(defect)).1.unwrap_err().to_string()
}

/// The registers by the datasheet, chapter 5, worked by hand.
///
/// 0.58 A with 0.11 Ohm: the sensitive scale has 0.180 V/0.13 Ohm/sqrt 2/32 = 30.6 mA a step, so 18 steps (CS = 17) are
/// 0.551 A, and 0.3 A are 9 steps (CS = 8). 16 microsteps are MRES = 4.
const WRITES: [(u8, u32); 11] = [
    (0x03, 0x0000_0200),
    (0x01, 7),
    (0x22, 0),
    (0x00, 0x0000_01c0),
    (0x10, 0x0008_1108),
    (0x11, 0xff),
    (0x13, 0),
    (0x14, 0),
    (0x42, 0),
    (0x70, 0xc10d_0024),
    (0x6c, 0x0403_0053),
];

#[test]
fn a_driver_takes_its_settings_and_each_is_confirmed() {
    // The count begins anew on the way.
    let (chip, ended) = configured_from(None, 250);
    assert_eq!(ended.unwrap().faults(), None);
    // The delay of answers comes once more, before anything is asked.
    assert_eq!(chip.written[0], WRITES[0]);
    assert_eq!(chip.written[1..], WRITES);
    assert_eq!(chip.registers[&0x01], 0, "the reset at power-up is cleared");
    assert_eq!(chip.registers[&0x02], (250 + 12) % 256);
}

#[test]
fn settings_become_the_bits_of_the_datasheet() {
    let bits = |run_a, microsteps, chopper| {
        let settings = TmcSettings::new(0, (run_a, run_a), 0.11, microsteps, chopper).unwrap();
        let writes: BTreeMap<u8, u32> =
            settings.writes().into_iter().map(|(register, value)| (register.number, value)).collect();
        [0x00, 0x10, 0x6c].map(|number| writes[&number])
    };
    // 1.2 A is above the sensitive scale, whose most is 0.979 A: 55.2 mA a step, 21 of them.
    assert_eq!(bits(1.2, 256, Chopper::SpreadCycle), [0x1c4, 0x0008_1414, 0x0001_0053]);
    assert_eq!(bits(0.5, 1, Chopper::StealthChop), [0x1c0, 0x0008_0f0f, 0x0803_0053]);
    for (place, microsteps) in [256, 128, 64, 32, 16, 8, 4, 2, 1].into_iter().enumerate() {
        let chopper = bits(0.5, microsteps, Chopper::StealthChop)[2];
        assert_eq!(chopper >> 24, place as u32, "{microsteps}: interpolation and double edges are off");
    }
    let (run_a, hold_a) = crate::pump_file::tmc_range::made_a((0.58, 0.3), 0.11);
    assert!((run_a - 0.5507).abs() < 1e-4 && (hold_a - 0.2754).abs() < 1e-4);
}

#[test]
fn settings_outside_their_range_are_refused_with_it() {
    let told = |address, currents, ohm, microsteps| {
        TmcSettings::new(address, currents, ohm, microsteps, Chopper::default()).unwrap_err().to_string()
    };
    let usual = (0.5, 0.3);
    assert_eq!(told(4, usual, 0.11, 16), "[drive.klipper.tmc] address is 4; allowed: 0 to 3");
    assert!(told(0, usual, 110.0, 16).contains("sense_ohm is 110 Ohm; allowed: 0.075 to 1 Ohm"));
    assert!(told(0, usual, f64::NAN, 16).contains("sense_ohm is NaN"));
    assert!(told(0, (1.8, 0.3), 0.11, 16).contains("run_a is 1.8 A; allowed: 0.031 to 1.768 A (RMS)"));
    assert!(told(0, (f64::NAN, 0.3), 0.11, 16).contains("run_a is NaN A"));
    assert!(told(0, (0.5, 0.6), 0.11, 16).contains("hold_a is 0.6 A; allowed: 0.031 A to run_a, 0.5 A"));
    assert!(told(0, (0.5, 0.0), 0.11, 16).contains("hold_a is 0 A"));
    for microsteps in [0, 3, 512] {
        let message = told(0, usual, 0.11, microsteps);
        assert!(
            message.contains(&format!("is {microsteps} beside full_steps_per_rev = 1; allowed:")),
            "{message}"
        );
    }
}

#[test]
fn single_losses_and_damages_cost_nothing() {
    for defect in [Defect::Lost(2), Defect::Damaged(3)] {
        let (chip, ended) = configured(Some(defect));
        ended.unwrap();
        assert_eq!(chip.written[chip.written.len() - WRITES.len()..], WRITES, "{defect:?}");
    }
}

#[test]
fn each_defect_has_one_clear_error() {
    assert!(
        refused(Defect::Lost(99)).contains("no TMC2209 answers at address 2 of its wire, asked 3 times;")
    );
    assert!(refused(Defect::Damaged(99)).contains("at address 2 are damaged (3 of 3 tries); check its wire"));
    assert!(refused(Defect::Deaf).contains("answers, and has not taken SLAVECONF, sent 3 times;"));
    assert!(refused(Defect::ResetBy(0x22)).contains("counts 0 writes, and 103 before VACTUAL was sent"));
    // The counts of a reset may be those of a write, and its flag tells it all the same.
    let (_, ended) = configured_from(Some(Defect::ResetBy(0x22)), 250);
    assert_eq!(ended, Err(TmcError::Reset { address: 2 }));
    let other = refused(Defect::Forgets(0x6c));
    assert!(other.contains("has CHOPCONF = 0x04030052, and 0x04030053 was written"), "{other}");
    assert!(refused(Defect::OtherChip).contains("tells version 0x20, and a TMC2209 has 0x21"));
}

#[test]
fn nothing_is_written_to_another_chip_but_the_delay_of_its_answers() {
    let (chip, _) = configured(Some(Defect::OtherChip));
    assert_eq!(chip.written, [WRITES[0]]);
}

#[test]
fn a_driver_that_was_reset_or_is_off_is_told_apart() {
    let (mut chip, _) = configured(None);
    let told = |chip: &mut Chip, events, flags| {
        chip.registers.extend([(0x01, events), (0x6f, flags)]);
        Tmc::new(chip, 2).check().map_err(|error| error.to_string())
    };
    assert!(told(&mut chip, 0, 0xc008_0000).unwrap().stands());
    assert!(told(&mut chip, 1, 0).unwrap_err().contains("address 2 was reset, so its motor was without"));
    let off = told(&mut chip, 2, 1 << 2).unwrap_err();
    assert!(off.contains("has switched its motor off: coil A is shorted to ground;"), "{off}");
    let warm = told(&mut chip, 0, 1).unwrap();
    assert!(warm.warnings().unwrap().contains("it is hot"));
}

#[test]
fn a_bit_on_the_wire_has_a_rate_that_the_chip_takes() {
    for clock_hz in [16_000_000, 20_000_000, 64_000_000, 72_000_000, 125_000_000, 480_000_000] {
        let rate = f64::from(clock_hz) / f64::from(bit_ticks(clock_hz));
        assert!((9600.0..=500_000.0).contains(&rate), "{clock_hz} Hz: {rate} bits/s");
    }
    assert_eq!(bit_ticks(72_000_000), 1800);
}
