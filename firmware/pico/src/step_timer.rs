//! The timer that makes the steps: 64 bits at 1 MHz, and its alarm 0.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use pump_node::{Axes, Axis, Shared};
use rp2040_hal::pac::{self, Interrupt, NVIC, RESETS, TIMER, interrupt};

use crate::axis_pins::AxisPins;
use crate::pico::Pico;
use crate::{AXES, QUEUE};

/// Rate of the timer, Hz.
pub(crate) const TICK_HZ: u32 = 1_000_000;

/// Farthest tick for which the alarm is set. It compares 32 bits.
const FARTHEST: u64 = 1 << 30;

/// Time before the alarm of the steps in which the thread enters no critical section, ticks. Most take less, and the
/// clock tells whole ticks.
const CLEAR: u32 = 8;

type NodeAxes = Axes<'static, AxisPins, Pico, QUEUE, AXES>;

/// Place of something that the firmware's image does not hold, unlike a value.
struct Place<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: the thread uses the axes within critical sections alone. The interrupt uses them, has the highest priority
// and is on from the moment when they are there.
unsafe impl<T> Sync for Place<T> {}

static AXES_OF_NODE: Place<NodeAxes> = Place(UnsafeCell::new(MaybeUninit::uninit()));
static EACH_AXIS: Place<[MaybeUninit<Axis<AxisPins, QUEUE>>; AXES]> =
    Place(UnsafeCell::new(MaybeUninit::uninit()));

/// Priorities of the interrupts: that of the steps comes before all others (ARMv6-M has four, in the upper bits).
const FIRST: u8 = 0;
const SECOND: u8 = 1 << 6;

/// Timer with its alarms off.
pub(crate) struct StepTimer(());

impl StepTimer {
    /// Takes the timer, which counts µs.
    pub(crate) fn new(timer: TIMER, resets: &mut RESETS) -> Self {
        resets.reset().modify(|_, word| word.timer().clear_bit());
        while resets.reset_done().read().timer().bit_is_clear() {}
        timer.inte().write(|word| word.alarm_0().set_bit().alarm_1().set_bit());
        Self(())
    }
}

/// Lets the interrupt of the steps interrupt the others.
pub(crate) fn put_steps_first(interrupts: &mut NVIC) {
    // SAFETY: no critical section relies on priorities.
    unsafe {
        interrupts.set_priority(Interrupt::TIMER_IRQ_0, FIRST);
        interrupts.set_priority(Interrupt::TIMER_IRQ_1, SECOND);
        interrupts.set_priority(Interrupt::UART0_IRQ, SECOND);
        interrupts.set_priority(Interrupt::USBCTRL_IRQ, SECOND);
    }
}

fn timer() -> &'static pac::timer::RegisterBlock {
    // SAFETY: the registers used here are read, or written by the interrupt and within critical sections.
    unsafe { &*TIMER::ptr() }
}

/// Returns the tick, µs since the reset.
#[inline(always)]
pub(crate) fn now() -> u64 {
    let timer = timer();
    loop {
        let high = timer.timerawh().read().bits();
        let low = timer.timerawl().read().bits();
        if timer.timerawh().read().bits() == high {
            return (u64::from(high) << 32) | u64::from(low);
        }
    }
}

/// Waits for a tick that is near, if it has not passed.
#[inline(always)]
pub(crate) fn wait_until(tick: u64) {
    let timer = timer();
    // The difference of the lower halves is small and positive until the tick.
    while (tick as u32).wrapping_sub(timer.timerawl().read().bits()) as i32 > 0 {}
}

/// Sleeps until a tick or the next interrupt, whichever comes first. It does not sleep if the thread `is_asked`.
pub(crate) fn sleep_until(tick: u64, is_asked: impl Fn() -> bool) {
    timer().alarm1().write(|word| unsafe { word.bits(tick as u32) });
    // An interrupt between the look and the sleep would wake nobody. While it is kept off it ends the sleep, and comes
    // just afterwards (ARMv6-M, section B1.5.19: WFI).
    cortex_m::interrupt::disable();
    // The alarm compares for equality, so a tick that has passed would not wake.
    if now() < tick && !is_asked() {
        cortex_m::asm::wfi();
    }
    // SAFETY: interrupts were on.
    unsafe { cortex_m::interrupt::enable() };
}

/// Returns the lower half of the tick.
#[inline(always)]
pub(crate) fn low() -> u32 {
    timer().timerawl().read().bits()
}

/// Returns true if the alarm of the steps has come, or comes soon.
pub(crate) fn alarm_is_near() -> bool {
    if !NVIC::is_enabled(Interrupt::TIMER_IRQ_0) {
        return false;
    }
    let (timer, set) = (timer(), 1 << 0);
    // The alarm is disarmed when it comes.
    let is_armed = timer.armed().read().bits() & set != 0;
    let has_come = timer.intr().read().bits() & set != 0;
    has_come || is_armed && timer.alarm0().read().bits().wrapping_sub(low()) < CLEAR
}

/// Axes that the thread and the interrupt share.
pub(crate) struct SharedAxes(());

impl SharedAxes {
    /// Makes the axes, and gives them to the interrupt. The timer is taken, so it happens once.
    pub(crate) fn new(_: StepTimer) -> Self {
        // SAFETY: the interrupts are off, and find what they need from here on. Each place is written before its use.
        unsafe {
            let places = (*EACH_AXIS.0.get()).assume_init_mut();
            AxisPins::ALL.into_iter().zip(places.iter_mut()).for_each(|(pins, place)| make(pins, place));
            let axes = (*EACH_AXIS.0.get().cast::<MaybeUninit<_>>()).assume_init_mut();
            (*AXES_OF_NODE.0.get()).write(Axes::new(axes, Pico, TICK_HZ));
            NVIC::unmask(Interrupt::TIMER_IRQ_0);
            NVIC::unmask(Interrupt::TIMER_IRQ_1);
        }
        Self(())
    }

    /// Returns true if any motor moves.
    pub(crate) fn is_moving(&mut self) -> bool {
        critical_section::with(|_| {
            // SAFETY: `new` has put the axes there, and the interrupt is kept off. A look does not change the alarm.
            let axes = unsafe { (*AXES_OF_NODE.0.get()).assume_init_ref() };
            axes.is_moving()
        })
    }
}

/// Makes an axis in its place. The stack holds one axis at a time.
#[inline(never)]
fn make(pins: AxisPins, place: &mut MaybeUninit<Axis<AxisPins, QUEUE>>) {
    place.write(Axis::new(pins, TICK_HZ));
}

impl Shared<AxisPins, Pico, QUEUE, AXES> for SharedAxes {
    // In memory as a whole (memory.x).
    #[inline(never)]
    fn with<R>(&mut self, act: impl FnOnce(&mut Axes<'_, AxisPins, Pico, QUEUE, AXES>) -> R) -> R {
        critical_section::with(|_| {
            // SAFETY: `new` has put the axes there, and the interrupt is kept off.
            let axes = unsafe { (*AXES_OF_NODE.0.get()).assume_init_mut() };
            let result = act(axes);
            set_alarm(axes.next_alarm());
            result
        })
    }

    #[inline(never)]
    fn with_steps_as_due<R>(
        &mut self,
        act: impl FnOnce(&mut Axes<'_, AxisPins, Pico, QUEUE, AXES>) -> R,
    ) -> R {
        critical_section::with(|_| {
            // SAFETY: `new` has put the axes there, and the interrupt is kept off.
            act(unsafe { (*AXES_OF_NODE.0.get()).assume_init_mut() })
        })
    }
}

/// Sets the alarm for a tick, or has the interrupt come at once.
fn set_alarm(tick: Option<u64>) {
    let Some(tick) = tick else { return };
    let tick = tick.min(now() + FARTHEST) as u32;
    timer().alarm0().write(|word| unsafe { word.bits(tick) });
    // The alarm compares for equality, and the difference of the lower halves is positive until the tick.
    if tick.wrapping_sub(low()) as i32 <= 0 {
        NVIC::pend(Interrupt::TIMER_IRQ_0);
    }
}

#[interrupt]
fn TIMER_IRQ_0() {
    timer().intr().write(|word| word.alarm_0().clear_bit_by_one());
    // SAFETY: `SharedAxes::new` has put the axes there before the interrupt was on, and nothing interrupts this one.
    let axes = unsafe { (*AXES_OF_NODE.0.get()).assume_init_mut() };
    set_alarm(axes.on_timer());
}

#[interrupt]
fn TIMER_IRQ_1() {
    timer().intr().write(|word| word.alarm_1().clear_bit_by_one());
}
