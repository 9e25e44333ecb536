//! The socket of a board at which a motor is plugged in, as a person says it.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::printer_board::{Pins, PrinterBoard};
use crate::pump_file::{KlipperPin, KlipperPinError, KlipperTable, TmcTable};

/// Keys of pins that a person may say.
const KEYS: &str = "step, dir, enable, uart, tx and address";

/// Largest address of a stepper driver on its wire.
const ADDRESS_MOST: u8 = 3;

/// Socket of a board with the Klipper firmware: one of a [`PrinterBoard`], or pins by hand.
///
/// ```
/// use pump_bench::setup::MotorSocket;
///
/// let socket: MotorSocket = "skr-mini-e3-v3:Y".parse()?;
/// assert_eq!(socket.table(Some(0.5), None).step.name, "PB10");
/// let pins: MotorSocket = "step=PB13,dir=PB12,enable=!PB14".parse()?;
/// assert!(socket.has_driver_wire() && !pins.has_driver_wire());
/// # Ok::<(), pump_bench::setup::SocketError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct MotorSocket {
    /// Words for the socket, as a person says it.
    said: String,
    step: KlipperPin,
    dir: KlipperPin,
    enable: Option<KlipperPin>,
    wire: Option<DriverWire>,
}

/// Wire to a TMC2209.
#[derive(Debug, Clone, PartialEq, Eq)]
struct DriverWire {
    uart: KlipperPin,
    tx: Option<KlipperPin>,
    address: u8,
}

/// Text that is no socket of a board.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SocketError {
    /// No board of this name is known.
    #[error(
        "no board `{name}` is known; it is one of {known}, with its socket, as skr-mini-e3-v3:X; pins of another board \
         are step=PB13,dir=PB12,enable=!PB14"
    )]
    Board {
        /// Name that was given.
        name: String,
        /// Names that are known, as the message words them.
        known: String,
    },
    /// The board has no such socket.
    #[error("the {board} has no socket `{socket}`; it has {sockets}, as {board}:{first}")]
    Socket {
        /// Name of the board.
        board: &'static str,
        /// Socket that was given.
        socket: String,
        /// Sockets that it has, as the message words them.
        sockets: String,
        /// First of them.
        first: &'static str,
    },
    /// A word is no pin with its key.
    #[error("`{word}` is no pin with its key; the keys are {KEYS}, as step=PB13,dir=PB12,enable=!PB14")]
    Word {
        /// Word that was given.
        word: String,
    },
    /// A key comes twice.
    #[error("{key} is said twice; say it once")]
    Twice {
        /// Key.
        key: String,
    },
    /// A pin is missing.
    #[error(
        "the pin {key} is missing; step and dir turn a motor, as step=PB13,dir=PB12, and tx and address need uart"
    )]
    Missing {
        /// Key of the pin.
        key: &'static str,
    },
    /// The address is none.
    #[error("the address of a stepper driver is `{text}`; allowed: 0 to {ADDRESS_MOST}")]
    Address {
        /// Text that was given.
        text: String,
    },
    /// A pin is none.
    #[error(transparent)]
    Pin(#[from] KlipperPinError),
}

impl MotorSocket {
    /// Returns true if the stepper driver has a wire, by which its current is set.
    pub fn has_driver_wire(&self) -> bool {
        self.wire.is_some()
    }

    /// Returns the name of the pin that makes steps. Two motors do not share it.
    pub fn step_pin(&self) -> &str {
        &self.step.name
    }

    /// Returns the board whose socket it is. `None` for pins by hand.
    pub fn board(&self) -> Option<&'static PrinterBoard> {
        PrinterBoard::of(self.said.split_once([':', ' ']).map_or(self.said.as_str(), |(name, _)| name))
    }

    /// Returns the table of a pump file. The stepper driver is set where it has a wire and the motor's current, in A
    /// (RMS), is known. `hold_a` is the current at rest, if it is another one.
    pub fn table(&self, current_a: Option<f64>, hold_a: Option<f64>) -> KlipperTable {
        let mut table = KlipperTable::new(self.step.clone(), self.dir.clone());
        table.enable.clone_from(&self.enable);
        table.tmc = self.wire.as_ref().zip(current_a).map(|(wire, run_a)| TmcTable {
            tx: wire.tx.clone(),
            address: wire.address,
            hold_a,
            ..TmcTable::new(wire.uart.clone(), run_a)
        });
        table
    }

    fn of_board(board: &'static PrinterBoard, pins: &Pins) -> Result<Self, SocketError> {
        let (uart, tx) = pins.wire;
        let wire =
            DriverWire { uart: uart.parse()?, tx: tx.map(str::parse).transpose()?, address: pins.address };
        Ok(Self {
            said: format!("{}:{}", board.name, pins.name),
            step: pins.step.parse()?,
            dir: pins.dir.parse()?,
            enable: Some(pins.enable.parse()?),
            wire: Some(wire),
        })
    }

    /// Reads pins that were said by hand.
    fn of_pins(said: &str) -> Result<Self, SocketError> {
        let (mut step, mut dir, mut enable, mut uart, mut tx, mut address) =
            (None, None, None, None, None, None);
        for word in said.split([',', ' ']).filter(|word| !word.is_empty()) {
            let unknown = || SocketError::Word { word: word.to_owned() };
            let (key, pin) = word.split_once('=').ok_or_else(unknown)?;
            let place = match key {
                "step" => &mut step,
                "dir" => &mut dir,
                "enable" => &mut enable,
                "uart" => &mut uart,
                "tx" => &mut tx,
                "address" => &mut address,
                _ => return Err(unknown()),
            };
            if place.replace(pin.to_owned()).is_some() {
                return Err(SocketError::Twice { key: key.to_owned() });
            }
        }
        let pin = |pin: Option<String>| pin.map(|pin| pin.parse::<KlipperPin>()).transpose();
        let needed = |key, text| pin(text)?.ok_or(SocketError::Missing { key });
        let address = match address {
            None => None,
            Some(text) => match text.parse::<u8>() {
                Ok(address) if address <= ADDRESS_MOST => Some(address),
                _ => return Err(SocketError::Address { text }),
            },
        };
        let (step, dir, enable, tx) = (needed("step", step)?, needed("dir", dir)?, pin(enable)?, pin(tx)?);
        let wire = match pin(uart)? {
            Some(uart) => Some(DriverWire { uart, tx, address: address.unwrap_or(0) }),
            None if tx.is_some() || address.is_some() => return Err(SocketError::Missing { key: "uart" }),
            None => None,
        };
        Ok(Self { said: said.to_owned(), step, dir, enable, wire })
    }
}

impl FromStr for MotorSocket {
    type Err = SocketError;

    fn from_str(text: &str) -> Result<Self, SocketError> {
        let text = text.trim();
        if text.contains('=') {
            return Self::of_pins(text);
        }
        let (name, socket) = text.split_once([':', ' ']).unwrap_or((text, ""));
        let board = PrinterBoard::of(name).ok_or_else(|| {
            let names: Vec<_> = PrinterBoard::all().iter().map(|board| board.name).collect();
            SocketError::Board { name: name.to_owned(), known: names.join(", ") }
        })?;
        let pins = board.pins(socket.trim()).ok_or_else(|| SocketError::Socket {
            board: board.name,
            socket: socket.trim().to_owned(),
            sockets: board.sockets().collect::<Vec<_>>().join(", "),
            first: board.sockets().next().unwrap_or_default(),
        })?;
        Self::of_board(board, pins)
    }
}

impl Display for MotorSocket {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.write_str(&self.said)
    }
}

impl TryFrom<String> for MotorSocket {
    type Error = SocketError;

    fn try_from(text: String) -> Result<Self, SocketError> {
        text.parse()
    }
}

impl From<MotorSocket> for String {
    fn from(socket: MotorSocket) -> Self {
        socket.said
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        text.parse::<MotorSocket>().unwrap_err().to_string()
    }

    #[test]
    fn each_socket_of_each_board_has_pins_of_its_own() {
        for board in PrinterBoard::all() {
            let mut seen = std::collections::BTreeSet::new();
            for socket in board.sockets() {
                let read: MotorSocket = format!("{}:{socket}", board.name).parse().unwrap();
                let table = read.table(Some(0.5), None);
                let (enable, tmc) = (table.enable.unwrap(), table.tmc.unwrap());
                for pin in [&table.step, &table.dir, &enable] {
                    assert!(seen.insert(pin.name.clone()), "{read}: {pin}");
                }
                assert!(seen.insert(format!("{} {}", tmc.uart, tmc.address)), "{read}");
                assert!(enable.inverted && !table.step.inverted && !table.dir.inverted, "{read}");
                assert_eq!((tmc.run_a, read.to_string()), (0.5, format!("{}:{socket}", board.name)));
            }
        }
    }

    /// Lines of config/generic-bigtreetech-skr-mini-e3-v3.0.cfg.
    #[test]
    fn a_socket_is_that_of_the_boards_own_file() {
        let table = "SKR-Mini-E3-V3 e".parse::<MotorSocket>().unwrap().table(Some(0.65), None);
        let tmc = table.tmc.unwrap();
        let pins = [table.step, table.dir, table.enable.unwrap(), tmc.uart, tmc.tx.unwrap()];
        assert_eq!(pins.map(|pin| pin.to_string()), ["PB3", "PB4", "!PD1", "PC11", "PC10"]);
        assert_eq!(tmc.address, 3);
    }

    #[test]
    fn pins_by_hand_are_read_back_as_they_were_said() {
        let said = "step=PB13,dir=!PB12,enable=!PB14,uart=PC11,tx=PC10,address=2";
        let socket: MotorSocket = said.parse().unwrap();
        assert_eq!((String::from(socket.clone()), socket.step_pin()), (said.to_owned(), "PB13"));
        assert_eq!(socket.table(Some(0.4), None).tmc.map(|tmc| tmc.address), Some(2));
        assert_eq!(socket.table(None, None).tmc, None);
        let bare: MotorSocket = "step=gpio2 dir=gpio3".parse().unwrap();
        assert_eq!((bare.has_driver_wire(), bare.table(Some(0.4), None).enable), (false, None));
    }

    #[test]
    fn what_is_no_socket_is_refused_with_what_is_allowed() {
        assert!(refused("ramps:X").starts_with("no board `ramps` is known; it is one of skr-mini-e3-v3, "));
        assert_eq!(
            refused("skr-mini-e3-v3"),
            "the skr-mini-e3-v3 has no socket ``; it has X, Y, Z, E, as skr-mini-e3-v3:X"
        );
        assert!(refused("octopus-v1.1:8").contains("has no socket `8`; it has 0, 1, 2, 3, 4, 5, 6, 7, as"));
        assert!(refused("step=PB13").starts_with("the pin dir is missing;"));
        assert!(refused("step=PB13,dir=PB12,tx=PC10").starts_with("the pin uart is missing;"));
        assert!(refused("step=PB13,dir=PB12,heater=PC9").starts_with("`heater=PC9` is no pin with its key;"));
        assert!(refused("step=PB13,step=PB12").starts_with("step is said twice;"));
        assert!(refused("step=PB13,dir=PB12,uart=PC1,address=4").starts_with("the address of a stepper dr"));
        assert!(refused("step=,dir=PB12").starts_with("`` is no pin of a board;"));
        assert!(refused("").starts_with("no board `` is known;"));
    }
}
