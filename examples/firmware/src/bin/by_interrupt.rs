//! A dose from a timer's interrupt, with the motor shared between interrupt and main program.
//!
//! The plan may have more segments than the queue: the main program fills the queue while the motor turns.
#![no_std]
#![no_main]

#[path = "../board.rs"]
#[allow(dead_code, reason = "the other program uses all of it")]
mod board;
#[path = "../pump.rs"]
mod pump;

use core::cell::RefCell;
use core::panic::PanicInfo;

use cortex_m::peripheral::Peripherals;
use cortex_m_rt::{entry, exception};
use cortex_m_semihosting::debug;
use critical_section::Mutex;
use pump_ctl::drive::{Actuator, Fault, OnFault, PinFault, StepDir, Timer, Timing};
use pump_ctl::plan::{Cruise, Doser, Limits, Phase, Ramps, Request};
use pump_ctl::step::{PushError, Stepper, TickRate};

use board::{Alarm, COUNT_HZ, Output, StepPin, Wait, counts};
use pump::{LIMITS, PUMP};

const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).expect("the timer runs");
const COUNTS_PER_TICK: u32 = COUNT_HZ / TICK_RATE.hz();

/// All that interrupt and main program share.
struct Axis {
    actuator: Actuator<StepDir<StepPin, Output, Output, Wait>, 8>,
    alarm: Alarm,
    /// Time in ticks since power-up, and the count at which that tick began.
    ticks: u64,
    began: u32,
    /// Ending of the move, once the motor stands.
    ended: Option<Result<(), Fault<PinFault>>>,
}

static AXIS: Mutex<RefCell<Option<Axis>>> = Mutex::new(RefCell::new(None));

/// Works on the axis while its interrupt waits. Keep the work short.
fn with<R>(work: impl FnOnce(&mut Axis) -> R) -> Option<R> {
    critical_section::with(|cs| AXIS.borrow_ref_mut(cs).as_mut().map(work))
}

impl Axis {
    /// Returns the time in 64 bits, from a counter of 32 bits that wraps. Call it more often than that.
    fn now(&mut self) -> u64 {
        let passed = counts().wrapping_sub(self.began) / COUNTS_PER_TICK;
        self.ticks += u64::from(passed);
        self.began = self.began.wrapping_add(passed * COUNTS_PER_TICK);
        self.ticks
    }

    /// Sets the timer. A time that is past, or too far off for its counter, fires early; `on_timer` then waits on.
    fn fire_at(&mut self, tick: u64) {
        let ahead = tick.saturating_sub(self.now()).min(500_000) as u32;
        self.alarm.set(self.began.wrapping_add(ahead * COUNTS_PER_TICK));
    }

    /// Makes the step that is due.
    fn on_alarm(&mut self) {
        let now = self.now();
        match self.actuator.on_timer(now) {
            Ok(Timer::At(next)) => self.fire_at(next),
            Ok(Timer::Done) => self.end(Ok(())),
            Err(fault) => self.end(Err(fault)),
        }
    }

    fn end(&mut self, ended: Result<(), Fault<PinFault>>) {
        self.alarm.off();
        self.ended = Some(ended);
    }
}

#[exception]
fn SysTick() {
    with(Axis::on_alarm);
}

#[entry]
fn main() -> ! {
    debug::exit(if dose() == Some(true) { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::nop();
    }
}

/// Doses 2 mL. Returns true if the motor stands where the plan ends.
fn dose() -> Option<bool> {
    let core = Peripherals::take()?;
    board::start_counter();
    let pins = StepDir::new(StepPin(Output::new(0)), Output::new(1), Output::new(2), Wait, Timing::default());
    let stepper = Stepper::new(LIMITS.motor.brake(TICK_RATE).ok()?);
    let mut actuator = Actuator::new(pins, stepper, OnFault::Hold);
    // The driver takes its time to wake up: enable it before the interrupt is there.
    actuator.enable().ok()?;
    let axis = Axis { actuator, alarm: Alarm::new(core.SYST), ticks: 0, began: counts(), ended: None };
    critical_section::with(|cs| AXIS.replace(cs, Some(axis)));

    let request = Request::new(2.0, Cruise::Flow { ml_s: 5.0 }).with_ramps(Ramps::Fastest);
    let doser = Doser::new(&PUMP, Limits::new(LIMITS.motor)).ok()?;
    let plan = doser.plan(Phase::known(0.3), &request).ok()?;

    // Segments are computed out here, with interrupts on, and pushed inside. The end comes first: if this program
    // falls behind, the motor still never goes beyond it.
    let mut segments = plan.segments(TICK_RATE).peekable();
    with(|axis| axis.actuator.stepper().set_end(plan.steps()))?.ok()?;
    let mut started = false;
    while let Some(segment) = segments.peek() {
        match with(|axis| axis.actuator.stepper().push(*segment, TICK_RATE))? {
            Ok(()) => drop(segments.next()),
            Err(PushError::Full) if started => {}
            Err(PushError::Full) => {
                start()?;
                started = true;
            }
            // A fault has stopped the motor; it is told below.
            Err(_) => break,
        }
    }
    if !started {
        start()?;
    }

    let ended = loop {
        if let Some(ended) = with(|axis| axis.ended)? {
            break ended;
        }
    };
    let position = with(|axis| axis.actuator.stepper().position())?;
    Some(ended == Ok(()) && position == plan.steps())
}

fn start() -> Option<()> {
    with(|axis| {
        let now = axis.now();
        let due = axis.actuator.start(now).ok()?;
        axis.fire_at(due);
        Some(())
    })?
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}
