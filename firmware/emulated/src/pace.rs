//! The hold that a test has on the board's time, over the second serial port.
//!
//! At the end of its leave the board stops its clock. It says where it stands: the tick, 8 bytes, and the number of
//! bytes that it has sent over the link since the reset, 4 bytes. The test answers with a leave: the tick of its end,
//! 8 bytes, and the number of bytes that it has sent, 4 bytes. Once these bytes are all there, the clock goes on. All
//! numbers are little-endian. So a slow computer delays neither side's time.

use cortex_m::asm::wfi;

use crate::registers::STRAP;
use crate::serial::Serial;
use crate::step_timer::{self, SharedAxes, StepTimer};

/// Bytes of a leave.
const LEAVE: usize = 12;

/// The board's leave to go on.
pub(crate) struct Pace {
    port: Serial,
    until: u64,
}

impl Pace {
    /// Begins with no leave, or with leave for ever if the emulator's command line asks for no hold.
    pub(crate) fn new(port: Serial) -> Self {
        Self { port, until: if STRAP.read() == 0 { u64::MAX } else { 0 } }
    }

    /// Returns true if a test holds the board's time.
    pub(crate) fn holds(&self) -> bool {
        self.until != u64::MAX
    }

    /// Returns the tick at which the leave ends.
    pub(crate) fn until(&self) -> u64 {
        self.until
    }

    /// Waits at the end of the leave for another one, and for the bytes of the link that belong to it.
    pub(crate) fn wait(&mut self, timer: &mut StepTimer, axes: &mut SharedAxes, link: &Serial) {
        timer.hold(axes, || {
            let [tick, sent] = [step_timer::now(), link.sent().into()];
            self.port.send(&tick.to_le_bytes());
            self.port.send(&sent.to_le_bytes()[..4]);
            let mut leave = [0; LEAVE];
            let mut there = 0;
            loop {
                cortex_m::interrupt::disable();
                while let Some(place) = leave.get_mut(there) {
                    let Some(byte) = self.port.take() else { break };
                    *place = byte;
                    there += 1;
                }
                let [a, b, c, d, e, f, g, h, rest @ ..] = leave;
                let is_all = there == LEAVE && link.arrived() == u32::from_le_bytes(rest);
                if !is_all {
                    // An interrupt that came since the question ends it at once.
                    wfi();
                }
                enable_interrupts();
                if is_all {
                    self.until = u64::from_le_bytes([a, b, c, d, e, f, g, h]);
                    return;
                }
            }
        });
    }
}

#[allow(unsafe_code)]
fn enable_interrupts() {
    // SAFETY: no critical section is under way.
    unsafe { cortex_m::interrupt::enable() };
}
