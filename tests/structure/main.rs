//! The shape of the sources: rooms, arrows, lengths. ARCHITECTURE.md promises what these tests hold.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod graph;
mod names;
mod signatures;
mod sources;
mod texts;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use graph::Graph;
use names::Names;
use signatures::Signatures;
use sources::Sources;
use texts::{Texts, names_the_command};

/// The libraries, whose signatures and texts are held to rules.
const LIBRARIES: [&str; 6] =
    ["pump_model", "pump_ctl", "pump_link", "pump_node", "pump_bench", "pump_service"];

/// The folder of the workspace.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folder of `file`, relative to the workspace.
fn folder(file: &Path) -> PathBuf {
    file.parent().map(Path::to_owned).unwrap_or_default()
}

/// The arrows between the source files of every crate of the workspace.
fn house() -> Graph {
    let sources = Sources::of_workspace(root());
    let graph = Names::new(&sources).graph();
    if let Some(file) = std::env::var_os("STRUCTURE_DRAWING") {
        std::fs::write(file, graph.to_string()).expect("STRUCTURE_DRAWING names a file that can be written");
    }
    graph
}

#[test]
fn no_circle_of_files_crosses_a_folder() {
    let graph = house();
    let crossing: Vec<String> = graph
        .circles()
        .into_iter()
        .filter(|circle| circle.iter().any(|file| folder(file) != folder(&circle[0])))
        .map(|circle| graph.describe(&circle))
        .collect();
    assert!(
        crossing.is_empty(),
        "{} circles of files cross a folder:\n{}",
        crossing.len(),
        crossing.join("\n")
    );
}

#[test]
fn no_circle_of_rooms_stands_in_a_crate() {
    // A room is a folder or a file that stands directly below `src`.
    let rooms = house().of_rooms(|file| {
        let parts: Vec<_> = file.iter().collect();
        let source = parts.iter().position(|part| *part == "src")?;
        Some(parts[..parts.len().min(source + 2)].iter().collect())
    });
    let circles: Vec<String> = rooms.circles().iter().map(|circle| rooms.describe(circle)).collect();
    assert!(circles.is_empty(), "{} circles of rooms:\n{}", circles.len(), circles.join("\n"));
}

#[test]
fn the_arrows_are_found() {
    let graph = house();
    let arrow = |from: &str, to: &str| graph.has(Path::new(from), Path::new(to));
    // Through a re-export, and across crates.
    assert!(arrow("crates/pump-bench/src/bench/bench.rs", "crates/pump-bench/src/dosing/prepared.rs"));
    assert!(arrow("crates/pump-bench/src/bench/bench.rs", "crates/pump-model/src/pump/pump.rs"));
    // A room's own file draws no arrow by what it hands on.
    assert!(!arrow("crates/pump-bench/src/bench/mod.rs", "crates/pump-bench/src/bench/bench.rs"));
    assert!(graph.len() > 500, "{} arrows", graph.len());
}

#[test]
fn no_arrow_runs_from_a_crate_to_the_command() {
    for (file, others) in house().arrows() {
        let up = others.iter().find(|other| file.starts_with("crates") && other.starts_with("src"));
        assert_eq!(up, None, "{} names it", file.display());
    }
}

#[test]
fn no_public_signature_names_a_foreign_type() {
    for (path, module) in Sources::of_workspace(root()).modules {
        if !LIBRARIES.contains(&path[0].as_str()) {
            continue;
        }
        let mut signatures = Signatures::default();
        module.items.iter().for_each(|item| signatures.look_at(item));
        let file = module.file.display();
        assert!(signatures.found.is_empty(), "{file} promises {:?}", signatures.found);
    }
}

/// The subcommands of `dose`, each a file or a folder of `src/commands`. Two files hold what they share.
fn subcommands() -> Vec<String> {
    let commands = std::fs::read_dir(root().join("src/commands")).unwrap();
    let names =
        commands.map(|entry| entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned());
    names.filter(|name| !["mod", "dose", "delivery"].contains(&name.as_str())).collect()
}

#[test]
fn no_text_of_a_library_names_the_command_or_its_options() {
    let subcommands = subcommands();
    let mut named = Vec::new();
    for (path, module) in Sources::of_workspace(root()).modules {
        if !LIBRARIES.contains(&path[0].as_str()) {
            continue;
        }
        let texts = Texts::of(&module.items).into_iter();
        named.extend(
            texts
                .filter(|text| names_the_command(text, &subcommands))
                .map(|text| (module.file.clone(), text)),
        );
    }
    assert!(named.is_empty(), "{} texts name the command: {named:#?}", named.len());
}

#[test]
fn texts_that_name_the_command_are_found() {
    let subcommands = subcommands();
    let names = |text: &str| names_the_command(text, &subcommands);
    for text in ["run `dose resume`", "then dose resume, or", "see `dose`", "give --port", "(`--smooth`)"] {
        assert!(names(text), "{text}");
    }
    for text in ["the dose in mL", "a smooth dose -- or none", "--", "whole doses resume"] {
        assert!(!names(text), "{text}");
    }
    let file = "#[error(\"a {}\", \"b\")] struct A; /// c\n fn f() { g!(\"d\", (\"e\",)); \"f\" }";
    let texts = Texts::of(&syn::parse_file(file).unwrap().items);
    assert_eq!(texts, ["a {}", "b", "d", "e", "f"]);
}

#[test]
fn no_folder_has_more_than_fifteen_files() {
    let mut folders: BTreeMap<PathBuf, usize> = BTreeMap::new();
    for file in sources::files(root(), &["rs", "py"]) {
        *folders.entry(folder(&file)).or_default() += 1;
    }
    folders.retain(|_, files| *files > 15);
    assert!(folders.is_empty(), "{folders:?}");
}

#[test]
fn no_line_is_longer_than_120_columns() {
    let mut long = Vec::new();
    let written = sources::files(root(), &["rs", "py", "pyi", "md", "toml"]);
    // The seeds of the fuzz targets are data.
    for file in written.into_iter().filter(|file| !file.starts_with("fuzz/corpus")) {
        let text = std::fs::read_to_string(root().join(&file)).unwrap();
        for (number, line) in text.lines().enumerate() {
            // Tables cannot be wrapped.
            if line.chars().count() > 120 && !line.trim_start().starts_with('|') {
                long.push(format!("{}:{}", file.display(), number + 1));
            }
        }
    }
    assert!(long.is_empty(), "{} lines: {}", long.len(), long.join(" "));
}
