//! Sets the figures that McIntyre et al. publish beside those that the model computes.
//!
//! `make validate` writes docs/validation.md and its pictures, and fails where a deviation exceeds its bound.
//! `cargo run --example validate -- PT1` repeats one of the tests of the paper's Table 2.

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
    fn every_test_of_the_papers_table_2_runs_over_its_speeds() {
        for (name, head, slowest, fastest) in [
            ("FT1", "3 rollers, 25 °C, 10 to 170 r/min in steps of 10 r/min (S)", 10, 170),
            ("FT2", "3 rollers, 25 °C, 15 to 165 r/min in steps of 10 r/min (S)", 15, 165),
            ("FT3", "3 rollers, 25 °C, 10 to 170 r/min in steps of 10 r/min (R)", 10, 170),
            ("FT4", "3 rollers, 40 °C, 10 to 170 r/min in steps of 10 r/min (R)", 10, 170),
            ("FT5", "2 rollers, 25 °C, 10 to 300 r/min in steps of 10 r/min (S)", 10, 300),
            ("PT1", "3 rollers, 25 °C, 10 to 200 r/min in steps of 10 r/min (S)", 10, 200),
            ("pt2", "2 rollers, 25 °C, 10 to 200 r/min in steps of 10 r/min (S)", 10, 200),
        ] {
            let text = runs::run(name).unwrap();
            assert!(text.lines().next().unwrap().contains(head), "{text}");
            let rpm: Vec<u32> =
                text.lines().filter_map(|line| line.split_whitespace().next()?.parse().ok()).collect();
            assert_eq!(rpm, (slowest..=fastest).step_by(10).collect::<Vec<_>>(), "{name}");
        }
    }

    #[test]
    fn warm_water_changes_the_mass_of_ten_revolutions_alone() {
        // At 10 r/min: speed, time, volume, mass, volume by the speed law.
        let first = |name| -> Vec<f64> {
            let text = runs::run(name).unwrap();
            let row = text.lines().find(|line| line.trim_start().starts_with("10 ")).unwrap();
            row.split_whitespace().map(|word| word.parse().unwrap()).collect()
        };
        let (cold, warm) = (first("FT3"), first("FT4"));
        assert_eq!((cold[2], cold[4]), (warm[2], warm[4]));
        assert_eq!((cold[3], warm[3]), (212.545, 211.479));
    }

    #[test]
    fn measurements_without_a_name_in_the_paper_run_by_ours_and_nothing_else_runs() {
        for (name, place) in
            [("roller-volume", "Section 3.3"), ("resistance", "Eq. 17"), ("compliance", "Eqs. 20 and 21")]
        {
            let text = runs::run(name).unwrap();
            assert!(text.lines().next().unwrap().contains(place) && text.lines().count() > 4, "{text}");
        }
        let refused = runs::run("FT6").unwrap_err().to_string();
        assert!(refused.contains("allowed: FT1, FT2") && refused.contains("PT2, roller-volume"), "{refused}");
    }

    #[test]
    fn the_citation_names_this_version_and_the_paper_of_the_page() {
        let citation = fs::read_to_string(docs().with_file_name("CITATION.cff")).unwrap();
        let page = fs::read_to_string(docs().join("validation.md")).unwrap();
        let value =
            |key: &str| citation.lines().find_map(|line| line.trim_start().strip_prefix(key)).unwrap();
        assert_eq!(value("version: "), env!("CARGO_PKG_VERSION"));
        assert_eq!(value("- name: "), "pump-dose contributors");
        let doi = value("doi: ");
        assert!(doi.ends_with("2011.13167") && page.contains(&format!("https://doi.org/{doi}")), "{doi}");
    }

    #[test]
    fn every_figure_names_its_place() {
        let page = page::files(&page::sections().unwrap()).unwrap().remove(0).1;
        let sources: Vec<&str> = page
            .lines()
            .filter(|line| line.starts_with("| ") && line.split('|').count() == 10)
            .map(|line| line.split('|').nth(4).unwrap().trim())
            .filter(|source| !["source", "---"].contains(source))
            .collect();
        assert!(sources.len() > 130, "{} rows", sources.len());
        for source in sources {
            let is_place = ["Section ", "Table "].iter().any(|place| source.starts_with(place));
            assert!(is_place || [paper::CODE, paper::REFERENCE, "none"].contains(&source), "{source}");
        }
        assert!(!page.contains("looked up") && !page.contains("available here"));
    }
}
