//! The functions that the page calls. The page reads and writes the memory behind the places that they return.

#![allow(unsafe_code, reason = "names that a page can call, and one dose that every call shares")]

use core::cell::UnsafeCell;
use core::panic::PanicInfo;

use crate::Demo;

/// The dose of this page.
struct Shared(UnsafeCell<Demo>);

// SAFETY: the module has no shared memory, so one thread of the browser makes every call.
unsafe impl Sync for Shared {}

static SHARED: Shared = Shared(UnsafeCell::new(Demo::new()));

/// Lets `act` have the dose.
fn with<T>(act: impl FnOnce(&mut Demo) -> T) -> T {
    // SAFETY: no other reference lives. A call ends before the next one begins, as nothing here calls the page, and
    // no `act` below calls `with`.
    act(unsafe { &mut *SHARED.0.get() })
}

/// Ends the call of the page with an error. No input leads here.
#[panic_handler]
fn stop(_: &PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}

// SAFETY of each name below: no other function of the module has it.

/// Returns the place of the settings.
#[unsafe(no_mangle)]
pub extern "C" fn settings() -> *mut f64 {
    with(|demo| demo.settings_mut().as_mut_ptr())
}

/// Plans the dose. Returns 1, or 0 if it is refused.
#[unsafe(no_mangle)]
pub extern "C" fn plan() -> u32 {
    with(|demo| u32::from(demo.plan()))
}

/// Returns the place of the figures.
#[unsafe(no_mangle)]
pub extern "C" fn facts() -> *const f64 {
    with(|demo| demo.facts().as_ptr())
}

/// Computes the cautions of a smooth flow. Returns 1, or 0 if there are none.
#[unsafe(no_mangle)]
pub extern "C" fn cautions() -> u32 {
    with(|demo| u32::from(demo.cautions()))
}

/// Returns the place of the figures of the cautions.
#[unsafe(no_mangle)]
pub extern "C" fn caution_figures() -> *const f64 {
    with(|demo| demo.caution_figures().as_ptr())
}

/// Returns the place of the refusal's text.
#[unsafe(no_mangle)]
pub extern "C" fn refusal() -> *const u8 {
    with(|demo| demo.refusal().as_ptr())
}

/// Returns the number of bytes of the refusal's text.
#[unsafe(no_mangle)]
pub extern "C" fn refusal_length() -> usize {
    with(|demo| demo.refusal().len())
}

/// Computes the waveform every `dt_s`. Returns the number of rows.
#[unsafe(no_mangle)]
pub extern "C" fn trace(dt_s: f64) -> usize {
    with(|demo| demo.trace(dt_s))
}

/// Returns the place of a column of the waveform, or null.
#[unsafe(no_mangle)]
pub extern "C" fn column(number: usize) -> *const f64 {
    with(|demo| demo.columns().get(number).map_or(core::ptr::null(), |column| column.as_ptr()))
}

/// Computes the errors over the start angle. Returns the number of angles.
#[unsafe(no_mangle)]
pub extern "C" fn errors() -> usize {
    with(Demo::errors)
}

/// Returns the place of a column of the errors, or null.
#[unsafe(no_mangle)]
pub extern "C" fn error_column(number: usize) -> *const f64 {
    with(|demo| demo.error_columns().get(number).map_or(core::ptr::null(), |column| column.as_ptr()))
}

/// Computes the times of the steps after step `made`. Returns their number.
#[unsafe(no_mangle)]
pub extern "C" fn steps(made: u32) -> usize {
    with(|demo| demo.steps(u64::from(made)))
}

/// Returns the place of the times of the steps.
#[unsafe(no_mangle)]
pub extern "C" fn step_times() -> *const f64 {
    with(|demo| demo.step_times().as_ptr())
}
