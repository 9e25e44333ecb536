//! The settings of a simulated board.

use std::collections::BTreeMap;

use super::number::print;
use super::options::{Firmware, Options};

/// First setting that grbl prints with decimals. Settings below are whole numbers, 11 and 12 excepted.
const FIRST_WITH_DECIMALS: u16 = 100;

/// Settings of a board by their numbers.
#[derive(Debug)]
pub(super) struct Settings {
    values: BTreeMap<u16, f32>,
    firmware: Firmware,
}

impl Settings {
    /// Returns grbl's usual settings, with those of the options in their place.
    pub(super) fn new(options: &Options) -> Self {
        let mut values: BTreeMap<u16, f32> = [
            (0, 10.0),
            (1, 255.0),
            (2, 0.0),
            (3, 0.0),
            (4, 0.0),
            (5, 0.0),
            (6, 0.0),
            (10, 1.0),
            (11, 0.01),
            (12, 0.002),
            (13, 0.0),
            (20, 0.0),
            (21, 0.0),
            (22, 0.0),
        ]
        .into();
        for axis in 0..3 {
            values.insert(100 + axis, 250.0);
            values.insert(110 + axis, 6000.0);
            values.insert(120 + axis, 400.0);
            values.insert(130 + axis, 200.0);
        }
        values.extend(options.settings.iter().copied());
        Self { values, firmware: options.firmware }
    }

    /// Returns a setting; 0 if there is none of this number.
    pub(super) fn get(&self, number: u16) -> f32 {
        self.values.get(&number).copied().unwrap_or(0.0)
    }

    /// Changes a setting. Returns the number of grbl's error if that is not possible.
    pub(super) fn set(&mut self, number: u16, value: f32) -> Result<(), u16> {
        if !self.values.contains_key(&number) || !self.lists(number) {
            return Err(3);
        }
        if value < 0.0 {
            return Err(4);
        }
        if number == 20 && value != 0.0 && self.get(22) == 0.0 {
            return Err(10);
        }
        // grbl keeps 30,000 steps/s where that limit is compiled in. Whole numbers have eight bits.
        let kept =
            if number < FIRST_WITH_DECIMALS && !(11..=12).contains(&number) { value.trunc() } else { value };
        self.values.insert(number, kept);
        Ok(())
    }

    /// Returns the answer to `$$`.
    pub(super) fn lines(&self) -> Vec<String> {
        self.values
            .iter()
            .filter(|(number, _)| self.lists(**number))
            .map(|(n, v)| self.line(*n, *v))
            .collect()
    }

    /// Returns an item of FluidNC's configuration by its path.
    pub(super) fn item(&self, path: &str) -> Option<String> {
        let item = |axis: &str, first: u16| {
            let number = ["x", "y", "z"].iter().position(|name| *name == axis)?;
            Some(print(self.get(first + number as u16), 3))
        };
        let mut parts = path.split('/');
        let value = match (parts.next()?, parts.next()?, parts.next()) {
            ("stepping", "idle_ms", None) => (self.get(1) as i64).to_string(),
            ("axes", axis, Some("steps_per_mm")) => item(axis, 100)?,
            ("axes", axis, Some("max_rate_mm_per_min")) => item(axis, 110)?,
            ("axes", axis, Some("acceleration_mm_per_sec2")) => item(axis, 120)?,
            _ => return None,
        };
        Some(format!("$/{path}={value}"))
    }

    fn lists(&self, number: u16) -> bool {
        self.firmware != Firmware::FluidNc || matches!(number, 10 | 13)
    }

    fn line(&self, number: u16, value: f32) -> String {
        let whole = number < FIRST_WITH_DECIMALS && !(11..=12).contains(&number);
        if whole { format!("${number}={}", value as i64) } else { format!("${number}={}", print(value, 3)) }
    }
}
