//! Rows of the page, each with their figure, our figure, and the largest deviation that is allowed.

use libm::{floor, log10};

/// Largest deviation of our figure from the compared one that is allowed.
#[derive(Clone, Copy)]
pub(crate) enum Bound {
    /// Our figure must equal the compared one.
    Equal,
    /// Our figure may differ by this part of the compared one, percent.
    Percent(f64),
    /// Our figure may differ by this amount, in the row's unit.
    Absolute(f64),
    /// Our figure must be no more than the compared one.
    AtMost,
    /// Any deviation is allowed.
    Open,
}

/// The way in which a figure was checked.
#[derive(Clone, Copy)]
pub(crate) enum Done {
    /// Our figure follows from other inputs.
    Computed,
    /// The model takes the figure as it is.
    Input,
    /// Our parameters were chosen so that this figure results, so it is no evidence.
    Fitted,
    /// The figure could not be checked, for this reason.
    Not(&'static str),
}

/// A row of a table.
pub(crate) struct Row {
    name: String,
    unit: &'static str,
    source: &'static str,
    compared: Option<f64>,
    ours: Option<f64>,
    bound: Bound,
    done: Done,
}

/// The head of a table of rows.
pub(crate) const HEAD: &str = "| | unit | compared | source | ours | deviation | bound | done |
| --- | --- | --- | --- | --- | --- | --- | --- |
";

impl Row {
    /// Returns a row for their figure and ours, which is computed.
    pub(crate) fn computed(
        name: impl Into<String>,
        unit: &'static str,
        (compared, source): (f64, &'static str),
        ours: f64,
        bound: Bound,
    ) -> Self {
        let name = name.into();
        Self { name, unit, source, compared: Some(compared), ours: Some(ours), bound, done: Done::Computed }
    }

    /// Returns a row for a figure that the model takes as it is.
    pub(crate) fn input(
        name: impl Into<String>,
        unit: &'static str,
        compared: (f64, &'static str),
        ours: f64,
    ) -> Self {
        Self::computed(name, unit, compared, ours, Bound::Equal).taken()
    }

    /// Returns a row for their figure without one of ours.
    pub(crate) fn unchecked(
        name: impl Into<String>,
        unit: &'static str,
        (compared, source): (f64, &'static str),
        why: &'static str,
    ) -> Self {
        let (name, done) = (name.into(), Done::Not(why));
        Self { name, unit, source, compared: Some(compared), ours: None, bound: Bound::Open, done }
    }

    /// Returns a row for figures that were not published.
    pub(crate) fn missing(name: impl Into<String>, source: &'static str, why: &'static str) -> Self {
        Self { compared: None, ..Self::unchecked(name, "", (0.0, source), why) }
    }

    /// Returns a row for our figure without a published one.
    pub(crate) fn ours(name: impl Into<String>, unit: &'static str, ours: f64) -> Self {
        let (name, done) = (name.into(), Done::Computed);
        Self { name, unit, source: "none", compared: None, ours: Some(ours), bound: Bound::Open, done }
    }

    /// Returns the row with another bound.
    pub(crate) fn bounded(self, bound: Bound) -> Self {
        Self { bound, ..self }
    }

    /// Returns the row as an input.
    pub(crate) fn taken(self) -> Self {
        Self { done: Done::Input, ..self }
    }

    /// Returns the row as a fitted figure.
    pub(crate) fn fitted(self) -> Self {
        Self { done: Done::Fitted, ..self }
    }

    /// Returns ours less the compared figure and the largest deviation that is allowed, both in percent or in the row's
    /// unit.
    fn deviation(&self) -> Option<(f64, f64)> {
        let (compared, ours) = (self.compared?, self.ours?);
        Some(match self.bound {
            Bound::Equal => (ours - compared, 0.0),
            Bound::Percent(bound) => (100.0 * (ours - compared) / compared.abs(), bound),
            Bound::Absolute(bound) => (ours - compared, bound),
            Bound::AtMost => (ours - compared, f64::INFINITY),
            Bound::Open => (100.0 * (ours - compared) / compared.abs(), f64::INFINITY),
        })
    }

    /// Returns a message if the deviation exceeds its bound or is not a number.
    pub(crate) fn beyond_bound(&self) -> Option<String> {
        let (deviation, bound) = self.deviation()?;
        let holds = match self.bound {
            Bound::AtMost => deviation <= 0.0,
            _ => deviation.abs() <= bound,
        };
        (!holds).then(|| format!("{}: deviation {deviation}, allowed {bound}", self.name))
    }

    /// Returns the row as Markdown.
    pub(crate) fn markdown(&self) -> String {
        let shown = |value: f64| match self.done {
            // A conversion from degrees to radians and back rounds the last bit.
            Done::Input => trimmed(&figure(value, 7)),
            _ => figure(value, 7),
        };
        let unit = match self.bound {
            Bound::Percent(_) | Bound::Open => " %".to_owned(),
            _ if self.unit == "%" => " points".to_owned(),
            _ if self.unit.is_empty() => String::new(),
            _ => format!(" {}", self.unit),
        };
        let deviation = match (self.deviation(), self.bound) {
            (None, _) | (_, Bound::AtMost) => "-".to_owned(),
            // The last bit depends on the order of a sum, not on the figures that are compared.
            (Some((deviation, _)), _) if deviation.abs() < 1e-12 => "0".to_owned(),
            (Some((deviation, _)), _) => {
                format!("{}{}{unit}", if deviation > 0.0 { "+" } else { "" }, figure(deviation, 3))
            }
        };
        let bound = match self.bound {
            Bound::Equal => "0".to_owned(),
            Bound::Percent(bound) | Bound::Absolute(bound) => format!("{}{unit}", as_printed(bound)),
            Bound::AtMost => "at most compared".to_owned(),
            Bound::Open => "-".to_owned(),
        };
        let done = match self.done {
            Done::Computed => "computed",
            Done::Input => "input",
            Done::Fitted => "fitted",
            Done::Not(why) => why,
        };
        let compared = self.compared.map_or("-".to_owned(), as_printed);
        format!(
            "| {} | {} | {compared} | {} | {} | {deviation} | {bound} | {done} |\n",
            self.name,
            self.unit,
            self.source,
            self.ours.map_or("-".to_owned(), shown)
        )
    }
}

/// Prints a figure with all the digits that it was given.
fn as_printed(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-3 { format!("{value:e}") } else { value.to_string() }
}

/// Prints a number with `digits` significant digits.
pub(crate) fn figure(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = floor(log10(value.abs())) as i32;
    if exponent < -3 {
        return format!("{value:.0$e}", (digits - 1).max(0) as usize);
    }
    format!("{value:.0$}", (digits - 1 - exponent).max(0) as usize)
}

/// Returns the number without zeros at the end of its fraction.
fn trimmed(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beyond(compared: f64, ours: f64, bound: Bound) -> bool {
        Row::computed("a length", "mm", (compared, "paper"), ours, bound).beyond_bound().is_some()
    }

    #[test]
    fn what_is_beyond_its_bound_is_told_and_no_number_is_within_any() {
        assert!(beyond(2.0, 2.1, Bound::Percent(4.9)) && !beyond(2.0, 2.1, Bound::Percent(5.1)));
        assert!(beyond(-2.0, -2.1, Bound::Absolute(0.09)) && !beyond(-2.0, -2.1, Bound::Absolute(0.11)));
        assert!(beyond(2.0, 2.1, Bound::AtMost) && !beyond(2.0, 1.0, Bound::AtMost));
        assert!(beyond(2.0, 2.0 + 1e-15, Bound::Equal) && !beyond(2.0, 2.0, Bound::Equal));
        assert!(beyond(2.0, f64::NAN, Bound::Open) && !beyond(2.0, 5.0, Bound::Open));
    }

    #[test]
    fn figures_have_the_digits_asked_for() {
        assert_eq!(figure(21.318_49, 4), "21.32");
        assert_eq!(figure(212.0, 5), "212.00");
        assert_eq!(figure(-0.0421, 2), "-0.042");
        assert_eq!(figure(1.26e-6, 2), "1.3e-6");
    }
}
