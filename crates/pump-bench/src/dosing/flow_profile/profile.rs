//! The rows of a flow over time.

use pump_ctl::plan::{FlowError, FlowRow};

use super::error::ProfileError;
use crate::files::Table;
use crate::record::ShortText;

/// Most rows of a profile: eleven days of a row a second.
const MOST_ROWS: usize = 1_000_000;

/// Flow over time at the rollers: linear between rows, and a step where two rows have one time.
///
/// ```
/// use pump_bench::dosing::FlowProfile;
///
/// let profile = FlowProfile::parse("bolus.csv", "time_s,flow_ml_s\n0,0\n5,4\n10,0\n")?;
/// assert_eq!(profile.volume_ml(), 20.0);
/// # Ok::<(), pump_bench::dosing::ProfileError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FlowProfile {
    name: ShortText,
    rows: Vec<FlowRow>,
    /// Lines of the rows in the file. None without a file.
    lines: Vec<u64>,
}

impl FlowProfile {
    /// Reads a profile from CSV with the columns `time_s` and `flow_ml_s`. `name` is for the report and the log.
    ///
    /// # Errors
    ///
    /// [`ProfileError`] with the line or the row that is wrong.
    pub fn parse(name: &str, text: &str) -> Result<Self, ProfileError> {
        const COLUMNS: [&str; 2] = ["time_s", "flow_ml_s"];
        let table = Table::parse(text, &COLUMNS).map_err(ProfileError::Table)?;
        if let Some(column) = COLUMNS.into_iter().find(|column| !table.has(column)) {
            return Err(ProfileError::Column { column });
        }
        let lines: Vec<u64> = table.rows().map(|cells| cells.line() as u64).collect();
        let rows = lines.iter().zip(table.rows()).map(|(row, cells)| {
            let row = *row;
            let number = |column| cells.required(column).map_err(|source| ProfileError::Row { row, source });
            Ok(FlowRow::new(number("time_s")?, number("flow_ml_s")?))
        });
        let rows = rows.collect::<Result<_, ProfileError>>()?;
        Ok(Self { lines, ..Self::of(name, rows)? })
    }

    /// Makes a profile of times, in s, and flows at the rollers, in mL/s.
    ///
    /// # Errors
    ///
    /// [`ProfileError`] if there are too many rows, or not a flow for each time.
    pub fn from_columns(name: &str, times_s: &[f64], flows_ml_s: &[f64]) -> Result<Self, ProfileError> {
        let (times, flows) = (times_s.len(), flows_ml_s.len());
        if times != flows {
            return Err(ProfileError::Unequal { times, flows });
        }
        let rows =
            times_s.iter().zip(flows_ml_s).map(|(time_s, flow_ml_s)| FlowRow::new(*time_s, *flow_ml_s));
        Self::of(name, rows.collect())
    }

    fn of(name: &str, rows: Vec<FlowRow>) -> Result<Self, ProfileError> {
        if rows.len() > MOST_ROWS {
            return Err(ProfileError::TooLong { rows: rows.len(), most: MOST_ROWS });
        }
        Ok(Self { name: ShortText::new(name), rows, lines: Vec::new() })
    }

    /// Returns the profile that runs the other way.
    #[must_use]
    pub fn reversed(self) -> Self {
        let rows = self.rows.into_iter().map(|row| FlowRow { flow_ml_s: -row.flow_ml_s, ..row });
        Self { rows: rows.collect(), ..self }
    }

    /// Returns a refusal that names a row by its line in the file, the header included.
    pub(crate) fn located(&self, refused: FlowError) -> FlowError {
        let line = |row: u64| usize::try_from(row).ok().and_then(|row| self.lines.get(row.checked_sub(1)?));
        refused.with_row(|row| line(row).copied().unwrap_or(row))
    }

    /// Returns the profile with all its flows times `factor`.
    #[must_use]
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let rows = self.rows.iter().map(|row| FlowRow { flow_ml_s: factor * row.flow_ml_s, ..*row });
        Self { rows: rows.collect(), lines: self.lines.clone(), name: self.name }
    }

    /// Returns the name of the profile.
    pub fn name(&self) -> &str {
        self.name.as_str()
    }

    pub(crate) fn asked(&self) -> ShortText {
        self.name
    }

    /// Returns the rows.
    pub fn rows(&self) -> &[FlowRow] {
        &self.rows
    }

    /// Returns the volume at the rollers, in mL, negative in reverse.
    pub fn volume_ml(&self) -> f64 {
        self.stretches()
            .map(|[from, to]| 0.5 * (from.flow_ml_s + to.flow_ml_s) * (to.time_s - from.time_s))
            .sum()
    }

    /// Returns the mean of the flow over the volume, in mL/s, positive: the flow at which most of the volume passes.
    pub(crate) fn main_flow_ml_s(&self) -> f64 {
        let squares = self.stretches().map(|[from, to]| {
            let (first, last) = (from.flow_ml_s, to.flow_ml_s);
            (to.time_s - from.time_s) * (first * first + first * last + last * last) / 3.0
        });
        squares.sum::<f64>() / self.volume_ml().abs()
    }

    /// Returns the largest flow, in mL/s, positive.
    pub(crate) fn largest_flow_ml_s(&self) -> f64 {
        self.rows.iter().map(|row| row.flow_ml_s.abs()).fold(0.0, f64::max)
    }

    /// Refuses the first row that is none, whatever the pump.
    ///
    /// # Errors
    ///
    /// [`FlowError`] with the row and its value.
    pub(crate) fn check(&self) -> Result<(), FlowError> {
        let (mut before_s, mut sign) = (0.0, 0.0);
        for (row, FlowRow { time_s, flow_ml_s }) in (1..).zip(self.rows.iter().copied()) {
            if !(time_s >= 0.0 && time_s.is_finite()) || (row == 1 && time_s > 0.0) {
                return Err(FlowError::Time { row, time_s });
            }
            if time_s < before_s {
                return Err(FlowError::TimeGoesBack { row, time_s, before_s });
            }
            if !flow_ml_s.is_finite() {
                return Err(FlowError::Flow { row, flow_ml_s });
            }
            if flow_ml_s * sign < 0.0 {
                return Err(FlowError::TurnsBack { row, flow_ml_s });
            }
            if flow_ml_s != 0.0 {
                sign = flow_ml_s.signum();
            }
            before_s = time_s;
        }
        let volume_ml = self.volume_ml();
        if volume_ml == 0.0 {
            return Err(FlowError::Nothing { rows: self.rows.len() as u64 });
        }
        Ok(())
    }

    fn stretches(&self) -> impl Iterator<Item = [FlowRow; 2]> {
        self.rows.windows(2).filter_map(|pair| <[FlowRow; 2]>::try_from(pair).ok())
    }
}
