//! docs/embedding.md prints the program that `make embedded` compiles and runs.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs::read_to_string;
use std::path::Path;

#[test]
fn the_program_on_the_page_is_the_one_that_runs() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let page = read_to_string(root.join("docs/embedding.md")).unwrap();
    let program = read_to_string(root.join("examples/firmware/src/bin/by_interrupt.rs")).unwrap();
    let (_, printed) = page.split_once("```rust,ignore\n").unwrap();
    let (printed, _) = printed.split_once("\n```").unwrap();
    assert!(
        printed == program.trim_end(),
        "print examples/firmware/src/bin/by_interrupt.rs in docs/embedding.md"
    );
}
