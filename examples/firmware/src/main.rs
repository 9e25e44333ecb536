//! Doses on a Cortex-M4 without f64 in hardware. The dose is planned there and stepped from a timer's
//! interrupt. The program needs neither an operating system nor an allocator.
//!
//! It runs on the board MPS2 with the AN386 image, which QEMU emulates:
//!
//! ```text
//! rustup target add thumbv7em-none-eabihf
//! apt-get install --no-install-recommends qemu-system-arm
//! cd examples/firmware && cargo run --release
//! ```
//!
//! # How it works
//!
//! The pump is a constant ([`pump`]), printed by `dose pumps show three-roller --format rust`. The main
//! program plans ([`dose`]) and queues all of the plan's integer segments, 18 here. All work in f64 is done
//! before the motor starts. Then the interrupt ([`machine`]) calls `Actuator::on_timer`, which makes the
//! step that is due by the pins of [`board`] and says when the next is. The interrupt sets SysTick for
//! that. Deadlines are absolute, in microseconds of a free-running timer, so that latencies do not add up.
//! The main program stops or changes the move in a critical section of some 1,500 instructions ([`runs`]).
//! A change is planned beside the interrupts, while the old plan goes on.
//!
//! Wiring: GPIO 0 pin 0 to STEP, 1 to DIR, 2 to nENABLE of a DRV8825 or the like. On another board exchange `board.rs`,
//! `memory.x` and `.cargo/config.toml`, and measure `LEAD` in `machine.rs` anew.
//!
//! # Output
//!
//! - The plan of 25 mL from 0.3 rad at 5 mL/s: every number and its 64 bits, then every segment.
//! - `run: whole`, `run: stopped` (after 2 s), `run: changed` (to 20 mL at 3 mL/s after 2 s). Each step has the time
//!   at which it was due, in us since the start, and the time at which its pin rose, in counts of 40 ns. The position
//!   follows.
//! - `cost:` in instructions ([`measure`]), and `memory:`. To enter and leave an interrupt takes a real Cortex-M4 some
//!   24 cycles more; the emulator counts none.
//! - `end`.
//!
//! `check.rs` doses on the host and compares; `make embedded` runs both. A real board's clock is another: leave out
//! [`measure::check_clock`] there, and read `cost:` as five times the counts of its timer.
//!
//! # The emulated time
//!
//! With `-icount shift=3` an instruction takes 2^3 = 8 ns: 125 million a second, much as a Cortex-M4 at 168 MHz.
//! All times are then the same on every host. The timers count at 25 MHz, so a count is five instructions, which
//! [`measure::check_clock`] verifies. Do not wait by `wfi` there: the emulator then waits in the host's time. Do not
//! reload the CMSDK timer in its interrupt, which adds latency. It runs freely here, and SysTick interrupts.
#![no_std]
#![no_main]

mod board;
mod dose;
mod machine;
mod measure;
mod memory;
mod output;
mod pump;
mod runs;

use core::fmt::Write;
use core::panic::PanicInfo;

use cortex_m::peripheral::Peripherals;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, heprintln};
use pump_ctl::drive::{Actuator, OnFault, StepDir, Timing};
use pump_ctl::step::Stepper;

use board::{Alarm, Output, StepPin, Wait};
use machine::{Machine, Made, Record};

#[entry]
fn main() -> ! {
    install();
    write_all().expect("the host takes what is written");
    debug::exit(debug::EXIT_SUCCESS);
    unreachable!("the host ends the emulation")
}

/// Makes the machine. It is not inlined, so that its part of the stack is free afterwards.
#[inline(never)]
fn install() {
    let core = Peripherals::take().expect("nobody has taken them before");
    let record = cortex_m::singleton!(: Record = [Made { due: 0, rose: 0 }; 16_384]);
    board::start_counter();
    let pins = StepDir::new(StepPin(Output::new(0)), Output::new(1), Output::new(2), Wait, Timing::default());
    let brake = pump::LIMITS.motor.brake(dose::TICK_RATE).expect("the motor can be stopped");
    let executor = Stepper::new(brake);
    let mut actuator = Actuator::new(pins, executor, OnFault::Hold);
    actuator.enable().expect("these pins do not fail");
    Machine::install(actuator, Alarm::new(core.SYST), record.expect("it is made once"));
}

fn write_all() -> core::fmt::Result {
    let mut out = output::Buffered::new();
    measure::check_clock();
    let plan = measure::plan(&mut out)?;
    measure::executor(&mut out, &plan)?;
    runs::whole(&mut out, &plan)?;
    runs::stopped(&mut out, &plan)?;
    runs::changed(&mut out, &plan)?;
    measure::memory(&mut out)?;
    writeln!(out, "end")?;
    out.flush()
}

/// Reports place and reason of a panic, and ends the emulation with a failure.
#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    heprintln!("{}", info);
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}
