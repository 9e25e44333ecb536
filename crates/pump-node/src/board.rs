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

    /// Returns the step pin: its bit in the word of the board's outputs ([`Board::set_steps`]).
    fn step_pin(&self) -> u32;

    /// Sets the direction pin.
    fn set_direction(&mut self, high: bool);

    /// Sets the enable pin.
    fn set_enable(&mut self, high: bool);

    /// Reads the pin of the index sensor. It is called in the interrupt where a sensor is connected.
    fn index_is_high(&mut self) -> bool;

    /// Reads the fault output of the stepper driver, which is low while there is a fault.
    fn driver_fault_is_high(&mut self) -> bool;
}

/// Step pins that change together, as bits in the word of the board's outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Edge {
    /// Pins that become high.
    pub high: u32,
    /// Pins that become low.
    pub low: u32,
}

impl Edge {
    /// Returns the edge of one pin.
    pub(crate) fn of(pin: u32, high: bool) -> Self {
        if high { Self { high: pin, low: 0 } } else { Self { high: 0, low: pin } }
    }

    /// Adds the pins of another edge.
    pub(crate) fn join(&mut self, other: Self) {
        self.high |= other.high;
        self.low |= other.low;
    }
}

/// The parts of the board that all axes share.
pub trait Board {
    /// Returns the tick of the timer. It never falls, and has 64 bits.
    fn now(&mut self) -> u64;

    /// Returns the ticks since `tick`, which is at most 2^32 - 1 ticks ago. It is called in the interrupt, and a timer
    /// that is read in two halves needs the lower one alone.
    fn since(&mut self, tick: u64) -> u32 {
        self.now().wrapping_sub(tick) as u32
    }

    /// Waits until the timer is at `tick`, if it is not beyond. It is called in the interrupt, before a step.
    fn wait_until(&mut self, tick: u64);

    /// Sets step pins, all that rise at one time. It is called in the interrupt.
    fn set_steps(&mut self, edge: Edge);

    /// Returns true while the emergency stop is pressed. It is called in the interrupt.
    fn estop_is_pressed(&mut self) -> bool;
}
