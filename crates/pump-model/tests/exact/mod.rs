//! An exact solution of the flow-centric model at constant speed, for comparison only.
//!
//! It shares neither the flow curves nor the integrator with the product. The state is extended by the powers
//! of the time since the last edge, and the matrix exponential is summed by scaling and squaring.

use pump_model::Line;

const N: usize = 7;
type Matrix = [[f64; N]; N];

/// Coefficients of the paper's roller volume, mL over degrees, highest order first.
const PUBLISHED: [f64; 6] = [
    1.3157682477570371e-8,
    -1.2381057474044833e-6,
    -8.751039956479692e-6,
    2.7926272254840817e-3,
    -3.158742581049441e-3,
    -2.870791521667906e-4,
];
const PHI: f64 = 50.53 * core::f64::consts::PI / 180.0;
const FIRST_RISE: f64 = 0.567_223_275_490_138_6 * core::f64::consts::PI / 180.0;
/// Flow per radian a = pi r_i^2 (r_b - r_o), mL/rad.
const NOMINAL: f64 = core::f64::consts::PI * 25.0 * 56.0 / 1000.0;

/// Returns g(x), mL/rad: the slope of the roller volume where it rises.
fn g(x: f64) -> f64 {
    if !(FIRST_RISE..=PHI).contains(&x) {
        return 0.0;
    }
    let to_deg = 180.0 / core::f64::consts::PI;
    let degree = x * to_deg;
    let slope = PUBLISHED[..5]
        .iter()
        .zip([5.0, 4.0, 3.0, 2.0, 1.0])
        .fold(0.0, |sum, (c, order)| sum * degree + c * order);
    slope * to_deg
}

/// Port of the published pump at constant speed.
pub(crate) struct Exact {
    pub line: Line,
    pub rollers: u32,
    pub speed_rad_s: f64,
    pub outlet: bool,
}

impl Exact {
    fn pitch(&self) -> f64 {
        2.0 * core::f64::consts::PI / f64::from(self.rollers)
    }

    /// Returns the flow per radian just inside `theta`, a point that is no edge.
    fn flow_per_rad(&self, theta: f64) -> f64 {
        let psi = core::f64::consts::PI - PHI - core::f64::consts::PI / 3.0;
        let mut sum = NOMINAL;
        for k in -50..50 {
            let turned = theta - f64::from(k) * self.pitch();
            sum -= if self.outlet { g(PHI - turned) } else { g(turned - psi) };
        }
        sum
    }

    /// Returns the angles of the edges in [0, pitch], both included.
    fn edges(&self) -> Vec<f64> {
        let psi = core::f64::consts::PI - PHI - core::f64::consts::PI / 3.0;
        let mut edges = vec![0.0, self.pitch()];
        for x in [FIRST_RISE, PHI] {
            let angle = if self.outlet { PHI - x } else { psi + x };
            edges.push(angle.rem_euclid(self.pitch()));
        }
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        edges
    }

    /// Returns the flow as coefficients in the time since `start`, mL/s. Interpolation at five inner points
    /// is exact for degree 4.
    fn flow_coefficients(&self, start: f64, end: f64) -> [f64; 5] {
        let duration = (end - start) / self.speed_rad_s;
        let nodes: Vec<f64> = (0..5).map(|n| duration * (0.1 + 0.2 * f64::from(n))).collect();
        let mut table: Vec<f64> = nodes
            .iter()
            .map(|t| self.flow_per_rad(start + t * self.speed_rad_s) * self.speed_rad_s)
            .collect();
        for order in 1..5 {
            for n in (order..5).rev() {
                table[n] = (table[n] - table[n - 1]) / (nodes[n] - nodes[n - order]);
            }
        }
        let mut c = [0.0; 5];
        for n in (0..5).rev() {
            for k in (1..5).rev() {
                c[k] = c[k - 1] - nodes[n] * c[k];
            }
            c[0] = table[n] - nodes[n] * c[0];
        }
        c
    }

    /// Returns the exponential of the extended matrix over `t` inside the piece [start, end].
    fn propagator(&self, start: f64, end: f64, t: f64) -> Matrix {
        let (r, c, l) =
            (self.line.resistance_kpa_s_ml, self.line.compliance_ml_kpa, self.line.inertance_kpa_s2_ml);
        let sign = if self.outlet { 1.0 } else { -1.0 };
        let mut a = [[0.0; N]; N];
        a[0][1] = -sign / c;
        a[1][0] = sign / l;
        a[1][1] = -r / l;
        // States 2 to 6 are the powers 0 to 4 of time over the piece's duration, which keeps the matrix
        // balanced.
        let duration = (end - start) / self.speed_rad_s;
        for (k, q) in self.flow_coefficients(start, end).into_iter().enumerate() {
            a[0][2 + k] = sign * q * duration.powi(k as i32) / c;
        }
        for k in 1..5 {
            a[2 + k][1 + k] = k as f64 / duration;
        }
        exponential(a, t)
    }

    /// Returns the state after `t` from `state` at angle 0, t = 0.
    pub(crate) fn at(&self, t: f64, state: [f64; 2]) -> [f64; 2] {
        let edges = self.edges();
        let (mut y, mut time) = (state, 0.0);
        loop {
            for pair in edges.windows(2) {
                let duration = (pair[1] - pair[0]) / self.speed_rad_s;
                let step = duration.min(t - time);
                y = apply(&self.propagator(pair[0], pair[1], step), y);
                time += step;
                if t - time <= 1e-15 * t {
                    return y;
                }
            }
        }
    }

    /// Returns the state at the start of a pitch that repeats itself.
    pub(crate) fn periodic(&self) -> [f64; 2] {
        let period = self.pitch() / self.speed_rad_s;
        let offset = self.at(period, [0.0, 0.0]);
        let column = |y| {
            let moved: [f64; 2] = self.at(period, y);
            [moved[0] - offset[0], moved[1] - offset[1]]
        };
        let (p, q) = (column([1.0, 0.0]), column([0.0, 1.0]));
        let (a, b, c, d) = (1.0 - p[0], -q[0], -p[1], 1.0 - q[1]);
        let determinant = a * d - b * c;
        [(d * offset[0] - b * offset[1]) / determinant, (a * offset[1] - c * offset[0]) / determinant]
    }
}

fn apply(matrix: &Matrix, y: [f64; 2]) -> [f64; 2] {
    let z = [y[0], y[1], 1.0, 0.0, 0.0, 0.0, 0.0];
    let row = |n: usize| matrix[n].iter().zip(z).map(|(m, x)| m * x).sum();
    [row(0), row(1)]
}

fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    let mut product = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            product[i][j] = (0..N).map(|k| a[i][k] * b[k][j]).sum();
        }
    }
    product
}

fn exponential(a: Matrix, t: f64) -> Matrix {
    let largest = a.iter().flatten().fold(0.0_f64, |norm, x| norm.max((x * t).abs()));
    let squarings = (largest * N as f64).max(1e-3).log2().ceil().max(0.0) as i32 + 3;
    let factor = t / 2_f64.powi(squarings);
    let mut sum = [[0.0; N]; N];
    let mut term = [[0.0; N]; N];
    for n in 0..N {
        sum[n][n] = 1.0;
        term[n][n] = 1.0;
    }
    for order in 1..20 {
        term = multiply(&term, &a);
        for i in 0..N {
            for j in 0..N {
                term[i][j] *= factor / f64::from(order);
                sum[i][j] += term[i][j];
            }
        }
    }
    for _ in 0..squarings {
        sum = multiply(&sum, &sum);
    }
    sum
}
