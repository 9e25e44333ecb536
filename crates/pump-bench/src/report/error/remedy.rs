//! Remedies: what a person can do about an error. A shell words them as its users act.

/// Remedy of an error. The command words it with its own commands and options, Python with its methods.
///
/// The enum is exhaustive on purpose: every shell that words remedies has words for each of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Remedy {
    /// Look at the status, then make the rest of the unfinished dose or accept the dose as it is.
    FinishOrAccept,
    /// Make the rest of the unfinished dose up to its end at low flow, or accept the dose as it is.
    FinishAtLowFlowOrAccept,
    /// Make the rest of the unfinished dose or accept the dose as it is. Find the angle after that.
    FinishOrAcceptThenFindAngle,
    /// Accept the unfinished dose as it is.
    Accept,
    /// Ask for more than the carry, or drop the carry.
    DropCarry,
    /// Replace the tube, and put that on record.
    ReplaceTube,
    /// Look at the status.
    SeeStatus,
    /// Look at the status once the cause is removed.
    ThenSeeStatus,
    /// Look at the status, then resume or accept what the fault left.
    SeeStatusThenFinish,
    /// Keep the record on a faster disk.
    FasterDisk,
    /// Keep the record in another folder.
    OtherFolder,
    /// Make room on the disk, or keep the record in another folder.
    RoomOrOtherFolder,
    /// Give this user access to the folder, or keep the record in another one.
    AccessOrOtherFolder,
    /// Name a folder for the record.
    NameFolder,
    /// Look where the rollers stand, move the damaged journal away, and say the angle.
    SayAngle,
    /// Dose without a calibration.
    UseNoCalibration,
    /// Dose at a calibrated speed, calibrate more speeds, or dose without a calibration.
    CalibrateMoreSpeeds,
    /// Calibrate again, or dose without a calibration.
    CalibrateAgain,
    /// Correct the file of readings, or begin the guided calibration anew.
    BeginCalibrationAnew,
    /// Turn more pitches, or find the angle.
    MorePitchesOrFindAngle,
    /// Write the values of the own pump into a pump file, or confirm that the values are right.
    WriteOrConfirmPump,
}

impl Remedy {
    /// Every remedy.
    pub const ALL: &[Self] = &[
        Self::FinishOrAccept,
        Self::FinishAtLowFlowOrAccept,
        Self::FinishOrAcceptThenFindAngle,
        Self::Accept,
        Self::DropCarry,
        Self::ReplaceTube,
        Self::SeeStatus,
        Self::ThenSeeStatus,
        Self::SeeStatusThenFinish,
        Self::FasterDisk,
        Self::OtherFolder,
        Self::RoomOrOtherFolder,
        Self::AccessOrOtherFolder,
        Self::NameFolder,
        Self::SayAngle,
        Self::UseNoCalibration,
        Self::CalibrateMoreSpeeds,
        Self::CalibrateAgain,
        Self::BeginCalibrationAnew,
        Self::MorePitchesOrFindAngle,
        Self::WriteOrConfirmPump,
    ];
}
