//! The README's commands print what the README says.

#[test]
fn every_example_prints_what_it_shows() {
    let state = tempfile::tempdir().expect("a folder for the record");
    trycmd::TestCases::new()
        .env("DOSE_STATE_DIR", state.path().to_string_lossy())
        .env("COLUMNS", "100")
        .case("README.md");
}
