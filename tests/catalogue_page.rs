//! docs/catalogue.md: its tables are those of the catalogue of bought heads.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use pump_bench::heads::{BoughtHead, HeadSource, Provenance, bought_heads};

/// Marks in the page between which the tables stand.
const MARKS: (&str, &str) = ("<!-- the catalogue -->\n", "<!-- end of the catalogue -->\n");

/// A number with four significant digits, without trailing zeros.
fn shown(value: f64) -> String {
    let decimals = (3.0 - value.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The documents, each once, in the order of the rows.
fn documents() -> Vec<&'static HeadSource> {
    let mut documents: Vec<&HeadSource> = Vec::new();
    for head in bought_heads() {
        if !documents.contains(&&head.source) {
            documents.push(&head.source);
        }
    }
    documents
}

fn page() -> String {
    let documents = documents();
    let mut text = "\n| from | kind | document | table or page | quoted by | address | remark |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n"
        .to_owned();
    for (number, source) in documents.iter().enumerate() {
        let HeadSource { kind, document, table, quoted_by, address, remark, .. } = source;
        let by = quoted_by.as_deref().unwrap_or("-");
        let remark = remark.as_deref().unwrap_or("");
        write!(text, "| {} | {kind} | {document} | {table} | {by} ", number + 1)
            .expect("a text takes any words");
        writeln!(text, "| <{address}> | {remark} |").expect("a text takes any words");
    }
    text += "\n| name | head | tubing | rollers | bore mm | wall mm | mL per revolution | as published | from |\n\
             | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for row in bought_heads() {
        let known = |value: Option<f64>| value.map_or("-".to_owned(), |value| value.to_string());
        let (rollers, ml) = (known(row.rollers.map(f64::from)), shown(row.ml_per_rev));
        let (bore, wall) = (known(row.bore_mm), known(row.wall_mm));
        let note = row.note.as_ref().map_or(String::new(), |note| format!(" ({note})"));
        let from =
            1 + documents.iter().position(|source| **source == row.source).expect("a row has a document");
        let BoughtHead { name, maker, head, tubing, published, .. } = row;
        write!(text, "| `{name}` | {maker} {head} | {tubing} | {rollers} | {bore} | {wall} | {ml} ")
            .expect("a text takes any words");
        writeln!(text, "| {published}{note} | {from} |").expect("a text takes any words");
    }
    text + "\n"
}

#[test]
fn the_page_of_the_catalogue_holds_the_rows_that_the_program_has() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/catalogue.md");
    let text = fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once(MARKS.0).expect("the first mark stands in the page");
    let (tables, after) = rest.split_once(MARKS.1).expect("the second mark stands in the page");
    let expected = page();
    if std::env::var_os("WRITE_CATALOGUE").is_some() {
        fs::write(&path, [before, MARKS.0, &expected, MARKS.1, after].concat()).unwrap();
        return;
    }
    for (line, (is, should)) in tables.lines().zip(expected.lines()).enumerate() {
        assert_eq!(is, should, "line {line} of the tables; WRITE_CATALOGUE=1 writes them anew");
    }
    assert_eq!(tables, expected, "WRITE_CATALOGUE=1 writes the tables anew");
    let rows = bought_heads().len();
    for kind in Provenance::ALL {
        let count = bought_heads().iter().filter(|row| row.source.kind == kind).count();
        assert!(before.contains(&format!("- `{kind}`, {count} rows: ")), "the page counts {kind}: {count}");
    }
    assert!(before.contains(&format!("{rows} heads")), "the page says how many rows there are: {rows}");
}
