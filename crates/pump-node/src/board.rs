//! The hardware of a node.

/// Levels of the output pins of an axis. True is high.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Levels {
    /// Level of the step pin.
    pub step: bool,
    /// Level of the direction pin.
    pub direction: bool,
    /// Level of the enable pin.
    pub enable: bool,
}

/// The pins of an axis. All are inputs until [`Self::make_outputs`] is called.
pub trait Pins {
    /// Gives step, direction and enable pin these levels, and then makes them outputs. Pins that are outputs
    /// already take the levels.
    fn make_outputs(&mut self, levels: Levels);

    /// Sets the step pin. It is called in the interrupt.
    fn set_step(&mut self, high: bool);

    /// Sets the direction pin.
    fn set_direction(&mut self, high: bool);

    /// Sets the enable pin.
    fn set_enable(&mut self, high: bool);

    /// Reads the pin of the index sensor. It is called in the interrupt where a sensor is connected.
    fn index_is_high(&mut self) -> bool;

    /// Reads the fault output of the motor's driver, which is low while there is a fault.
    fn driver_fault_is_high(&mut self) -> bool;
}

/// The parts of the board that all axes share.
pub trait Board {
    /// Returns the tick of the timer. It never falls, and has 64 bits.
    fn now(&mut self) -> u64;

    /// Waits until the timer is at `tick`, if it is not beyond. It is called in the interrupt, before a step.
    fn wait_until(&mut self, tick: u64);

    /// Waits so many ns at least. It is called in the interrupt, for the pulse of a step.
    fn wait_ns(&mut self, ns: u32);

    /// Returns true while the emergency stop is pressed. It is called in the interrupt.
    fn estop_is_pressed(&mut self) -> bool;
}
