//! The clock of the board, 64 bits at 1 MHz, and the alarm that makes the steps.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use cortex_m::peripheral::{NVIC, SYST, syst::SystClkSource};
use pump_node::{Axes, Axis, Shared};

use crate::axis_pins::AxisPins;
use crate::mps2::Mps2;
use crate::registers::{ALARM, CLOCK, COUNT_HZ, Interrupt, TIMER_INTERRUPTS, TIMER_RUNS};
use crate::{AXES, QUEUE};

/// Rate of the ticks, Hz.
pub(crate) const TICK_HZ: u32 = 1_000_000;

/// Counts of the timers in a tick.
const COUNTS: u32 = COUNT_HZ / TICK_HZ;

/// Farthest tick for which the alarm is set, ticks from now.
const FARTHEST: u64 = 2 * TICK_HZ as u64;

/// Time before the alarm in which the thread enters no critical section, counts: 12 us.
const CLEAR: u32 = 12 * COUNTS;

/// Longest time for which the thread waits until the alarm is not near, counts: 60 us.
const PATIENCE: u32 = 60 * COUNTS;

/// Longest time of SysTick, which has 24 bits, ticks.
const LONGEST_SLEEP: u64 = (0xff_ffff / COUNTS) as u64;

/// A tick, and the count at its begin. Ticks are counted from there.
#[derive(Clone, Copy)]
struct Known {
    tick: u64,
    count: u32,
}

type NodeAxes = Axes<'static, AxisPins, Mps2, QUEUE, AXES>;

/// Place of what thread and interrupt share.
struct Place<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: the thread uses the axes, and writes the known tick, within critical sections alone. The interrupt uses the
// axes and reads the tick, has the highest priority and is on from the moment when they are there.
unsafe impl<T> Sync for Place<T> {}

static AXES_OF_NODE: Place<NodeAxes> = Place(UnsafeCell::new(MaybeUninit::uninit()));
static EACH_AXIS: Place<[MaybeUninit<Axis<AxisPins, QUEUE>>; AXES]> =
    Place(UnsafeCell::new(MaybeUninit::uninit()));
static KNOWN: Place<Known> = Place(UnsafeCell::new(MaybeUninit::new(Known { tick: 0, count: 0 })));

/// Count at which the alarm was last set to come.
static ALARM_AT: AtomicU32 = AtomicU32::new(0);

/// Returns the counts of the clock, which wraps after 171 s. The timer counts down.
#[inline(always)]
fn count() -> u32 {
    !CLOCK.value.read()
}

#[inline(always)]
fn known() -> Known {
    // SAFETY: there from the start. The thread alone writes it, where no interrupt reads.
    unsafe { (*KNOWN.0.get()).assume_init() }
}

/// Returns the tick, us since the reset.
#[inline(always)]
pub(crate) fn now() -> u64 {
    let known = known();
    known.tick + u64::from(count().wrapping_sub(known.count) / COUNTS)
}

/// Keeps the clock from wrapping unseen. The thread calls it every ms.
pub(crate) fn keep() {
    cortex_m::interrupt::free(|_| {
        let Known { tick, count: from } = known();
        let passed = count().wrapping_sub(from) / COUNTS;
        let known = Known { tick: tick + u64::from(passed), count: from.wrapping_add(passed * COUNTS) };
        // SAFETY: no interrupt reads meanwhile.
        unsafe { (*KNOWN.0.get()).write(known) };
    });
}

/// Returns the counts from now to a tick. The result is negative if it has passed, and [`FARTHEST`] at most.
#[inline(always)]
fn counts_until(tick: u64) -> i32 {
    let known = known();
    let ahead = tick.saturating_sub(known.tick).min(FARTHEST) as u32;
    known.count.wrapping_add(ahead * COUNTS).wrapping_sub(count()) as i32
}

/// Waits for a tick that is near, if it has not passed.
#[inline(always)]
pub(crate) fn wait_until(tick: u64) {
    let known = known();
    let at = known.count.wrapping_add((tick.saturating_sub(known.tick) as u32).wrapping_mul(COUNTS));
    while at.wrapping_sub(count()) as i32 > 0 {}
}

/// Clock that runs.
pub(crate) struct StepTimer(SYST);

impl StepTimer {
    /// Starts the clock at tick 0.
    pub(crate) fn new(mut sleep: SYST) -> Self {
        sleep.set_clock_source(SystClkSource::Core);
        sleep.enable_interrupt();
        CLOCK.reload.write(u32::MAX);
        CLOCK.value.write(u32::MAX);
        CLOCK.control.write(TIMER_RUNS);
        ALARM.reload.write(u32::MAX);
        Self(sleep)
    }

    /// Sleeps until a tick or an interrupt, whichever comes first, unless `is_awake`.
    pub(crate) fn sleep_until(&mut self, tick: u64, is_awake: impl FnOnce() -> bool) {
        // With interrupts off none is missed between the question and the sleep, which they still end.
        cortex_m::interrupt::disable();
        let ahead = counts_until(tick.min(now() + LONGEST_SLEEP));
        if ahead > 0 && !is_awake() {
            self.0.set_reload(ahead.unsigned_abs());
            self.0.clear_current();
            self.0.enable_counter();
            cortex_m::asm::wfi();
            self.0.disable_counter();
        }
        // SAFETY: no critical section is under way.
        unsafe { cortex_m::interrupt::enable() };
    }

    /// Holds the board's time while `wait` runs. The axes and their alarm stand meanwhile, serial ports go on.
    pub(crate) fn hold(&mut self, axes: &mut SharedAxes, wait: impl FnOnce()) {
        keep_clear();
        NVIC::mask(Interrupt::Alarm);
        ALARM.control.write(TIMER_INTERRUPTS);
        CLOCK.control.write(0);
        wait();
        CLOCK.control.write(TIMER_RUNS);
        // SAFETY: no critical section is under way.
        unsafe { NVIC::unmask(Interrupt::Alarm) };
        axes.set_alarm();
    }
}

/// Waits while the alarm is near, so that a critical section does not hold up the interrupt.
fn keep_clear() {
    let began = count();
    loop {
        let now = count();
        let near = ALARM_AT.load(Relaxed).wrapping_sub(now) < CLEAR;
        if !near || now.wrapping_sub(began) >= PATIENCE {
            return;
        }
    }
}

/// Axes that the thread and the interrupt share.
pub(crate) struct SharedAxes(());

impl SharedAxes {
    /// Makes the axes, and gives them to the interrupt.
    pub(crate) fn new(_: &StepTimer) -> Self {
        // SAFETY: the interrupt is off, and finds what it needs from here on. Each place is written before it is used.
        unsafe {
            let places = (*EACH_AXIS.0.get()).assume_init_mut();
            AxisPins::ALL.into_iter().zip(places.iter_mut()).for_each(|(pins, place)| make(pins, place));
            let axes = (*EACH_AXIS.0.get().cast::<MaybeUninit<_>>()).assume_init_mut();
            (*AXES_OF_NODE.0.get()).write(Axes::new(axes, Mps2, TICK_HZ));
            NVIC::unmask(Interrupt::Alarm);
        }
        Self(())
    }

    /// Sets the alarm, which was off.
    fn set_alarm(&mut self) {
        cortex_m::interrupt::free(|_| {
            // SAFETY: `new` has put the axes there, and the interrupt is kept off.
            set_alarm(unsafe { (*AXES_OF_NODE.0.get()).assume_init_mut() }.next_alarm());
        });
    }
}

/// Makes an axis in its place. The stack holds one axis at a time.
#[inline(never)]
fn make(pins: AxisPins, place: &mut MaybeUninit<Axis<AxisPins, QUEUE>>) {
    place.write(Axis::new(pins, TICK_HZ));
}

impl Shared<AxisPins, Mps2, QUEUE, AXES> for SharedAxes {
    fn with<R>(&mut self, act: impl FnOnce(&mut Axes<'_, AxisPins, Mps2, QUEUE, AXES>) -> R) -> R {
        keep_clear();
        cortex_m::interrupt::free(|_| {
            // SAFETY: `new` has put the axes there, and the interrupt is kept off.
            let axes = unsafe { (*AXES_OF_NODE.0.get()).assume_init_mut() };
            let result = act(axes);
            set_alarm(axes.next_alarm());
            result
        })
    }
}

/// Sets the alarm for a tick, or has the interrupt come at once.
fn set_alarm(tick: Option<u64>) {
    let Some(tick) = tick else { return };
    match counts_until(tick) {
        ahead @ 1.. => {
            ALARM_AT.store(count().wrapping_add(ahead.unsigned_abs()), Relaxed);
            ALARM.value.write(ahead.unsigned_abs());
            ALARM.control.write(TIMER_RUNS | TIMER_INTERRUPTS);
        }
        _ => NVIC::pend(Interrupt::Alarm),
    }
}

/// Makes the steps that are due. It is called by the alarm's interrupt.
pub(crate) fn on_alarm() {
    ALARM.clear.write(1);
    // SAFETY: `SharedAxes::new` has put the axes there before the interrupt was on, and nothing interrupts this one.
    let axes = unsafe { (*AXES_OF_NODE.0.get()).assume_init_mut() };
    set_alarm(axes.on_timer());
}
