//! The life of a tube: what it has pumped, its calibrations, its drift, and when to calibrate again.

mod picture;

use serde::Serialize;

use crate::bench::Bench;
use crate::calibration::{DRIFT_NEEDS, Drift, FactorAtTime, Stored};
use crate::dosing::{DoseError, TubeLife};
use crate::numbers::significant;
use crate::record::{Clock, LogLine, Stamp, SystemClock, Wear};

/// Coverage factor of the uncertainties (GUM, 6.2).
const COVERAGE: f64 = 2.0;

/// Length of a day, in s.
const DAY_S: f64 = 86_400.0;

/// Length of a day, in s.
const WHOLE_DAY_S: u64 = 86_400;

/// Life of a tube (`schema` `tube/1`).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct TubeReport {
    /// `tube/1`.
    pub schema: &'static str,
    /// Id of the pump.
    pub pump: String,
    /// Number of the tube, from 1.
    pub tube: u32,
    /// Volume that the tube has pumped in either direction, L.
    pub volume_l: f64,
    /// Volume that the tube lasts, L; null if nobody has said it.
    pub life_l: Option<f64>,
    /// Revolutions of the pump head in either direction.
    pub revolutions: f64,
    /// Revolutions that the tube lasts; null if nobody has said it.
    pub life_revolutions: Option<f64>,
    /// Time in motion, h.
    pub motion_h: f64,
    /// Time in motion that the tube lasts, h; null if nobody has said it.
    pub life_h: Option<f64>,
    /// Part of its life that the tube has behind it, by the measure that is nearest to its end; null without a life.
    pub used_part: Option<f64>,
    /// Calibrations of this tube, oldest first, at the speed of the last one.
    pub calibrations: Vec<TubeCalibration>,
    /// Speed at which the calibrations are compared, r/min; null without one.
    pub speed_rpm: Option<f64>,
    /// Drift of the volume of a revolution in 30 days, as a part; null with fewer than three calibrations.
    pub drift_per_30_days: Option<f64>,
    /// Expanded uncertainty (k = 2) of that drift.
    pub expanded_drift_per_30_days: Option<f64>,
    /// First date on which the upper bound of the drift exceeds the last calibration's uncertainty; null if unknown.
    pub calibrate_again_by: Option<String>,
    /// Days by which that date has passed.
    #[serde(skip)]
    overdue_days: u64,
}

/// Calibration of a tube.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct TubeCalibration {
    /// Number of the calibration.
    pub version: u32,
    /// Date of the calibration, UTC.
    pub date: String,
    /// Measured over model volume.
    pub factor: f64,
    /// Expanded uncertainty (k = 2) of the factor.
    pub expanded_uncertainty: f64,
}

impl TubeReport {
    /// Reads the life of the tube of a bench.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if the record, its log or a calibration cannot be read.
    pub fn of(bench: &Bench) -> Result<Self, DoseError> {
        let state = bench.stands()?;
        let since_s = tube_since_s(bench, state.tube());
        let stored = bench.calibrations().list()?;
        let of_tube: Vec<&Stored> =
            stored.iter().filter(|stored| is_of_tube(stored, state.tube(), since_s)).collect();
        // A reading in whose place another one came is none.
        let is_replaced = |at: usize| of_tube.get(at + 1).is_some_and(|next| of_one_dose(of_tube[at], next));
        let calibrations: Vec<&Stored> = of_tube
            .iter()
            .enumerate()
            .filter(|(at, _)| !is_replaced(*at))
            .map(|(_, stored)| *stored)
            .collect();
        let last_rpm = |stored: &&Stored| Some(stored.calibration.displacement.as_ref()?.reference_rpm);
        let speed_rpm = calibrations.last().and_then(last_rpm);
        let at_speed = |stored: &&Stored| {
            let (found, speed_rpm) = (stored.calibration.displacement.as_ref()?, speed_rpm?);
            let factor = found.factor_at(bench.model(), speed_rpm).ok()?;
            let standard = found.standard_at(bench.model(), speed_rpm).ok()?;
            let time: Stamp = stored.calibration.date.parse().ok()?;
            Some((stored.version, FactorAtTime::new(time.unix_s, factor, standard)))
        };
        let factors: Vec<(u32, FactorAtTime)> = calibrations.iter().filter_map(at_speed).collect();
        let drift = Drift::of(&factors.iter().map(|(_, factor)| *factor).collect::<Vec<_>>());
        let last_factor = factors.last().map_or(1.0, |(_, factor)| factor.factor);
        let by = drift.and_then(|drift| drift.days).zip(factors.last());
        let by_s = by.map(|(days, (_, last))| last.unix_s.saturating_add((days * DAY_S) as u64));
        let wear = state.wear;
        Ok(Self {
            schema: "tube/1",
            pump: bench.file().pump.id.clone(),
            tube: state.tube(),
            volume_l: 1e-3 * wear.volume_ml,
            life_l: bench.file().tube.life_ml.map(|life_ml| 1e-3 * life_ml),
            revolutions: wear.revolutions,
            life_revolutions: bench.file().tube.life_rev,
            motion_h: wear.motion_s / 3600.0,
            life_h: bench.file().tube.life_h,
            used_part: TubeLife::nearest(&bench.file().tube, wear, Wear::default()).map(|life| life.part()),
            speed_rpm,
            drift_per_30_days: drift.map(|drift| 30.0 * drift.per_day / last_factor),
            expanded_drift_per_30_days: drift
                .map(|drift| COVERAGE * 30.0 * drift.standard_per_day / last_factor),
            calibrate_again_by: by_s.map(|by_s| Stamp::new(by_s, 0).date()),
            overdue_days: by_s.map_or(0, |by_s| {
                (SystemClock.now().unix_s / WHOLE_DAY_S).saturating_sub(by_s / WHOLE_DAY_S)
            }),
            calibrations: factors
                .iter()
                .map(|(version, factor)| TubeCalibration::of(*version, factor))
                .collect(),
        })
    }

    /// One line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("plain data: {error}"))
    }

    /// The life of the tube in words.
    pub fn text(&self) -> String {
        let life = self.life_l.map_or(String::new(), |life_l| {
            let left_l = (life_l - self.volume_l).max(0.0);
            format!(" of {} L, {} L left,", significant(life_l, 4), significant(left_l, 4))
        });
        let of =
            |life: Option<f64>| life.map_or(String::new(), |life| format!(" of {}", significant(life, 4)));
        let mut text = format!(
            "tube {} of {}: {} L{life} in {}{} revolutions and {}{} h of motion\n",
            self.tube,
            self.pump,
            significant(self.volume_l, 4),
            significant(self.revolutions, 4),
            of(self.life_revolutions),
            significant(self.motion_h, 3),
            of(self.life_h)
        );
        if let Some(part) = self.used_part {
            let percent = match 100.0 * part {
                little if little > 0.0 && little < 0.01 => "less than 0.01".to_owned(),
                percent => significant(percent, 3),
            };
            text += &format!("{percent} % of its life is used; the first measure that is reached counts\n");
        }
        for calibration in &self.calibrations {
            text += &calibration.line(self.speed_rpm.unwrap_or_default());
        }
        text += &self.picture();
        let percent = |part: Option<f64>| part.map(|part| significant(100.0 * part, 2));
        let drift = percent(self.drift_per_30_days).zip(percent(self.expanded_drift_per_30_days));
        text += &match (drift, &self.calibrate_again_by) {
            (Some((drift, unsure)), Some(by)) => format!(
                "drift {drift} % ± {unsure} % in 30 days (k = 2)\ncalibrate again by {by}{}: from then on the drift \
                 may exceed the uncertainty of the last calibration\n",
                match self.overdue_days {
                    0 => String::new(),
                    1 => ", which was yesterday".to_owned(),
                    days => format!(", which was {days} days ago"),
                }
            ),
            (Some((drift, unsure)), None) => format!("drift {drift} % ± {unsure} % in 30 days (k = 2)\n"),
            (None, _) if self.calibrations.len() >= DRIFT_NEEDS => format!(
                "calibrate again by: unknown, since the {} calibrations of this tube lie too close together to tell \
                 its drift, or have no uncertainty; a drift shows after days\n",
                self.calibrations.len()
            ),
            (None, _) => format!(
                "calibrate again by: unknown, since {} of {DRIFT_NEEDS} calibrations of this tube are on record\n",
                self.calibrations.len()
            ),
        };
        text
    }
}

impl TubeCalibration {
    fn of(version: u32, found: &FactorAtTime) -> Self {
        Self {
            version,
            date: Stamp::new(found.unix_s, 0).to_string(),
            factor: found.factor,
            expanded_uncertainty: COVERAGE * found.standard,
        }
    }

    fn line(&self, speed_rpm: f64) -> String {
        let day = self.date.split('T').next().unwrap_or_default();
        format!(
            "  calibration {} of {day}  model volume times {:.4} ± {:.4} (k = 2) at {} r/min\n",
            self.version,
            self.factor,
            self.expanded_uncertainty,
            significant(speed_rpm, 3)
        )
    }
}

/// Returns the time of the last dose of an earlier tube, in seconds since 1970. 0 for the first tube.
fn tube_since_s(bench: &Bench, tube: u32) -> u64 {
    let lines = if tube > 1 { bench.log().ok() } else { None };
    let earlier = |line| match line {
        Ok(LogLine::Dose(dose)) if dose.tube < tube => Some(dose.time.unix_s),
        _ => None,
    };
    lines.into_iter().flatten().filter_map(earlier).last().unwrap_or(0)
}

/// Returns true for two calibrations whose last readings are of one dose.
fn of_one_dose(one: &Stored, next: &Stored) -> bool {
    let last = |stored: &Stored| stored.calibration.runs.last().cloned();
    last(one).zip(last(next)).is_some_and(|(one, next)| one.time.is_some() && one.is_of_dose(&next))
}

/// Returns true for a calibration of the tube of that number. One of an earlier version has no number: it counts if it
/// was made after the last dose of an earlier tube.
fn is_of_tube(stored: &Stored, tube: u32, since_s: u64) -> bool {
    if let Some(number) = stored.calibration.tube_number {
        return number == tube;
    }
    let date = stored.calibration.date.parse::<Stamp>();
    date.is_ok_and(|date| date.unix_s > since_s || since_s == 0)
}
