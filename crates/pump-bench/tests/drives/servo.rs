//! A servo of another program, which no pump file names.

use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use pump_bench::drives::{Abilities, Drive, DriveError, DriveFault, DriveLimits, Gate, Leave};
use pump_bench::{Bench, built_in};
use pump_ctl::plan::Plan;

/// Error of the servo's own protocol.
#[derive(Debug, PartialEq)]
pub(super) struct Overload {
    pub(super) amperes: f64,
}

impl Display for Overload {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        write!(to, "the servo draws {} A", self.amperes)
    }
}

impl Error for Overload {}

/// Servo of another program. It makes ten steps at a time.
#[derive(Debug, Default)]
pub(super) struct Servo {
    pub(super) name: Option<&'static str>,
    /// Step at which the servo fails.
    pub(super) fails_at: Option<u64>,
    /// Net steps made so far.
    pub(super) turned: i64,
    pub(super) limits: Option<DriveLimits>,
    /// Steps before which the servo waits for 1.5 s.
    pub(super) waits_at: Option<u64>,
    /// True if the servo holds only while it moves.
    pub(super) lets_go: bool,
    /// True if the servo tells its count.
    pub(super) counts: bool,
    /// Steps by which the servo is found elsewhere once it is connected again.
    pub(super) strays: i64,
    /// True once the servo was connected.
    pub(super) is_connected: bool,
    /// Times that the servo was let go, if it can be.
    pub(super) released: Option<u32>,
}

impl Drive for Servo {
    fn id(&self) -> &str {
        self.name.unwrap_or("servo")
    }

    fn abilities(&self) -> Abilities {
        Abilities::new()
            .with_step_times(true)
            .with_readback(self.counts)
            .with_release(self.released.is_some())
    }

    fn connect(&mut self) -> Result<(), DriveError> {
        if std::mem::replace(&mut self.is_connected, true) {
            self.turned += self.strays;
        }
        Ok(())
    }

    fn count(&self) -> Option<i64> {
        self.counts.then_some(self.turned)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        self.released = self.released.map(|times| times + 1);
        Ok(())
    }

    fn limits(&self) -> Option<DriveLimits> {
        self.limits
    }

    fn holds_at_rest(&self) -> bool {
        !self.lets_go
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let (all, sign) = (plan.each_step().count() as u64, i64::from(plan.direction().sign()));
        let mut made = 0;
        while made < all {
            if self.fails_at.is_some_and(|fails_at| made >= fails_at) {
                let error = DriveError::device(Overload { amperes: 7.5 });
                return Err(DriveFault::between(made as i64, made as i64 + 10, error));
            }
            let next = (made + 10).min(all);
            match gate(made, next) {
                Leave::Go => {
                    if self.waits_at == Some(made) {
                        std::thread::sleep(Duration::from_millis(1500));
                    }
                    self.turned += sign * (next - made) as i64;
                    made = next;
                }
                Leave::Wait => {}
                Leave::Stop => break,
            }
        }
        Ok(made)
    }
}

pub(super) fn go(_: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub(super) fn bench(folder: &Path) -> Bench {
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap();
    bench.driven_by(&Servo::default()).unwrap().confirming_pump(true)
}

/// Bench of a servo that tells its count.
pub(super) fn counting(folder: &Path) -> (Bench, Servo) {
    let servo = Servo { counts: true, turned: 7, ..Servo::default() };
    let bench = Bench::new(built_in("three-roller").unwrap(), None, folder).unwrap();
    (bench.driven_by(&servo).unwrap().confirming_pump(true), servo)
}
