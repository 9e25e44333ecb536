//! The most steps a second that a board is asked for.
//!
//! Source: Klipper3d/klipper, `docs/Features.md`, "Step Benchmarks", column "1 stepper active". `docs/Benchmarks.md`
//! tells how they are measured: the board does nothing else, and most of them make a step at each edge of the pulse. A
//! step of this drive takes both edges, and half of the time is left for the rest of the firmware. So a board is asked
//! for a quarter of its benchmark.

/// Benchmarks by the start of the microcontroller's name, in steps/s. The first that fits counts.
const BENCHMARKS: [(&str, f64); 16] = [
    ("samd21", 686e3),
    ("stm32f042", 814e3),
    ("pru", 866e3),
    ("stm32g0b1", 1_103e3),
    ("stm32f103", 1_180e3),
    ("sam3x8", 1_273e3),
    ("sam4s8", 1_690e3),
    ("lpc1768", 1_923e3),
    ("lpc1769", 2_353e3),
    ("rp2040", 2_400e3),
    ("sam4e8", 2_500e3),
    ("samd51", 3_077e3),
    ("ar100", 3_529e3),
    ("stm32f407", 3_652e3),
    ("stm32f446", 3_913e3),
    ("stm32h7", 7_429e3),
];

/// Starts of the names of 8-bit microcontrollers (Klipper3d/klipper, `src/avr/Kconfig`). Their rate goes with the
/// clock: 157,000 steps/s at 16 MHz, and 196,000 at 20 MHz.
const AVR: [&str; 2] = ["atmega", "at90usb"];
const AVR_STEPS_PER_TICK: f64 = 157e3 / 16e6;

/// Part of the rate of one motor that several make together. The column "3 steppers active" has 0.61 times the other
/// (SAMD51) to 0.82 times (SAM4S8).
pub(super) const SEVERAL: f64 = 0.6;

/// Part of its benchmark that a board is asked for.
const SHARE: f64 = 0.25;

/// Steps for each tick of the clock of a microcontroller that the table lacks. The slowest one, by its clock, that
/// `docs/Benchmarks.md` measures is the PRU: it takes 231 ticks for a step.
const UNKNOWN_STEPS_PER_TICK: f64 = 1.0 / 256.0;

/// Returns the most steps a second that a board is asked for, by the name of its microcontroller in its dictionary and
/// the ticks of its clock in a second.
pub(super) fn most_steps_s(chip: Option<&str>, hz: u32) -> f64 {
    let chip = chip.unwrap_or_default();
    let listed = BENCHMARKS.iter().find(|(start, _)| chip.starts_with(start));
    let benchmark = match listed {
        Some((_, steps_s)) => *steps_s,
        None if AVR.iter().any(|start| chip.starts_with(start)) => AVR_STEPS_PER_TICK * f64::from(hz),
        None => UNKNOWN_STEPS_PER_TICK * f64::from(hz),
    };
    SHARE * benchmark
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_is_asked_for_a_quarter_of_its_benchmark() {
        for (chip, hz, steps_s) in [
            ("stm32f103xe", 72_000_000, 295_000.0),
            ("stm32g0b1xx", 64_000_000, 275_750.0),
            // The RP2040's timer has 12 MHz, whatever its processor has.
            ("rp2040", 12_000_000, 600_000.0),
            ("atmega2560", 16_000_000, 39_250.0),
            ("atmega1284p", 20_000_000, 49_062.5),
        ] {
            assert_eq!(most_steps_s(Some(chip), hz), steps_s, "{chip}");
        }
    }

    #[test]
    fn a_board_that_no_table_has_is_asked_for_less_than_any_of_the_table_with_its_clock() {
        for (chip, hz) in [
            ("samd21g18", 48_000_000),
            ("pru", 200_000_000),
            ("stm32h723xx", 520_000_000),
            ("atmega328p", 16_000_000),
        ] {
            assert!(most_steps_s(Some("unheard-of"), hz) < most_steps_s(Some(chip), hz), "{chip}");
        }
        assert_eq!(most_steps_s(None, 64_000_000), 62_500.0);
    }
}
