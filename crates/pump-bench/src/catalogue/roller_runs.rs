//! Measured roller volumes: runs of (angle, volume) from a table, and the report of their fit.

use pump_model::units::radians;
use pump_model::{Geometry, ModelError, VolumePoint};

use crate::export::Fitted;
use crate::files::{Table, TableError};
use crate::pump_file::{CurveFit, RollerVolumeTable};

/// Runs of a roller that was turned into the tube, with the displaced volume at several angles.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RollerRuns {
    /// Points of all runs, in the order of the table.
    points: Vec<VolumePoint>,
    /// Name of the run of each point.
    runs: Vec<String>,
}

/// A fall of the volume within a run. No roller does that: it is scatter, or a slip of the pen.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Fall {
    /// Name of the run that falls.
    pub run: String,
    /// Angle before the fall, in deg.
    pub from_deg: f64,
    /// Angle after the fall, in deg.
    pub to_deg: f64,
    /// Volume by which the run falls, in mL.
    pub fall_ml: f64,
}

impl RollerRuns {
    /// Collects points with the names of their runs.
    pub fn new(points: impl IntoIterator<Item = (String, VolumePoint)>) -> Self {
        let (runs, points) = points.into_iter().unzip();
        Self { points, runs }
    }

    /// Returns the points with the names of their runs, in the order of the table.
    pub fn points(&self) -> impl Iterator<Item = (&str, VolumePoint)> {
        self.runs.iter().map(String::as_str).zip(self.points.iter().copied())
    }

    /// Reads a table with `angle_deg` since first contact and `volume_ml` displaced since then.
    ///
    /// A column `run` may name the runs. Without it all points are one run.
    ///
    /// # Errors
    /// Returns the [`TableError`] of the first line that cannot be used.
    pub fn of_csv(text: &str) -> Result<Self, TableError> {
        let table = Table::parse(text, &["run", "angle_deg", "volume_ml"])?;
        let (mut points, mut runs) = (Vec::new(), Vec::new());
        for row in table.rows() {
            let angle_deg = row.required("angle_deg")?;
            points.push(VolumePoint { angle_deg, volume_ml: row.required("volume_ml")? });
            runs.push(match (row.text("run"), table.has("run")) {
                (Some(run), _) => run.to_owned(),
                (None, true) => {
                    return Err(row.error("run is missing; leave the column out for one run".to_owned()));
                }
                (None, false) => "1".to_owned(),
            });
        }
        Ok(Self { points, runs })
    }

    /// Returns the table `[roller_volume]` of a pump file.
    pub fn table(&self, fit: CurveFit) -> RollerVolumeTable {
        RollerVolumeTable::Measured { fit, points: self.points.clone() }
    }

    /// Returns the names of the runs, in the order of their first points.
    fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for run in &self.runs {
            if !names.contains(&run.as_str()) {
                names.push(run);
            }
        }
        names
    }

    /// Returns the places where the volume of a run falls from one angle to the next.
    pub fn falls(&self) -> Vec<Fall> {
        let mut falls = Vec::new();
        for name in self.names() {
            let of_run = self.points.iter().zip(&self.runs).filter(|(_, run)| *run == name);
            let mut points: Vec<_> = of_run.map(|(point, _)| *point).collect();
            points.sort_by(|one, other| one.angle_deg.total_cmp(&other.angle_deg));
            let pairs = points.windows(2).filter(|pair| pair[1].volume_ml < pair[0].volume_ml);
            falls.extend(pairs.map(|pair| Fall {
                run: name.to_owned(),
                from_deg: pair[0].angle_deg,
                to_deg: pair[1].angle_deg,
                fall_ml: pair[0].volume_ml - pair[1].volume_ml,
            }));
        }
        falls
    }

    /// Returns the report of a fit on a pump with these dimensions, as lines for people.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of points that cannot be fitted.
    pub fn report(&self, fit: CurveFit, geometry: &Geometry) -> Result<Vec<String>, ModelError> {
        let found = fit.of(&self.points)?;
        let runs = self.names().len();
        let (mut most_ml, mut most_deg): (f64, f64) = (0.0, 0.0);
        for (residual_ml, point) in found.residuals_ml().zip(&self.points) {
            if residual_ml.abs() > most_ml {
                (most_ml, most_deg) = (residual_ml.abs(), point.angle_deg);
            }
        }
        let name = match fit {
            CurveFit::Quintic => "quintic",
            CurveFit::Spline => "spline",
        };
        let mut lines = vec![
            format!(
                "{} points of {runs} run{}; the {name} is {:.4} mL RMS off, {most_ml:.4} mL at most \
                 ({most_deg:.2}°)",
                self.points.len(),
                if runs == 1 { "" } else { "s" },
                found.rms_ml(),
            ),
            format!(
                "a roller displaces {:.4} mL over {:.2}°, which leaves {:.4} mL per revolution",
                found.curve().total_ml(),
                found.curve().engagement_deg(),
                found.revolution_ml(geometry),
            ),
        ];
        lines.extend(self.falls().into_iter().map(|fall| {
            let Fall { run, from_deg, to_deg, fall_ml } = fall;
            format!(
                "run {run} falls by {fall_ml:.4} mL from {from_deg:.2}° to {to_deg:.2}°: scatter, or a slip \
                 of the pen"
            )
        }));
        lines.extend(found.held_deg().map(|(from_deg, to_deg)| {
            format!("the fit does not rise from {from_deg:.2}° to {to_deg:.2}°: there the volume is held")
        }));
        Ok(lines)
    }

    /// Returns each point beside the curve that doses use, in order of angle.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of points that cannot be fitted.
    pub fn fitted(&self, fit: CurveFit) -> Result<Vec<Fitted>, ModelError> {
        let found = fit.of(&self.points)?;
        let mut fitted: Vec<_> = self
            .points
            .iter()
            .map(|point| Fitted {
                x: point.angle_deg,
                measured: point.volume_ml,
                fitted: found.curve().at(radians(point.angle_deg)),
            })
            .collect();
        fitted.sort_by(|one, other| one.x.total_cmp(&other.x));
        Ok(fitted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_are_those_within_a_run() {
        // Run b lies below run a everywhere: no fall.
        let text = "run,angle_deg,volume_ml\na,0,0\nb,0,0\na,10,0.5\nb,10,0.4\na,20,1.2\nb,20,1.0\n\
                    b,30,0.9\na,30,1.5\n";
        let runs = RollerRuns::of_csv(text).unwrap();
        let falls = runs.falls();
        assert_eq!(falls.len(), 1);
        assert!(falls[0].run == "b" && falls[0].from_deg == 20.0 && falls[0].to_deg == 30.0);
        assert!((falls[0].fall_ml - 0.1).abs() < 1e-12);
    }

    #[test]
    fn tables_that_name_no_run_are_one_and_half_named_ones_are_refused() {
        let runs = RollerRuns::of_csv("angle_deg,volume_ml\n0,0\n10,1\n").unwrap();
        assert_eq!(runs.names(), ["1"]);
        let refused = |text| RollerRuns::of_csv(text).unwrap_err().to_string();
        assert!(refused("run,angle_deg,volume_ml\na,0,0\n,10,1\n").contains("line 3: run is missing"));
        assert!(refused("angle_deg,volume_ml\n0,\n").contains("line 2: volume_ml is missing"));
        assert!(refused("angle,volume_ml\n0,0\n").contains("unknown column `angle`"));
    }
}
