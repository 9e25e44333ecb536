//! The life of a tube and the part of it that is used up.

use std::fmt;

use crate::dosing::DoseError;
use crate::notice::{Notice, Remedy};
use crate::pump_file::TubeTable;
use crate::record::Wear;

/// Part of its life from which on a tube is warned of.
const WARNED_FROM: f64 = 0.9;

/// Length of an hour, in s.
const HOUR_S: f64 = 3600.0;

/// Measure of a tube's life.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LifeUnit {
    /// Volume pumped either way, in mL.
    Millilitres,
    /// Revolutions of the pump head either way.
    Revolutions,
    /// Time in motion, in h.
    Hours,
}

impl LifeUnit {
    /// Returns what a tube has done by this measure, as a verb.
    pub(crate) fn verb(self) -> &'static str {
        match self {
            Self::Millilitres => "pumped",
            Self::Revolutions => "turned",
            Self::Hours => "run",
        }
    }
}

impl fmt::Display for LifeUnit {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(match self {
            Self::Millilitres => "mL",
            Self::Revolutions => "revolutions",
            Self::Hours => "h",
        })
    }
}

/// Life of a tube by one measure, with a planned dose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TubeLife {
    pub(crate) unit: LifeUnit,
    /// Life of the tube.
    pub(crate) life: f64,
    /// Part that the tube has behind it.
    pub(crate) used: f64,
    /// Part that the planned dose takes.
    pub(crate) planned: f64,
}

impl TubeLife {
    /// Returns the life that a dose of `planned` wear comes nearest to the end of, or furthest beyond. `None` if the
    /// pump file gives no life.
    pub(crate) fn nearest(table: &TubeTable, worn: Wear, planned: Wear) -> Option<Self> {
        let of = |unit, life: Option<f64>, amount: fn(Wear) -> f64| {
            life.map(|life| Self { unit, life, used: amount(worn), planned: amount(planned) })
        };
        let lives = [
            of(LifeUnit::Millilitres, table.life_ml, |wear| wear.volume_ml),
            of(LifeUnit::Revolutions, table.life_rev, |wear| wear.revolutions),
            of(LifeUnit::Hours, table.life_h, |wear| wear.motion_s / HOUR_S),
        ];
        lives.into_iter().flatten().max_by(|one, other| one.part().total_cmp(&other.part()))
    }

    /// Returns the part of the life that is used up after the dose.
    pub(crate) fn part(&self) -> f64 {
        self.after() / self.life
    }

    /// Returns what the tube will have behind it after the dose.
    fn after(&self) -> f64 {
        self.used + self.planned
    }

    /// Refuses a dose that uses up the tube.
    pub(crate) fn check(&self) -> Result<(), DoseError> {
        let Self { unit, life, used, planned } = *self;
        if self.after() < life { Ok(()) } else { Err(DoseError::TubeWorn { unit, life, used, planned }) }
    }

    /// Warns of a tube that is almost used up.
    pub(crate) fn warning(&self) -> Option<Notice> {
        let Self { unit, life, .. } = *self;
        let after = self.after();
        (after >= WARNED_FROM * life).then(|| {
            let text = format!(
                "with this dose the tube will have {} {after:.1} {unit} of its life of {life} {unit}; \
                 {:.1} {unit} are left",
                unit.verb(),
                (life - after).max(0.0)
            );
            Notice::from(text).with_remedy(Remedy::NoteNewTube)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tube(used: f64, planned: f64) -> TubeLife {
        TubeLife { unit: LifeUnit::Millilitres, life: 1000.0, used, planned }
    }

    #[test]
    fn the_planned_dose_counts_for_the_warning_and_for_the_refusal() {
        assert_eq!(tube(0.0, 899.0).warning(), None);
        let warning = tube(890.0, 20.0).warning().unwrap();
        assert!(
            warning.text().contains("910.0 mL of its life of 1000 mL")
                && warning.text().contains("90.0 mL are left"),
            "{warning}"
        );
        assert!(tube(890.0, 109.0).check().is_ok());
        for (used, planned) in [(890.0, 110.0), (1000.0, 0.1), (0.0, 2000.0)] {
            let error = tube(used, planned).check().unwrap_err().to_string();
            assert!(error.contains("its life of 1000 mL"), "{error}");
        }
    }

    #[test]
    fn of_several_lives_the_first_that_is_reached_counts() {
        let table = TubeTable {
            life_ml: Some(1000.0),
            life_h: Some(2.0),
            life_rev: Some(100.0),
            ..TubeTable::default()
        };
        let wear = |volume_ml, revolutions, motion_s| Wear { volume_ml, revolutions, motion_s };
        let planned = wear(10.0, 1.0, 36.0);
        for (worn, unit, used) in [
            (wear(980.0, 20.0, 60.0), LifeUnit::Millilitres, 980.0),
            (wear(500.0, 98.5, 60.0), LifeUnit::Revolutions, 98.5),
            (wear(500.0, 20.0, 7180.0), LifeUnit::Hours, 7180.0 / 3600.0),
        ] {
            let nearest = TubeLife::nearest(&table, worn, planned).unwrap();
            assert_eq!((nearest.unit, nearest.used), (unit, used));
        }
        assert_eq!(TubeLife::nearest(&TubeTable::default(), planned, planned), None);
        let spent = TubeLife::nearest(&table, wear(0.0, 99.5, 0.0), planned).unwrap().check().unwrap_err();
        assert_eq!(
            spent.to_string(),
            "the tube has turned 99.5 revolutions, and this dose of 1.0000 revolutions would exceed its \
             life of 100 revolutions"
        );
    }
}
