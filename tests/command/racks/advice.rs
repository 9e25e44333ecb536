//! The commands that a rack's messages name: each means the pump of the rack that it is about.

use std::fs;
use std::process::{Command, Stdio};

use super::{MIX, desk};
use crate::user::{Answer, User};

/// A desk with a rack of two pumps, neither of which is the pump that a command without `--pump` means.
fn two_others(steps: &str) -> User {
    let rack = format!(
        "schema = \"rack/1\"\n[pumps]\nleft = \"two-roller\"\nright = \"pumps/base.toml\"\n[[step]]\nratio = {{ left = \
         1, right = 1 }}\n{steps}"
    );
    let user = desk(&rack);
    let pump =
        user.types(&["pumps", "show", "two-roller"]).out.replace("id = \"two-roller\"", "id = \"base-id\"");
    fs::create_dir(user.path("pumps")).unwrap();
    fs::write(user.path("pumps/base.toml"), pump).unwrap();
    user
}

/// Stops the rack by Ctrl-C once both pumps move.
fn stopped(user: &User) -> Answer {
    let mut command = user.command(&["run", "mix.toml"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    user.until_moved("two-roller");
    user.until_moved("base-id");
    assert!(Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Answer { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

#[test]
fn a_stopped_rack_names_the_rest_of_each_pump_and_the_steps_that_did_not_begin() {
    let user = two_others(
        "volume = \"90mL\"\nrate = \"1mL/s\"\n[[step]]\npump = \"left\"\nvolume = \"1mL\"\n[[step]]\npump = \
         \"left\"\nvolume = \"1mL\"\n",
    );
    // The pump of a command without `--pump` is not in the rack, and its unfinished dose stays.
    assert_eq!(user.types(&["5mL"]).code, 0);
    let answer = stopped(&user);
    assert_eq!(answer.code, 130, "{}", answer.err);
    let row = |name: &str| answer.out.lines().find(|line| line.starts_with(name)).unwrap().to_owned();
    let (left, right) = (row("left"), row("right"));
    assert!(left.contains(", 0 of 3 steps done, ") && left.ends_with(", 2 steps not begun"), "{left}");
    assert!(left.contains("the rest of the unfinished step is on record") && !right.contains("not begun"));
    for told in [
        "`dose resume --pump two-roller` makes the rest of left",
        "`dose resume --pump pumps/base.toml` makes the rest of right",
        "; steps that did not begin are in no rest: 2 of left\n",
    ] {
        assert!(answer.err.contains(told), "{told}: {}", answer.err);
    }
    let refused = user.types(&["run", "mix.toml", "--pace", "fast"]);
    assert_eq!(refused.code, 4, "{}", refused.err);
    let (pumps, before) = (["two-roller", "pumps/base.toml"], user.record());
    for (name, pump) in ["left", "right"].iter().zip(pumps) {
        assert!(refused.err.contains(&format!("pump `{name}` of the rack: ")), "{}", refused.err);
        let command = format!("dose resume --pump {pump}");
        assert!(refused.err.contains(&format!("finish it with `{command}`")), "{}", refused.err);
        let words: Vec<&str> = command.split(' ').skip(1).collect();
        assert_eq!(user.types(&words).code, 0, "{command}");
        assert!(user.json(&["status", "--pump", pump])["unfinished"].is_null());
    }
    assert_eq!(user.record(), before, "another pump was not touched");
}

#[test]
fn every_pump_of_a_rack_that_stands_is_named_with_the_word_that_clears_it() {
    let user = two_others("volume = \"6mL\"\nrate = \"6mL/s\"\n");
    for _ in 0..2 {
        // The second time both pumps stand already.
        let answer = user.types(&["run", "mix.toml", "--pace", "fast", "--max-per-day", "1mL"]);
        assert_eq!(answer.code, 5, "{}", answer.err);
        for (name, pump) in [("left", "two-roller"), ("right", "pumps/base.toml")] {
            assert!(answer.err.contains(&format!("pump `{name}` of the rack: ")), "{}", answer.err);
            let clear = format!("`dose safety clear {pump} --reason <TEXT>`");
            assert!(answer.err.contains(&clear), "{clear}: {}", answer.err);
        }
    }
    for pump in ["two-roller", "pumps/base.toml"] {
        assert_eq!(user.types(&["safety", "clear", pump, "--reason", "a test"]).code, 0);
    }
    assert_eq!(user.types(&["run", "mix.toml", "--pace", "fast"]).code, 0);
}

#[test]
fn a_warning_of_a_rack_names_the_command_of_its_pump() {
    let user = two_others("volume = \"6mL\"\nrate = \"6mL/s\"\n");
    assert_eq!(user.types(&["home", "--unknown", "--pump", "pumps/base.toml"]).code, 0);
    let answer = user.types(&["run", "mix.toml", "--dry-run"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    let warning =
        answer.out.lines().find(|line| line.starts_with("warning: right: ") && line.contains("`dose home"));
    assert!(warning.unwrap().contains(" --pump pumps/base.toml`"), "{}", answer.out);
}

#[test]
fn a_pump_of_a_rack_that_cannot_be_read_hides_no_other_row() {
    let user = desk(&MIX.replace("two-roller", "none.toml"));
    let answer = user.types(&["status", "--rack", "mix.toml"]);
    assert_eq!(answer.code, 2, "{}", answer.err);
    let rows: Vec<&str> = answer.out.lines().collect();
    assert!(rows[0].starts_with("acid  nothing on record"), "{}", answer.out);
    assert!(rows[1].starts_with("base  cannot be read: cannot read pump file none.toml"), "{}", answer.out);
    assert!(answer.err.contains("1 of 2 pumps cannot be read: base"), "{}", answer.err);
}

#[test]
fn a_smooth_step_or_dose_on_a_board_with_ramps_of_its_own_names_the_way_without_and_the_driver_node() {
    let user = two_others("volume = \"6mL\"\nrate = \"6mL/s\"\n");
    let rack = "schema = \"rack/1\"\n[pumps]\nright = \"pumps/base.toml\"\n[[step]]\npump = \"right\"\nvolume = \
                \"1mL\"\nrate = \"1mL/s\"\nsmooth = true\n";
    fs::write(user.path("mix.toml"), rack).unwrap();
    let pump = fs::read_to_string(user.path("pumps/base.toml")).unwrap();
    let drive = "\n[drive]\ndriver = \"grbl\"\nport = \"/dev/ttyUSB99\"\n";
    fs::write(user.path("pumps/base.toml"), pump + drive).unwrap();
    let step = user.is_refused(&["run", "mix.toml", "--dry-run"]);
    assert!(step.contains("pump `right` of the rack, step 1: "), "{step}");
    let dose = user.is_refused(&["1mL", "--pump", "pumps/base.toml", "--smooth", "--dry-run"]);
    for refused in [step, dose] {
        let advice = "leave --smooth out, or smooth = true of a rack's step; or drive the motor by a board with driver \
                      = \"node\" or \"klipper\" in [drive]";
        assert!(refused.contains(advice) && !refused.contains("resume"), "{refused}");
    }
}
