//! Sets the figures that McIntyre et al. publish beside those that the model computes.
//!
//! `make validate` writes docs/validation.md and its pictures, and fails where a deviation exceeds its bound.
//! `cargo run --example validate -- PT1` repeats one of the paper's tests.

mod drawing;
mod flow;
mod inconsistencies;
mod line;
mod page;
mod paper;
mod pictures;
mod pressures;
mod roller_centric;
mod roller_volume;
mod row;
mod runs;
mod volumes;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Folder of the page and its pictures.
fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

#[allow(clippy::print_stdout, reason = "an example shows its result")]
fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = env::args().skip(1).collect();
    if names.is_empty() {
        return write();
    }
    for name in names {
        println!("{}", runs::run(&name)?);
    }
    Ok(())
}

#[allow(clippy::print_stdout, reason = "an example says which files it wrote")]
fn write() -> Result<(), Box<dyn Error>> {
    let sections = page::sections()?;
    for (name, content) in page::files(&sections)? {
        let path = docs().join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(&path, content).map_err(|error| format!("{}: {error}", path.display()))?;
        println!("{}", path.display());
    }
    let beyond = page::beyond_bounds(&sections);
    if beyond.is_empty() { Ok(()) } else { Err(beyond.join("\n").into()) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn the_committed_page_is_what_the_code_computes() {
        for (name, content) in page::files(&page::sections().unwrap()).unwrap() {
            let committed = fs::read_to_string(docs().join(&name)).unwrap();
            let differs = committed.lines().zip(content.lines()).find(|(old, new)| old != new);
            assert!(committed == content, "docs/{name} is not up to date, run `make validate`: {differs:?}");
        }
    }

    #[test]
    fn every_deviation_is_within_its_bound() {
        assert_eq!(page::beyond_bounds(&page::sections().unwrap()), [""; 0]);
    }

    #[test]
    fn every_test_of_the_paper_runs_by_its_name_and_no_other_does() {
        for name in ["FT1", "FT2", "FT3", "FT4", "FT5", "PT1", "pt2"] {
            assert!(runs::run(name).unwrap().lines().count() > 4, "{name}");
        }
        assert!(runs::run("FT6").unwrap_err().to_string().contains("allowed: FT1, FT2"));
    }
}
