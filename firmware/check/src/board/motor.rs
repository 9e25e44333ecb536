//! The motor of an axis, as the edges of its pins turn it.

use super::emulator::Edge;

/// Returns the step pin of an axis (firmware/pico). The next pin is that of the direction.
pub(crate) fn step_pin(axis: u8) -> u8 {
    2 + 4 * axis
}

/// Returns the times of the rises of an axis's step pin, in ns. A pin that becomes an output is no rise.
pub(crate) fn rises(edges: &[Edge], axis: u8) -> Vec<f64> {
    let pin = step_pin(axis);
    edges.iter().filter(|edge| edge.pin == pin && edge.level == 1).map(|edge| edge.at_ns).collect()
}

/// Steps that the pins of axis X have made, signed, by their edges.
#[derive(Debug, Default)]
pub(crate) struct Motor {
    reverse: bool,
    pub(crate) count: i64,
    /// Time of the last step, in ns.
    pub(crate) turned_ns: f64,
}

impl Motor {
    /// Turns the motor by edges.
    pub(crate) fn turn(&mut self, edges: &[Edge]) {
        let step = step_pin(0);
        for edge in edges {
            if edge.pin == step && edge.level == 1 {
                self.count += if self.reverse { -1 } else { 1 };
                self.turned_ns = edge.at_ns;
            } else if edge.pin == step + 1 {
                self.reverse = edge.level == 0;
            }
        }
    }
}
