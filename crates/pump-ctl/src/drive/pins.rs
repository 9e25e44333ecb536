//! The pins of a stepper driver: step, direction, enable, and an index input.

use core::fmt;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin, OutputPin};

use super::step_motor::StepMotor;
use super::timing::Timing;
use crate::step::Direction;

/// A pin that is not wired. Writing does nothing, and reading gives low.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoPin;

impl ErrorType for NoPin {
    type Error = core::convert::Infallible;
}

impl OutputPin for NoPin {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

impl InputPin for NoPin {
    fn is_high(&mut self) -> Result<bool, Self::Error> {
        Ok(false)
    }

    fn is_low(&mut self) -> Result<bool, Self::Error> {
        Ok(true)
    }
}

/// A pin of a stepper driver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Pin {
    /// Step pin.
    Step,
    /// Direction pin.
    Direction,
    /// Enable pin.
    Enable,
    /// Pin of the index sensor.
    Index,
}

impl fmt::Display for Pin {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(match self {
            Self::Step => "step pin",
            Self::Direction => "direction pin",
            Self::Enable => "enable pin",
            Self::Index => "pin of the index sensor",
        })
    }
}

/// A pin that could not be set or read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the {pin} could not be set or read: {kind}")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PinFault {
    /// Pin that failed.
    pub pin: Pin,
    /// Kind of the pin's own error.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub kind: ErrorKind,
    /// True if the motor has made the step in which the pin failed.
    pub made: bool,
}

impl Pin {
    fn fault(self, error: impl Error) -> PinFault {
        PinFault { pin: self, kind: error.kind(), made: false }
    }
}

/// A stepper driver on pins: `S` step, `D` direction, `E` enable, `I` index sensor, `W` the delay between
/// them.
///
/// ```
/// use std::cell::Cell;
///
/// use embedded_hal::delay::DelayNs;
/// use pump_ctl::drive::{NoPin, StepDir, StepMotor, Timing};
/// use pump_ctl::step::Direction;
///
/// struct Elapsed<'a>(&'a Cell<u64>);
///
/// impl DelayNs for Elapsed<'_> {
///     fn delay_ns(&mut self, ns: u32) {
///         self.0.set(self.0.get() + u64::from(ns));
///     }
/// }
///
/// let ns = Cell::new(0);
/// let mut driver = StepDir::new(NoPin, NoPin, NoPin, Elapsed(&ns), Timing::default());
/// driver.step(Direction::Forward).unwrap();
/// assert_eq!(ns.get(), 650 + 650 + 1900 + 1900);
/// driver.step(Direction::Forward).unwrap();
/// assert_eq!(ns.get(), 5100 + 3800);
/// ```
#[derive(Debug)]
pub struct StepDir<S, D, E, W, I = NoPin> {
    step: S,
    direction: D,
    enable: E,
    index: Option<I>,
    delay: W,
    timing: Timing,
    /// Direction in which the direction pin points. It is unknown at first.
    facing: Option<Direction>,
}

impl<S: OutputPin, D: OutputPin, E: OutputPin, W: DelayNs> StepDir<S, D, E, W> {
    /// Makes a driver from pins as they are. No pin is set before the motor is enabled. `enable` may be
    /// [`NoPin`].
    pub fn new(step: S, direction: D, enable: E, delay: W, timing: Timing) -> Self {
        Self { step, direction, enable, index: None, delay, timing, facing: None }
    }

    /// Adds an index sensor to the driver.
    pub fn with_index<I: InputPin>(self, index: I) -> StepDir<S, D, E, W, I> {
        let Self { step, direction, enable, index: _, delay, timing, facing } = self;
        StepDir { step, direction, enable, index: Some(index), delay, timing, facing }
    }
}

impl<S, D, E, W, I> StepDir<S, D, E, W, I> {
    /// Gives the parts back: step, direction and enable pin, index sensor and delay. The pins stay as they
    /// are.
    pub fn release(self) -> (S, D, E, Option<I>, W) {
        (self.step, self.direction, self.enable, self.index, self.delay)
    }
}

impl<S, D, E, W, I> StepDir<S, D, E, W, I>
where
    S: OutputPin,
    D: OutputPin,
    E: OutputPin,
    W: DelayNs,
    I: InputPin,
{
    /// Sets the direction pin, with the hold time before and the set-up time after.
    fn face(&mut self, direction: Direction) -> Result<(), PinFault> {
        if self.facing == Some(direction) {
            return Ok(());
        }
        self.delay.delay_ns(self.timing.direction_hold_ns);
        self.facing = None;
        let high = (direction == Direction::Forward) != self.timing.reversed;
        self.direction.set_state(high.into()).map_err(|error| Pin::Direction.fault(error))?;
        self.facing = Some(direction);
        self.delay.delay_ns(self.timing.direction_setup_ns);
        Ok(())
    }

    fn energise(&mut self, on: bool) -> Result<(), PinFault> {
        let high = on != self.timing.enable_active_low;
        self.enable.set_state(high.into()).map_err(|error| Pin::Enable.fault(error))
    }
}

impl<S, D, E, W, I> StepMotor for StepDir<S, D, E, W, I>
where
    S: OutputPin,
    D: OutputPin,
    E: OutputPin,
    W: DelayNs,
    I: InputPin,
{
    type Error = PinFault;

    fn step(&mut self, direction: Direction) -> Result<(), PinFault> {
        self.face(direction)?;
        self.step.set_high().map_err(|error| Pin::Step.fault(error))?;
        self.delay.delay_ns(self.timing.step_high_ns);
        // The driver steps when the pin rises.
        self.step.set_low().map_err(|error| PinFault { made: true, ..Pin::Step.fault(error) })?;
        self.delay.delay_ns(self.timing.step_low_ns);
        Ok(())
    }

    fn made_its_step(&self, error: &PinFault) -> bool {
        error.made
    }

    fn enable(&mut self) -> Result<(), PinFault> {
        self.step.set_low().map_err(|error| Pin::Step.fault(error))?;
        self.energise(true)?;
        // A step pin that a fault left high has only just fallen.
        self.delay.delay_ns(self.timing.enable_setup_ns.max(self.timing.step_low_ns));
        Ok(())
    }

    fn disable(&mut self) -> Result<(), PinFault> {
        self.energise(false)
    }

    fn index(&mut self) -> Result<Option<bool>, PinFault> {
        let Some(index) = &mut self.index else {
            return Ok(None);
        };
        let high = index.is_high().map_err(|error| Pin::Index.fault(error))?;
        Ok(Some(high != self.timing.index_active_low))
    }
}
