//! Advice to a person: the remedies of errors and warnings in the words of the command.

use std::error::Error;
use std::fmt;

use pump_bench::notice::Remedy;
use pump_bench::report::Explain;
use pump_bench::units::QuantityError;

/// The text of an error and its sources, and its remedies after that.
pub(crate) fn told(error: &impl Explain) -> String {
    error.told(words)
}

/// The words of a remedy: the command or the option that does it.
#[allow(clippy::too_many_lines, reason = "a table: one line for a remedy")]
pub(crate) fn words(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::FinishOrAccept => {
            "see `dose status`, then finish it with `dose resume` or accept it as it is with `dose accept`"
        }
        Remedy::FinishAtLowFlowOrAccept => {
            "`dose resume` without --finish any goes on to that end, `dose accept` accepts the dose as it is"
        }
        Remedy::FinishOrAcceptThenFindAngle => {
            "finish the dose with `dose resume` or accept it as it is with `dose accept`, then find the angle again"
        }
        Remedy::Accept => "accept the dose as it is with `dose accept`",
        Remedy::ClearStand => {
            "see `dose safety`, then clear it with `dose safety clear NAME --reason <TEXT>`"
        }
        Remedy::EmptyVessel => "empty the vessel and run `dose vessel emptied`",
        Remedy::DropCarry => "ask for more than the carry, or drop the carry with `dose home --set`",
        Remedy::ReplaceTube => "replace the tube and run `dose tube --new`",
        Remedy::SeeStatus => "see `dose status`",
        Remedy::ThenSeeStatus => "then see `dose status`",
        Remedy::SeeStatusThenFinish => "see `dose status`, then `dose resume` or `dose accept`",
        Remedy::FasterDisk => "keep the record on a faster disk with --state-dir or DOSE_STATE_DIR",
        Remedy::OtherFolder => "choose another folder with --state-dir or DOSE_STATE_DIR",
        Remedy::RoomOrOtherFolder => {
            "make room there, or choose another folder with --state-dir or DOSE_STATE_DIR"
        }
        Remedy::AccessOrOtherFolder => {
            "give this user access to it, or choose another folder with --state-dir or DOSE_STATE_DIR"
        }
        Remedy::NameFolder => "name one with --state-dir or DOSE_STATE_DIR",
        Remedy::SayAngle => {
            "see where the rollers stand, move the file away, and say so with `dose home --set <ANGLE>`"
        }
        Remedy::UseNoCalibration => "to dose without a calibration, run `dose calibrate use none`",
        Remedy::CalibrateMoreSpeeds => {
            "dose within that, calibrate more speeds, or run `dose calibrate use none`"
        }
        Remedy::CalibrateAgain => "calibrate again, or run `dose calibrate use none`",
        Remedy::BeginCalibrationAnew => "correct the file, or begin anew with `dose calibrate run --anew`",
        Remedy::TakeLineAwareRamps => "`--ramps line` takes such ramps",
        Remedy::SuckBack => "`--retract` sucks back",
        Remedy::DoseThenWeigh => "make a dose into a tared vessel, then run `dose calibrate last <READING>`",
        Remedy::DoseFromKnownAngle => {
            "make one of these and weigh it, or say the angle before the next with `dose home --set 0deg --tolerance \
             1deg`"
        }
        Remedy::JoinOrBeginAnew => {
            "join the reading to these runs with --add, or calibrate by the reading alone with --anew"
        }
        Remedy::WeighAlone => {
            "calibrate by the reading alone with --anew, or name the fluid that was weighed with --fluid"
        }
        Remedy::StateMaxSpeed => "--max-speed 300rpm says what your motor and tube allow",
        Remedy::ChangeFileAlone => {
            "the file is yours now: change it by hand, or put its old values back before setup writes it again"
        }
        Remedy::NameWeighedFluid => "name the fluid that was weighed with --fluid",
        Remedy::MorePitchesOrFindAngle => "make it more pitches long, or find the angle with `dose home`",
        Remedy::FindAngle => {
            "`dose home --set <ANGLE>` says it; with a sensor or a mark, `dose home --sensor` or `dose home --mark` \
             finds it"
        }
        Remedy::FindAngleOfUnfinished => {
            "`dose home --unfinished --set <ANGLE> --tolerance 1deg` says the angle and how well you see it, and keeps \
             the unfinished dose; with a sensor or a mark, `dose home --unfinished --sensor` or `dose home \
             --unfinished --mark` finds it"
        }
        Remedy::FinishAtConstantSpeed => "`dose resume --rate <FLOW>` makes the rest at constant speed",
        Remedy::FinishAnywhere => "`dose resume --finish any` lets the rest end anywhere",
        Remedy::FindOrSayAngle => {
            "`dose home --set <ANGLE>` says it, and `dose home --sensor` or `dose home --mark` finds it"
        }
        Remedy::BridgeStop => {
            "a board without a stop needs a bridge from its stop input to GND (GP22 of a Pico)"
        }
        Remedy::CheckFaultLevel => {
            "on new wiring see that [drive.pins] driver_fault names the level of its fault output"
        }
        Remedy::ThenFindAngle => {
            "find the angle again once the cause is removed: `dose home --set <ANGLE>` says it, or `dose home \
             --unfinished --set <ANGLE>` while a dose is unfinished; `--sensor` or `--mark` in its place finds it"
        }
        Remedy::FindAngleIfLost => {
            "once the cause is removed, `dose status` tells how well the angle is known; where it is unknown, `dose \
             home --set <ANGLE>` says it, or `dose home --unfinished --set <ANGLE>` while a dose is unfinished; \
             `--sensor` or `--mark` in place of `--set` finds it"
        }
        Remedy::FindAngleDropCarry => "`dose home` finds the angle and drops the carry",
        Remedy::TurnAndSayAngle => {
            "to dose other volumes, turn a roller to where it begins to leave the outlet and run `dose home \
             --set 0deg`, or give --start-angle"
        }
        Remedy::SayAngleOrMark => {
            "say where the rollers stand with `dose home --set <ANGLE>`, or turn them to a mark with `dose \
             home --mark`"
        }
        Remedy::GentlerFlow => {
            "make the flow smaller there or let it change over a longer time, or raise [motor] max_acceleration_rad_s2 \
             and max_speed_rpm in the pump file if the motor can follow; `dose run --rate <FLOW>` keeps the mean flow \
             alone, and pulsates"
        }
        Remedy::SayExactAngle => {
            "`dose home --set <ANGLE> --tolerance 0deg` says the angle; `dose home --sensor` finds it to a step only \
             with index_width_deg = 0 in [drive], beside index_angle_deg, for a sensor that answers within a step"
        }
        Remedy::SetAngle => "say where they stand with `dose home --set <ANGLE>`",
        Remedy::HomeBySensorOrMark => "run `dose home`",
        Remedy::SayUnknownAngle => "if nobody knows the angle, run `dose home --unknown`",
        Remedy::FinishOrLeave => "`dose resume` makes the rest, `dose accept` leaves it",
        Remedy::FinishByVolumeOrWeigh => {
            "`dose resume --until-scale` goes on while the vessel stands on its balance; `dose resume` makes the rest \
             by volume; `dose accept` accepts it, then weigh the vessel and dose what it lacks"
        }
        Remedy::AcceptInstead => "`dose accept` accepts the dose as it is instead",
        Remedy::AcceptAndWeigh => {
            "with the vessel still on its balance, `dose resume --until-scale` makes it by weight; `dose accept` \
             accepts the dose instead, then weigh the vessel and dose by weight what it lacks"
        }
        Remedy::RotorTurnedByHand => {
            "if the rotor was turned by hand since its angle was recorded, accept the dose with `dose accept`, run \
             `dose home --unknown`, and dose again"
        }
        Remedy::FinishByVolumeInstead => {
            "`dose resume` without --until-scale makes the rest by volume; `dose accept` accepts the dose, then \
             weigh the vessel and dose what it lacks"
        }
        Remedy::PutVesselBack => {
            "put the vessel back as the dose left it, or accept the dose with `dose accept`, then weigh the vessel \
             and dose what it lacks"
        }
        Remedy::RaiseCeiling => {
            "find where the rest went; then `--max-volume` allows more, or `dose accept` accepts the dose as it is"
        }
        Remedy::NameMotor => {
            "accept the dose with `dose accept`, and name a motor with --driver and --port, or in [drive] of the \
             pump file"
        }
        Remedy::OtherProtocol => "name the balance's own protocol with --scale-protocol",
        Remedy::CheckBalance => {
            "check its cable and power, and see if --scale-protocol and --scale-line are those of the balance"
        }
        Remedy::OtherScalePort => "name the port of the balance with --scale-port",
        Remedy::NoteNewTube => "have a new one ready and run `dose tube --new` once it is in",
        Remedy::Weigh => "`dose calibrate run` weighs what it delivers",
        Remedy::CalibrateRuns => "run `dose calibrate run`",
        Remedy::WeighToBeSurer => "`dose calibrate run` makes it surer",
        Remedy::WeighOneMore => "make the dose again, then run `dose calibrate last <READING>`",
        Remedy::Verify => "run `dose calibrate verify`",
        Remedy::FindPhase => "run `dose calibrate phase`",
        Remedy::UseShortDoses => "run `dose calibrate phase --use`",
        Remedy::UsePhase => "`--use` has doses use all three",
        Remedy::UseCalibration => "`dose calibrate use <N>` uses one",
        Remedy::UseModel => "`dose calibrate use none` goes back to the model",
        Remedy::ContinueCalibration => "`dose calibrate run --continue` goes on with it",
        Remedy::SeeWhyUnreadable => "`dose calibrate run --continue` says why",
        Remedy::SlowDown => "`--rate` sets the rate",
        Remedy::EndAtLowFlow => "`--finish low-flow` ends it there",
        Remedy::SuckBackLess => "suck back less, or dose at a lower rate",
        Remedy::LeaveSmoothOut => {
            "leave --smooth out, or smooth = true of a rack's step; or drive the motor by a board with driver = \
             \"node\" or \"klipper\" in [drive]"
        }
        Remedy::FlowByNode => {
            "run at a --rate, or drive the motor by a board with driver = \"node\" or \"klipper\" in [drive]"
        }
        Remedy::LeaveRampsOut => {
            "leave --ramps out; `dose home --configure` sets the board's acceleration to the best for the \
             pump's default rate"
        }
        Remedy::BeginOneByOne => "begin the motions one after another",
        Remedy::SwitchOff => "switch its power off",
        Remedy::CheckCable => "check its cable and power",
        Remedy::NamePort => "give `--port /dev/ttyUSB0`, or port = \"...\" in [drive]",
        Remedy::FindPort => {
            "plug the board's cable in and name its port with --port; `dose setup` finds the boards that answer"
        }
        Remedy::JoinPortGroup => {
            "add this user to the port's group, dialout on most systems (sudo usermod -aG dialout USER), and log in \
             anew"
        }
        Remedy::PortEachTime => "without it every command needs --port",
        Remedy::Configure => "`--configure` sets it",
        Remedy::ConfigureOrRaise => "`--configure` sets it, or raise [motor] max_acceleration_rad_s2",
        Remedy::AcceptSettings => {
            "if another board is at this port, connect the pump's own board or name its port with --port; if you \
             changed the settings or replaced the board, use `--accept-settings` once with each pump of the board, or \
             once with their rack; otherwise set them back"
        }
        Remedy::AcceptBoard => {
            "if the board was replaced, use `--accept-settings` once with each of its pumps, or once with their rack"
        }
        Remedy::WriteSettingsAnew => "`--accept-settings` writes it anew",
        Remedy::ResetBoard => {
            "if nobody else uses it, `--accept-settings` resets it and takes it, once: each of its motors is without \
             current meanwhile"
        }
        Remedy::WritePins => "`dose setup` writes such a file",
        Remedy::TakePlace => "`--accept-settings` gives it to this pump, once",
        Remedy::SeekOffset => "seek it with --offset",
        Remedy::CheckPump => "`dose pumps check` says what they give",
        Remedy::PrintSource => "print it anew with `dose pumps show NAME --format rust`",
        Remedy::ListHeads => "`dose pumps list --catalogue` lists the heads",
        Remedy::WriteOrConfirmPump => {
            "say --confirm-pump once if these are the values of your pump; otherwise write your pump's values into its \
             pump file, without confirmed = false and direction_confirmed = false, and name the file with --pump"
        }
        Remedy::ConfirmTurning => {
            "say --confirm-pump once if the pump file is right now, and watch the motor; otherwise set the file back"
        }
        Remedy::UpdateFirmware => {
            "build the firmware of this version (make firmware), hold the board's button BOOTSEL while you plug its \
             cable in, and drag target/pump-node.uf2 onto the drive that appears"
        }
        Remedy::UpdateProgram => "install a version of this program that is as new as the firmware",
        Remedy::DescribeHose => {
            "give the line's hose in the pump file, [inlet.hose] or [outlet.hose], and its resistance follows the fluid"
        }
    }
}

/// A quantity that was refused. Its text has the remedies in the words of the command.
#[derive(Debug)]
pub(crate) struct Advised(pub(crate) QuantityError);

impl fmt::Display for Advised {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(&told(&self.0))
    }
}

impl Error for Advised {}

#[cfg(test)]
mod tests {
    use clap::Command;

    use super::*;
    use crate::cli;

    /// Words of an advice that stand for a value.
    const VALUES: [&str; 16] = [
        "<READING>",
        "<TEXT>",
        "none",
        "any",
        "<ANGLE>",
        "<FLOW>",
        "<N>",
        "0deg",
        "1deg",
        "NAME",
        "rust",
        "low-flow",
        "line",
        "/dev/ttyUSB0",
        "sbi",
        "mt-sics",
    ];

    /// True if the command or one below it has the option.
    fn has(command: &Command, option: &str) -> bool {
        command.get_arguments().any(|arg| arg.get_long() == Some(option))
            || command.get_subcommands().any(|below| has(below, option))
    }

    #[test]
    fn advice_names_commands_and_options_that_there_are() {
        let root = cli::command();
        for remedy in Remedy::ALL {
            let advice = words(*remedy);
            for quoted in advice.split('`').skip(1).step_by(2) {
                let mut at = &root;
                let mut named = quoted.split(' ').peekable();
                let is_command = named.next_if_eq(&"dose").is_some();
                for word in named {
                    match word.strip_prefix("--") {
                        Some(option) if is_command => assert!(
                            at.get_arguments().any(|arg| arg.get_long() == Some(option)),
                            "{word} in {advice}"
                        ),
                        Some(option) => assert!(has(&root, option), "{word} in {advice}"),
                        None if VALUES.contains(&word) => {}
                        None => at = at.find_subcommand(word).unwrap_or_else(|| panic!("{word} in {advice}")),
                    }
                }
                assert!(is_command || quoted.starts_with("--"), "{advice}");
            }
            for word in advice.split([' ', ',', ';', '`']) {
                if let Some(option) = word.strip_prefix("--") {
                    assert!(has(&root, option), "{word} in {advice}");
                }
            }
        }
    }
}
