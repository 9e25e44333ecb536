//! A bought head with one tubing, and the document that its figures are from.

use core::fmt;

use serde::{Deserialize, Serialize};

/// A bought head with one tubing, as published. A value that its document does not state is `None`.
///
/// ```
/// let head = pump_bench::heads::bought_head("masterflex-ls-16").unwrap();
/// assert_eq!((head.ml_per_rev, head.rollers), (0.8, None));
/// assert_eq!(head.published, "0.8 mL per revolution");
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct BoughtHead {
    /// Name of the row: lower-case letters, digits and `-`. It stays as it is.
    pub name: String,
    /// Maker of the head.
    pub maker: String,
    /// Head, in the maker's words.
    pub head: String,
    /// Number of rollers.
    pub rollers: Option<u32>,
    /// Tubing, in the document's words.
    pub tubing: String,
    /// Diameter of the tube's bore, in mm.
    pub bore_mm: Option<f64>,
    /// Thickness of the tube's wall, in mm.
    pub wall_mm: Option<f64>,
    /// Volume of a revolution, in mL: as published, or the published flow divided by its speed.
    pub ml_per_rev: f64,
    /// Slowest speed of the head that its document states, in r/min.
    pub least_rpm: Option<f64>,
    /// Fastest speed of the head that its document states, in r/min. It is that of the published flow where the
    /// document states no other.
    pub most_rpm: Option<f64>,
    /// Figures as the document states them.
    pub published: String,
    /// Remark on the row.
    pub note: Option<String>,
    /// Document that the figures are from.
    pub source: HeadSource,
}

/// The document that figures of heads are from.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct HeadSource {
    /// Kind of the document.
    pub kind: Provenance,
    /// Title of the maker's document.
    pub document: String,
    /// Table or page of the document; of a program, its own table.
    pub table: String,
    /// Page, file or program that quotes the document. `None` for a document of the maker's that was at hand.
    pub quoted_by: Option<String>,
    /// Address of the document, or of the page that quotes it.
    pub address: String,
    /// Conditions of the figures, and what else bears on them.
    pub remark: Option<String>,
}

/// The kind of a document, by how far the maker's own words are away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Provenance {
    /// A document of the maker's.
    Maker,
    /// A page or file that quotes the maker's figures and names the maker's document.
    Quoted,
    /// The table of a program that drives such heads. It names no document.
    Program,
}

impl Provenance {
    /// All kinds of documents.
    pub const ALL: [Self; 3] = [Self::Maker, Self::Quoted, Self::Program];

    /// Returns the word for the kind, as in JSON.
    pub(crate) fn as_str(self) -> &'static str {
        match self {
            Self::Maker => "maker",
            Self::Quoted => "quoted",
            Self::Program => "program",
        }
    }
}

impl HeadSource {
    /// Returns the document with its table, and who quotes it.
    pub fn cited(&self) -> String {
        let by = self.quoted_by.as_ref().map_or(String::new(), |by| format!("; quoted by {by}"));
        format!("{}, {}{by}", self.document, self.table)
    }
}

impl fmt::Display for Provenance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}
