//! Tables as people and spreadsheets write them: CSV with a header; a cell may stand between quotes.

use thiserror::Error;

/// A line of a table that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}: {message}")]
pub struct TableError {
    /// Number of the line in the file, from 1.
    pub line: usize,
    /// Message that says what is wrong and what is accepted.
    pub message: String,
}

/// A table of known columns. It may have any of them, in any order.
#[derive(Debug)]
pub(crate) struct Table<'a> {
    columns: Vec<&'a str>,
    rows: Vec<(usize, Vec<&'a str>)>,
}

/// A line of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row<'t> {
    line: usize,
    columns: &'t [&'t str],
    cells: &'t [&'t str],
}

impl<'a> Table<'a> {
    /// Parses `text`. Empty lines and lines that begin with `#` are skipped.
    pub(crate) fn parse(text: &'a str, known: &[&str]) -> Result<Self, TableError> {
        let refuse = |line, message| Err(TableError { line, message });
        let mut lines = text
            .trim_start_matches('\u{feff}')
            .lines()
            .enumerate()
            .map(|(n, line)| (n + 1, line.trim()))
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let Some((first, header)) = lines.next() else {
            return refuse(
                1,
                format!("the table is empty; its first line names columns of {}", known.join(", ")),
            );
        };
        // R quotes the names of columns. No known column and no number has a comma.
        let unquoted = |cell: &'a str| match cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"')) {
            Some(inner) if !inner.contains('"') => inner.trim(),
            _ => cell,
        };
        let cells = |line: &'a str| line.split(',').map(|cell| unquoted(cell.trim())).collect::<Vec<_>>();
        let columns = cells(header);
        for (n, column) in columns.iter().enumerate() {
            if !known.contains(column) {
                let hint = if header.contains(';') || header.contains('\t') {
                    "; the cells stand between commas, and numbers have a point: 42.5"
                } else {
                    ""
                };
                return refuse(
                    first,
                    format!("unknown column `{column}`; known: {}{hint}", known.join(", ")),
                );
            }
            if columns[..n].contains(column) {
                return refuse(first, format!("column `{column}` stands twice; keep one of them"));
            }
        }
        let mut rows = Vec::new();
        for (line, text) in lines {
            let cells = cells(text);
            if cells.len() != columns.len() {
                return refuse(line, format!("{} cells under {} columns", cells.len(), columns.len()));
            }
            rows.push((line, cells));
        }
        Ok(Self { columns, rows })
    }

    /// Returns true if the table has the column.
    pub(crate) fn has(&self, column: &str) -> bool {
        self.columns.contains(&column)
    }

    /// Returns the lines of the table in order.
    pub(crate) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|(line, cells)| Row { line: *line, columns: &self.columns, cells })
    }
}

impl Row<'_> {
    /// Returns the number of the line in the file, from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// Returns an error at this line.
    pub(crate) fn error(&self, message: String) -> TableError {
        TableError { line: self.line, message }
    }

    /// Returns the text in a column, or `None` for an empty cell or a missing column.
    pub(crate) fn text(&self, column: &str) -> Option<&str> {
        let place = self.columns.iter().position(|name| *name == column)?;
        self.cells.get(place).copied().filter(|cell| !cell.is_empty())
    }

    /// Returns the finite number in a column, or `None` for an empty cell or a missing column.
    pub(crate) fn number(&self, column: &str) -> Result<Option<f64>, TableError> {
        let Some(text) = self.text(column) else { return Ok(None) };
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(self.error(format!(
                "{column} is `{text}`; write a number, as 42.5, in the unit of the column's name"
            ))),
        }
    }

    /// Returns the number in a column that must have one.
    pub(crate) fn required(&self, column: &str) -> Result<f64, TableError> {
        self.number(column)?.ok_or_else(|| self.error(format!("{column} is missing")))
    }

    /// Returns the number in a column that must have a positive one.
    pub(crate) fn positive(&self, column: &str) -> Result<f64, TableError> {
        let value = self.required(column)?;
        if value > 0.0 {
            Ok(value)
        } else {
            Err(self.error(format!("{column} is {value}; allowed: more than 0")))
        }
    }

    /// Returns the only one of several columns that has a number: its name, the number and the column's
    /// companion.
    pub(crate) fn one_of<T: Copy, const N: usize>(
        &self,
        columns: [(&'static str, T); N],
    ) -> Result<(&'static str, f64, T), TableError> {
        let mut found = None;
        for (name, of) in columns {
            if let Some(value) = self.number(name)?
                && found.replace((name, value, of)).is_some()
            {
                found = None;
                break;
            }
        }
        found.ok_or_else(|| self.error(format!("give one of {}", columns.map(|(name, _)| name).join(", "))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_around_a_cell_are_no_part_of_it() {
        let columns = ["time_s", "flow_ml_s"];
        let table = Table::parse("\"time_s\", \"flow_ml_s\"\n\"0\",1.5\n", &columns).unwrap();
        let row = table.rows().next().unwrap();
        assert_eq!((row.required("time_s"), row.required("flow_ml_s")), (Ok(0.0), Ok(1.5)));
        assert!(Table::parse("\"time_s\"\"\",flow_ml_s\n", &columns).is_err());
    }

    #[test]
    fn a_table_of_a_spreadsheet_with_other_separators_is_told_what_stands_between_cells() {
        for text in ["time_s;flow_ml_s\n0;1,5\n", "time_s\tflow_ml_s\n0\t1\n"] {
            let refused = Table::parse(text, &["time_s", "flow_ml_s"]).unwrap_err().to_string();
            assert!(
                refused.contains("the cells stand between commas, and numbers have a point"),
                "{refused}"
            );
        }
        let refused = Table::parse("time,flow_ml_s\n", &["time_s", "flow_ml_s"]).unwrap_err().to_string();
        assert!(refused.ends_with("known: time_s, flow_ml_s"), "{refused}");
    }
}
