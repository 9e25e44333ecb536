//! The emulated board, which runs only as far as the host waits.

use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use super::lockstep::{Lockstep, Machine};
use super::motor::step_pin;

/// Change of a pin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Edge {
    /// Time of the board, in ns.
    pub(crate) at_ns: f64,
    /// Number of the pin.
    pub(crate) pin: u8,
    /// Level: 0 low, 1 high, 2 not driven.
    pub(crate) level: u8,
}

/// Instructions of the board since it was made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Counts {
    /// Instructions in all.
    pub(crate) all: f64,
    /// Interrupts of the timer.
    pub(crate) interrupts: f64,
    /// Instructions in these interrupts.
    pub(crate) instructions: f64,
    /// Most instructions in one of them.
    pub(crate) most: f64,
    /// Most instructions for which the thread kept the interrupts off since it was last asked.
    pub(crate) kept_off: f64,
}

/// Extremes that a board has come to. Times are since it was last asked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extremes {
    /// Longest time with interrupts off, in ns.
    pub(crate) off_ns: f64,
    /// Longest time with interrupts off in which the USB controller was used, in ns.
    pub(crate) usb_off_ns: f64,
    /// Deepest place of the stack.
    pub(crate) stack: u32,
}

/// Board in a process of its own.
pub(crate) struct Board {
    process: Child,
    to: ChildStdin,
    from: ChildStdout,
    now_ns: f64,
    /// Time of the last rise of a step pin, in ns.
    pub(crate) stepped_ns: f64,
    /// Bytes of the host that the board has not been given.
    written: Vec<u8>,
    /// Bytes of the board that the host has not read.
    said: Vec<u8>,
    edges: Vec<Edge>,
}

/// Emulated board.
pub(crate) type Emulator = Lockstep<Board>;

impl Emulator {
    /// Starts the emulator with this firmware, an ELF file. It is reached over its UART.
    pub(crate) fn new(firmware: &Path) -> io::Result<Self> {
        Self::with_options(firmware, &[])
    }

    /// Starts the emulator with this firmware and more options (firmware/emulator/serve.mjs).
    pub(crate) fn with_options(firmware: &Path, options: &[&str]) -> io::Result<Self> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../emulator/serve.mjs");
        let mut process = Command::new("node")
            .arg(script)
            .arg(firmware)
            .args(options)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let (Some(to), Some(from)) = (process.stdin.take(), process.stdout.take()) else {
            return Err(io::Error::other("the emulator has no pipes"));
        };
        let (written, said, edges) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self::over(Board {
            process,
            to,
            from,
            now_ns: 0.0,
            stepped_ns: f64::NEG_INFINITY,
            written,
            said,
            edges,
        }))
    }

    /// Takes the edges since the last call.
    pub(crate) fn take_edges(&self) -> Vec<Edge> {
        std::mem::take(&mut self.shared().machine.edges)
    }

    /// Returns the edges since they were last taken.
    pub(crate) fn edges(&self) -> Vec<Edge> {
        self.shared().machine.edges.clone()
    }

    /// Sets the level of an input pin.
    pub(crate) fn input(&self, pin: u8, high: bool) -> io::Result<()> {
        self.shared().machine.ask(&[b'I', pin, u8::from(high)])
    }

    /// Has the firmware stop for good, as after a panic.
    pub(crate) fn halt(&self) -> io::Result<()> {
        self.shared().machine.ask(b"H")
    }

    /// Resets the board. Its motor keeps its place.
    pub(crate) fn reset(&self) -> io::Result<()> {
        let board = &mut self.shared().machine;
        board.said.clear();
        board.written.clear();
        board.ask(b"R").map(drop)
    }

    /// Plugs the USB cable in anew. Bytes on their way are lost.
    pub(crate) fn plug_usb(&self) -> io::Result<()> {
        let board = &mut self.shared().machine;
        board.said.clear();
        board.written.clear();
        board.ask(b"U")
    }

    /// Returns the extremes that the board has come to.
    pub(crate) fn extremes(&self) -> io::Result<Extremes> {
        let board = &mut self.shared().machine;
        board.to.write_all(b"X")?;
        let [off_ns, usb_off_ns, stack] = board.numbers()?;
        Ok(Extremes { off_ns, usb_off_ns, stack: stack as u32 })
    }

    /// Returns the names of the USB device: its ids, manufacturer, product and serial number.
    pub(crate) fn usb_names(&self) -> io::Result<Vec<String>> {
        let board = &mut self.shared().machine;
        board.to.write_all(b"S")?;
        let mut text = vec![0; board.length()?];
        board.from.read_exact(&mut text)?;
        Ok(String::from_utf8_lossy(&text).lines().map(str::to_owned).collect())
    }

    /// Returns the instructions of the board's interrupts.
    pub(crate) fn counts(&self) -> io::Result<Counts> {
        let board = &mut self.shared().machine;
        board.to.write_all(b"C")?;
        let [all, interrupts, instructions, most, kept_off, _] = board.numbers()?;
        Ok(Counts { all, interrupts, instructions, most, kept_off })
    }
}

impl Board {
    /// Returns the time of the board, in ns.
    pub(crate) fn time_ns(&self) -> f64 {
        self.now_ns
    }

    /// Sends a request whose answer is the time.
    fn ask(&mut self, request: &[u8]) -> io::Result<()> {
        self.to.write_all(request)?;
        [self.now_ns] = self.numbers()?;
        Ok(())
    }

    fn numbers<const N: usize>(&mut self) -> io::Result<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            let mut bytes = [0; 8];
            self.from.read_exact(&mut bytes)?;
            *number = f64::from_le_bytes(bytes);
        }
        Ok(numbers)
    }

    fn length(&mut self) -> io::Result<usize> {
        let mut bytes = [0; 4];
        self.from.read_exact(&mut bytes)?;
        Ok(u32::from_le_bytes(bytes) as usize)
    }
}

impl Machine for Board {
    const SLICE_NS: f64 = f64::INFINITY;

    fn now_ns(&self) -> f64 {
        self.now_ns
    }

    fn advance(&mut self, until_ns: f64) -> io::Result<()> {
        let bytes = std::mem::take(&mut self.written);
        let mut request = vec![b'A'];
        request.extend(until_ns.to_le_bytes());
        request.push(1);
        request.extend((bytes.len() as u32).to_le_bytes());
        request.extend(bytes);
        self.ask(&request)?;
        let mut said = vec![0; self.length()?];
        self.from.read_exact(&mut said)?;
        self.said.extend(said);
        for _ in 0..self.length()? {
            let [at_ns] = self.numbers()?;
            let mut pin_and_level = [0; 2];
            self.from.read_exact(&mut pin_and_level)?;
            let [pin, level] = pin_and_level;
            if level == 1 && (0..4).any(|axis| pin == step_pin(axis)) {
                self.stepped_ns = at_ns;
            }
            self.edges.push(Edge { at_ns, pin, level });
        }
        Ok(())
    }

    fn said(&mut self) -> &mut Vec<u8> {
        &mut self.said
    }

    fn give(&mut self, bytes: &[u8]) {
        self.written.extend(bytes);
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
