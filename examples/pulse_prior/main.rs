//! Derives the default pulse of a head that is known by its volume per revolution alone from published drawings.
//!
//! `make pulse-prior` writes docs/pulse_prior.md. The test holds the page and the figures of the library to the
//! drawings.

mod designs;

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use pump_model::Drawing;
use pump_model::identification::widening;

use designs::{angle_of_an_unknown_wall_deg, designs};

/// Number of equal parts of the engagement angle at whose ends the shape of the pulse is taken.
const PARTS: usize = 10;

/// The pulse of a head, from its drawing.
struct Drawn {
    name: &'static str,
    source: &'static str,
    rollers: u32,
    revolution_ml: f64,
    engagement_deg: f64,
    /// Part of the bore's volume over phi that the roller takes: V_r/(a phi).
    fullness: f64,
    /// V/V_r and its slope over u = x/phi, at u = 0, 0.1 and so on.
    shape: [(f64, f64); PARTS + 1],
}

impl Drawn {
    fn of(design: &designs::Design) -> Result<Self, Box<dyn Error>> {
        let (geometry, drawing) = (&design.geometry, Drawing::new(&design.geometry)?);
        let phi_rad = drawing.engagement_rad();
        let total_ml = drawing.volume_ml(phi_rad);
        let nominal_ml_rad = geometry.nominal_ml_rad();
        let shape = core::array::from_fn(|n| {
            let x_rad = phi_rad * n as f64 / PARTS as f64;
            (drawing.volume_ml(x_rad) / total_ml, drawing.slope_ml_rad(x_rad) * phi_rad / total_ml)
        });
        Ok(Self {
            name: design.name,
            source: design.source,
            rollers: geometry.rollers,
            revolution_ml: core::f64::consts::TAU * nominal_ml_rad - f64::from(geometry.rollers) * total_ml,
            engagement_deg: phi_rad.to_degrees(),
            fullness: total_ml / (nominal_ml_rad * phi_rad),
            shape,
        })
    }

    fn pitch_deg(&self) -> f64 {
        360.0 / f64::from(self.rollers)
    }

    fn share(&self) -> f64 {
        self.fullness * self.engagement_deg / self.pitch_deg()
    }
}

/// The figures that the library takes from the drawings.
struct Figures {
    /// Geometric mean of phi, deg.
    engagement_deg: f64,
    /// Twice the standard deviation of ln phi.
    engagement_spread: f64,
    /// Mean of V_r/(a phi).
    fullness: f64,
    /// Twice the standard deviation of V_r/(a phi).
    fullness_standard: f64,
    /// Largest phi over the pitch.
    widest_part: f64,
    /// Mean of V/V_r and of its slope over x/phi.
    shape: [(f64, f64); PARTS + 1],
}

impl Figures {
    fn of(drawn: &[Drawn]) -> Self {
        let logs: Vec<f64> = drawn.iter().map(|one| one.engagement_deg.ln()).collect();
        let fullnesses: Vec<f64> = drawn.iter().map(|one| one.fullness).collect();
        let shape = core::array::from_fn(|n| {
            let of = |value: fn((f64, f64)) -> f64| {
                mean(&drawn.iter().map(|one| value(one.shape[n])).collect::<Vec<_>>())
            };
            (of(|knot| knot.0), of(|knot| knot.1))
        });
        Self {
            engagement_deg: mean(&logs).exp(),
            engagement_spread: 2.0 * deviation(&logs),
            fullness: mean(&fullnesses),
            fullness_standard: 2.0 * deviation(&fullnesses),
            widest_part: drawn.iter().map(|one| one.engagement_deg / one.pitch_deg()).fold(0.0, f64::max),
            shape,
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn deviation(values: &[f64]) -> f64 {
    let middle = mean(values);
    let squares: f64 = values.iter().map(|value| (value - middle) * (value - middle)).sum();
    (squares / (values.len() - 1) as f64).sqrt()
}

/// Writes what the drawings say of all heads.
fn law(page: &mut String, figures: &Figures, drawings: usize) -> Result<(), Box<dyn Error>> {
    writeln!(
        page,
        "\nPhi is {:.1}° (geometric mean), or {:.3} of the pitch where that is less: more rollers leave \
         less room for each.\n\
         The standard uncertainty is twice the scatter of the drawings: a factor of {:.3} either way (ln \
         phi ± {:.3}). The\n\
         fullness is {:.3} ± {:.3}, twice its scatter too.\n\
         The intervals of doses take both {:.3} times as wide again, because five drawings show the scatter only \
         roughly\n\
         (Student's t of 4 degrees of freedom, over that of many).\n\n\
         Geometry bounds the pulse, whatever the head. Pulses beyond the bounds are left out of the law:\n\n\
         - 2 phi + pitch <= 360°: a roller seals until the next one does, and engages and leaves within the same \
         turn.\n\
         - V_r/(a phi) <= 2/3: what a roller squeezes passes the backplate's end while it leaves, so phi is its width \
         at\n  \
         least. A round roller that closes the bore takes two thirds of it over its own width at most, as a\n  \
         flattened bore of unchanged perimeter has lost (h/D)² of its area.\n\
         - The share of a pitch <= 2/3: rollers stand side by side, so the width of each is a pitch at most.\n\n\
         A sixth head, github.com/bgamari/peristaltic-pump, does not state its wall thickness, so its fullness \
         is not known.\n\
         Its phi is {:.1}°, within two standard uncertainties of the mean.\n\n\
         | x/phi | V/V_r | slope |\n| --- | --- | --- |",
        figures.engagement_deg,
        figures.widest_part,
        figures.engagement_spread.exp(),
        figures.engagement_spread,
        figures.fullness,
        figures.fullness_standard,
        widening(drawings as u32 - 1),
        angle_of_an_unknown_wall_deg(),
    )?;
    Ok(())
}

/// Returns the page.
fn page() -> Result<String, Box<dyn Error>> {
    let drawn = designs().iter().map(Drawn::of).collect::<Result<Vec<_>, _>>()?;
    let figures = Figures::of(&drawn);
    let mut page = String::from(
        "# The default pulse of a bought head\n\n\
         A head that is known by its volume per revolution alone ([A bought head](bought_head.md)) delivers that\n\
         volume exactly over whole pitches. Within a pitch its flow is the bore's flow a less the pulse of \
         a roller. Makers\n\
         publish no dimensions, so the pulse's angle phi and its fullness V_r/(a phi) follow from heads \
         whose drawings are\n\
         published. `make pulse-prior` writes this page, and a test holds the library's figures to it.\n\n\
         | head | rollers | mL/rev | phi | phi/pitch | fullness | share of the pitch | source |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for one in &drawn {
        writeln!(
            page,
            "| {} | {} | {:.4} | {:.2}° | {:.3} | {:.4} | {:.4} | {} |",
            one.name,
            one.rollers,
            one.revolution_ml,
            one.engagement_deg,
            one.engagement_deg / one.pitch_deg(),
            one.fullness,
            one.share(),
            one.source,
        )?;
    }
    law(&mut page, &figures, drawn.len())?;
    for (n, (volume, slope)) in figures.shape.iter().enumerate() {
        writeln!(page, "| {:.1} | {volume:.4} | {slope:.4} |", n as f64 / PARTS as f64)?;
    }
    page.push_str(
        "\nThe shape of the pulse is the mean of the drawings. Cubics join its values and slopes.\n",
    );
    Ok(page)
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/pulse_prior.md")
}

#[allow(clippy::print_stdout, reason = "an example says which file it wrote")]
fn main() -> Result<(), Box<dyn Error>> {
    fs::write(path(), page()?)?;
    println!("{}", path().display());
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use pump_bench::displacement::{PulseBounds, PulsePrior};
    use pump_model::DefaultPulse;

    use super::*;

    #[test]
    fn the_committed_page_is_what_the_drawings_give() {
        assert_eq!(fs::read_to_string(path()).unwrap(), page().unwrap(), "run `make pulse-prior`");
    }

    #[test]
    fn the_library_has_the_figures_of_the_drawings() {
        let drawn: Vec<_> = designs().iter().map(|design| Drawn::of(design).unwrap()).collect();
        let figures = Figures::of(&drawn);
        let prior = PulsePrior::of(3);
        for (held, derived) in [
            (prior.engagement_deg, figures.engagement_deg),
            (prior.engagement_spread, figures.engagement_spread),
            (prior.fullness, figures.fullness),
            (prior.fullness_standard, figures.fullness_standard),
            (PulsePrior::of(12).engagement_deg / 30.0, figures.widest_part),
        ] {
            assert!((held / derived - 1.0).abs() < 2e-3, "{held} is {derived} by the drawings");
        }
        for ((volume, slope), (drawn_volume, drawn_slope)) in
            DefaultPulse::shape().into_iter().zip(figures.shape)
        {
            assert!(
                (volume - drawn_volume).abs() < 1e-4 && (slope - drawn_slope).abs() < 1e-4,
                "{volume} {slope}"
            );
        }
    }

    #[test]
    fn the_prior_covers_every_drawing_and_the_angle_of_the_sixth() {
        let prior = PulsePrior::of(3);
        let drawn: Vec<_> = designs().iter().map(|design| Drawn::of(design).unwrap()).collect();
        let angles = drawn.iter().map(|one| one.engagement_deg).chain([angle_of_an_unknown_wall_deg()]);
        for engagement_deg in angles {
            assert!((engagement_deg / prior.engagement_deg).ln().abs() < 2.0 * prior.engagement_spread);
        }
        for one in drawn {
            assert!((one.fullness - prior.fullness).abs() < 2.0 * prior.fullness_standard, "{}", one.name);
            assert!(PulseBounds::of(one.rollers).hold(one.engagement_deg, one.fullness), "{}", one.name);
        }
    }
}
