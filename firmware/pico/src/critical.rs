//! The critical sections of the thread: those of the axes, and those of the USB port.
//!
//! Where the alarm of the steps is near, its interrupt comes first. So no step waits for a section that is shorter than
//! the time that is kept clear before the alarm, unless steps leave no such time for [`PATIENCE`].
#![allow(unsafe_code)]

use cortex_m::asm;
use cortex_m::interrupt;
use cortex_m::register::primask;
use critical_section::{Impl, RawRestoreState, set_impl};

use crate::step_timer::{alarm_is_near, low};

/// Longest time for which the thread waits until the alarm is not near, ticks.
const PATIENCE: u32 = 250;

/// Critical sections of the one core that runs.
struct Clear;

set_impl!(Clear);

// SAFETY: interrupts are off from `acquire` to `release`, and the other core never starts.
unsafe impl Impl for Clear {
    unsafe fn acquire() -> RawRestoreState {
        let were_on = primask::read().is_active();
        let mut waits_since = None;
        loop {
            interrupt::disable();
            if !were_on || !alarm_is_near() {
                return were_on;
            }
            let since = *waits_since.get_or_insert_with(low);
            if low().wrapping_sub(since) >= PATIENCE {
                return were_on;
            }
            // SAFETY: interrupts were on.
            unsafe { interrupt::enable() };
            // With the barrier, an interrupt that waits is taken here (Arm application note 321).
            asm::isb();
        }
    }

    unsafe fn release(were_on: RawRestoreState) {
        if were_on {
            // SAFETY: interrupts were on before the section.
            unsafe { interrupt::enable() };
        }
    }
}
