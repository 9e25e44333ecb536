//! The interface of every drive. A drive makes the steps of a plan and asks for leave before each stretch.

use std::fmt::{self, Debug, Display, Formatter};
use std::ops::ControlFlow;
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_ctl::plan::{FlowMotion, Plan, PlannedMotion};

use super::abilities::Abilities;
use super::board_share::BoardShare;
use super::common_begin::BeginPlace;
use super::error::{DriveError, DriveFault};
use crate::displacement::Correction;
use crate::notice::Notice;

/// Time between two questions of a wait at rest.
const POLL: Duration = Duration::from_millis(20);

/// Returns the time to wait for a line that settles within `settle_s`. A time that is negative or no finite number is
/// none, as [`Drive::settle`] says.
pub(in crate::drives) fn wait_of(settle_s: f64) -> Duration {
    Duration::try_from_secs_f64(settle_s).unwrap_or_default()
}

/// Leave of a gate for the steps that a drive is about to make. A drive treats each answer, so there will be no
/// further one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leave {
    /// The steps may be made.
    Go,
    /// The steps are not on record yet. The drive makes only those that it had leave for, and asks again.
    Wait,
    /// The motion ends: the motor decelerates and holds.
    Stop,
}

/// Gate that a drive asks before it makes steps. `made` are made, and the next up to `about_to` are about to
/// be made. The gate answers within milliseconds.
pub type Gate<'a> = dyn FnMut(u64, u64) -> Leave + 'a;

/// Question that a drive asks now and then while nothing moves. To break is to end the wait.
pub type Watch<'a> = dyn FnMut() -> ControlFlow<()> + 'a;

/// Limits of the pump head's motion by the device's own settings.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DriveLimits {
    /// Slowest cruise, in rad/s. Zero without such a limit.
    pub min_speed_rad_s: f64,
    /// Fastest cruise, in rad/s.
    pub max_speed_rad_s: f64,
    /// Acceleration of the device's own ramps, in rad/s². It holds whatever the plan says. `None` for a device that
    /// makes the ramps of the plan.
    pub acceleration_rad_s2: Option<f64>,
}

impl DriveLimits {
    /// Makes the limits of a device with ramps of its own, and without a slowest cruise.
    pub const fn new(max_speed_rad_s: f64, acceleration_rad_s2: f64) -> Self {
        Self { acceleration_rad_s2: Some(acceleration_rad_s2), ..Self::of_speed(max_speed_rad_s) }
    }

    /// Makes the limits of a device that makes the ramps of the plan up to this speed, in rad/s.
    pub const fn of_speed(max_speed_rad_s: f64) -> Self {
        Self { min_speed_rad_s: 0.0, max_speed_rad_s, acceleration_rad_s2: None }
    }

    /// Returns the limits with this slowest cruise, in rad/s.
    #[must_use]
    pub const fn with_min_speed(self, min_speed_rad_s: f64) -> Self {
        Self { min_speed_rad_s, ..self }
    }
}

/// Event that the rotor's angle may not have survived.
///
/// Each event but three widens the angle by two full steps of the motor: a released rotor may fall that far before it
/// is caught again. After an emergency stop, and after another program has had the device, the angle is unknown. A
/// motor that was halted may have slipped farther.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Disturbance {
    /// The device was reset, or switched on.
    Reset,
    /// The drive has reset the device, to configure it for other pins, stepper drivers or motors than before.
    Reconfigured,
    /// The motor was without current.
    Disabled,
    /// The stepper driver has switched the motor off, or lost its supply, and nobody knows when. A motion that was
    /// under way may have had no current for any part of its steps.
    CurrentLost,
    /// The device was out of reach in motion.
    LinkLost,
    /// The emergency stop has cut the current of every motor of the device. People may have turned the rotor meanwhile.
    EmergencyStop,
    /// The motor was stopped in motion without a ramp, and may have slipped by so many steps. The device's count is
    /// that of the steps which the motor was given.
    Halted {
        /// Most steps by which the motor may have slipped. 0 below the speed from which it stops within a step.
        slip_steps: u32,
        /// True if the motor was without current from then on, so that the rotor may have fallen as well.
        without_current: bool,
    },
    /// Another program has had the device, or the device was exchanged for another one, since the motor moved last.
    /// Nobody knows what has turned meanwhile.
    TakenOver,
    /// Another axis of the device turns the motor than before. Its count says nothing of this rotor, which was without
    /// current while it was connected to the other axis.
    OtherAxis,
}

impl Display for Disturbance {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.write_str(match self {
            Self::Reset => "the device was reset",
            Self::Reconfigured => {
                "this program has reset the board to configure it anew, because its pins, its stepper drivers or its \
                 motors have changed"
            }
            Self::Disabled => "the motor was without current",
            Self::CurrentLost => "the stepper driver has lost the motor's current",
            Self::LinkLost => "the device was out of reach in motion",
            Self::EmergencyStop => {
                "the emergency stop was pressed, and each motor of the board was without current"
            }
            Self::TakenOver => {
                "another program has had the board, or it is another board, since the motor moved last"
            }
            Self::Halted { without_current: true, .. } => {
                "the motor was stopped in motion without a ramp, and was without current from then on"
            }
            Self::Halted { .. } => "the motor was stopped in motion without a ramp, and may have slipped",
            Self::OtherAxis => {
                "the motor is at another axis of the board than before, which counts from elsewhere"
            }
        })
    }
}

/// Result of a search for the index mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IndexSearch {
    /// Steps made in all.
    pub made: u64,
    /// Steps made after the mark. `None` if the mark was not found.
    pub beyond: Option<u64>,
}

/// Drive of one motor.
///
/// Only [`Self::id`] and [`Self::run`] must be written. The other methods suit a motor in real time that holds its
/// angle, has no limits, no count and no sensor, and cannot be let go. `&mut T` is a drive too.
///
/// A drive that a pump file names is opened by [`crate::Bench::session`]. Any other is given to
/// [`crate::Session::with_drive`]. The record, the pauses, the limits and the rest of an unfinished dose are the same
/// for both.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use pump_bench::drives::{Drive, DriveFault, Gate, Leave};
/// use pump_bench::{Bench, DoseRequest, Session, built_in};
/// use pump_ctl::plan::Plan;
///
/// /// Belt that turns the pump head.
/// #[derive(Debug)]
/// struct Belt;
///
/// impl Drive for Belt {
///     fn id(&self) -> &str {
///         "belt"
///     }
///
///     fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
///         let mut made = 0;
///         for step in plan.each_step() {
///             loop {
///                 match gate(made, step.number) {
///                     Leave::Go => break,
///                     Leave::Wait => {}
///                     Leave::Stop => return Ok(made),
///                 }
///             }
///             made = step.number; // here the belt makes the step
///         }
///         Ok(made)
///     }
/// }
///
/// let state = tempfile::tempdir()?;
/// let bench = Bench::new(built_in("three-roller").unwrap(), None, state.path())?.driven_by(&Belt)?;
/// let bench = bench.confirming_pump(true); // the belt turns the head of the built-in pump
/// let mut session = Session::with_drive(&bench, Box::new(Belt))?;
/// let prepared = session.prepare(DoseRequest::dose(0.1))?;
/// assert!(session.run(&prepared, |_steps| ControlFlow::Continue(()))?.completed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Drive: Debug + Send {
    /// Returns the name of the drive, 1 to 64 of a-z, 0-9, `-` and `_`. The record of a pump under this drive is in
    /// the folder of this name, so the name must not change.
    fn id(&self) -> &str;

    /// Returns true if no motor moves. A simulation may wait for the disk at no cost. Its rotor stands at 0 deg as
    /// long as nothing is on record.
    fn is_simulated(&self) -> bool {
        false
    }

    /// Returns the abilities of the drive. They never change.
    fn abilities(&self) -> Abilities {
        Abilities::new()
    }

    /// Returns the limits of the device. `None` if it takes whatever the pump file allows.
    fn limits(&self) -> Option<DriveLimits> {
        None
    }

    /// Returns the device's own count of steps, positive toward the outlet, from any zero. `None` without a
    /// count. A count of zero is that of a device that was just switched on, unless the drive tells each reset
    /// ([`Abilities::tells_resets`]).
    fn count(&self) -> Option<i64> {
        None
    }

    /// Returns the farthest count, either way, to which the device counts exactly. `None` if it counts any motion. A
    /// run that goes on until it is stopped ends there.
    fn farthest_count(&self) -> Option<i64> {
        None
    }

    /// Returns the last disturbance of the rotor since this was last asked, or since the drive was opened.
    fn disturbed(&mut self) -> Option<Disturbance> {
        None
    }

    /// Returns true if the last check found the motor without current. Once the disturbance that was told last is on
    /// record, to give it current again is no further one.
    fn is_without_current(&self) -> bool {
        false
    }

    /// Says that the disturbances which [`Self::disturbed`] has told are on record. A disk may be full in between.
    fn recorded(&mut self) {}

    /// Returns true if the motor holds wherever it rests, in the pauses of a motion too. Otherwise each rest after a
    /// motion counts as a disturbance, and [`Self::disturbed`] need not tell it.
    fn holds_at_rest(&self) -> bool {
        true
    }

    /// Returns how often the motor of the last motion may have rested before that motion ended, as far as the device
    /// tells. A motor that waits for a program that is late rests too. The pauses that the gate asks for are counted
    /// by the session as well, and need not be told.
    fn rests(&self) -> u32 {
        0
    }

    /// Puts the device and the settings that it has told on record, if that was left for later
    /// (`records_later` of the opening). A session calls this before it announces its first motion.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the record cannot be written. Nothing moves, and the drive is kept.
    fn put_on_record(&mut self) -> Result<(), DriveError> {
        Ok(())
    }

    /// Connects the device anew, if it has to be. A session calls this before it asks for limits, disturbances and
    /// count: once at the beginning, and again after a fault, a refused plan or a release. The count that the drive
    /// tells then is compared with the record.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the device cannot be used. Nothing moves, and the drive is kept.
    fn connect(&mut self) -> Result<(), DriveError> {
        Ok(())
    }

    /// Checks that the device can run a plan, and that the rotor is where it was left. Nothing has moved or
    /// been announced yet. [`Self::connect`] is the place to connect a device anew, and not this one.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the device cannot run the plan, or has moved or been reset since.
    fn check(&mut self, _plan: &Plan) -> Result<(), DriveError> {
        Ok(())
    }

    /// Returns the part of its board that a motion takes, so that motions which run at once are added up before the
    /// first one moves. `None` if the device makes it whatever the other axes do.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the board cannot make the motion even while no other axis moves.
    fn board_share(&self, _motion: PlannedMotion<'_>) -> Result<Option<BoardShare>, DriveError> {
        Ok(None)
    }

    /// Returns the time from the leave for the first steps to the first of them, in s, where the device is given the
    /// steps before they begin. A rack gives the leave earlier by so much.
    fn begin_lead_s(&self) -> f64 {
        0.0
    }

    /// Forgets the plan that was checked last, because it is not run. A device that several pumps share has kept a
    /// part of itself for it.
    fn forget_plan(&mut self) {}

    /// Sets the correction of the displacement from now on. Only a simulation needs it.
    fn displaces(&mut self, _correction: Correction) {}

    /// Has the next motion begin with those of the other places. It is called only if [`Abilities::together`] says
    /// that the drive can.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the drive cannot begin with others. The place is given up.
    fn begin_with(&mut self, _place: BeginPlace) -> Result<(), DriveError> {
        Err(DriveError::no_common_begin(self.id()))
    }

    /// Makes the steps of `plan` and asks `gate` before them. When the gate says [`Leave::Stop`], the motor
    /// decelerates and holds.
    ///
    /// Returns the number of steps made, those of the deceleration included.
    ///
    /// # Errors
    ///
    /// [`DriveFault`] if the drive failed with the motor under way.
    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault>;

    /// Checks that the device can run a flow over time, as [`Self::check`] does for a plan.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the drive runs no flow over time, or the device has moved or been reset since.
    fn check_flow(&mut self, _flow: &FlowMotion<'_>) -> Result<(), DriveError> {
        Err(DriveError::no_flow(self.id()))
    }

    /// Makes each step of a flow over time at its time, and asks `gate` before them, as [`Self::run`] does. It is
    /// called only if [`Abilities::flow_over_time`] says that the drive can.
    ///
    /// # Errors
    ///
    /// [`DriveFault`] if the drive runs no flow over time, or failed with the motor under way.
    fn run_flow(&mut self, _flow: &FlowMotion<'_>, _gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        Err(DriveFault::at(0, DriveError::no_flow(self.id())))
    }

    /// Makes steps of `plan` until the index mark is found or `gate` says [`Leave::Stop`], then stops and holds.
    ///
    /// # Errors
    ///
    /// [`DriveFault`] if the drive has no index sensor, or failed with the motor under way.
    fn seek(&mut self, _plan: &Plan, _gate: &mut Gate<'_>) -> Result<IndexSearch, DriveFault> {
        Err(DriveFault::at(0, DriveError::no_index(self.id())))
    }

    /// Waits for at least `settle_s`, until nothing noticeable can still arrive in the vessel. The wait ends
    /// early when `watch` breaks. A time that is negative or no finite number is none.
    ///
    /// Returns the volume that the vessel received since the last plan was begun, in mL. Returns `None` if
    /// nobody can read it, or if the wait ended early.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the drive failed meanwhile.
    fn settle(&mut self, settle_s: f64, watch: &mut Watch<'_>) -> Result<Option<f64>, DriveError> {
        let wait = wait_of(settle_s);
        let began = Instant::now();
        while began.elapsed() < wait && watch().is_continue() {
            sleep(POLL.min(wait.saturating_sub(began.elapsed())));
        }
        Ok(None)
    }

    /// Returns the time of the last motion by the drive's own clock, in s. `None` for a drive whose motions take as
    /// long as the computer's clock says.
    fn simulated_s(&self) -> Option<f64> {
        None
    }

    /// Returns the notes for the user to read before the device moves, and after it has. Each note is returned once.
    fn notes(&mut self) -> Vec<Notice> {
        Vec::new()
    }

    /// Releases the rotor. It is called only if [`Abilities::release`] says that the drive can.
    ///
    /// # Errors
    ///
    /// [`DriveError`] if the device cannot be reached, refuses, or cannot let go of its motor.
    fn release(&mut self) -> Result<(), DriveError> {
        Err(DriveError::no_release(self.id()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_waited_for_as_long_as_it_settles_and_never_for_a_time_that_does_not_end() {
        assert_eq!(wait_of(1.5), Duration::from_millis(1500));
        for settle_s in [0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300] {
            assert_eq!(wait_of(settle_s), Duration::ZERO, "{settle_s}");
        }
    }
}
