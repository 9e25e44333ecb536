//! Computes what reaches the vessel: the error and the back flow of doses over start angle and volume.
//!
//! `make accuracy` writes docs/accuracy.md and its pictures.

mod back_flow;
mod dose_error;
mod front;
mod page;
mod pictures;
mod trial;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// Folder of the page and its pictures.
fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

#[allow(clippy::print_stdout, reason = "an example says which files it wrote")]
fn main() -> Result<(), Box<dyn Error>> {
    for (name, content) in page::files()? {
        let path = docs().join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(&path, content).map_err(|error| format!("{}: {error}", path.display()))?;
        println!("{}", path.display());
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn the_committed_page_is_what_the_code_computes() {
        for (name, content) in page::files().unwrap() {
            let committed = fs::read_to_string(docs().join(&name)).unwrap();
            let differs = committed.lines().zip(content.lines()).find(|(old, new)| old != new);
            assert!(committed == content, "docs/{name} is not up to date, run `make accuracy`: {differs:?}");
        }
    }
}
