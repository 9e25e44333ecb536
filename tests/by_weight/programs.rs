//! Claims about a balance that a program reads, which prints at once what it shows.

use std::time::Duration;

use crate::balance::Speech;
use crate::rig::{Rig, heard, number, truth};

/// A command of the shell that asks the simulated balance, and prints its mass whether it stands still or not.
fn program(rig: &Rig) -> String {
    let port = rig.balance.path().display();
    format!("exec 3<>'{port}'; printf 'SI\\r\\n' >&3; read -r _ _ mass unit <&3; echo \"$mass $unit\"")
}

#[test]
fn a_calibration_by_a_program_waits_until_the_balance_has_settled() {
    heard(|| {
        // The balance lags by 0.5 s, so that at once it lacks some mL of 14 mL/s.
        let rig = Rig::new(Speech::MtSics, crate::balance::Truth { lag_s: 0.5, ..truth() });
        let run = ["calibrate", "run", "--speeds", "40rpm", "--runs", "1", "--volume", "50mL"];
        let found = rig.json(&[&run[..], &["--scale-command", &program(&rig)]].concat());
        let factor = number(&found["displacement"], "factor");
        // A drop of 0.04 mL hangs or fell before.
        assert!((factor - truth().factor).abs() < 0.04 / 50.0 + 5e-4, "{factor}: {found}");
    });
}

#[test]
fn a_program_that_hangs_hears_ctrl_c_and_its_deadline() {
    heard(|| {
        let rig = Rig::new(Speech::MtSics, truth());
        for hangs in ["sleep 1000", "sleep 1000; echo 1 g", "yes"] {
            let words = ["5g", "--until-scale", "--scale-wait", "1s", "--scale-command", hangs];
            let ended = rig.types(&words);
            assert_eq!((ended.code, rig.steps()), (Some(2), 0), "{hangs}: {ended:?}");
            let told =
                ended.err.contains("said nothing within 1 s") || ended.err.contains("prints without end");
            assert!(told, "{}", ended.err);
        }
        let begun = rig.path("begun");
        let command = format!("echo > '{}'; sleep 1000", begun.display());
        let child = rig.begins(&["5g", "--until-scale", "--scale-command", &command], 0);
        while !begun.exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        let ended = crate::rig::interrupted(child);
        assert_eq!((ended.code, rig.steps()), (Some(130), 0), "{ended:?}");
    });
}
