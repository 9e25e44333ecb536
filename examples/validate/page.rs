//! Makes the page: sections of rows, the paper's contradictions, and the tests that can be repeated.

use std::error::Error;

use crate::row::{HEAD, Row};
use crate::{
    drawing, flow, inconsistencies, line, pictures, pressures, roller_centric, roller_volume, runs, volumes,
};

/// A part of the page with one table.
pub(crate) struct Section {
    pub title: &'static str,
    /// Markdown above the table, with a blank line at its end, or empty.
    pub before: String,
    pub rows: Vec<Row>,
    /// Markdown below the table, or empty.
    pub after: String,
}

/// Computes all sections.
pub(crate) fn sections() -> Result<Vec<Section>, Box<dyn Error>> {
    Ok(vec![
        roller_volume::dimensions()?,
        roller_volume::section()?,
        flow::section()?,
        volumes::section()?,
        line::section()?,
        pressures::section()?,
        drawing::section()?,
        roller_centric::section()?,
    ])
}

/// Returns a message for each figure whose deviation exceeds its bound.
pub(crate) fn beyond_bounds(sections: &[Section]) -> Vec<String> {
    sections.iter().flat_map(|section| section.rows.iter().filter_map(Row::beyond_bound)).collect()
}

/// Returns the page and its pictures, each as its name below docs/ and its contents.
pub(crate) fn files(sections: &[Section]) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let mut page = INTRODUCTION.to_owned();
    for Section { title, before, rows, after } in sections {
        let rows: String = rows.iter().map(Row::markdown).collect();
        page += &format!("\n## {title}\n\n{before}{HEAD}{rows}");
        if !after.is_empty() {
            page += &format!("\n{after}");
        }
    }
    page += &format!("\n## Where the paper contradicts itself\n\n{}", inconsistencies::markdown()?);
    page += &format!("\n## The paper's tests, to be repeated\n\n{}", runs::markdown());
    let mut files = vec![("validation.md".to_owned(), filled(&page))];
    for (name, svg) in pictures::all()? {
        files.push((format!("validation/{name}.svg"), svg));
    }
    Ok(files)
}

/// Largest width of a line of prose on the page, columns.
const WIDTH: usize = 110;

/// Divides the lines of prose at spaces, so that none is wider than [`WIDTH`]. Tables, titles and pictures
/// stay.
fn filled(page: &str) -> String {
    let mut filled = String::new();
    for line in page.lines() {
        if line.starts_with(['|', '#', '!']) {
            filled += line;
            filled += "\n";
            continue;
        }
        let indent = if line.starts_with("- ") { "  " } else { "" };
        let mut columns = 0;
        for word in words(line) {
            let length = word.chars().count();
            if columns > 0 && columns + 1 + length > WIDTH {
                filled += "\n";
                filled += indent;
                columns = indent.len();
            } else if columns > 0 {
                filled += " ";
                columns += 1;
            }
            filled += &word;
            columns += length;
        }
        filled += "\n";
    }
    filled
}

/// Returns the words of a line. Code stays in one word, and so does a sign or number that Markdown could take
/// for the start of a list.
fn words(line: &str) -> Vec<String> {
    let starts_a_line = |word: &str| {
        let first = word.chars().next();
        first.is_some_and(|first| first.is_alphanumeric() || "`*([\"".contains(first)) && !word.ends_with('.')
            || first.is_some_and(char::is_alphabetic)
    };
    let mut words: Vec<String> = Vec::new();
    for word in line.split(' ') {
        match words.last_mut() {
            Some(last) if last.matches('`').count() % 2 == 1 || !starts_a_line(word) => {
                last.push(' ');
                last.push_str(word);
            }
            _ => words.push(word.to_owned()),
        }
    }
    words
}

const INTRODUCTION: &str = "\
# Validation: McIntyre et al. beside this model

`make validate` writes this page. A test checks that the code computes every figure on it, and that every \
deviation is within its bound.

The paper is McIntyre, van Schoor, Uren, Kloppers, \"Modelling the pulsatile flow rate and pressure response of a \
roller-type peristaltic pump\", submitted to Sensors and Actuators A: Physical (preprint of 2020, [arXiv \
2011.13167](https://doi.org/10.48550/arXiv.2011.13167)). It draws its measured curves and prints no numbers for them. \
The authors' code contains numbers for one curve only: 15 means of the roller volume (Fig. 9). They stand point by \
point beside ours below. The other measured curves cannot be compared with ours: the volume over speed (Fig. 12), the \
volume over the largest inlet pressure (Fig. 13), and the pressures (Figs. 15 and 16).

- The column *source* names the origin of a figure. A section, an equation, a table or a figure is a place in the \
preprint. *authors' code* is github.com/MPMcIntyre/Roller-pump-model-and-simulation, either its Main.m or its \
measured data. A *reference* does not appear in the paper. It was computed once, outside this code, from the paper's \
equations and data.
- The column *done* says how a figure was checked. *computed*: our figure follows from other inputs. *input*: the \
model takes the figure as it is. *fitted*: our figure was fitted to published figures and is no evidence. *needs raw \
data*: the figure cannot be checked.
- The column *compared* contains the figure of the source. A deviation in % is relative to it. Any other deviation is \
our figure minus it. A `-` means that there is nothing to compare.
";
