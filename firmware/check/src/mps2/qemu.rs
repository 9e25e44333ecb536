//! The board in QEMU, which runs only as far as the host waits.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, ChildStderr, ChildStdin, Command, Stdio};
use std::time::{Duration, Instant};

use crate::lockstep::{Lockstep, Machine};
use crate::scope::{Edge, Scope};

/// Time of a byte on a line of 460,800 baud: start, eight data, stop, in ns.
const BYTE_NS: f64 = 10e9 / 460_800.0;

/// Time of a tick of the board, in ns.
const TICK_NS: f64 = 1e3;

/// Longest wait for QEMU's start, in the computer's time.
const START_LIMIT: Duration = Duration::from_secs(60);

/// An instruction takes 2^3 ns of the board's time. A processor that sleeps goes on at once to what wakes it.
const CLOCK: &str = "shift=3,sleep=off";

/// The 1 that tells the firmware that its time is held (firmware/emulated).
const STRAP: &str = "loader,addr=0x21000000,data=1,data-len=4";

/// Logs of QEMU: registers that it does not model, and those of the timers.
const LOG: [&str; 6] = ["-d", "unimp", "-trace", "cmsdk_apb_timer_read", "-trace", "cmsdk_apb_timer_write"];

/// QEMU in a process of its own.
pub(crate) struct Board {
    process: Child,
    monitor: ChildStdin,
    log: BufReader<ChildStderr>,
    /// The board's serial ports: the link, and the hold on its time.
    link: TcpStream,
    pace: TcpStream,
    scope: Scope,
    /// Time since the board was made, now and at its last reset, in ns.
    now_ns: f64,
    reset_ns: f64,
    /// Bytes of the host that the board has not been given, and time from which the line is free for them.
    written: Vec<u8>,
    line_free_ns: f64,
    /// Bytes of the board that the host has not read.
    said: Vec<u8>,
    /// Bytes given to the board and taken from it since the reset.
    given: u32,
    taken: u32,
}

/// Board in QEMU.
pub(crate) type Qemu = Lockstep<Board>;

impl Qemu {
    /// Starts QEMU with this firmware, an ELF file.
    pub(crate) fn new(firmware: &Path) -> io::Result<Self> {
        let ports = [TcpListener::bind("127.0.0.1:0")?, TcpListener::bind("127.0.0.1:0")?];
        let mut command = Command::new("qemu-system-arm");
        command.args(["-machine", "mps2-an386", "-icount", CLOCK, "-device", STRAP]).args(LOG);
        command.args(["-display", "none", "-monitor", "stdio"]);
        for port in &ports {
            command.args(["-serial", &format!("tcp:{},nodelay=on", port.local_addr()?)]);
        }
        command.arg("-kernel").arg(firmware);
        let mut process =
            command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
        let (Some(monitor), Some(log)) = (process.stdin.take(), process.stderr.take()) else {
            return Err(io::Error::other("QEMU has no pipes"));
        };
        let [link, pace] = &ports;
        let (link, pace) = (accept(link, &mut process)?, accept(pace, &mut process)?);
        let (log, scope) = (BufReader::new(log), Scope::default());
        let (written, said) = (Vec::new(), Vec::new());
        let (now_ns, reset_ns, line_free_ns, given, taken) = (0.0, 0.0, 0.0, 0, 0);
        let mut board = Board {
            process,
            monitor,
            log,
            link,
            pace,
            scope,
            now_ns,
            reset_ns,
            written,
            line_free_ns,
            said,
            given,
            taken,
        };
        board.hold()?;
        Ok(Self::over(board))
    }

    /// Takes the edges since the last call.
    pub(crate) fn take_edges(&self) -> Vec<Edge> {
        self.shared().machine.scope.take()
    }

    /// Resets the board. Its motor keeps its place.
    pub(crate) fn reset(&self) -> io::Result<()> {
        let board = &mut self.shared().machine;
        board.said.clear();
        board.written.clear();
        (board.given, board.taken) = (0, 0);
        board.reset_ns = board.now_ns;
        board.scope.reset(board.now_ns);
        board.monitor.write_all(b"system_reset\n")?;
        board.hold()
    }
}

/// Waits until QEMU has connected to a port.
fn accept(port: &TcpListener, process: &mut Child) -> io::Result<TcpStream> {
    port.set_nonblocking(true)?;
    let began = Instant::now();
    loop {
        match port.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false)?;
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
            Err(error) if error.kind() != io::ErrorKind::WouldBlock => return Err(error),
            Err(_) => {}
        }
        if let Some(status) = process.try_wait()? {
            return Err(io::Error::other(format!("QEMU has ended before the board ran: {status}")));
        }
        if began.elapsed() > START_LIMIT {
            return Err(io::Error::other(format!("QEMU does not start within {} s", START_LIMIT.as_secs())));
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

impl Board {
    /// Reads on until the board has stopped its clock, and takes what it has sent.
    fn hold(&mut self) -> io::Result<()> {
        let mut line = Vec::new();
        loop {
            line.clear();
            if self.log.read_until(b'\n', &mut line)? == 0 {
                return Err(io::Error::other("QEMU has ended"));
            }
            if self.scope.read(&String::from_utf8_lossy(&line)) {
                break;
            }
        }
        let mut report = [0; 12];
        self.pace.read_exact(&mut report)?;
        let [tick @ .., a, b, c, d] = report;
        self.now_ns = self.reset_ns + TICK_NS * u64::from_le_bytes(tick) as f64;
        let sent = u32::from_le_bytes([a, b, c, d]);
        let mut said = vec![0; sent.wrapping_sub(self.taken) as usize];
        self.link.read_exact(&mut said)?;
        self.taken = sent;
        self.said.extend(said);
        Ok(())
    }
}

impl Machine for Board {
    const SLICE_NS: f64 = 1e6;

    fn now_ns(&self) -> f64 {
        self.now_ns
    }

    // The board is given the bytes that the line carries until then.
    fn advance(&mut self, until_ns: f64) -> io::Result<()> {
        let free_ns = self.line_free_ns.max(self.now_ns);
        let carried = ((until_ns - free_ns) / BYTE_NS).max(0.0) as usize;
        let bytes: Vec<u8> = self.written.drain(..carried.min(self.written.len())).collect();
        if !bytes.is_empty() {
            self.line_free_ns = free_ns + BYTE_NS * bytes.len() as f64;
            self.given = self.given.wrapping_add(bytes.len() as u32);
            self.link.write_all(&bytes)?;
        }
        let until = ((until_ns - self.reset_ns) / TICK_NS).ceil() as u64;
        let mut leave = until.to_le_bytes().to_vec();
        leave.extend(self.given.to_le_bytes());
        self.pace.write_all(&leave)?;
        self.hold()
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
