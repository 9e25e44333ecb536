//! `heads.toml`: its tables, and the rows that follow from them.

use std::collections::HashMap;

use serde::Deserialize;

use super::bought_head::{BoughtHead, HeadSource, Provenance};

/// Schema of the file.
const SCHEMA: &str = "heads/1";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HeadsFile {
    schema: String,
    source: Vec<SourceTable>,
    head: Vec<HeadTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SourceTable {
    key: String,
    kind: Provenance,
    document: String,
    table: String,
    quoted_by: Option<String>,
    address: String,
    remark: Option<String>,
    /// Slowest and fastest speed of the heads, in r/min. Slowest 0 stands for a speed that is not stated.
    speeds_rpm: Option<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HeadTable {
    maker: String,
    head: String,
    source: String,
    rollers: Option<u32>,
    tubing: Vec<TubingRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TubingRow {
    name: String,
    tubing: String,
    bore_mm: Option<f64>,
    wall_mm: Option<f64>,
    ml_per_rev: Option<f64>,
    flow_ml_min: Option<f64>,
    at_rpm: Option<f64>,
    low_flow_ml_min: Option<f64>,
    low_rpm: Option<f64>,
    note: Option<String>,
}

impl TubingRow {
    /// Returns the volume of a revolution in mL, and the figures as published. `None` if they are incomplete.
    fn figures(&self) -> Option<(f64, String)> {
        let low = match (self.low_flow_ml_min, self.low_rpm) {
            (None, None) => String::new(),
            (Some(flow), Some(rpm)) => format!("; {flow} mL/min at {rpm} r/min"),
            _ => return None,
        };
        match (self.ml_per_rev, self.flow_ml_min, self.at_rpm) {
            (Some(ml), None, None) => Some((ml, format!("{ml} mL per revolution{low}"))),
            (None, Some(flow), Some(rpm)) => Some((flow / rpm, format!("{flow} mL/min at {rpm} r/min{low}"))),
            _ => None,
        }
    }
}

/// Returns the rows of the text of a `heads.toml`, or what is wrong with it.
pub(super) fn rows_of(text: &str) -> Result<Vec<BoughtHead>, String> {
    let file: HeadsFile = toml::from_str(text).map_err(|error| error.to_string())?;
    if file.schema != SCHEMA {
        return Err(format!("schema is `{}`; this version reads `{SCHEMA}`", file.schema));
    }
    type Source = (HeadSource, Option<[f64; 2]>);
    let sources: HashMap<String, Source> = file
        .source
        .into_iter()
        .map(|source| {
            let SourceTable { key, kind, document, table, quoted_by, address, remark, speeds_rpm } = source;
            (key, (HeadSource { kind, document, table, quoted_by, address, remark }, speeds_rpm))
        })
        .collect();
    let mut rows = Vec::new();
    for head in file.head {
        let (source, speeds_rpm) =
            sources.get(&head.source).ok_or_else(|| format!("no source `{}`", head.source))?;
        for row in head.tubing {
            let (ml_per_rev, published) = row
                .figures()
                .ok_or_else(|| format!("{} needs ml_per_rev, or flow_ml_min with at_rpm", row.name))?;
            let [least_rpm, most_rpm] = speeds_rpm.map_or([row.low_rpm, row.at_rpm], |[least, most]| {
                [Some(least).filter(|least| *least > 0.0), Some(most)]
            });
            rows.push(BoughtHead {
                name: row.name,
                maker: head.maker.clone(),
                head: head.head.clone(),
                rollers: head.rollers,
                tubing: row.tubing,
                bore_mm: row.bore_mm,
                wall_mm: row.wall_mm,
                ml_per_rev,
                least_rpm,
                most_rpm,
                published,
                note: row.note,
                source: source.clone(),
            });
        }
    }
    Ok(rows)
}
