//! The defects of a simulated board itself, and what somebody else does to it. Those of its line are the line's.

use super::machine::Machine;

impl Machine {
    /// Lets somebody else do things, and each defect of the board happen, at their places.
    pub(crate) fn suffer(&mut self) {
        let turned = self.turned;
        if let Some((_, byte)) = self.defects.pressed.take_if(|(place, _)| turned >= *place) {
            self.receive(byte);
        }
        if let Some((_, way_mm)) = self.defects.foreign.take_if(|(place, _)| turned >= *place) {
            // The answer goes to the program that jogs.
            let _ = self.jog(&format!("G91G21X{way_mm:.3}F6000"));
        }
        if let Some((_, steps, told)) = self.defects.misses.take_if(|(place, ..)| turned >= *place) {
            self.true_steps -= steps;
            self.defects.miscounts = Some((told, -steps));
        }
        if let Some((_, code)) = self.defects.alarm.take_if(|(place, _)| turned >= *place) {
            self.alarm(code);
        }
        self.stalled |= self.defects.stalls.is_some_and(|place| turned >= place);
        if let Some((_, by)) = self.defects.miscounts.take_if(|(place, _)| turned >= *place) {
            self.miscounted += by;
        }
    }
}
