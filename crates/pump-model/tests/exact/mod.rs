//! An exact solution of the flow-centric model at constant speed, for comparison only.
//!
//! It shares neither the flow curves nor the integrator with the product. The state is extended by the powers
//! of the time since the last edge, and the matrix exponential is summed by scaling and squaring.

type Matrix<const N: usize> = [[f64; N]; N];

/// A line with constant coefficients, y' = A y + b u, where u is the flow from the rollers into the line,
/// mL/s.
pub(crate) struct Linear<const S: usize> {
    pub matrix: Matrix<S>,
    pub input: [f64; S],
}

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

    /// Returns the exponential of the extended matrix over `t` inside the piece [start, end]. `K` is `S` + 5.
    fn propagator<const S: usize, const K: usize>(
        &self,
        line: &Linear<S>,
        [start, end]: [f64; 2],
        t: f64,
    ) -> Matrix<K> {
        let sign = if self.outlet { 1.0 } else { -1.0 };
        let mut a = [[0.0; K]; K];
        for (row, from) in a.iter_mut().zip(&line.matrix) {
            row[..S].copy_from_slice(from);
        }
        // The last five states are the powers 0 to 4 of time over the piece's duration, which keeps the matrix
        // balanced.
        let duration = (end - start) / self.speed_rad_s;
        for (k, q) in self.flow_coefficients(start, end).into_iter().enumerate() {
            for (row, input) in a.iter_mut().zip(line.input) {
                row[S + k] = sign * input * q * duration.powi(k as i32);
            }
        }
        for k in 1..5 {
            a[S + k][S + k - 1] = k as f64 / duration;
        }
        exponential(a, t)
    }

    /// Returns the state of a line after `t` from `state` at angle 0, t = 0. `K` is `S` + 5.
    pub(crate) fn follow<const S: usize, const K: usize>(
        &self,
        line: &Linear<S>,
        t: f64,
        state: [f64; S],
    ) -> [f64; S] {
        let edges = self.edges();
        let (mut y, mut time) = (state, 0.0);
        loop {
            for pair in edges.windows(2) {
                let duration = (pair[1] - pair[0]) / self.speed_rad_s;
                let step = duration.min(t - time);
                y = apply(&self.propagator::<S, K>(line, [pair[0], pair[1]], step), y);
                time += step;
                if t - time <= 1e-15 * t {
                    return y;
                }
            }
        }
    }

    /// Returns the state of a line at the start of a pitch that repeats itself. `K` is `S` + 5.
    pub(crate) fn periodic<const S: usize, const K: usize>(&self, line: &Linear<S>) -> [f64; S] {
        let after = |state| self.follow::<S, K>(line, self.pitch() / self.speed_rad_s, state);
        let offset = after([0.0; S]);
        // (I - M) y = offset, where column n of M is what state n leaves after a pitch.
        let columns: [[f64; S]; S] = core::array::from_fn(|n| {
            let moved = after(core::array::from_fn(|k| f64::from(u8::from(k == n))));
            core::array::from_fn(|k| f64::from(u8::from(k == n)) - (moved[k] - offset[k]))
        });
        solved(core::array::from_fn(|row| columns.map(|column| column[row])), offset)
    }
}

/// Returns the solution of A x = b, by Gauss's elimination with pivots.
fn solved<const S: usize>(mut a: Matrix<S>, mut b: [f64; S]) -> [f64; S] {
    for n in 0..S {
        let pivot = (n..S).max_by(|i, j| a[*i][n].abs().total_cmp(&a[*j][n].abs())).expect("a row is left");
        a.swap(n, pivot);
        b.swap(n, pivot);
        for row in 0..S {
            if row != n {
                let factor = a[row][n] / a[n][n];
                let above = a[n];
                for (entry, above) in a[row].iter_mut().zip(above) {
                    *entry -= factor * above;
                }
                b[row] -= factor * b[n];
            }
        }
    }
    core::array::from_fn(|n| b[n] / a[n][n])
}

fn apply<const S: usize, const K: usize>(matrix: &Matrix<K>, y: [f64; S]) -> [f64; S] {
    // At a piece's start only power 0 of the time differs from 0.
    let mut z = [0.0; K];
    z[..S].copy_from_slice(&y);
    z[S] = 1.0;
    core::array::from_fn(|n| matrix[n].iter().zip(z).map(|(m, x)| m * x).sum())
}

fn multiply<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    let mut product = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            product[i][j] = (0..N).map(|k| a[i][k] * b[k][j]).sum();
        }
    }
    product
}

fn exponential<const N: usize>(a: Matrix<N>, t: f64) -> Matrix<N> {
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
