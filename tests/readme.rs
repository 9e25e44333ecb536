//! The READMEs say what is so: commands print what is shown, and equal bits are promised for the libm in use.

#[test]
fn every_example_prints_what_it_shows() {
    let state = tempfile::tempdir().expect("a folder for the record");
    trycmd::TestCases::new()
        .env("DOSE_STATE_DIR", state.path().to_string_lossy())
        .env("XDG_CONFIG_HOME", state.path().to_string_lossy())
        .env("COLUMNS", "100")
        .case("README.md")
        .case("docs/continuous.md")
        .case("docs/sizing.md");
}

#[test]
fn every_example_of_racks_prints_what_it_shows() {
    let state = tempfile::tempdir().expect("a folder for the records");
    trycmd::TestCases::new()
        .env("DOSE_STATE_DIR", state.path().to_string_lossy())
        .env("XDG_CONFIG_HOME", state.path().to_string_lossy())
        .env("COLUMNS", "100")
        .case("docs/racks.md");
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
