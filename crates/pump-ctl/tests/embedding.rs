//! docs/embedding.md prints the programs that `make embedded` compiles and runs.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs::read_to_string;
use std::path::Path;

#[test]
fn the_programs_on_the_page_are_those_that_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let page = read_to_string(root.join("docs/embedding.md")).unwrap();
    let mut printed = page.split("```rust,ignore\n").skip(1).map(|rest| rest.split_once("\n```").unwrap().0);
    for name in ["by_interrupt", "by_rtic"] {
        let file = format!("examples/firmware/src/bin/{name}.rs");
        let program = read_to_string(root.join(&file)).unwrap();
        assert!(printed.next() == Some(program.trim_end()), "print {file} in docs/embedding.md");
    }
    assert_eq!(printed.next(), None, "a program that no file holds");
}

#[test]
fn the_files_of_the_build_on_the_page_are_those_of_the_example() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let page = read_to_string(root.join("docs/embedding.md")).unwrap();
    let parts = [
        (".cargo/config.toml", "[build]", "# icount"),
        ("memory.x", "/* MPS2", ""),
        ("Cargo.toml", "[dependencies]", "[lints.rust]"),
        ("Cargo.toml", "[profile.release]", ""),
    ];
    for (name, first, after) in parts {
        let file = read_to_string(root.join("examples/firmware").join(name)).unwrap();
        let part = &file[file.find(first).unwrap()..];
        let end = if after.is_empty() { part.len() } else { part.find(after).unwrap() };
        assert!(page.contains(part[..end].trim_end()), "print {name} in docs/embedding.md");
    }
}
