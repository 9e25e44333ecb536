//! Makes the page: sections of rows, the paper's contradictions, and the tests that can be repeated.

use std::error::Error;

use crate::row::{HEAD, Row};
use crate::{
    drawing, flow, inconsistencies, line, pictures, pressures, roller_centric, roller_volume, runs, volumes,
};

/// Part of the page with one table.
pub struct Section {
    pub title: &'static str,
    /// Markdown above the table, with a blank line at its end; or empty.
    pub before: String,
    pub rows: Vec<Row>,
    /// Markdown below the table, or empty.
    pub after: String,
}

/// Computes all sections.
pub fn sections() -> Result<Vec<Section>, Box<dyn Error>> {
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

/// Returns a text for each figure that is beyond its bound.
pub fn beyond_bounds(sections: &[Section]) -> Vec<String> {
    sections.iter().flat_map(|section| section.rows.iter().filter_map(Row::beyond_bound)).collect()
}

/// Returns names below docs/ and contents of the page and its pictures.
pub fn files(sections: &[Section]) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let mut page = INTRODUCTION.to_owned();
    for Section { title, before, rows, after } in sections {
        let rows: String = rows.iter().map(Row::markdown).collect();
        page += &format!("\n## {title}\n\n{before}{HEAD}{rows}");
        if !after.is_empty() {
            page += &format!("\n{after}");
        }
    }
    page += &format!("\n## Where the paper contradicts itself\n\n{}", inconsistencies::markdown()?);
    page += &format!("\n## Its tests, to be repeated\n\n{}", runs::markdown());
    let mut files = vec![("validation.md".to_owned(), page)];
    for (name, svg) in pictures::all()? {
        files.push((format!("validation/{name}.svg"), svg));
    }
    Ok(files)
}

const INTRODUCTION: &str = "\
# Validation: McIntyre et al. beside this model

Made by `make validate`; a test holds this page to what the code computes, and every deviation to its bound.

The paper: McIntyre, van Schoor, Uren, Kloppers, \"Modelling the pulsatile flow rate and pressure response of a roller-type
peristaltic pump\", Sensors and Actuators A (preprint arXiv 2011.13167). Its raw curves were not published, so nothing here
reproduces a measurement point by point: the volumes of its pumps over speed and its pressures cannot be set beside ours.

- source: *Table 1* and *paper* are figures of the paper; where else than in Table 1 a figure stands could not be looked up, and
  what its Table 2 lists is not available here, so its figures have no table of their own. *authors' code* is Main.m of
  github.com/MPMcIntyre/Roller-pump-model-and-simulation. *reference* is not the paper's: it was computed once outside this code,
  from the paper's equations and data, and some of these the paper may print as well.
- done: *computed*, ours follows from other inputs; *input*, the model takes the figure as it is; *fitted*, ours was adjusted to
  published figures and is no evidence; *needs raw data*, cannot be checked.
- A deviation in % is of theirs, any other is ours less theirs. `-` in its column: there is nothing to compare.
";
