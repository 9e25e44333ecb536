//! The record of a pump in words.

use super::status::{BoardStatus, CalibrationStatus, Status, UnfinishedCalibration, UnfinishedStatus};
use crate::notice::{Remedy, Wording};
use crate::numbers::{between, microlitres, significant};
use crate::record::{AngleLoss, Purpose, Wear};

impl Status {
    /// The record in words, a line each for the rotor, the tube, the calibration and an unfinished dose. A front end
    /// words what makes the rest of something unfinished.
    pub fn text(&self, words: Wording) -> String {
        let (pump, driver) = (&self.pump, &self.driver);
        if !self.recorded {
            let stands = if self.angle_known {
                "a fresh simulated pump stands at 0°"
            } else {
                "where the rollers stand is unknown"
            };
            let calibration = self.calibration.as_ref().map_or(String::new(), |used| used.text() + "\n");
            let safety = self.safety.line(words).map_or(String::new(), |line| line + "\n");
            return format!("{pump} ({driver}): nothing on record; {stands}\n{calibration}{safety}");
        }
        let lines = [
            Some(self.rotor()),
            self.lost(words).or(self.disturbed()),
            self.board.as_ref().map(BoardStatus::text),
            Some(self.tube()),
            self.calibration.as_ref().map(CalibrationStatus::text),
            self.last_by_weight.map(|weighed| weighed.text()),
            self.unfinished.as_ref().map(|dose| self.unfinished_dose(dose, words)),
            self.unfinished_calibration.map(|calibration| calibration.text(words)),
            self.safety.line(words),
        ];
        lines.into_iter().flatten().map(|line| line + "\n").collect()
    }

    fn rotor(&self) -> String {
        let angle = match (self.angle_deg, self.half_width_deg) {
            (None, _) => "an unknown angle".to_owned(),
            (Some(angle_deg), 0.0) => format!("{angle_deg:.4}°"),
            (Some(angle_deg), width_deg) => format!("{angle_deg:.4}° ± {width_deg:.2}°"),
        };
        let (pump, driver, carry) = (&self.pump, &self.driver, microlitres(self.carry_ml));
        format!("{pump} ({driver}): rotor at {angle}, {carry} carried to the next dose")
    }

    fn lost(&self, words: Wording) -> Option<String> {
        let (cause, find) = (self.angle_lost_by?, Remedy::finding_angle(self.unfinished.is_some()));
        let board_may_tell = self.unfinished.as_ref().is_some_and(|dose| dose.board_may_tell);
        let (told, find) = (cause.told(), words(find));
        Some(match cause {
            AngleLoss::UncountedSteps if board_may_tell => {
                format!(
                    "the angle is unknown until the board tells its count, because {told}; if it was reset: {find}"
                )
            }
            _ => format!("the angle is unknown, because {told}; {find}"),
        })
    }

    fn disturbed(&self) -> Option<String> {
        (self.disturbances == 1 && self.angle_known).then(|| {
            "the rotor may have moved unseen once since its angle was found: by a reset, without current, or in a \
             stop without a ramp; a second time makes the angle unknown"
                .to_owned()
        })
    }

    fn tube(&self) -> String {
        let Wear { volume_ml, revolutions, motion_s } = self.wear;
        let time = match motion_s {
            ..60.0 => format!("{motion_s:.1} s"),
            ..3600.0 => format!("{:.1} min", motion_s / 60.0),
            _ => format!("{:.1} h", motion_s / 3600.0),
        };
        let life = self.tube_life_ml.map_or(String::new(), |life_ml| format!(" of {life_ml} mL"));
        let turns = self.tube_life_revolutions.map_or(String::new(), |turns| format!(" of {turns}"));
        let hours = self.tube_life_h.map_or(String::new(), |hours| format!(" (of {hours} h)"));
        format!(
            "tube: {volume_ml:.1} mL{life} in {revolutions:.2}{turns} revolutions and {time}{hours} of motion"
        )
    }

    fn unfinished_dose(&self, dose: &UnfinishedStatus, words: Wording) -> String {
        let remedy = match (dose.by_weight, dose.over_time) {
            (true, _) => Remedy::FinishByVolumeOrWeigh,
            (false, true) => Remedy::Accept,
            (false, false) => Remedy::FinishOrLeave,
        };
        let no_rest = match (dose.over_time, dose.until_stopped) {
            (true, _) => "; no rest of it can be made, as its times have passed",
            (false, true) => "; its rest goes on until it is stopped",
            (false, false) => "",
        };
        let by_angle = if dose.steps_are_exact && dose.delivered_least_ml < dose.delivered_most_ml {
            " (the steps are exact: the bounds are those of the rollers' angle)"
        } else if !dose.steps_are_exact && dose.board_may_tell {
            " (by the record alone: a board that was not reset since knows the exact steps, and tells them and \
             the angle once the rest is made)"
        } else {
            ""
        };
        let of_then = dose.other_volumes.map_or(String::new(), |(then_ml, now_ml)| {
            let [then_ml, now_ml] = [then_ml, now_ml].map(|ml| significant(ml, 6));
            format!(" (by the pump file of then, which gave {then_ml} mL per revolution; it gives {now_ml} mL now)")
        });
        let searched = match dose.searched_ml {
            0.0 => String::new(),
            ml => format!("; turns to find the angle pumped another {} mL", significant(ml, 3)),
        };
        let end = dose.end.map_or(String::new(), |end| format!("; {}", end.told(dose.cause.as_deref())));
        match &self.in_use_by {
            Some(holder) => format!("in motion, by {holder}: {}", dose.made(true)),
            None => {
                format!(
                    "unfinished: {}{of_then}{by_angle}{searched}{end}{no_rest}; {}",
                    dose.made(false),
                    words(remedy)
                )
            }
        }
    }
}

impl UnfinishedStatus {
    /// Returns in words what was asked for, and how much of it was delivered; or will be, while it `moves`.
    pub(super) fn made(&self, moves: bool) -> String {
        let made = between(self.delivered_least_ml, self.delivered_most_ml);
        let delivered = if moves { "are delivered by the end of this stretch" } else { "were delivered" };
        let by_model = match self.by_weight {
            true => " by the model",
            // The bounds are those of the rollers' angle and of steps that nobody knows.
            false => " by the model, whose own \u{b1} adds to that",
        };
        format!("{}, of which {made} {delivered}{by_model}", self.asked())
    }

    fn asked(&self) -> String {
        let asked_ml = significant(self.requested_ml, 6);
        if self.until_stopped {
            return "a run until it is stopped".to_owned();
        }
        if self.over_time {
            return format!("a flow over time of {asked_ml} mL");
        }
        let noun = match self.purpose {
            Purpose::Dose => "dose",
            Purpose::Prime => "prime",
            Purpose::Purge => "purge",
            Purpose::Run => "run",
            Purpose::Calibrate => "calibration run",
            Purpose::Retract => "retraction",
            Purpose::Jog => "turn",
        };
        let weighed = match self.target_g.filter(|_| self.by_weight) {
            Some(target_g) => format!(" by weight ({} g)", significant(target_g, 6)),
            None if self.by_weight => " by weight".to_owned(),
            None => String::new(),
        };
        format!("a {noun} of {asked_ml} mL{weighed}")
    }
}

impl CalibrationStatus {
    /// The calibration in words, with the pulse that its short doses found.
    fn text(&self) -> String {
        let Self { version, date, .. } = self;
        let in_use = format!("doses use calibration {version} of {date}");
        let volume_ml = self.roller_volume_ml.zip(self.roller_volume_standard_ml);
        let engagement_deg = self.engagement_deg.zip(self.engagement_standard_deg);
        let Some(((volume_ml, volume), (deg, angle))) = volume_ml.zip(engagement_deg) else { return in_use };
        let (volume, angle) = (2.0 * volume, 2.0 * angle);
        format!(
            "{in_use}: roller volume {volume_ml:.4} ± {volume:.4} mL over {deg:.2}° ± {angle:.2}° (k = 2)"
        )
    }
}

impl UnfinishedCalibration {
    /// The calibration in words, and the command that goes on with it.
    pub(super) fn text(&self, words: Wording) -> String {
        match (self.readings, self.planned) {
            (Some(readings), Some(planned)) => format!(
                "unfinished: a guided calibration with {readings} of {planned} readings on record; {}",
                words(Remedy::ContinueCalibration)
            ),
            _ => format!(
                "unfinished: a guided calibration whose readings cannot be read; {}",
                words(Remedy::SeeWhyUnreadable)
            ),
        }
    }
}
