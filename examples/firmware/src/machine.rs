//! The motor, shared by the main program and the timer's interrupt.

use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use cortex_m_rt::exception;
use critical_section::Mutex;
use pump_ctl::drive::{Actuator, Fault, PinFault, StepDir, Timer};
use pump_ctl::plan::Plan;
use pump_ctl::step::{Junction, Segment, StopPlan};

use crate::board::{Alarm, COUNT_HZ, Output, StepPin, Wait, counts};
use crate::dose::{QUEUE, TICK_HZ, TICK_RATE, queue};

/// Driver with step, direction and enable pin.
pub type Driver = StepDir<StepPin, Output, Output, Wait>;

/// Number of counts of a tick.
const TICK: u32 = COUNT_HZ / TICK_HZ;

/// Time by which the alarm goes off before a deadline, counts. From the alarm to the pin it takes 26 inside
/// a segment, 32 into the next, 53 down the brake. With this lead all are within 20 of the deadline, which
/// is less than a tick.
const LEAD: u32 = 34;

/// Step as it was made.
#[derive(Clone, Copy)]
pub struct Made {
    /// Time at which the step was due, ticks since the start.
    pub due: u32,
    /// Time at which the step's pin rose, counts since the start.
    pub rose: u32,
}

/// Room for the steps of a move.
pub type Record = [Made; 16_384];

/// Clock in ticks since power-up, [`LEAD`] ahead: the time at which a step that is made now will be seen at
/// the pin.
struct Clock {
    ticks: u64,
    /// [`counts`] at the moment at which that tick begins.
    began: u32,
}

impl Clock {
    /// Returns the time in ticks. It must be called every 171 s at least.
    fn now(&mut self) -> u64 {
        let passed = counts().wrapping_sub(self.began) / TICK;
        self.ticks += u64::from(passed);
        self.began = self.began.wrapping_add(passed * TICK);
        self.ticks
    }

    /// Returns [`counts`] at the moment at which `tick` begins, or 2 s from now if that is farther off.
    fn counts_at(&self, tick: u64) -> u32 {
        let ahead = tick.saturating_sub(self.ticks).min(u64::from(2 * TICK_HZ)) as u32;
        self.began.wrapping_add(ahead * TICK)
    }
}

pub struct Machine {
    actuator: Actuator<Driver, QUEUE>,
    alarm: Alarm,
    clock: Clock,
    /// Deadline for which the alarm is set, ticks.
    due: u64,
    started: u64,
    /// [`counts`] at which a pin of a step at `started` would rise.
    started_counts: u32,
    record: &'static mut Record,
    made: usize,
    /// Reason for which the last move ended early.
    fault: Option<Fault<PinFault>>,
}

static MACHINE: Mutex<RefCell<Option<Machine>>> = Mutex::new(RefCell::new(None));

/// True if the motor turns. Reading it does not hold up the interrupt.
static MOVING: AtomicBool = AtomicBool::new(false);

/// Returns true if the motor turns.
pub fn is_moving() -> bool {
    MOVING.load(Relaxed)
}

/// Works on the machine while its interrupt waits.
pub fn with<R>(work: impl FnOnce(&mut Machine) -> R) -> R {
    critical_section::with(|cs| {
        work(MACHINE.borrow_ref_mut(cs).as_mut().expect("main installs it before it asks or sets an alarm"))
    })
}

#[exception]
fn SysTick() {
    with(Machine::on_alarm);
}

impl Machine {
    pub fn install(actuator: Actuator<Driver, QUEUE>, alarm: Alarm, record: &'static mut Record) {
        let clock = Clock { ticks: 0, began: counts().wrapping_sub(LEAD) };
        let machine = Self {
            actuator,
            alarm,
            clock,
            due: 0,
            started: 0,
            started_counts: 0,
            record,
            made: 0,
            fault: None,
        };
        critical_section::with(|cs| MACHINE.replace(cs, Some(machine)));
    }

    /// Makes the step that is due and sets the alarm for the next, in the interrupt.
    fn on_alarm(&mut self) {
        let now = self.clock.now();
        match self.actuator.on_timer(now) {
            Ok(Timer::At(next)) => {
                if now >= self.due {
                    self.note();
                }
                self.set_alarm(next);
            }
            Ok(Timer::Done) => self.end(),
            // The motor stands already. A panic here could not be reported, so the main program asks.
            Err(fault) => {
                self.fault = Some(fault);
                self.end();
            }
        }
    }

    fn set_alarm(&mut self, due: u64) {
        self.due = due;
        self.alarm.set(self.clock.counts_at(due));
    }

    fn note(&mut self) {
        if let Some(place) = self.record.get_mut(self.made) {
            place.due = (self.due - self.started) as u32;
            place.rose = StepPin::rose_at().wrapping_sub(self.started_counts);
            self.made += 1;
        }
    }

    fn end(&mut self) {
        self.alarm.off();
        MOVING.store(false, Relaxed);
    }

    /// Queues the whole plan, while the motor stands, and starts it from position 0.
    pub fn start(&mut self, plan: &Plan) {
        let stepper = self.actuator.stepper();
        assert!(stepper.set_position(0), "the motor moves");
        queue(stepper, plan);
        self.made = 0;
        self.fault = None;
        self.started = self.clock.now();
        self.started_counts = self.clock.counts_at(self.started).wrapping_add(LEAD);
        let due = self.actuator.start(self.started).expect("the motor is enabled, with segments queued");
        MOVING.store(true, Relaxed);
        self.set_alarm(due);
    }

    /// Returns the ticks since the start.
    pub fn elapsed(&mut self) -> u64 {
        self.clock.now() - self.started
    }

    /// Returns the reason for which the last move ended early, if it did.
    pub fn fault(&self) -> Option<Fault<PinFault>> {
        self.fault
    }

    /// Returns the number of steps made.
    pub fn position(&mut self) -> i64 {
        self.actuator.stepper().position()
    }

    /// Decelerates from the next step on. Times are ticks since the start.
    pub fn stop(&mut self, elapsed: u64) -> StopPlan {
        let promise = self.actuator.stop(self.started + elapsed);
        match self.actuator.stepper().next_deadline() {
            Some(due) => self.set_alarm(due),
            None => self.end(),
        }
        StopPlan { last_step_at: promise.last_step_at - self.started, ..promise }
    }

    /// Returns the place at which a new plan could take over: after the first step at `not_before` or
    /// later. Times are ticks since the start.
    pub fn junction(&mut self, not_before: u64) -> Option<Junction> {
        let junction = self.actuator.stepper().junction(self.started + not_before)?;
        Some(Junction { at: junction.at - self.started, ..junction })
    }

    /// Drops the steps that are planned after the junction at `not_before` or later.
    pub fn retarget(&mut self, not_before: u64) -> Option<Junction> {
        let junction = self.actuator.stepper().retarget(self.started + not_before)?;
        Some(Junction { at: junction.at - self.started, ..junction })
    }

    /// Says where the plan ends, which no step goes beyond.
    pub fn set_end(&mut self, end: i64) {
        self.actuator.stepper().set_end(end).expect("the motor is not stopping");
    }

    pub fn push(&mut self, segment: Segment) {
        self.actuator
            .stepper()
            .push(segment, TICK_RATE)
            .expect("the queue has room, and a plan's segments are valid");
    }

    /// Says that nothing will be pushed any more.
    pub fn finish(&mut self) {
        self.actuator.stepper().finish();
    }

    /// Returns the steps of the move so far.
    pub fn record(&self) -> &[Made] {
        self.record.get(..self.made).unwrap_or_default()
    }
}
