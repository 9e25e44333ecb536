//! The motor of an axis: a stepper driver on pins. The interrupt makes the pulses of its step pin.

use core::convert::Infallible;

use pump_ctl::drive::StepMotor;
use pump_ctl::step::Direction;
use pump_link::message::{AxisConfig, FaultOutput};

use crate::board::{Levels, Pins};

/// A stepper driver.
#[derive(Debug)]
pub(crate) struct Driver<P> {
    pins: P,
    config: AxisConfig,
    /// Direction in which the direction pin points.
    facing: Direction,
    energised: bool,
    /// True once the pins are outputs.
    pub(crate) is_set_up: bool,
}

impl<P: Pins> Driver<P> {
    /// Makes a driver whose pins are inputs.
    pub(crate) fn new(pins: P) -> Self {
        let config = AxisConfig::new(0);
        Self { pins, config, facing: Direction::Forward, energised: false, is_set_up: false }
    }

    /// Makes the pins outputs. The levels are set before. An energised motor stays so on the way.
    pub(crate) fn set_up(&mut self, config: AxisConfig, energised: bool) {
        self.pins.make_outputs(Levels {
            step: config.step_active_low,
            direction: !config.reversed,
            enable: energised != config.enable_active_low,
        });
        (self.config, self.facing, self.energised) = (config, Direction::Forward, energised);
        self.is_set_up = true;
    }

    /// Returns the step pin: its bit in the word of the board's outputs.
    pub(crate) fn step_pin(&self) -> u32 {
        self.pins.step_pin()
    }

    pub(crate) fn is_energised(&self) -> bool {
        self.energised
    }

    /// Sets the direction pin. Returns true if that changed it.
    pub(crate) fn face(&mut self, direction: Direction) -> bool {
        let turned = direction != self.facing;
        if turned {
            self.facing = direction;
            self.pins.set_direction((direction == Direction::Forward) != self.config.reversed);
        }
        turned
    }

    /// Returns true if the driver reports a fault.
    pub(crate) fn has_fault(&mut self) -> bool {
        match self.config.driver_fault {
            FaultOutput::None => false,
            FaultOutput::ActiveLow => !self.pins.driver_fault_is_high(),
            FaultOutput::ActiveHigh => self.pins.driver_fault_is_high(),
        }
    }
}

impl<P: Pins> StepMotor for Driver<P> {
    type Error = Infallible;

    fn step(&mut self, _: Direction) -> Result<(), Infallible> {
        // The interrupt has begun the pulse. The direction pin was set before the move began, and a move never turns
        // round.
        Ok(())
    }

    fn enable(&mut self) -> Result<(), Infallible> {
        self.pins.set_enable(!self.config.enable_active_low);
        self.energised = true;
        Ok(())
    }

    fn disable(&mut self) -> Result<(), Infallible> {
        self.pins.set_enable(self.config.enable_active_low);
        self.energised = false;
        Ok(())
    }

    fn index(&mut self) -> Result<Option<bool>, Infallible> {
        Ok(self.config.has_index.then(|| self.pins.index_is_high() != self.config.index_active_low))
    }
}
