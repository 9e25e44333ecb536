//! The pins of a stepper driver: step, direction, enable, and an index input.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin, OutputPin};

use super::error::StepFault;
use super::motion::Motion;

/// Times that a stepper driver needs, ns, and the polarity of its pins.
///
/// The default is that of a DRV8825, the slowest of the common drivers. Its times are 1.9 us high and low,
/// 650 ns set-up and hold, and 1.7 ms from sleep to step (Texas Instruments, SLVSA73F, section 6.6).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Timing {
    /// Time for which the step pin is active, ns.
    pub step_high_ns: u32,
    /// Time for which the step pin is inactive before the next step, ns.
    pub step_low_ns: u32,
    /// Time from a change of direction to the next step, ns.
    pub direction_setup_ns: u32,
    /// Time from a step to the next change of direction, ns.
    pub direction_hold_ns: u32,
    /// Time from enable to the first step, ns.
    pub enable_setup_ns: u32,
    /// True if the motor is energised while the enable pin is low.
    pub enable_active_low: bool,
    /// True if a low direction pin is forward.
    pub reversed: bool,
    /// True if the index sensor is active while its pin is low.
    pub index_active_low: bool,
}

impl Default for Timing {
    fn default() -> Self {
        Self {
            step_high_ns: 1900,
            step_low_ns: 1900,
            direction_setup_ns: 650,
            direction_hold_ns: 650,
            enable_setup_ns: 1_700_000,
            enable_active_low: true,
            reversed: false,
            index_active_low: false,
        }
    }
}

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

/// A pin that could not be set or read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PinFault {
    /// Pin that failed.
    pub pin: Pin,
    /// Kind of the pin's own error.
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    pub kind: ErrorKind,
}

impl Pin {
    fn fault(self, error: impl Error) -> PinFault {
        PinFault { pin: self, kind: error.kind() }
    }
}

/// A stepper driver on pins: `S` step, `D` direction, `E` enable, `I` index sensor, `W` the delay between
/// them.
///
/// ```
/// use std::cell::Cell;
///
/// use embedded_hal::delay::DelayNs;
/// use pump_ctl::drive::{Motion, NoPin, StepDir, Timing};
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
/// driver.step(1).unwrap();
/// assert_eq!(ns.get(), 650 + 650 + 1900 + 1900);
/// driver.step(1).unwrap();
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
    facing: Option<i8>,
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

impl<S, D, E, W, I> StepDir<S, D, E, W, I>
where
    S: OutputPin,
    D: OutputPin,
    E: OutputPin,
    W: DelayNs,
    I: InputPin,
{
    /// Sets the direction pin, with the hold time before and the set-up time after.
    fn face(&mut self, direction: i8) -> Result<(), PinFault> {
        if self.facing == Some(direction) {
            return Ok(());
        }
        self.delay.delay_ns(self.timing.direction_hold_ns);
        self.facing = None;
        let high = (direction > 0) != self.timing.reversed;
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

impl<S, D, E, W, I> Motion for StepDir<S, D, E, W, I>
where
    S: OutputPin,
    D: OutputPin,
    E: OutputPin,
    W: DelayNs,
    I: InputPin,
{
    type Error = PinFault;

    fn step(&mut self, direction: i8) -> Result<(), StepFault<PinFault>> {
        self.face(direction).map_err(|error| StepFault { error, made: false })?;
        let failed = |error, made| StepFault { error: Pin::Step.fault(error), made };
        self.step.set_high().map_err(|error| failed(error, false))?;
        self.delay.delay_ns(self.timing.step_high_ns);
        self.step.set_low().map_err(|error| failed(error, true))?;
        self.delay.delay_ns(self.timing.step_low_ns);
        Ok(())
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
