//! The device of a session: its drive, with the limits that it sets. The pump file sets some for a dry run.

use std::time::Instant;

use pump_ctl::plan::{FlowError, PlanError};
use pump_model::units::rpm;

use super::bench::Bench;
use crate::dosing::DoseError;
use crate::drives::{Drive, DriveLimits, registry};
use crate::pump_file::{DriverName, PumpFile};

/// Connected drive of a session.
#[derive(Debug)]
pub(super) struct Device<'a> {
    pub(super) drive: Box<dyn Drive + 'a>,
    /// Pump file with its motor as the device allows it.
    pub(super) file: PumpFile,
    pub(super) limits: Option<DriveLimits>,
    /// Instant from which on the motor holds.
    pub(super) holds_since: Instant,
}

impl Device<'_> {
    /// Returns the most steps that the device can count in a direction from where it stands. `None` without a bound.
    pub(super) fn most_steps(&self, reverse: bool) -> Option<u64> {
        let (farthest, count) = (self.drive.farthest_count()?, self.drive.count()?);
        let ahead = if reverse { farthest.saturating_add(count) } else { farthest.saturating_sub(count) };
        Some(u64::try_from(ahead).unwrap_or(0))
    }

    /// Returns the slowest cruise of the pump head, in rad/s.
    pub(super) fn least_rad_s(&self) -> f64 {
        self.limits.map_or(0.0, |limits| limits.min_speed_rad_s)
    }
}

/// Returns the pump file with the motor's limits as the device sets them: never faster than the file, and with the
/// acceleration of a device that has one of its own.
pub(super) fn as_allowed(file: &PumpFile, limits: Option<DriveLimits>) -> PumpFile {
    let mut file = file.clone();
    if let Some(limits) = limits {
        let motor = &mut file.motor;
        motor.max_speed_rpm = motor.max_speed_rpm.min(rpm(limits.max_speed_rad_s));
        motor.max_acceleration_rad_s2 = limits.acceleration_rad_s2.unwrap_or(motor.max_acceleration_rad_s2);
    }
    file
}

impl Bench {
    /// Returns the pump file for a plan that asks no device. The pulses of a node's or a Klipper board's pins stand in
    /// the file, and no board makes more steps than they allow. A plan that leaves the pump's record out takes the
    /// settings that its board had the last time.
    ///
    /// # Errors
    ///
    /// [`DoseError::Connection`] if the settings on record cannot be read.
    pub(super) fn file_for_dry_run(&self) -> Result<PumpFile, DoseError> {
        let step_rad = self.file().limits().motor.step_rad();
        let klipper = self.drive().klipper.as_ref();
        let limits = if self.drive_id() == DriverName::Node.as_str() {
            let pins = self.drive().pins_or_usual();
            let most_steps_s = 1e6 / (pins.step_pulse_us + pins.step_pause_us);
            Some(DriveLimits::of_speed(most_steps_s * step_rad))
        } else if let Some(pins) = klipper.filter(|_| self.drive_id() == DriverName::Klipper.as_str()) {
            // A board pauses as long as the pulse is.
            Some(DriveLimits::of_speed(0.5e6 / pins.pulse_us() * step_rad))
        } else if self.plans_afresh() {
            registry::recorded_limits(self.drive(), self.opening(), step_rad)
                .map_err(DoseError::Connection)?
        } else {
            None
        };
        Ok(as_allowed(self.file(), limits))
    }

    /// Returns the refusal of a plan with the cause of a speed limit that is lower than that of the pump file. `file`
    /// is the pump file as the device allows it.
    pub(super) fn told_by_device(&self, file: &PumpFile, refused: DoseError) -> DoseError {
        let is_of_speed = matches!(
            refused,
            DoseError::Plan(PlanError::RateTooHigh { .. } | PlanError::SpeedTooHigh { .. })
                | DoseError::Flow(FlowError::TooFast { .. })
                | DoseError::SteepFlow { source: FlowError::TooFast { .. }, .. }
        );
        let [limit_rpm, file_rpm] = [file, self.file()].map(|file| file.motor.max_speed_rpm);
        if !is_of_speed || limit_rpm >= file_rpm {
            return refused;
        }
        let motor = file.limits().motor;
        DoseError::DeviceSpeed {
            driver: self.drive_id().to_owned(),
            most_steps_s: motor.max_speed_rad_s / motor.step_rad(),
            limit_rpm,
            file_rpm,
            source: Box::new(refused),
        }
    }
}
