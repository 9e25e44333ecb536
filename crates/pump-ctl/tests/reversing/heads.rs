//! Heads whose flow reverses, and an independent account of their flow.
//!
//! The flow follows from McIntyre et al.'s formula and numbers, written down here once more. Its integral is a sum
//! over a fine grid, so nothing of the product's polynomials, roots and searches is in it.

use core::f64::consts::{PI, TAU};

use pump_model::{Geometry, Line, Pump, RollerVolume, Variant};

/// Coefficients of V, mL over deg, highest order first: the least-squares polynomial of the paper's points.
const COEFFICIENTS: [f64; 6] = [
    1.315_768_247_757_037_1e-8,
    -1.238_105_737_448_403_6e-6,
    -8.751_039_956_479_692e-6,
    2.792_627_225_480_817_3e-3,
    -3.158_742_581_049_441e-3,
    -2.870_791_521_667_906e-4,
];

/// Grid points of a pitch.
const POINTS: usize = 12_000;

/// A head: the paper's, with another number of rollers, other pulses or another bed.
pub(crate) struct Head {
    pub(crate) rollers: u32,
    /// Roller volume over the paper's.
    factor: f64,
    /// Engagement angle phi, deg.
    phi_deg: f64,
    beta_deg: f64,
    /// Volumes since the start of a pitch at the grid's points, mL.
    volumes_ml: Vec<f64>,
}

impl Head {
    pub(crate) fn new(rollers: u32, factor: f64, phi_deg: f64, beta_deg: f64) -> Self {
        let mut head = Self { rollers, factor, phi_deg, beta_deg, volumes_ml: vec![0.0] };
        let mut sum_ml = 0.0;
        for n in 0..POINTS {
            // Simpson's rule between two points.
            let at = |part: f64| head.flow_ml_rad((n as f64 + part) * head.grid_rad());
            sum_ml += head.grid_rad() * (at(1e-9) + 4.0 * at(0.5) + at(1.0 - 1e-9)) / 6.0;
            head.volumes_ml.push(sum_ml);
        }
        head
    }

    /// Returns twenty heads: few rollers with large pulses, many with pulses that overlap, and short beds.
    pub(crate) fn twenty() -> Vec<Self> {
        let few = [1.15, 1.2, 1.3, 1.45].map(|factor| Self::new(3, factor, 50.53, 30.0));
        let narrow = [1.05, 1.2, 1.4].map(|factor| Self::new(4, factor, 42.0, 20.0));
        let two = [1.2, 1.6].map(|factor| Self::new(2, factor, 50.53, 30.0));
        let many = [(12, 1.03), (13, 0.99)].map(|(rollers, factor)| Self::new(rollers, factor, 50.53, 10.0));
        let short = [(5, 1.1, -10.0), (6, 1.1, -30.0), (8, 1.1, -60.0), (12, 1.02, -70.0)]
            .map(|(rollers, factor, beta_deg)| Self::new(rollers, factor, 45.0, beta_deg));
        let crowded = [(7, 1.25), (8, 1.2), (9, 1.15), (10, 1.15), (11, 1.12)]
            .map(|(rollers, factor)| Self::new(rollers, factor, 50.53, -20.0));
        few.into_iter().chain(narrow).chain(two).chain(many).chain(short).chain(crowded).collect()
    }

    /// Returns the head of section 10 of the physics: three rollers, their volume 1.2 times the paper's.
    pub(crate) fn reference() -> Self {
        Self::new(3, 1.2, 50.53, 30.0)
    }

    /// Makes the product's model of the head.
    pub(crate) fn pump(&self) -> Pump {
        let geometry = Geometry {
            contact_angle_rad: self.beta_deg.to_radians(),
            ..Geometry::published(self.rollers, Variant::Measured)
        };
        let paper = RollerVolume::measured().unwrap();
        let roller = paper.scaled_to(self.factor * paper.total_ml()).unwrap();
        let roller = roller.stretched_to(self.phi_deg).unwrap();
        Pump::new(geometry, roller, Line::PUBLISHED, Line::PUBLISHED).unwrap()
    }

    /// Makes the model of the paper's head with another roller volume.
    pub(crate) fn with_roller_ml(roller_ml: f64) -> Pump {
        let roller = RollerVolume::measured().unwrap().scaled_to(roller_ml).unwrap();
        let geometry = Geometry::published(3, Variant::Measured);
        Pump::new(geometry, roller, Line::PUBLISHED, Line::PUBLISHED).unwrap()
    }

    pub(crate) fn pitch_rad(&self) -> f64 {
        TAU / f64::from(self.rollers)
    }

    /// Returns the distance between two points of the grid, rad.
    pub(crate) fn grid_rad(&self) -> f64 {
        self.pitch_rad() / POINTS as f64
    }

    pub(crate) fn pitch_ml(&self) -> f64 {
        self.volumes_ml[POINTS]
    }

    /// Returns q = a - sum of g(phi - theta + k pitch), g = max(0, dV/dx), with a = pi r_i² (r_b - r_o).
    pub(crate) fn flow_ml_rad(&self, theta_rad: f64) -> f64 {
        let nominal_ml_rad = PI * 5.0 * 5.0 * (63.0 - 7.0) / 1000.0;
        let phi_rad = self.phi_deg.to_radians();
        let pulse = |x_rad: f64| {
            // The paper's curve, stretched to this phi and larger by the factor.
            let deg = x_rad / phi_rad * 50.53;
            let slope = COEFFICIENTS[..5]
                .iter()
                .zip([5.0, 4.0, 3.0, 2.0, 1.0])
                .fold(0.0, |sum, (c, n)| sum * deg + n * c);
            self.factor * slope.max(0.0) * 50.53 / phi_rad
        };
        let mut x_rad = (phi_rad - theta_rad).rem_euclid(self.pitch_rad());
        let mut flow_ml_rad = nominal_ml_rad;
        while x_rad <= phi_rad {
            flow_ml_rad -= pulse(x_rad);
            x_rad += self.pitch_rad();
        }
        flow_ml_rad
    }

    /// Returns the volume since angle 0, mL, on a straight line between two points of the grid.
    pub(crate) fn volume_ml(&self, theta_rad: f64) -> f64 {
        let pitches = (theta_rad / self.pitch_rad()).floor();
        let place = (theta_rad - pitches * self.pitch_rad()) / self.grid_rad();
        let number = (place as usize).min(POINTS - 1);
        let [low, high] = [self.volumes_ml[number], self.volumes_ml[number + 1]];
        pitches * self.pitch_ml() + low + (place - number as f64) * (high - low)
    }

    /// Returns the first angle at which a turn has delivered `owed_ml`, or at which it turns back with less than
    /// `short_ml` missing. It walks along the grid.
    pub(crate) fn first_angle_rad(&self, start_rad: f64, owed_ml: f64, short_ml: f64) -> f64 {
        let direction = owed_ml.signum();
        let start_ml = self.volume_ml(start_rad);
        let (mut angle_rad, mut missing_ml, mut was_rising) = (start_rad, owed_ml.abs(), false);
        loop {
            let next_rad = angle_rad + direction * self.grid_rad();
            let next_ml = owed_ml.abs() - direction * (self.volume_ml(next_rad) - start_ml);
            if next_ml <= 0.0 {
                return angle_rad + direction * self.grid_rad() * missing_ml / (missing_ml - next_ml);
            }
            if was_rising && next_ml > missing_ml && missing_ml < short_ml {
                return angle_rad;
            }
            was_rising = next_ml < missing_ml;
            (angle_rad, missing_ml) = (next_rad, next_ml);
        }
    }
}
