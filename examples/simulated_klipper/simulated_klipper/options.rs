//! The character of a simulated board, and its defects.

/// Step pins, direction pins and enable pins of the four sockets, by their numbers, as an SKR Mini E3 V2.0 has them
/// (config/generic-bigtreetech-skr-mini-e3-v2.0.cfg of Klipper3d/klipper). Enable pins are active low.
pub(super) const SOCKETS: [Socket; 4] = [
    Socket { name: "X", step: pin(b'B', 13), enable: pin(b'B', 14), address: 0 },
    Socket { name: "Y", step: pin(b'B', 10), enable: pin(b'B', 11), address: 2 },
    Socket { name: "Z", step: pin(b'B', 0), enable: pin(b'B', 1), address: 1 },
    Socket { name: "E", step: pin(b'B', 3), enable: pin(b'D', 2), address: 3 },
];

/// Pins of the line to the drivers: the board reads the first, and writes the second.
pub(super) const DRIVER_LINE: [u32; 2] = [pin(b'C', 11), pin(b'C', 10)];

/// Socket of a motor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Socket {
    pub(super) name: &'static str,
    pub(super) step: u32,
    pub(super) enable: u32,
    /// Address of its driver on the drivers' line.
    pub(super) address: u8,
}

/// Returns the number of a pin of an STM32, such as PB13.
const fn pin(port: u8, number: u32) -> u32 {
    (port - b'A') as u32 * 16 + number
}

/// Returns the number of the pin of this name.
pub(crate) fn pin_of(name: &str) -> Option<u32> {
    let port = *name.strip_prefix('P')?.as_bytes().first()?;
    let number = name.get(2..)?.parse().ok()?;
    ((b'A'..=b'D').contains(&port) && number < 16).then(|| pin(port, number))
}

/// Index sensor: its pin is high once in so many steps of a motor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct IndexSensor {
    pub(crate) pin: u32,
    pub(crate) socket: usize,
    pub(crate) steps: u32,
}

/// Parts of the bytes that the line loses, doubles and damages, in each direction.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Noise {
    pub(crate) lost: f64,
    pub(crate) doubled: f64,
    pub(crate) damaged: f64,
    pub(crate) seed: u64,
}

/// Character of a board.
#[derive(Debug, Clone)]
pub(crate) struct Character {
    /// Microcontroller, as its dictionary says. The pins of an RP2040 are gpio0 to gpio29.
    pub(crate) chip: &'static str,
    /// Ticks of the board's clock in a second, as its dictionary says.
    pub(crate) hz: u32,
    /// Drift of its clock, in parts of a million.
    pub(crate) drift_ppm: f64,
    /// Tick at which the board is switched on.
    pub(crate) first_tick: u64,
    /// Commands that its queue holds.
    pub(crate) slots: u16,
    /// Most steps a second.
    pub(crate) most_steps_s: f64,
    /// Rate of its line, in bits a second. 0 is a line without delay, as USB.
    pub(crate) baud: u32,
    /// Number of sockets that have a driver with a line.
    pub(crate) drivers: usize,
    pub(crate) noise: Noise,
    pub(crate) index: Option<IndexSensor>,
    /// Name that the firmware's dictionary gives as `app`.
    pub(crate) app: &'static str,
    /// Command that the firmware lacks, by its name.
    pub(crate) lacks: Option<String>,
    /// File that the time of each step goes to.
    pub(crate) record: Option<std::path::PathBuf>,
}

impl Default for Character {
    fn default() -> Self {
        Self {
            // An STM32F103 (72 MHz, 20 kB of RAM).
            chip: "stm32f103xe",
            hz: 72_000_000,
            drift_ppm: 0.0,
            first_tick: 0,
            slots: 512,
            // Half of the 1,180,000 of Klipper's docs/Features.md, which step at both edges of a pulse.
            most_steps_s: 590_000.0,
            baud: 250_000,
            drivers: 2,
            noise: Noise::default(),
            index: None,
            app: "Klipper",
            lacks: None,
            record: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{SOCKETS, pin_of};

    #[test]
    fn pins_have_the_numbers_of_their_port_and_place() {
        assert_eq!(pin_of("PA0"), Some(0));
        assert_eq!(pin_of("PB13"), Some(SOCKETS[0].step));
        assert_eq!(pin_of("PD15"), Some(63));
        assert!(["PE0", "PA16", "A0", "P", ""].iter().all(|name| pin_of(name).is_none()));
    }
}
