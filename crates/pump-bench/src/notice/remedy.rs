//! Remedies: what a person can do about an error or a warning. A front end words them as its users act.

/// Words of a front end for each remedy: the command names its commands and options, Python its methods.
pub type Wording = fn(Remedy) -> &'static str;

/// Remedy of an error or a warning. The command words it with its own commands and options, Python with its methods.
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
    /// Clear the stand of a pump, with a reason.
    ClearStand,
    /// Empty the receiving vessel, and put that on record.
    EmptyVessel,
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
    /// Take the ramps that leave the line at rest.
    TakeLineAwareRamps,
    /// Suck back after the dose.
    SuckBack,
    /// Make a dose, then weigh it before the pump turns again.
    DoseThenWeigh,
    /// Find the angle or dose whole pitches, then weigh that dose.
    DoseFromKnownAngle,
    /// Join the reading to the runs of the calibration in use, or calibrate by the reading alone.
    JoinOrBeginAnew,
    /// Calibrate by the reading alone, or say the fluid of the earlier ones.
    WeighAlone,
    /// State the fastest speed of the head.
    StateMaxSpeed,
    /// Put the written values back into a pump file, or go on changing it by hand.
    ChangeFileAlone,
    /// Name the fluid that was weighed.
    NameWeighedFluid,
    /// Find the angle of the rollers.
    FindAngle,
    /// Find the angle of the rollers of an unfinished dose, which stays on record.
    FindAngleOfUnfinished,
    /// Make the rest of the unfinished dose at a constant speed.
    FinishAtConstantSpeed,
    /// Make the rest of the unfinished dose up to any end.
    FinishAnywhere,
    /// Find the angle of the rollers, or say it.
    FindOrSayAngle,
    /// Bridge the stop input of a board that has no emergency stop.
    BridgeStop,
    /// See that the pump file names the level of the stepper driver's fault output.
    CheckFaultLevel,
    /// Find the angle of the rollers again once the cause is removed.
    ThenFindAngle,
    /// See how well the angle of the rollers is known once the cause is removed, and find it if it is lost.
    FindAngleIfLost,
    /// Find the angle of the rollers, which drops the carry.
    FindAngleDropCarry,
    /// Turn a roller to where it begins to leave the outlet and say so, or state the angle for a dose.
    TurnAndSayAngle,
    /// Say where the rollers stand, or turn them to their mark.
    SayAngleOrMark,
    /// Find the angle of the rollers by a sensor, or say it without a tolerance.
    SayExactAngle,
    /// Let the flow be smaller or change more slowly, or allow the motor more acceleration.
    GentlerFlow,
    /// Say where the rollers stand.
    SetAngle,
    /// Find the angle of the rollers by a sensor or a mark.
    HomeBySensorOrMark,
    /// Say that nobody knows the angle.
    SayUnknownAngle,
    /// Make the rest of the unfinished dose, or leave it.
    FinishOrLeave,
    /// Make the rest of an unfinished dose by weight by volume, or accept the dose and weigh it.
    FinishByVolumeOrWeigh,
    /// Accept the unfinished dose in place of its rest.
    AcceptInstead,
    /// Accept the unfinished dose, and dose by weight what the vessel lacks.
    AcceptAndWeigh,
    /// Accept the dose, say that nobody knows the angle, and dose again, if the rotor was turned by hand.
    RotorTurnedByHand,
    /// Make the rest by volume, or accept the dose and weigh the vessel.
    FinishByVolumeInstead,
    /// Put the vessel back as the dose left it, or accept the dose and weigh the vessel.
    PutVesselBack,
    /// Allow the pump to turn for more, or accept the dose.
    RaiseCeiling,
    /// Accept the dose, and name the driver and the port of a motor.
    NameMotor,
    /// Name the other protocol of balances.
    OtherProtocol,
    /// Check cable, power, protocol and line of the balance.
    CheckBalance,
    /// Name the port of the balance.
    OtherScalePort,
    /// Have a new tube ready, and put on record when it is in.
    NoteNewTube,
    /// Weigh what the pump delivers.
    Weigh,
    /// Calibrate with weighed runs.
    CalibrateRuns,
    /// Calibrate the pump of a file, which makes its uncertainty smaller.
    WeighToBeSurer,
    /// Make one more dose like the one that was weighed, and weigh it.
    WeighOneMore,
    /// Verify the scatter of doses.
    Verify,
    /// Find roller volume and zero with short doses.
    FindPhase,
    /// Weigh short doses, and have doses use them.
    UseShortDoses,
    /// Have doses use what short doses show.
    UsePhase,
    /// Use a calibration that is on record.
    UseCalibration,
    /// Go back to the model from a calibration.
    UseModel,
    /// Go on with the guided calibration.
    ContinueCalibration,
    /// See why the readings of the guided calibration cannot be read.
    SeeWhyUnreadable,
    /// Choose a slower rate.
    SlowDown,
    /// End the dose at low flow.
    EndAtLowFlow,
    /// Suck back less, or dose at a lower rate.
    SuckBackLess,
    /// Dose without a smooth flow, or drive the motor by a board that keeps the times of its steps.
    LeaveSmoothOut,
    /// Run at a rate, or drive the motor by a board that keeps the times of its steps.
    FlowByNode,
    /// Dose with the board's own ramps, and configure the board for them.
    LeaveRampsOut,
    /// Begin the motions of several pumps one after another.
    BeginOneByOne,
    /// Switch the device's power off.
    SwitchOff,
    /// Check the cable and the power of the device.
    CheckCable,
    /// Name a serial port, for this run or in the pump file.
    NamePort,
    /// Plug the board's cable in, and find its port.
    FindPort,
    /// Give this user the right to use serial ports.
    JoinPortGroup,
    /// Name a serial port each time, where the pump file has none.
    PortEachTime,
    /// Have the board's settings written.
    Configure,
    /// Have the board's acceleration written, or raise that of the pump file.
    ConfigureOrRaise,
    /// Connect the pump's own board, accept the board's new settings once, or set them back.
    AcceptSettings,
    /// Have the record of the board's settings written anew.
    WriteSettingsAnew,
    /// Have a board reset that another program has configured, and take it.
    ResetBoard,
    /// Have a pump file written that names the pins of the board.
    WritePins,
    /// Give the pump the place of another one on its board.
    TakePlace,
    /// Connect the board on record, or accept the one at the port from now on.
    AcceptBoard,
    /// Seek the offset of the points too.
    SeekOffset,
    /// See what follows from the pump file.
    CheckPump,
    /// Print the source anew.
    PrintSource,
    /// See the heads of the catalogue.
    ListHeads,
    /// Write the values of the own pump into a pump file, or confirm that the values are right.
    WriteOrConfirmPump,
    /// Confirm that the pump file turns the motor as it should, or set the file back.
    ConfirmTurning,
    /// Update the firmware of the board.
    UpdateFirmware,
    /// Update this program.
    UpdateProgram,
    /// Describe the lines by their hoses, so that their resistance follows the fluid.
    DescribeHose,
}

impl Remedy {
    /// Returns the way to the rotor's angle: while a dose `is_unfinished`, one that keeps it.
    pub(crate) fn finding_angle(is_unfinished: bool) -> Self {
        if is_unfinished { Self::FindAngleOfUnfinished } else { Self::FindAngle }
    }

    /// Every remedy.
    pub const ALL: &[Self] = &[
        Self::FinishOrAccept,
        Self::FinishAtLowFlowOrAccept,
        Self::FinishOrAcceptThenFindAngle,
        Self::Accept,
        Self::ClearStand,
        Self::EmptyVessel,
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
        Self::TakeLineAwareRamps,
        Self::SuckBack,
        Self::DoseThenWeigh,
        Self::DoseFromKnownAngle,
        Self::JoinOrBeginAnew,
        Self::WeighAlone,
        Self::StateMaxSpeed,
        Self::ChangeFileAlone,
        Self::NameWeighedFluid,
        Self::FindAngle,
        Self::FindAngleOfUnfinished,
        Self::FinishAtConstantSpeed,
        Self::FinishAnywhere,
        Self::FindOrSayAngle,
        Self::BridgeStop,
        Self::CheckFaultLevel,
        Self::ThenFindAngle,
        Self::FindAngleIfLost,
        Self::FindAngleDropCarry,
        Self::TurnAndSayAngle,
        Self::SayAngleOrMark,
        Self::SayExactAngle,
        Self::GentlerFlow,
        Self::SetAngle,
        Self::HomeBySensorOrMark,
        Self::SayUnknownAngle,
        Self::FinishOrLeave,
        Self::FinishByVolumeOrWeigh,
        Self::AcceptInstead,
        Self::AcceptAndWeigh,
        Self::RotorTurnedByHand,
        Self::FinishByVolumeInstead,
        Self::PutVesselBack,
        Self::RaiseCeiling,
        Self::NameMotor,
        Self::OtherProtocol,
        Self::CheckBalance,
        Self::OtherScalePort,
        Self::NoteNewTube,
        Self::Weigh,
        Self::CalibrateRuns,
        Self::WeighToBeSurer,
        Self::WeighOneMore,
        Self::Verify,
        Self::FindPhase,
        Self::UseShortDoses,
        Self::UsePhase,
        Self::UseCalibration,
        Self::UseModel,
        Self::ContinueCalibration,
        Self::SeeWhyUnreadable,
        Self::SlowDown,
        Self::EndAtLowFlow,
        Self::SuckBackLess,
        Self::LeaveSmoothOut,
        Self::FlowByNode,
        Self::LeaveRampsOut,
        Self::BeginOneByOne,
        Self::SwitchOff,
        Self::CheckCable,
        Self::NamePort,
        Self::FindPort,
        Self::JoinPortGroup,
        Self::PortEachTime,
        Self::Configure,
        Self::ConfigureOrRaise,
        Self::AcceptSettings,
        Self::WriteSettingsAnew,
        Self::ResetBoard,
        Self::WritePins,
        Self::TakePlace,
        Self::AcceptBoard,
        Self::SeekOffset,
        Self::CheckPump,
        Self::PrintSource,
        Self::ListHeads,
        Self::WriteOrConfirmPump,
        Self::ConfirmTurning,
        Self::UpdateFirmware,
        Self::UpdateProgram,
        Self::DescribeHose,
    ];
}
