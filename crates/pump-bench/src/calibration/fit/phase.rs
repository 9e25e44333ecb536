//! The zero of the angle and the shape of a pulse, from short doses at known start angles.

use nalgebra::{Matrix3, Vector3};
use pump_model::identification::{Estimate, widening};
use pump_model::math::{degrees, radians, sqrt, wrap};
use pump_model::{ModelError, Pump};
use serde::{Deserialize, Serialize};

use super::displacement::Expected;
use super::revolution::Revolution;
use crate::calibration::{CalibrationError, Reading, Weighing};
use crate::files::Table;

/// Zeros that the search starts from, over a pitch.
const STARTS: u32 = 36;

/// Steps of the search; it takes about ten.
const MOST_STEPS: u32 = 200;

/// Change of a parameter by which its effect is measured, part of V_r and phi, and rad.
const PROBE: f64 = 1e-5;

/// A short dose with what arrived.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShortDose {
    /// Where the rollers stood by the record, deg.
    pub start_angle_deg: f64,
    /// How far the rotor turned, deg; negative in reverse.
    pub turned_deg: f64,
    /// What arrived, mL, without sign.
    pub volume_ml: f64,
    /// Its cruise speed, r/min; none takes the mean speed of the calibration's runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_rpm: Option<f64>,
}

/// What short doses say of a pump.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PhaseFit {
    /// V_r, mL.
    pub roller_volume_ml: Estimate,
    /// phi, deg.
    pub engagement_deg: Estimate,
    /// Model angle of the rollers where the record says 0, deg, within half a pitch either way.
    pub zero_deg: Estimate,
    /// Standard deviation of the doses about the fit, mL.
    pub scatter_ml: f64,
    /// Doses less parameters.
    pub degrees_of_freedom: u32,
}

/// Reads short doses: CSV with `start_angle_deg`, `turned_deg`, one of `mass_g` and `volume_ml`, and perhaps
/// `temperature_degc` and `speed_rpm`.
pub fn short_doses_of_csv(text: &str, weighing: &Weighing<'_>) -> Result<Vec<ShortDose>, CalibrationError> {
    let known =
        ["start_angle_deg", "turned_deg", "mass_g", "volume_ml", "temperature_degc", "speed_rpm", "time"];
    let table = Table::parse(text, &known)?;
    let mut doses = Vec::new();
    for row in table.rows() {
        let turned_deg = row.required("turned_deg")?;
        if turned_deg == 0.0 {
            return Err(row.error("turned_deg is 0; a dose turns".to_owned()).into());
        }
        let (name, value, reading) =
            row.one_of([("mass_g", Reading::MassG as fn(f64) -> Reading), ("volume_ml", Reading::VolumeMl)])?;
        if value <= 0.0 {
            return Err(row.error(format!("{name} is {value}; allowed: more than 0")).into());
        }
        let degc = row.number("temperature_degc")?.unwrap_or(weighing.fluid.temperature_degc);
        let volume_ml = match reading(value) {
            Reading::MassG(mass_g) => weighing.volume_ml(mass_g, degc)?,
            Reading::VolumeMl(volume_ml) => volume_ml,
        };
        let speed_rpm = row.number("speed_rpm")?;
        if let Some(rpm) = speed_rpm.filter(|rpm| *rpm <= 0.0) {
            return Err(row.error(format!("speed_rpm is {rpm}; allowed: more than 0")).into());
        }
        let start_angle_deg = row.required("start_angle_deg")?;
        doses.push(ShortDose { start_angle_deg, turned_deg, volume_ml, speed_rpm });
    }
    Ok(doses)
}

/// V_r over the model's, phi over the model's, and the zero, rad.
type Parameters = Vector3<f64>;

/// Doses of a pump whose volume of a revolution is known.
struct Doses<'a> {
    pump: &'a Pump,
    /// Volume of a revolution over the model's, for each dose.
    factors: &'a [f64],
    /// Every volume by the model times this, to see what the uncertainty of the revolution does.
    tilt: f64,
    doses: &'a [ShortDose],
    expected: &'a Expected,
}

impl PhaseFit {
    /// Fits the doses of `pump`, as it is without calibration: weighted nonlinear least squares after Levenberg and Marquardt,
    /// with the volume of a revolution held, which whole pitches tell better than any short dose. What is unsure of it is part
    /// of the standard uncertainties, by a second fit to so much more. A dose weighs as in [`Displacement::fit`](super::Displacement::fit).
    pub fn of(
        pump: &Pump,
        revolution: Revolution<'_>,
        doses: &[ShortDose],
        expected: &Expected,
    ) -> Result<Self, CalibrationError> {
        const NEEDED: usize = 5;
        if doses.len() < NEEDED {
            return Err(CalibrationError::TooFew { given: doses.len(), of: "short doses", needed: NEEDED });
        }
        let factors = doses.iter().map(|dose| revolution.factor(dose)).collect::<Result<Vec<_>, _>>()?;
        let all = Doses { pump, factors: &factors, tilt: 1.0, doses, expected };
        let (best, left) = all.search()?;
        let degrees_of_freedom = doses.len() as u32 - 3;
        let variance_ratio = left / f64::from(degrees_of_freedom);
        let undetermined =
            |why| CalibrationError::Undetermined { what: "roller volume, engagement angle and zero", why };
        let expected_covariance = inverse(&all.normal_equations(&best)?.0)
            .filter(|inverse| inverse.diagonal().iter().all(|variance| *variance > 0.0))
            .ok_or(undetermined(
                "they do not sweep a pulse; turn a fifth of a pitch from angles all over a pitch",
            ))?;
        // Readings that happen to agree do not make up for doses that say nothing of a pulse.
        if sqrt(expected_covariance[(2, 2)]) > pump.pitch_rad() / 12.0 {
            return Err(undetermined(
                "they sweep too little of a pulse; turn a fifth of a pitch from angles all over a pitch",
            ));
        }
        let covariance = expected_covariance * variance_ratio;
        let tilted = Doses { tilt: 1.0 + revolution.standard(pump)?, ..all }.search_from(best)?.0 - best;
        let standard = |n: usize| {
            let scattered = widening(degrees_of_freedom) * sqrt(covariance[(n, n)]);
            sqrt(scattered * scattered + tilted[n] * tilted[n])
        };
        let found = |value: f64, unit: f64, n| Estimate { value: value * unit, standard: standard(n) * unit };
        let pitch_rad = pump.pitch_rad();
        let zero_rad = wrap(best[2] + 0.5 * pitch_rad, pitch_rad) - 0.5 * pitch_rad;
        let fit = Self {
            roller_volume_ml: found(best[0], pump.roller_volume().total_ml(), 0),
            engagement_deg: found(best[1], pump.roller_volume().engagement_deg(), 1),
            zero_deg: found(zero_rad, degrees(1.0), 2),
            scatter_ml: all.scatter_ml(&best)?,
            degrees_of_freedom,
        };
        if fit.zero_deg.standard > degrees(pitch_rad) / 12.0 {
            return Err(undetermined(
                "the doses scatter too much, or sweep no pulse, for the zero to be found",
            ));
        }
        Ok(fit)
    }
}

impl Doses<'_> {
    fn model(&self, at: &Parameters) -> Result<Pump, ModelError> {
        let roller = self.pump.roller_volume();
        let roller =
            roller.scaled_to(at[0] * roller.total_ml())?.stretched_to(at[1] * roller.engagement_deg())?;
        let pump = Pump::new(*self.pump.geometry(), roller, *self.pump.inlet(), *self.pump.outlet())?;
        pump.shifted(at[2])?.scaled(self.tilt * self.pump.revolution_ml() / pump.revolution_ml())
    }

    /// Volume of a dose by the model, mL, where a revolution gives `factor` times the model's.
    fn volume_ml(pump: &Pump, dose: &ShortDose, factor: f64) -> f64 {
        let curve = pump.outlet_curve();
        let start_rad = radians(dose.start_angle_deg);
        let model_ml = curve.volume_ml(start_rad + radians(dose.turned_deg)) - curve.volume_ml(start_rad);
        factor * model_ml.abs()
    }

    /// What each dose gave beyond the model, over what is expected of it.
    fn residuals(&self, at: &Parameters) -> Result<Vec<f64>, ModelError> {
        let pump = self.model(at)?;
        let sigma_ml = |dose: &ShortDose| {
            let repeated_ml = self.expected.repeatability * dose.volume_ml;
            sqrt(repeated_ml * repeated_ml + self.expected.reading_ml * self.expected.reading_ml).max(1e-9)
        };
        let residual = |(dose, factor): (&ShortDose, &f64)| {
            (dose.volume_ml - Self::volume_ml(&pump, dose, *factor)) / sigma_ml(dose)
        };
        Ok(self.doses.iter().zip(self.factors).map(residual).collect())
    }

    fn scatter_ml(&self, at: &Parameters) -> Result<f64, ModelError> {
        let pump = self.model(at)?;
        let squares = self.doses.iter().zip(self.factors).map(|(dose, factor)| {
            let left_ml = dose.volume_ml - Self::volume_ml(&pump, dose, *factor);
            left_ml * left_ml
        });
        Ok(sqrt(squares.sum::<f64>() / (self.doses.len() - 3) as f64))
    }

    fn sum(&self, at: &Parameters) -> Result<f64, ModelError> {
        Ok(self.residuals(at)?.iter().map(|residual| residual * residual).sum())
    }

    /// J^T J and J^T r for the residuals r, with J = -dr/dp by central differences.
    fn normal_equations(&self, at: &Parameters) -> Result<(Matrix3<f64>, Vector3<f64>), ModelError> {
        let residuals = self.residuals(at)?;
        let mut columns = Vec::new();
        for n in 0..3 {
            let probe = Parameters::ith(n, PROBE);
            let (more, less) = (self.residuals(&(at + probe))?, self.residuals(&(at - probe))?);
            let slope = more.iter().zip(less).map(|(more, less)| (less - more) / (2.0 * PROBE));
            columns.push(slope.collect::<Vec<f64>>());
        }
        let dot = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
        let normal = Matrix3::from_fn(|row, column| dot(&columns[row], &columns[column]));
        let gradient = Vector3::from_fn(|row, _| dot(&columns[row], &residuals));
        Ok((normal, gradient))
    }

    /// Parameters with the smallest sum of squares, and that sum: from the best of zeros all over a pitch, since the sum
    /// has other minima in the zero.
    fn search(&self) -> Result<(Parameters, f64), CalibrationError> {
        let mut best: Option<(Parameters, f64)> = None;
        for n in 0..STARTS {
            let zero_rad = f64::from(n) / f64::from(STARTS) * self.pump.pitch_rad();
            let start = Parameters::new(1.0, 1.0, zero_rad);
            let sum = self.sum(&start)?;
            if best.is_none_or(|(_, least)| sum < least) {
                best = Some((start, sum));
            }
        }
        let why = "the model has no volume";
        let (start, _) = best.ok_or(CalibrationError::Undetermined { what: "the zero", why })?;
        self.search_from(start)
    }

    /// The nearest minimum downhill.
    fn search_from(&self, start: Parameters) -> Result<(Parameters, f64), CalibrationError> {
        let undetermined = |why| CalibrationError::Undetermined { what: "the zero", why };
        let (mut at, mut sum) = (start, self.sum(&start)?);
        let mut damping = 1e-3;
        for _ in 0..MOST_STEPS {
            let (normal, gradient) = self.normal_equations(&at)?;
            let damped = normal + Matrix3::from_diagonal(&(normal.diagonal() * damping));
            let step = inverse(&damped)
                .map(|inverse| inverse * gradient)
                .ok_or(undetermined("they sweep no pulse"))?;
            // Steps to pumps that cannot be are refused like steps uphill.
            match self.sum(&(at + step)) {
                Ok(next) if next <= sum => {
                    let done = size(&step) < 1e-10 || sum - next <= 1e-14 * sum;
                    (at, sum, damping) = (at + step, next, (0.1 * damping).max(1e-12));
                    if done {
                        return Ok((at, sum));
                    }
                }
                _ if size(&step) < 1e-10 => return Ok((at, sum)),
                _ => damping *= 10.0,
            }
        }
        Err(undetermined("the search did not end; are angles and volumes in their columns?"))
    }
}

/// Inverse by cofactors; none of a singular matrix. The parameters are all near 1, so nothing is lost by it.
fn inverse(of: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let [x, y, z] = [0, 1, 2].map(|n| of.column(n).into_owned());
    let determinant = x.dot(&y.cross(&z));
    let rows = [y.cross(&z), z.cross(&x), x.cross(&y)].map(|row| row.transpose() / determinant);
    let inverse = Matrix3::from_rows(&rows);
    inverse.iter().all(|element| element.is_finite()).then_some(inverse)
}

fn size(of: &Parameters) -> f64 {
    sqrt(of.dot(of))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::{AgainstSpeed, Displacement};
    use crate::sampling::Dice;

    const EXPECTED: Expected = Expected { repeatability: 0.0047, reading_ml: 0.005 };

    /// The plant's volume of a revolution, as if it had been weighed without any error.
    fn weighed(plant: &Pump) -> Displacement {
        let factor = plant.revolution_ml() / Pump::three_roller().revolution_ml();
        Displacement {
            reference_rpm: 60.0,
            factor,
            factor_standard: 0.0,
            slope_per_rpm: 0.0,
            slope_standard_per_rpm: 0.0,
            degrees_of_freedom: 100,
            scatter: None,
            lack_of_fit: 0.0,
            reading: 0.0,
            speeds_rpm: vec![60.0],
            outliers: vec![],
            speed_law: None,
        }
    }

    /// Doses of a fifth of a pitch from angles all over one, of a pump with V_r, phi, zero, with the expected noise.
    fn doses(plant: &Pump, count: u32, dice: &mut Dice) -> Vec<ShortDose> {
        (0..count)
            .map(|n| {
                let start_angle_deg = f64::from(n) * 120.0 / f64::from(count);
                let (from_rad, to_rad) = (radians(start_angle_deg), radians(start_angle_deg + 24.0));
                let curve = plant.outlet_curve();
                let exact_ml = curve.volume_ml(to_rad) - curve.volume_ml(from_rad);
                let volume_ml = exact_ml * (1.0 + EXPECTED.repeatability * dice.normal())
                    + EXPECTED.reading_ml * dice.normal();
                ShortDose { start_angle_deg, turned_deg: 24.0, volume_ml, speed_rpm: None }
            })
            .collect()
    }

    /// A three-roller pump with another roller volume and engagement angle, a bore larger by 1 % and its zero elsewhere.
    fn plant(roller_ml: f64, engagement_deg: f64, zero_deg: f64) -> Pump {
        let base = Pump::three_roller();
        let roller = base.roller_volume().scaled_to(roller_ml).unwrap().stretched_to(engagement_deg).unwrap();
        let pump = Pump::new(*base.geometry(), roller, *base.inlet(), *base.outlet()).unwrap();
        pump.shifted(radians(zero_deg)).unwrap().scaled(1.01).unwrap()
    }

    fn fit_as(
        displacement: Option<&Displacement>,
        doses: &[ShortDose],
    ) -> Result<PhaseFit, CalibrationError> {
        let base = Pump::three_roller();
        let against = AgainstSpeed::of(displacement, None, &base);
        PhaseFit::of(&base, Revolution { against, model_standard: 0.024 }, doses, &EXPECTED)
    }

    #[test]
    fn parameters_are_recovered_within_twice_their_errors_as_often_as_stated() {
        let (mut dice, mut inside) = (Dice::new(11), [0; 3]);
        const PLANTS: u32 = 1000;
        for n in 0..PLANTS {
            let truth = (2.0 + 2e-4 * f64::from(n), 48.0 + 0.004 * f64::from(n), -55.0 + 0.1 * f64::from(n));
            let plant = plant(truth.0, truth.1, truth.2);
            let doses = doses(&plant, 24, &mut dice);
            let found = fit_as(Some(&weighed(&plant)), &doses).unwrap();
            let errors = [
                (found.roller_volume_ml, truth.0),
                (found.engagement_deg, truth.1),
                (found.zero_deg, truth.2),
            ];
            for (inside, (found, truth)) in inside.iter_mut().zip(errors) {
                *inside += u32::from((found.value - truth).abs() < 2.0 * found.standard);
            }
            assert!(found.zero_deg.standard < 0.5 && found.roller_volume_ml.standard < 0.02, "{found:?}");
        }
        // 95.45 % of 1000; a binomial count lies within three of its deviations, 20, nearly always.
        for inside in inside {
            assert!((934..=975).contains(&inside), "{inside} of {PLANTS}");
        }
    }

    #[test]
    fn what_is_unsure_of_the_revolution_is_unsure_of_the_roller_volume() {
        let plant = plant(2.06, 50.0, 10.0);
        let doses = doses(&plant, 24, &mut Dice::new(3));
        let with =
            |displacement: Option<&Displacement>| fit_as(displacement, &doses).unwrap().roller_volume_ml;
        let (weighed, unweighed) = (with(Some(&weighed(&plant))), with(None));
        assert!(unweighed.standard > 3.0 * weighed.standard, "{weighed:?} {unweighed:?}");
        assert!((weighed.value - 2.06).abs() < 2.0 * weighed.standard, "{weighed:?}");
        assert!((unweighed.value - 2.06).abs() < 2.0 * unweighed.standard, "{unweighed:?}");
    }

    #[test]
    fn doses_that_say_nothing_of_a_pulse_are_refused() {
        let mut dice = Dice::new(5);
        let plant = plant(2.1, 50.0, 10.0);
        let known = weighed(&plant);
        let good = doses(&plant, 12, &mut dice);
        let fit = |doses: &[ShortDose]| fit_as(Some(&known), doses);
        assert!(fit(&good).is_ok());
        assert!(fit(&good[..4]).unwrap_err().to_string().contains("4 short doses; 5 at least"));
        let pitches: Vec<ShortDose> = good
            .iter()
            .map(|dose| ShortDose {
                turned_deg: 120.0,
                volume_ml: 7.1062 * (1.0 + 1e-3 * dice.normal()),
                ..*dose
            })
            .collect();
        let error = fit(&pitches).unwrap_err().to_string();
        assert!(error.contains("do not determine"), "{error}");
        let scattered: Vec<ShortDose> =
            good.iter().map(|dose| ShortDose { volume_ml: 0.2 + 3.0 * dice.uniform(), ..*dose }).collect();
        assert!(fit(&scattered).is_err());
    }

    #[test]
    fn a_table_of_short_doses_is_read() {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let text = "start_angle_deg,turned_deg,volume_ml\n0,24,1.2\n-10,-24,0.9\n";
        let doses = short_doses_of_csv(text, &Weighing::of(&file)).unwrap();
        assert_eq!(
            doses[1],
            ShortDose { start_angle_deg: -10.0, turned_deg: -24.0, volume_ml: 0.9, speed_rpm: None }
        );
        for bad in ["turned_deg,volume_ml\n24,1\n", "start_angle_deg,turned_deg,volume_ml\n0,0,1\n"] {
            assert!(short_doses_of_csv(bad, &Weighing::of(&file)).is_err());
        }
    }
}
