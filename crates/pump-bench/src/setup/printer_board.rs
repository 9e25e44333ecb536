//! Printer boards whose sockets are known: the pins of the motor that is plugged in there.
//!
//! Source: Klipper3d/klipper, folder `config`, in the file that each board names.

/// Printer board whose sockets are known.
///
/// ```
/// use pump_bench::setup::PrinterBoard;
///
/// let board = PrinterBoard::of("skr-mini-e3-v3").unwrap();
/// assert_eq!(board.sockets().collect::<Vec<_>>(), ["X", "Y", "Z", "E"]);
/// assert!(PrinterBoard::with_chip("stm32g0b1xx").any(|found| found == board));
/// ```
#[derive(Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PrinterBoard {
    /// Name of the board in answers, as `skr-mini-e3-v3`.
    pub name: &'static str,
    /// Name that is printed on the board.
    pub title: &'static str,
    /// File with the board's pins.
    pub source: &'static str,
    /// Microcontrollers that the board comes with, as its firmware names them.
    chips: &'static [&'static str],
    sockets: &'static [Pins],
}

/// Pins of a socket.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pins {
    /// Name that is printed at the socket.
    pub(super) name: &'static str,
    pub(super) step: &'static str,
    pub(super) dir: &'static str,
    /// Pin that gives the motor current. A `!` before it says that it does so while it is low.
    pub(super) enable: &'static str,
    /// Pin that reads the wire of the TMC2209, and the one that writes it. One pin may do both.
    pub(super) wire: (&'static str, Option<&'static str>),
    /// Address of the TMC2209 on its wire.
    pub(super) address: u8,
}

const fn pins(
    name: &'static str,
    [step, dir, enable]: [&'static str; 3],
    wire: (&'static str, Option<&'static str>),
    address: u8,
) -> Pins {
    Pins { name, step, dir, enable, wire, address }
}

/// Wire of the four drivers of an SKR Mini E3.
const MINI_WIRE: (&str, Option<&str>) = ("PC11", Some("PC10"));

/// Wire of the four drivers of an SKR Pico.
const PICO_WIRE: (&str, Option<&str>) = ("gpio9", Some("gpio8"));

/// Returns the wire of a driver that has one of its own.
const fn own(pin: &'static str) -> (&'static str, Option<&'static str>) {
    (pin, None)
}

/// Printer boards whose sockets are known.
const BOARDS: [PrinterBoard; 5] = [
    PrinterBoard {
        name: "skr-mini-e3-v3",
        title: "BIGTREETECH SKR Mini E3 V3.0",
        source: "generic-bigtreetech-skr-mini-e3-v3.0.cfg",
        chips: &["stm32g0b1xx"],
        sockets: &[
            pins("X", ["PB13", "PB12", "!PB14"], MINI_WIRE, 0),
            pins("Y", ["PB10", "PB2", "!PB11"], MINI_WIRE, 2),
            pins("Z", ["PB0", "PC5", "!PB1"], MINI_WIRE, 1),
            pins("E", ["PB3", "PB4", "!PD1"], MINI_WIRE, 3),
        ],
    },
    PrinterBoard {
        name: "skr-mini-e3-v2",
        title: "BIGTREETECH SKR Mini E3 V2.0",
        source: "generic-bigtreetech-skr-mini-e3-v2.0.cfg",
        chips: &["stm32f103xe"],
        sockets: &[
            pins("X", ["PB13", "PB12", "!PB14"], MINI_WIRE, 0),
            pins("Y", ["PB10", "PB2", "!PB11"], MINI_WIRE, 2),
            pins("Z", ["PB0", "PC5", "!PB1"], MINI_WIRE, 1),
            pins("E", ["PB3", "PB4", "!PD2"], MINI_WIRE, 3),
        ],
    },
    PrinterBoard {
        name: "skr-mini-e3-v1.2",
        title: "BIGTREETECH SKR Mini E3 V1.2",
        source: "generic-bigtreetech-skr-mini-e3-v1.2.cfg",
        chips: &["stm32f103xe"],
        sockets: &[
            pins("X", ["PB13", "PB12", "!PB14"], own("PB15"), 0),
            pins("Y", ["PB10", "PB2", "!PB11"], own("PC6"), 0),
            pins("Z", ["PB0", "PC5", "!PB1"], own("PC10"), 0),
            pins("E", ["PB3", "PB4", "!PD2"], own("PC11"), 0),
        ],
    },
    PrinterBoard {
        name: "skr-pico-v1",
        title: "BIGTREETECH SKR Pico V1.0",
        source: "generic-bigtreetech-skr-pico-v1.0.cfg",
        chips: &["rp2040"],
        sockets: &[
            pins("X", ["gpio11", "gpio10", "!gpio12"], PICO_WIRE, 0),
            pins("Y", ["gpio6", "gpio5", "!gpio7"], PICO_WIRE, 2),
            pins("Z", ["gpio19", "gpio28", "!gpio2"], PICO_WIRE, 1),
            pins("E", ["gpio14", "gpio13", "!gpio15"], PICO_WIRE, 3),
        ],
    },
    PrinterBoard {
        name: "octopus-v1.1",
        title: "BIGTREETECH Octopus V1.1 with TMC2209",
        source: "generic-bigtreetech-octopus-v1.1.cfg",
        chips: &["stm32f446xx", "stm32f429xx"],
        sockets: &[
            pins("0", ["PF13", "PF12", "!PF14"], own("PC4"), 0),
            pins("1", ["PG0", "PG1", "!PF15"], own("PD11"), 0),
            pins("2", ["PF11", "PG3", "!PG5"], own("PC6"), 0),
            pins("3", ["PG4", "PC1", "!PA0"], own("PC7"), 0),
            pins("4", ["PF9", "PF10", "!PG2"], own("PF2"), 0),
            pins("5", ["PC13", "PF0", "!PF1"], own("PE4"), 0),
            pins("6", ["PE2", "PE3", "!PD4"], own("PE1"), 0),
            pins("7", ["PE6", "PA14", "!PE0"], own("PD3"), 0),
        ],
    },
];

impl PrinterBoard {
    /// Returns all boards.
    pub fn all() -> &'static [Self] {
        const { &BOARDS }
    }

    /// Returns the board of this name.
    pub fn of(name: &str) -> Option<&'static Self> {
        Self::all().iter().find(|board| board.name.eq_ignore_ascii_case(name))
    }

    /// Returns the boards that come with this microcontroller, as its firmware names it.
    pub fn with_chip(chip: &str) -> impl Iterator<Item = &'static Self> {
        Self::all().iter().filter(move |board| board.chips.contains(&chip))
    }

    /// Returns the microcontrollers that the board comes with, as its firmware names them.
    pub fn chips(&self) -> &'static [&'static str] {
        self.chips
    }

    /// Returns the names of the sockets.
    pub fn sockets(&self) -> impl Iterator<Item = &'static str> {
        self.sockets.iter().map(|socket| socket.name)
    }

    /// Returns the pins of the socket of this name.
    pub(super) fn pins(&self, socket: &str) -> Option<&'static Pins> {
        self.sockets.iter().find(|pins| pins.name.eq_ignore_ascii_case(socket))
    }
}
