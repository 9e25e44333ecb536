//! Advice to a person: the remedies of errors in the words of the command.

use pump_bench::report::{Explain, Remedy};

/// The text of an error, and its remedies after that.
pub(crate) fn told(error: &impl Explain) -> String {
    let remedies = error.remedies().into_iter().map(|remedy| format!("; {}", words(remedy)));
    error.to_string() + &remedies.collect::<String>()
}

/// The words of a remedy: the command or the option that does it.
fn words(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::FinishOrAccept => {
            "see `dose status`, then finish it with `dose resume` or accept it as it is with `dose discard`"
        }
        Remedy::FinishAtLowFlowOrAccept => {
            "`dose resume` without --finish any goes on to that end, `dose discard` accepts the dose as it is"
        }
        Remedy::FinishOrAcceptThenFindAngle => {
            "finish the dose with `dose resume` or accept it as it is with `dose discard`, then find the angle anew"
        }
        Remedy::Accept => "accept the dose as it is with `dose discard`",
        Remedy::DropCarry => "ask for more than the carry, or drop the carry with `dose home --set`",
        Remedy::ReplaceTube => "replace the tube and say `dose tube --new`",
        Remedy::SeeStatus => "see `dose status`",
        Remedy::ThenSeeStatus => "then see `dose status`",
        Remedy::SeeStatusThenFinish => "see `dose status`, then `dose resume` or `dose discard`",
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
        Remedy::UseNoCalibration => "to dose without a calibration, say `dose calibrate use none`",
        Remedy::CalibrateMoreSpeeds => {
            "dose within that, calibrate more speeds, or say `dose calibrate use none`"
        }
        Remedy::CalibrateAgain => "calibrate again, or say `dose calibrate use none`",
        Remedy::BeginCalibrationAnew => "correct the file, or begin anew with `dose calibrate run --anew`",
        Remedy::WriteOrConfirmPump => {
            "write your pump's values into a pump file, without confirmed = false, and name it with --pump; or say \
             --confirm-pump once if these are the values of your pump"
        }
        Remedy::MorePitchesOrFindAngle => "make it more pitches long, or find the angle with `dose home`",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli;

    #[test]
    fn advice_names_commands_and_options_that_there_are() {
        let root = cli::command();
        for remedy in Remedy::ALL {
            let advice = words(*remedy);
            for quoted in advice.split('`').skip(1).step_by(2) {
                let mut at = &root;
                for word in quoted.split(' ').skip(1) {
                    match word.strip_prefix("--") {
                        Some(option) => assert!(
                            at.get_arguments().any(|arg| arg.get_long() == Some(option)),
                            "{word} in {advice}"
                        ),
                        None if ["none", "<ANGLE>"].contains(&word) => {}
                        None => at = at.find_subcommand(word).unwrap_or_else(|| panic!("{word} in {advice}")),
                    }
                }
                assert!(quoted.starts_with("dose "), "{advice}");
            }
        }
    }
}
