//! Advice to a person: the remedies of errors and warnings in the words of Python.

use pump_bench::notice::{Notice, Remedy};
use pump_bench::report::Explain;

use super::readable::readable;

/// Returns the text of an error and its sources, with its remedies in the words of Python.
pub(crate) fn told(error: &impl Explain) -> String {
    readable(&error.told(words))
}

/// Returns the texts of warnings, with their remedies in the words of Python.
pub(crate) fn worded(notices: &[Notice]) -> Vec<String> {
    notices.iter().map(|notice| notice.worded(words)).collect()
}

/// Words a remedy as a program does it: by a method, an argument, or by hand.
#[allow(clippy::too_many_lines, reason = "a table: one line for a remedy")]
pub(crate) fn words(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::FinishOrAccept => "finish it with bench.resume(), or accept it as it is with bench.discard()",
        Remedy::FinishAtLowFlowOrAccept => {
            "go on to that end with bench.resume(), or accept the dose as it is with bench.discard()"
        }
        Remedy::FinishOrAcceptThenFindAngle => {
            "finish the dose with bench.resume() or accept it with bench.discard(), then find the angle again"
        }
        Remedy::Accept => "accept the dose as it is with bench.discard()",
        Remedy::ClearStand => "see bench.status().safety, then clear it with bench.clear_safety(reason)",
        Remedy::EmptyVessel => "empty the vessel, then call bench.vessel_emptied()",
        Remedy::DropCarry => "ask for more than the carry, or drop the carry with bench.home_set()",
        Remedy::ReplaceTube => "replace the tube, then call bench.new_tube()",
        Remedy::SeeStatus | Remedy::ThenSeeStatus => "then see bench.status()",
        Remedy::SeeStatusThenFinish => "see bench.status(), then call bench.resume() or bench.discard()",
        Remedy::FasterDisk => "keep the record on a faster disk with state_dir",
        Remedy::OtherFolder => "choose another folder with state_dir",
        Remedy::RoomOrOtherFolder => "make room there, or choose another folder with state_dir",
        Remedy::AccessOrOtherFolder => "give this user access to it, or choose another folder with state_dir",
        Remedy::NameFolder => "name one with state_dir",
        Remedy::SayAngle => {
            "see where the rollers stand, move the file away, and say so with bench.home_set(angle_rad)"
        }
        Remedy::UseNoCalibration => "to dose without a calibration, call bench.use_calibration(None)",
        Remedy::CalibrateMoreSpeeds => {
            "dose within that, calibrate more speeds, or call bench.use_calibration(None)"
        }
        Remedy::CalibrateAgain => "calibrate again, or call bench.use_calibration(None)",
        Remedy::BeginCalibrationAnew => "correct the file, or begin anew",
        Remedy::MorePitchesOrFindAngle => {
            "make it more pitches long, or find the angle with bench.home_sensor()"
        }
        Remedy::FindAngle => "bench.home_sensor() or bench.home_mark() finds it",
        Remedy::FindAngleOfUnfinished => {
            "accept the dose with bench.discard(); then bench.home_set(angle_rad) says the angle"
        }
        Remedy::FinishAtConstantSpeed => "bench.resume(rate=...) makes the rest at constant speed",
        Remedy::FinishAnywhere => "bench.resume(finish=\"any\") lets the rest end anywhere",
        Remedy::FindOrSayAngle => "bench.home_sensor() finds it, or bench.home_set(angle_rad) says it",
        Remedy::BridgeStop => {
            "a board without a stop needs a bridge from its stop input to GND (GP22 of a Pico)"
        }
        Remedy::CheckFaultLevel => {
            "on new wiring see that [drive.pins] driver_fault names the level of its fault output"
        }
        Remedy::ThenFindAngle => "find the angle again once the journal can be written",
        Remedy::FindAngleIfLost => {
            "once the cause is removed, bench.status() tells how well the angle is known; where it is unknown, \
             bench.home_sensor() or bench.home_mark() finds it"
        }
        Remedy::FindAngleDropCarry => "bench.home_sensor() finds the angle and drops the carry",
        Remedy::TurnAndSayAngle => {
            "to dose other volumes, turn a roller to where it begins to leave the outlet and call \
             bench.home_set(0.0), or give start_angle_rad"
        }
        Remedy::SayAngleOrMark => {
            "say where the rollers stand with bench.home_set(angle_rad), or turn them to a mark and call \
             bench.home_mark()"
        }
        Remedy::GentlerFlow => {
            "make the flow smaller there or let it change over a longer time, or raise [motor] \
             max_acceleration_rad_s2 and max_speed_rpm in the pump file if the motor can follow; a run at a rate \
             keeps the mean flow alone, and pulsates"
        }
        Remedy::SayExactAngle => {
            "Bench.home_set() with a tolerance of 0deg says the angle; Bench.home_sensor() finds it to a step only \
             with index_width_deg = 0 in [drive], for a sensor that answers within a step"
        }
        Remedy::SetAngle => "say where they stand with bench.home_set(angle_rad)",
        Remedy::HomeBySensorOrMark => "call bench.home_sensor() or bench.home_mark()",
        Remedy::SayUnknownAngle => "if nobody knows the angle, call bench.home_set(None)",
        Remedy::FinishOrLeave => "bench.resume() makes the rest, bench.discard() leaves it",
        Remedy::FinishByVolumeOrWeigh => {
            "bench.resume(until_scale=balance) goes on while the vessel stands on its balance; bench.resume() makes \
             the rest by volume; bench.discard() accepts it, then weigh the vessel and dose what it lacks"
        }
        Remedy::AcceptInstead => "bench.discard() accepts the dose as it is instead",
        Remedy::AcceptAndWeigh => {
            "bench.discard() accepts it instead; then weigh the vessel, and dose what it lacks"
        }
        Remedy::RotorTurnedByHand => {
            "if the rotor was turned by hand since its angle was recorded, call bench.discard() and \
             bench.home_set(None), and dose again"
        }
        Remedy::FinishByVolumeInstead => {
            "bench.resume() makes the rest by volume; bench.discard() accepts the dose, then weigh the vessel and \
             dose what it lacks"
        }
        Remedy::PutVesselBack => {
            "put the vessel back as the dose left it, or call bench.discard(), then weigh the vessel and dose what \
             it lacks"
        }
        Remedy::RaiseCeiling => {
            "find where the rest went; then max_volume allows more, or bench.discard() accepts the dose as it is"
        }
        Remedy::NameMotor => {
            "call bench.discard(), and name a motor with driver and port, or in [drive] of the pump file"
        }
        Remedy::OtherProtocol => "name the balance's own protocol with protocol",
        Remedy::CheckBalance => {
            "check its cable and power, and see if protocol and line are those of the balance"
        }
        Remedy::OtherScalePort => "name the port of the balance",
        Remedy::NoteNewTube => "have a new one ready and call bench.new_tube() once it is in",
        Remedy::Weigh => "bench.calibration_run() delivers a run to be weighed",
        Remedy::CalibrateRuns => "see bench.calibration_run()",
        Remedy::WeighToBeSurer => "bench.calibrate() makes it surer",
        Remedy::WeighOneMore => "make the dose again, then call bench.calibrate_last()",
        Remedy::Verify => "see bench.verify()",
        Remedy::FindPhase => "see bench.calibrate_phase()",
        Remedy::UseShortDoses => "see bench.calibrate_phase()",
        Remedy::TakeLineAwareRamps => "ramps=\"line\" takes such ramps",
        Remedy::SuckBack => "retract sucks back",
        Remedy::DoseThenWeigh => "make a dose into a tared vessel, then call bench.calibrate_last()",
        Remedy::DoseFromKnownAngle => {
            "make one of these and weigh it, or say the angle before the next with bench.home_set()"
        }
        Remedy::WeighAlone => {
            "calibrate by the reading alone with anew=True, or name the fluid that was weighed with fluid= of pm.Bench"
        }
        Remedy::StateMaxSpeed | Remedy::ChangeFileAlone => "only the command sets up a pump",
        Remedy::NameWeighedFluid => "name the fluid that was weighed with fluid= of pm.Bench",
        Remedy::JoinOrBeginAnew => {
            "join the reading to these runs with add=True, or calibrate by the reading alone with anew=True"
        }
        Remedy::UsePhase => "bench.calibrate_phase(doses) has doses use all three",
        Remedy::UseCalibration => "bench.use_calibration(version) uses one",
        Remedy::UseModel => "bench.use_calibration(None) goes back to the model",
        Remedy::ContinueCalibration => "only the command goes on with it",
        Remedy::SeeWhyUnreadable => "only the command says why",
        Remedy::SlowDown => "rate sets the rate",
        Remedy::EndAtLowFlow => "finish=\"low-flow\" ends it there",
        Remedy::SuckBackLess => "suck back less, or dose at a lower rate",
        Remedy::LeaveSmoothOut => {
            "leave smooth out, or drive the motor by a board with the driver `node` or `klipper`"
        }
        Remedy::FlowByNode => {
            "run at a rate, or drive the motor by a board with the driver `node` or `klipper`"
        }
        Remedy::LeaveRampsOut => {
            "leave ramps out; Bench.open() with configure=True sets the board's acceleration to the best for \
             the pump's default rate"
        }
        Remedy::BeginOneByOne => "begin the motions one after another",
        Remedy::SwitchOff => "switch its power off",
        Remedy::CheckCable => "check its cable and power",
        Remedy::NamePort => "give port=\"/dev/ttyUSB0\", or port = \"...\" in [drive]",
        Remedy::FindPort => "plug the board's cable in and give its port=\"...\"",
        Remedy::JoinPortGroup => {
            "add this user to the port's group, dialout on most systems (sudo usermod -aG dialout USER), and log in \
             anew"
        }
        Remedy::PortEachTime => "without it Bench.open() needs port",
        Remedy::Configure => "Bench.open() with configure=True sets it",
        Remedy::ConfigureOrRaise => {
            "Bench.open() with configure=True sets it, or raise [motor] max_acceleration_rad_s2"
        }
        Remedy::AcceptSettings => {
            "if another board is at this port, connect the pump's own board or name its port; if you changed the \
             settings or replaced the board, open the bench of each of its pumps, or their rack, with \
             accept_settings=True once; otherwise set them back"
        }
        Remedy::AcceptBoard => {
            "if the board was replaced, open the bench of each of its pumps, or their rack, with accept_settings=True \
             once"
        }
        Remedy::ResetBoard => {
            "if nobody else uses it, Bench.open() with accept_settings=True resets it and takes it, once: each of its \
             motors is without current meanwhile"
        }
        Remedy::WritePins => "the command `dose setup` writes such a file",
        Remedy::TakePlace => "Bench.open() with accept_settings=True gives it to this pump, once",
        Remedy::WriteSettingsAnew => "Bench.open() with accept_settings=True writes it anew",
        Remedy::SeekOffset => "seek it with offset=True",
        Remedy::CheckPump => "Pump.from_toml() shows what they give",
        Remedy::PrintSource => "print it anew",
        Remedy::ListHeads => "the page catalogue of the documentation lists the heads",
        Remedy::WriteOrConfirmPump => {
            "write your pump's values into a pump file, without confirmed = false and direction_confirmed = false; or, \
             if these are your pump's, open the bench once with confirm_pump=True"
        }
        Remedy::ConfirmTurning => {
            "open the bench once with confirm_pump=True if the pump file is right now, and watch the motor; otherwise \
             set the file back"
        }
        Remedy::UpdateFirmware => {
            "build the firmware of this version (make firmware), hold the board's button BOOTSEL while you plug its \
             cable in, and drag target/pump-node.uf2 onto the drive that appears"
        }
        Remedy::UpdateProgram => "install a version of this package that is as new as the firmware",
        Remedy::DescribeHose => {
            "give the line's hose in the pump file, [inlet.hose] or [outlet.hose], and its resistance follows the fluid"
        }
    }
}
