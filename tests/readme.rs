//! The READMEs say what is so: commands print what is shown, and equal bits are promised for the libm in use.

#[test]
fn every_example_prints_what_it_shows() {
    let state = tempfile::tempdir().expect("a folder for the record");
    let read_me = state.path().join("README.md");
    std::fs::write(&read_me, without_times(include_str!("../README.md"))).expect("a copy is written");
    trycmd::TestCases::new()
        .env("DOSE_STATE_DIR", state.path().to_string_lossy())
        .env("XDG_CONFIG_HOME", state.path().to_string_lossy())
        .env("COLUMNS", "100")
        .case(read_me)
        .case("docs/continuous.md")
        .case("docs/sizing.md");
}

/// Returns a page whose times of day may be any: the README shows one, as the command does.
fn without_times(page: &str) -> String {
    const BEGAN: &str = "began 2";
    assert!(page.contains(BEGAN), "the README shows when a dose began");
    let (first, rest) = page.split_once(BEGAN).expect("a time");
    let rest = rest.trim_start_matches(|letter: char| letter.is_ascii_digit() || "-+T:".contains(letter));
    format!("{first}began [..]{rest}")
}

#[test]
fn every_example_of_a_page_whose_doses_build_on_one_another_prints_what_it_shows() {
    for page in [
        "docs/racks.md",
        "docs/bench.md",
        "docs/start.md",
        "docs/limits.md",
        "docs/model.md",
        "docs/files.md",
    ] {
        let state = tempfile::tempdir().expect("a folder for the records");
        trycmd::TestCases::new()
            .env("DOSE_STATE_DIR", state.path().to_string_lossy())
            .env("XDG_CONFIG_HOME", state.path().to_string_lossy())
            .env("COLUMNS", "100")
            .case(page);
    }
}

#[test]
fn the_picture_of_a_dose_is_what_its_command_draws() {
    let folder = tempfile::tempdir().expect("a folder for the record and the picture");
    let drawn = folder.path().join("dose.svg");
    let status = std::process::Command::new(env!("CARGO_BIN_EXE_dose"))
        .args(["25mL", "--start-angle", "17deg+-1deg", "--dry-run", "--plot"])
        .arg(&drawn)
        .env("DOSE_STATE_DIR", folder.path())
        .env("XDG_CONFIG_HOME", folder.path())
        .stdout(std::process::Stdio::null())
        .status()
        .expect("the command runs");
    assert!(status.success());
    let read = |file: &std::path::Path| std::fs::read_to_string(file).expect("a picture");
    let stale = "docs/dose.svg is not up to date: dose 25mL --start-angle 17deg+-1deg --plot docs/dose.svg";
    assert!(read(&drawn) == read(std::path::Path::new("docs/dose.svg")), "{stale}");
}

#[test]
fn equal_bits_are_promised_for_the_libm_that_is_locked() {
    let read = |file: &str| std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{file}: {error}"));
    for lock in ["Cargo.lock", "examples/firmware/Cargo.lock"] {
        let packages: toml::Table = read(lock).parse().expect("a lock file is TOML");
        let named = |package: &&toml::Value| package["name"].as_str() == Some("libm");
        let libm = packages["package"].as_array().and_then(|all| all.iter().find(named));
        let version = libm.and_then(|libm| libm["version"].as_str()).expect("libm is locked");
        for promise in ["crates/pump-model/README.md", "crates/pump-model/src/lib.rs"] {
            assert!(
                read(promise).contains(&format!("libm {version},")),
                "{promise}: not {version} of {lock}"
            );
        }
    }
}
