//! A motor whose steps are counted, and whose index sensor is watched.

use pump_ctl::drive::StepMotor;
use pump_ctl::step::Direction;

use super::lead::Lead;

/// Motor that counts its steps.
#[derive(Debug)]
pub(super) struct WatchedMotor<'a, M> {
    motor: &'a mut M,
    lead: &'a Lead,
    /// Last state of the index sensor, if the motion ends there.
    index: Option<bool>,
    /// True if the last step was made.
    has_stepped: bool,
}

impl<'a, M: StepMotor> WatchedMotor<'a, M> {
    /// Watches `motor`. A motion that `seeks` ends where the index sensor becomes active.
    pub(super) fn new(motor: &'a mut M, lead: &'a Lead, seeks: bool) -> Result<Self, M::Error> {
        let index = if seeks { motor.index()? } else { None };
        Ok(Self { motor, lead, index, has_stepped: false })
    }
}

impl<M: StepMotor> StepMotor for WatchedMotor<'_, M> {
    type Error = M::Error;

    fn step(&mut self, direction: Direction) -> Result<(), M::Error> {
        self.has_stepped = false;
        self.motor.step(direction)?;
        self.has_stepped = true;
        let number = self.lead.count();
        if let Some(was_active) = self.index {
            self.index = self.motor.index()?;
            if !was_active && self.index == Some(true) && self.lead.index_at().is_none() {
                self.lead.found(number);
            }
        }
        Ok(())
    }

    fn made_its_step(&self, error: &M::Error) -> bool {
        self.has_stepped || self.motor.made_its_step(error)
    }

    fn enable(&mut self) -> Result<(), M::Error> {
        self.motor.enable()
    }

    fn disable(&mut self) -> Result<(), M::Error> {
        self.motor.disable()
    }
}
