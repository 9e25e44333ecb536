//! The numbers of a calibration that was read, which must be those of a real one.

use pump_model::Shown;

use super::calibration::Calibration;
use super::fit::{Displacement, FittedPulse, ShortDose};
use super::run::{CalibrationRun, PLAUSIBLE, Reading};

/// Largest speed, in r/min, as of simulations: 1e4 rad/s.
const MOST_RPM: f64 = 95_493.0;
/// Largest volume, in mL, mass, in g, or number of steps.
const MOST: f64 = 1e9;
/// Largest angle, in deg: more than any run turns.
const MOST_DEG: f64 = 1e12;

impl Calibration {
    /// Checks that the data have the schema of this version, and numbers that weighed runs give.
    ///
    /// # Errors
    ///
    /// A message that names the key, its value and what is allowed.
    pub fn check(&self) -> Result<(), String> {
        self.check_schema()?;
        within("temperature_degc", self.temperature_degc, [-273.15, 1000.0])?;
        within("ambient_kpa", self.ambient_kpa, [0.0, 1e4])?;
        above_0("revolution_ml", self.revolution_ml, MOST)?;
        self.steps_per_rev.map_or(Ok(()), |steps| above_0("steps_per_rev", steps, MOST))?;
        within("zero_deg", self.zero_deg, [-MOST_DEG, MOST_DEG])?;
        standard("zero_standard_deg", self.zero_standard_deg)?;
        self.displacement.as_ref().map_or(Ok(()), Displacement::check)?;
        self.pulse.as_ref().map_or(Ok(()), FittedPulse::check)?;
        let mut runs = self.runs.iter().enumerate();
        runs.try_for_each(|(n, run)| check_run(&format!("runs[{n}]"), run))?;
        let mut doses = self.short_doses.iter().enumerate();
        doses.try_for_each(|(n, dose)| check_dose(&format!("short_doses[{n}]"), dose))
    }
}

impl Displacement {
    fn check(&self) -> Result<(), String> {
        above_0("displacement.reference_rpm", self.reference_rpm, MOST_RPM)?;
        // Every run lies between these, and so does their mean.
        within("displacement.factor", self.factor, [1.0 / PLAUSIBLE, PLAUSIBLE])?;
        standard("displacement.factor_standard", self.factor_standard)?;
        standard("displacement.slope_standard_per_rpm", self.slope_standard_per_rpm)?;
        standard("displacement.scatter", self.scatter.standard().unwrap_or(0.0))?;
        standard("displacement.lack_of_fit", self.lack_of_fit)?;
        standard("displacement.reading", self.reading)?;
        let mut slower_rpm = 0.0;
        for (n, rpm) in self.speeds_rpm.iter().enumerate() {
            let key = format!("displacement.speeds_rpm[{n}]");
            above_0(&key, *rpm, MOST_RPM)?;
            if *rpm < slower_rpm {
                return Err(format!("{key} is {}; allowed: rising speeds", Shown(*rpm)));
            }
            slower_rpm = *rpm;
            let kappa = self.kappa_at(*rpm);
            if !(kappa > 0.0 && kappa < PLAUSIBLE * PLAUSIBLE) {
                return Err(format!(
                    "displacement.slope_per_rpm is {}, by which the volume at {} r/min is {} times the model's; \
                     allowed: more than 0 and less than {}",
                    Shown(self.slope_per_rpm),
                    Shown(*rpm),
                    Shown(kappa),
                    PLAUSIBLE * PLAUSIBLE
                ));
            }
        }
        Ok(())
    }
}

impl FittedPulse {
    fn check(&self) -> Result<(), String> {
        above_0("pulse.roller_volume_ml", self.roller_volume_ml, MOST)?;
        standard("pulse.roller_volume_standard_ml", self.roller_volume_standard_ml)?;
        above_0("pulse.engagement_deg", self.engagement_deg, 360.0)?;
        standard("pulse.engagement_standard_deg", self.engagement_standard_deg)?;
        for (n, correlation) in self.correlations.iter().enumerate() {
            within(&format!("pulse.correlations[{n}]"), *correlation, [-1.0 - 1e-9, 1.0 + 1e-9])?;
        }
        standard("pulse.repeatability", self.repeatability)?;
        standard("pulse.reading_ml", self.reading_ml)
    }
}

fn check_run(key: &str, run: &CalibrationRun) -> Result<(), String> {
    above_0(&format!("{key}.speed_rpm"), run.speed_rpm, MOST_RPM)?;
    turned(key, run.turned_deg)?;
    let (unit, reading) = match run.reading {
        Reading::MassG(mass_g) => ("mass_g", mass_g),
        Reading::VolumeMl(volume_ml) => ("volume_ml", volume_ml),
    };
    above_0(&format!("{key}.reading.{unit}"), reading, MOST)?;
    run.digit.map_or(Ok(()), |digit| above_0(&format!("{key}.digit"), digit, MOST))?;
    run.start_half_width_deg.map_or(Ok(()), |deg| standard(&format!("{key}.start_half_width_deg"), deg))
}

fn check_dose(key: &str, dose: &ShortDose) -> Result<(), String> {
    turned(key, dose.turned_deg)?;
    above_0(&format!("{key}.volume_ml"), dose.volume_ml, MOST)?;
    dose.speed_rpm.map_or(Ok(()), |rpm| above_0(&format!("{key}.speed_rpm"), rpm, MOST_RPM))
}

fn turned(key: &str, deg: f64) -> Result<(), String> {
    if deg != 0.0 && deg.abs() <= MOST_DEG {
        return Ok(());
    }
    Err(format!("{key}.turned_deg is {}; allowed: other than 0, up to {MOST_DEG:e} either way", Shown(deg)))
}

fn within(key: &str, value: f64, [least, most]: [f64; 2]) -> Result<(), String> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(format!("{key} is {}; allowed: {} to {}", Shown(value), Shown(least), Shown(most)))
}

fn above_0(key: &str, value: f64, most: f64) -> Result<(), String> {
    if value > 0.0 && value <= most {
        return Ok(());
    }
    Err(format!("{key} is {}; allowed: more than 0, up to {}", Shown(value), Shown(most)))
}

/// Checks a standard uncertainty.
fn standard(key: &str, value: f64) -> Result<(), String> {
    within(key, value, [0.0, MOST])
}

#[cfg(test)]
mod tests {
    use super::super::{Expected, Fit, Source, runs_of_csv};
    use super::*;

    fn found() -> Calibration {
        let file = crate::built_in("three-roller").unwrap();
        let text = "speed_rpm,turned_deg,volume_ml\n20,720,42\n60,720,43\n100,720,44\n";
        let runs = runs_of_csv(text, 12_800.0).unwrap();
        let expected = Expected::of_runs(&file, &runs);
        Calibration::of_runs(&file, Source::File, runs, Fit::Best, &expected, None).unwrap()
    }

    #[test]
    fn a_fit_is_taken_and_what_none_gives_is_named() {
        assert_eq!(found().check(), Ok(()));
        let refused = |change: fn(&mut Calibration)| {
            let mut calibration = found();
            change(&mut calibration);
            calibration.check().unwrap_err()
        };
        fn displacement(of: &mut Calibration) -> &mut Displacement {
            of.displacement.as_mut().unwrap()
        }
        for (told, begin) in [
            (refused(|of| displacement(of).factor = 0.0), "displacement.factor is 0; allowed: 0.5 to 2"),
            (refused(|of| displacement(of).factor = 1e300), "displacement.factor is 1e300; allowed"),
            (refused(|of| displacement(of).factor_standard = -1.0), "displacement.factor_standard is -1"),
            (refused(|of| displacement(of).slope_per_rpm = 1.0), "displacement.slope_per_rpm is 1, by which"),
            (refused(|of| displacement(of).speeds_rpm.reverse()), "displacement.speeds_rpm[1] is 60"),
            (
                refused(|of| of.runs[1].reading = Reading::MassG(-5.0)),
                "runs[1].reading.mass_g is -5; allowed",
            ),
            (refused(|of| of.runs[0].speed_rpm = -5.0), "runs[0].speed_rpm is -5; allowed: more than 0"),
            (refused(|of| of.runs[2].turned_deg = 0.0), "runs[2].turned_deg is 0; allowed: other than 0"),
            (refused(|of| of.steps_per_rev = Some(-1e300)), "steps_per_rev is -1e300; allowed: more than 0"),
            (refused(|of| of.schema = "calibration/9".to_owned()), "its schema is `calibration/9`"),
        ] {
            assert!(told.starts_with(begin), "{told}");
        }
    }
}
