//! The stepper driver that a Klipper board sets itself: its current and its microsteps among the answers.

use super::answers::Answers;
use super::error::SetupError;
use super::motor_socket::MotorSocket;
use super::pump::USUAL_FULL_STEPS;
use crate::pump_file::{DriverName, TmcTable, tmc_range};

impl Answers {
    /// Returns true if the board sets the microsteps and the current of the stepper driver at the motor's socket.
    pub fn sets_stepper_driver(&self) -> bool {
        let has_wire = self.socket.as_ref().is_some_and(|socket| socket.has_driver_wire());
        self.driver == Some(DriverName::Klipper) && has_wire
    }

    /// Takes the motor's socket. If it has no wire to a stepper driver, the currents of a socket before are dropped.
    pub fn set_socket(&mut self, socket: MotorSocket) {
        if !socket.has_driver_wire() {
            (self.current_a, self.hold_a) = (None, None);
        }
        self.socket = Some(socket);
    }

    /// Refuses a current or microsteps that the stepper driver at the motor's socket does not make.
    pub(super) fn check_stepper_driver(&self) -> Result<(), SetupError> {
        if !self.sets_stepper_driver() {
            let is_klipper = self.driver == Some(DriverName::Klipper) && self.socket.is_some();
            let current_a = self.current_a.or(self.hold_a).filter(|_| is_klipper);
            let allowed = "no current, because the socket names no wire to a TMC2209: its own screw or jumper sets the \
                           stepper driver; or the wire beside its pins, as uart=PC11,tx=PC10,address=0";
            return current_a.map_or(Ok(()), |current_a| {
                Err(SetupError::Current { what: "current", current_a, allowed: allowed.to_owned() })
            });
        }
        if let Some(run_a) = self.current_a {
            check_current("current", run_a, self.hold_a)?;
        }
        let full_steps = self.full_steps.unwrap_or(USUAL_FULL_STEPS);
        let of_micro = self.microsteps.map(|microsteps| full_steps.saturating_mul(microsteps));
        let Some(steps) = self.steps_per_rev.or(of_micro) else { return Ok(()) };
        match tmc_range::microsteps(steps, full_steps) {
            Ok(_) => Ok(()),
            Err(_) => Err(SetupError::Microsteps {
                microsteps: f64::from(steps) / f64::from(full_steps.max(1)),
                full_steps,
                allowed: tmc_range::MICROSTEPS,
            }),
        }
    }
}

/// Refuses a current that no TMC2209 makes with the usual sense resistor.
fn check_current(what: &'static str, run_a: f64, hold_a: Option<f64>) -> Result<(), SetupError> {
    let sense_ohm = TmcTable::USUAL_SENSE_OHM;
    let (least, most) = tmc_range::range_a(sense_ohm);
    if !(least..=most).contains(&run_a) {
        let allowed = tmc_range::currents_in_words(sense_ohm);
        return Err(SetupError::Current { what, current_a: run_a, allowed });
    }
    let least = tmc_range::current_a(0, tmc_range::is_sensitive(run_a, sense_ohm), sense_ohm);
    match hold_a.filter(|hold_a| !(least..=run_a).contains(hold_a)) {
        None => Ok(()),
        Some(hold_a) => Err(SetupError::Current {
            what: "current at rest",
            current_a: hold_a,
            allowed: format!("{least:.3} A to that of the turning motor, {run_a} A"),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answers(socket: &str) -> Answers {
        let mut answers = Answers::of("acid");
        (answers.driver, answers.socket) = (Some(DriverName::Klipper), Some(socket.parse().unwrap()));
        answers
    }

    #[test]
    fn a_current_and_microsteps_are_those_that_the_stepper_driver_makes() {
        let mut of_wire = answers("skr-mini-e3-v3:X");
        for (run_a, hold_a, words) in [
            (1.9, None, "the current is 1.9 A; allowed: 0.031 to 1.768 A (RMS)"),
            (
                0.5,
                Some(0.6),
                "the current at rest is 0.6 A; allowed: 0.031 A to that of the turning motor, 0.5 A",
            ),
        ] {
            (of_wire.current_a, of_wire.hold_a) = (Some(run_a), hold_a);
            let said = of_wire.check().unwrap_err().to_string();
            assert!(said.starts_with(words), "{said}");
        }
        (of_wire.current_a, of_wire.hold_a, of_wire.microsteps) = (Some(0.5), Some(0.3), Some(15));
        let said = of_wire.check().unwrap_err().to_string();
        assert!(said.starts_with("15 microsteps of 200 full steps are none that a TMC2209 makes"), "{said}");
        of_wire.microsteps = Some(16);
        of_wire.check().unwrap();
        // A stepper driver without a wire may be of any kind, and its current is none of the board's.
        let mut bare = of_wire;
        bare.set_socket("step=PB13,dir=PB12".parse().unwrap());
        assert_eq!((bare.current_a, bare.hold_a), (None, None));
        bare.microsteps = Some(15);
        bare.check().unwrap();
    }
}
