//! Help at a terminal of 80 columns.

use crate::user::User;

/// The help that a terminal of 80 columns shows.
fn shown(words: &[&str]) -> Vec<String> {
    let output = User::new().command(words).env("COLUMNS", "80").output().unwrap();
    assert!(output.status.success(), "{words:?}");
    String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
}

fn fits(lines: &[String], most: usize) {
    assert!(lines.len() <= most, "{} lines:\n{}", lines.len(), lines.join("\n"));
    for line in lines {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

#[test]
fn the_short_help_lists_the_commands_and_ten_options_on_one_screen() {
    let lines = shown(&["-h"]);
    fits(&lines, 47);
    for command in
        ["prime", "purge", "calibrate", "identify", "simulate", "status", "resume", "accept", "release"]
            .into_iter()
            .chain(["tube", "home", "completions", "pumps", "setup", "size"])
    {
        assert!(lines.iter().any(|line| line.starts_with(&format!("  {command} "))), "{command}");
    }
    let options = lines.iter().filter(|line| line.contains(" --") && !line.contains("--help"));
    assert_eq!(options.count(), 10, "{lines:?}");
}

#[test]
fn the_short_help_of_status_fits_a_third_of_a_screen() {
    for words in [&["status", "-h"][..], &["-h", "status"]] {
        let lines = shown(words);
        fits(&lines, 18);
        assert!(lines.iter().any(|line| line.contains("--tube-limit")), "{lines:?}");
        assert!(!lines.iter().any(|line| line.contains("--smooth")), "{lines:?}");
    }
}

#[test]
fn the_long_help_has_every_option_under_a_heading() {
    let lines = shown(&["--help"]);
    for heading in [
        "Amount and speed:",
        "Fluid:",
        "Limits:",
        "Pump and record:",
        "Motor:",
        "Batch:",
        "Output:",
        "Examples:",
    ] {
        assert!(lines.iter().any(|line| line == heading), "{heading}: {lines:?}");
    }
    for option in
        ["--retract", "--max-outlet-pressure", "--state-dir", "--configure", "--missed", "--dt", "--finish"]
    {
        assert!(lines.iter().any(|line| line.contains(option)), "{option}");
    }
}

#[test]
fn completions_know_every_command_and_its_options() {
    let user = User::new();
    for shell in ["bash", "zsh", "fish"] {
        let answer = user.types(&["completions", shell]);
        assert_eq!(answer.code, 0, "{}", answer.err);
        for word in
            ["identify", "max-outlet-pressure", "mark-tolerance", "speed-law", "low-flow", "roller-centric"]
        {
            assert!(answer.out.contains(word), "{shell}: {word}");
        }
    }
}

#[test]
fn printed_lines_end_at_words_within_the_width() {
    let user = User::new();
    let mut command = user.command(&["25mL", "--dry-run", "-v"]);
    let text = String::from_utf8(command.env("COLUMNS", "80").output().unwrap().stdout).unwrap();
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    // A file or a program gets whole lines.
    let whole = String::from_utf8(command.env_remove("COLUMNS").output().unwrap().stdout).unwrap();
    assert!(whole.lines().any(|line| line.chars().count() > 100), "{whole}");
    assert_eq!(text.split_whitespace().collect::<Vec<_>>(), whole.split_whitespace().collect::<Vec<_>>());
}
