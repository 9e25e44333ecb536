//! A dose from a timer's interrupt under RTIC, with the motor shared between a task and the idle loop.
//!
//! The plan may have more segments than the queue: the idle loop fills the queue while the motor turns.
#![no_std]
#![no_main]

#[path = "../board.rs"]
#[allow(dead_code, reason = "the other program uses all of it")]
mod board;
#[path = "../pump.rs"]
mod pump;

use core::panic::PanicInfo;

use cortex_m_rt as _;
use cortex_m_semihosting::debug;

/// Device crate as RTIC asks for it. This board has none, and its own interrupts are not used.
mod device {
    /// Bits of a priority (`__NVIC_PRIO_BITS` of the AN386).
    pub const NVIC_PRIO_BITS: u8 = 3;
}

#[rtic::app(device = crate::device, peripherals = false)]
mod app {
    use cortex_m_semihosting::debug;
    use pump_ctl::drive::{Actuator, Fault, OnFault, PinFault, StepDir, Timer, Timing};
    use pump_ctl::plan::{Cruise, Doser, Limits, Phase, Ramps, Request};
    use pump_ctl::step::{PushError, Stepper, TickRate};
    use rtic::Mutex;

    use crate::board::{self, Alarm, COUNT_HZ, Output, StepPin, Wait, counts};
    use crate::pump::{LIMITS, PUMP};

    const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).expect("the timer runs");
    const COUNTS_PER_TICK: u32 = COUNT_HZ / TICK_RATE.hz();

    #[shared]
    struct Shared {
        axis: Axis,
    }

    #[local]
    struct Local {}

    /// Motor and its timer.
    pub struct Axis {
        actuator: Actuator<StepDir<StepPin, Output, Output, Wait>, 8>,
        alarm: Alarm,
        /// Time in ticks since power-up, and the count at which that tick began.
        ticks: u64,
        began: u32,
        /// Ending of the move, once the motor stands.
        ended: Option<Result<(), Fault<PinFault>>>,
    }

    #[init]
    fn init(context: init::Context) -> (Shared, Local) {
        board::start_counter();
        let pins =
            StepDir::new(StepPin(Output::new(0)), Output::new(1), Output::new(2), Wait, Timing::default());
        let brake = LIMITS.motor.brake(TICK_RATE).expect("the pump file was checked");
        let mut actuator = Actuator::new(pins, Stepper::new(brake), OnFault::Hold);
        // Interrupts are still off, so the driver may take its time to wake up.
        actuator.enable().expect("these pins do not fail");
        let alarm = Alarm::new(context.core.SYST);
        (Shared { axis: Axis { actuator, alarm, ticks: 0, began: counts(), ended: None } }, Local {})
    }

    /// Makes the step that is due. Any priority above that of longer work will do.
    #[task(binds = SysTick, priority = 2, shared = [axis])]
    fn step(mut context: step::Context) {
        context.shared.axis.lock(|axis| {
            let now = axis.now();
            match axis.actuator.on_timer(now) {
                Ok(Timer::At(next)) => axis.fire_at(next),
                Ok(Timer::Done) => axis.end(Ok(())),
                Err(fault) => axis.end(Err(fault)),
            }
        });
    }

    #[idle(shared = [axis])]
    fn idle(mut context: idle::Context) -> ! {
        let is_whole = dose(&mut context.shared.axis) == Some(true);
        debug::exit(if is_whole { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
        loop {
            cortex_m::asm::nop();
        }
    }

    /// Doses 2 mL. Returns true if the motor stands where the plan ends.
    fn dose(axis: &mut impl Mutex<T = Axis>) -> Option<bool> {
        let request = Request::new(2.0, Cruise::Flow { ml_s: 5.0 }).with_ramps(Ramps::Fastest);
        let doser = Doser::new(&PUMP, Limits::new(LIMITS.motor)).ok()?;
        let plan = doser.plan(Phase::known(0.3), &request).ok()?;

        // Segments are computed out here, with interrupts on, and pushed inside. The end comes first: if this loop
        // falls behind, the motor still never goes beyond it.
        let mut segments = plan.segments(TICK_RATE).peekable();
        axis.lock(|axis| axis.actuator.stepper().set_end(plan.steps())).ok()?;
        let mut started = false;
        while let Some(segment) = segments.peek() {
            match axis.lock(|axis| axis.actuator.stepper().push(*segment, TICK_RATE)) {
                Ok(()) => drop(segments.next()),
                Err(PushError::Full) if started => {}
                Err(PushError::Full) => {
                    axis.lock(Axis::start)?;
                    started = true;
                }
                // A fault has stopped the motor; it is told below.
                Err(_) => break,
            }
        }
        if !started {
            axis.lock(Axis::start)?;
        }

        let ended = loop {
            if let Some(ended) = axis.lock(|axis| axis.ended) {
                break ended;
            }
        };
        let position = axis.lock(|axis| axis.actuator.stepper().position());
        Some(ended == Ok(()) && position == plan.steps())
    }

    impl Axis {
        /// Begins the move whose segments are queued.
        fn start(&mut self) -> Option<()> {
            let now = self.now();
            let due = self.actuator.start(now).ok()?;
            self.fire_at(due);
            Some(())
        }

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

        fn end(&mut self, ended: Result<(), Fault<PinFault>>) {
            self.alarm.off();
            self.ended = Some(ended);
        }
    }
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}
