//! Claims about balances that are named wrongly: nothing moves, and the message says what is wrong.

use crate::balance::Speech;
use crate::rig::{Rig, heard, truth};

#[test]
fn a_balance_of_the_other_protocol_is_told_by_it() {
    heard(|| {
        for (speech, protocol, words) in [
            (Speech::MtSics, "sbi", "was asked in sbi and said `ES`, which is mt-sics"),
            // A balance of SBI does not answer the question of MT-SICS.
            (Speech::Sbi, "mt-sics", "said nothing within 1 s when it was asked in mt-sics"),
        ] {
            let rig = Rig::new(speech, truth());
            let port = rig.balance.path().to_str().unwrap();
            let scale =
                ["--until-scale", "--scale-port", port, "--scale-protocol", protocol, "--scale-wait", "1s"];
            let ended = rig.types(&[&["5g"][..], &scale].concat());
            assert_eq!((ended.code, rig.steps()), (Some(2), 0), "{ended:?}");
            assert!(ended.err.contains(words) && ended.err.contains("--scale-protocol"), "{}", ended.err);
        }
    });
}

#[test]
fn the_port_of_the_board_is_refused_as_that_of_the_balance_by_any_of_its_names() {
    heard(|| {
        let rig = Rig::new(Speech::MtSics, truth());
        let board = rig.board.path();
        let link = rig.path("scale");
        std::os::unix::fs::symlink(board, &link).unwrap();
        for port in [board.to_str().unwrap(), link.to_str().unwrap()] {
            for words in [
                &["5g", "--until-scale"][..],
                &["calibrate", "run", "--speeds", "10rpm", "--runs", "1"],
                &["calibrate", "verify", "--volume", "10mL"],
            ] {
                let ended = rig.types(&[words, &["--scale-port", port]].concat());
                assert_eq!((ended.code, rig.steps()), (Some(2), 0), "{words:?}: {ended:?}");
                assert!(ended.err.contains("is the port of the pump's board"), "{}", ended.err);
            }
        }
    });
}
