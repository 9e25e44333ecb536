//! A simulated board in memory, with a clock that goes on only where its driver waits.

use std::io;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use pump_bench::drives::wire::Wire;
use pump_bench::drives::{DriveError, Grbl, GrblBoard, Node, Opening};
use pump_bench::pump_file::{DriveTable, DriverName};

use crate::rig::motor;
use crate::simulated::Truth;
use crate::simulated::line::Line;
use crate::simulated::options::Options;

/// Time between two looks of the board at its motor.
const TICK: Duration = Duration::from_micros(500);

/// Time for which a motor has stood where it is said to rest.
const RESTS: Duration = Duration::from_millis(100);

/// Byte that cancels jogs.
const CANCEL: u8 = 0x85;

/// Longest time for a motor to come to rest.
const REST_LIMIT: Duration = Duration::from_secs(600);

/// Board on the table, which may be opened again and again.
#[derive(Debug, Clone)]
pub(crate) struct Board(Arc<Mutex<Table>>);

/// Board with its clock, and what befalls both.
#[derive(Debug)]
struct Table {
    line: Line,
    truth: Truth,
    now: Duration,
    meddling: Meddling,
    /// Time of the first jog cancel.
    cancelled: Option<Duration>,
}

/// Events that a test brings about.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Meddling {
    /// Factor by which the motor is slower than its settings say, less one.
    pub(crate) slower: f64,
    /// Times for which the drive does not get to run: before its next look, and after the next line that it sends.
    pub(crate) stalls: [Duration; 2],
    /// Byte that somebody else sends now.
    pub(crate) pressed: Option<u8>,
    /// True if the board says that it jogs, whatever it does.
    pub(crate) never_rests: bool,
    /// Distance by which every report is off from now on, in mm.
    pub(crate) astray_mm: f64,
    /// Axis whose coordinate is off, 0 for the first.
    pub(crate) astray_axis: usize,
    /// Time between two resets of a processor that comes no further than its banner.
    pub(crate) reboots: Option<Duration>,
    /// Line that the board neither obeys nor answers from now on.
    pub(crate) ignored: Option<&'static str>,
}

impl Table {
    fn pass(&mut self, time: Duration) {
        let mut left = time;
        while !left.is_zero() {
            let tick = left.min(TICK);
            left -= tick;
            self.tick(tick);
        }
    }

    fn tick(&mut self, tick: Duration) {
        if let Some(byte) = self.meddling.pressed.take() {
            self.line.receive(&[byte]);
        }
        self.now += tick;
        let time_s = tick.as_secs_f64() * self.line.options.time_scale;
        let said = self.line.outgoing.len();
        self.line.pass(self.now, time_s / (1.0 + self.meddling.slower));
        self.twist(said);
        self.line.publish(&mut self.truth);
    }

    /// Changes what the board has said after its first `said` bytes as the test wants it.
    fn twist(&mut self, said: usize) {
        let Meddling { never_rests, astray_mm, astray_axis, reboots, .. } = self.meddling;
        if let Some(every) = reboots {
            self.line.outgoing.truncate(said);
            if self.now.as_nanos() % every.as_nanos() < TICK.as_nanos() {
                self.line.outgoing.extend(b"\r\nGrbl 1.1h ['$' for help]\r\n");
            }
            return;
        }
        if !(never_rests || astray_mm != 0.0) || self.line.outgoing.len() <= said {
            return;
        }
        let bytes: Vec<u8> = self.line.outgoing.drain(said..).collect();
        let mut text = String::from_utf8(bytes).unwrap();
        if never_rests {
            text = text.replace("<Idle", "<Jog");
        }
        if astray_mm != 0.0 {
            text = text.split_inclusive("\r\n").map(|line| astray(line, astray_axis, astray_mm)).collect();
        }
        self.line.outgoing.extend(text.bytes());
    }
}

/// Returns a status report with one coordinate that is off. Other lines stay as they are.
fn astray(text: &str, axis: usize, by_mm: f64) -> String {
    let Some((head, rest)) = text.split_once("MPos:") else { return text.to_owned() };
    let (places, others) = rest.split_once('|').unwrap();
    let mut places: Vec<String> = places.split(',').map(str::to_owned).collect();
    places[axis] = format!("{:.3}", places[axis].parse::<f64>().unwrap() + by_mm);
    format!("{head}MPos:{}|{others}", places.join(","))
}

impl Board {
    /// Switches a board on.
    pub(crate) fn start(options: Options) -> Self {
        Self(Arc::new(Mutex::new(Table {
            line: Line::new(options),
            truth: Truth::default(),
            now: Duration::ZERO,
            meddling: Meddling::default(),
            cancelled: None,
        })))
    }

    fn table(&self) -> MutexGuard<'_, Table> {
        // A test may die while its driver waits. The next driver finds the board as it is.
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Opens the driver with this board.
    pub(crate) fn open(&self, table: &DriveTable, opening: &Opening) -> Result<Grbl, DriveError> {
        Grbl::over(Box::new(VirtualWire(self.clone())), table, &motor(), opening)
    }

    /// Takes the board for several axes.
    pub(crate) fn shared(&self) -> GrblBoard {
        GrblBoard::over(Box::new(VirtualWire(self.clone())))
    }

    /// Opens the driver of another kind of board with this one.
    pub(crate) fn open_as_node(&self) -> Result<Node, DriveError> {
        let table = DriveTable::of(DriverName::Node).with_port("/dev/ttyACM0");
        Node::over(Box::new(VirtualWire(self.clone())), &table, &motor(), &Opening::default())
    }

    /// Returns the truth about the board now.
    pub(crate) fn truth(&self) -> Truth {
        self.table().truth.clone()
    }

    /// Returns the time on the board's clock.
    pub(crate) fn now(&self) -> Duration {
        self.table().now
    }

    /// Returns the time at which the driver first cancelled jogs.
    pub(crate) fn first_cancel(&self) -> Option<Duration> {
        self.table().cancelled
    }

    /// Brings events about.
    pub(crate) fn meddle(&self, change: impl FnOnce(&mut Meddling)) {
        change(&mut self.table().meddling);
    }

    /// Sends bytes as another program does.
    pub(crate) fn send(&self, bytes: &[u8]) {
        self.table().line.receive(bytes);
    }

    /// Lets `time` pass.
    pub(crate) fn pass(&self, time: Duration) {
        self.table().pass(time);
    }

    /// Waits until the motor has stood for a while, and returns the truth then.
    pub(crate) fn rest(&self) -> Truth {
        let latest = self.now() + REST_LIMIT;
        let mut stood = self.now();
        while self.now() - stood < RESTS {
            assert!(self.now() < latest, "the motor turns on and on");
            self.pass(TICK);
            if self.table().truth.moving {
                stood = self.now();
            }
        }
        self.truth()
    }
}

/// Wire in virtual time.
#[derive(Debug)]
struct VirtualWire(Board);

impl VirtualWire {
    /// Refuses to go on once the cable is pulled.
    fn is_there(table: &Table) -> io::Result<()> {
        if table.line.is_pulled { Err(io::ErrorKind::BrokenPipe.into()) } else { Ok(()) }
    }
}

impl Wire for VirtualWire {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        let mut table = self.0.table();
        let stall = std::mem::take(&mut table.meddling.stalls[0]);
        table.pass(stall);
        let mut left = wait.max(TICK);
        loop {
            Self::is_there(&table)?;
            let leaving = table.line.leaving();
            let count = buffer.len().min(leaving.len());
            if count > 0 {
                for (byte, from) in buffer.iter_mut().zip(table.line.outgoing.drain(..count)) {
                    *byte = from;
                }
                return Ok(count);
            }
            if left.is_zero() {
                return Ok(0);
            }
            let tick = left.min(TICK);
            table.pass(tick);
            left -= tick;
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut table = self.0.table();
        Self::is_there(&table)?;
        let is_ignored = table.meddling.ignored.is_some_and(|line| bytes == format!("{line}\n").as_bytes());
        if is_ignored {
            return Ok(());
        }
        if bytes.contains(&CANCEL) {
            let now = table.now;
            table.cancelled.get_or_insert(now);
        }
        table.line.receive(bytes);
        if bytes.ends_with(b"\n") {
            let stall = std::mem::take(&mut table.meddling.stalls[1]);
            table.pass(stall);
        }
        Ok(())
    }

    fn now(&mut self) -> Duration {
        self.0.now()
    }

    fn sleep(&mut self, time: Duration) {
        self.0.pass(time);
    }
}
