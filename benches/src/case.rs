//! The benchmark case: three rollers at 100 r/min from rest at angle 0, both pressures every millisecond for
//! 10 s.

use std::f64::consts::TAU;

use pump_model::{ExactRun, Friction, Leg, Line, Port, Pump, Stretches};

pub(crate) const DT_S: f64 = 1e-3;
pub(crate) const SAMPLES: usize = 10_000;
pub(crate) const END_S: f64 = DT_S * SAMPLES as f64;
pub(crate) const PORTS: [Port; 2] = [Port::Inlet, Port::Outlet];

/// Samples of P_in and P_out, kPa absolute, at 0, 1 ms, 2 ms ...
pub(crate) type Samples = [Vec<f64>; 2];

/// Returns room for the samples of both ports.
pub(crate) fn room() -> Samples {
    [vec![0.0; SAMPLES], vec![0.0; SAMPLES]]
}

/// Returns the time of sample `n`, s.
pub(crate) fn sample_s(n: usize) -> f64 {
    n as f64 * DT_S
}

/// A polynomial of degree four, lowest order first.
pub(crate) type Quartic = [f64; 5];

/// Returns the value of a quartic at `t` by Horner's rule.
#[inline]
pub(crate) fn horner(c: &Quartic, t: f64) -> f64 {
    c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4])))
}

/// A time between two edges of a port's flow, s, and the flow, mL/s, over time since its start.
#[derive(Clone, Copy)]
pub(crate) struct Segment {
    pub start_s: f64,
    pub end_s: f64,
    pub flow: Quartic,
}

impl Segment {
    /// Returns true if the next segment's flow continues this segment's polynomial.
    fn goes_on_as(&self, next: &Self) -> bool {
        let over_s = next.start_s - self.start_s;
        (0..5).all(|n| {
            let t = (next.end_s - next.start_s) * f64::from(n) / 4.0;
            (horner(&self.flow, over_s + t) - horner(&next.flow, t)).abs() < 1e-9
        })
    }
}

/// The equations of one port for the peers: C dp/dt = s (Q - q), L dq/dt = s p - dP(q), with s = -1 at the
/// inlet. The drop dP is R q, or that of a hose's friction.
pub(crate) struct PortCase {
    pub sign: f64,
    pub line: Line,
    pub friction: Option<Friction>,
    pub segments: Vec<Segment>,
}

impl PortCase {
    fn new(pump: &Pump, port: Port, leg: Leg) -> Self {
        let sign = if port == Port::Inlet { -1.0 } else { 1.0 };
        let mut segments: Vec<Segment> = Vec::new();
        let pieces = Stretches::new(pump.curve(port), [leg])
            // Rounding may leave a last piece too short for a step.
            .take_while(|stretch| stretch.start_s < END_S - 1e-9)
            .map(|stretch| {
                let flow =
                    through(stretch.end_s - stretch.start_s, |t| stretch.flow_ml_s(stretch.start_s + t));
                Segment { start_s: stretch.start_s, end_s: stretch.end_s.min(END_S), flow }
            });
        for piece in pieces {
            match segments.last_mut() {
                // Two pieces with one polynomial need no stop between them.
                Some(last) if last.goes_on_as(&piece) => last.end_s = piece.end_s,
                _ => segments.push(piece),
            }
        }
        Self { sign, line: *pump.line(port), friction: None, segments }
    }

    /// Returns d(p, q)/dt where the flow at the rollers is `flow`.
    #[inline]
    pub(crate) fn derivative(&self, flow: f64, [p, q]: [f64; 2]) -> [f64; 2] {
        let Line { resistance_kpa_s_ml: r, compliance_ml_kpa: c, inertance_kpa_s2_ml: l, .. } = self.line;
        let drop_kpa = self.friction.map_or(r * q, |friction| friction.drop_kpa(q));
        [self.sign * (flow - q) / c, (self.sign * p - drop_kpa) / l]
    }

    /// Returns the Jacobian at the line's flow `at_ml_s` times a vector.
    pub(crate) fn jacobian_times(&self, at_ml_s: f64, [p, q]: [f64; 2]) -> [f64; 2] {
        let Line { resistance_kpa_s_ml: r, compliance_ml_kpa: c, inertance_kpa_s2_ml: l, .. } = self.line;
        let slope = self.friction.map_or(r, |friction| friction.slope_kpa_s_ml(at_ml_s));
        [-self.sign * q / c, (self.sign * p - slope * q) / l]
    }
}

/// A time between two edges of either port, s, with both ports' flows over time since its start.
#[derive(Clone, Copy)]
pub(crate) struct JointSegment {
    pub start_s: f64,
    pub end_s: f64,
    pub flows: [Quartic; 2],
}

/// The case with its exact solution.
pub(crate) struct Case {
    pub pump: Pump,
    pub leg: Leg,
    pub ports: [PortCase; 2],
    /// The segments of both ports as one system of four states.
    pub joint: Vec<JointSegment>,
    exact: Samples,
}

impl Case {
    pub(crate) fn new() -> Self {
        let pump = Pump::three_roller();
        let leg = Leg::constant_speed(0.0, 100.0 * TAU / 60.0);
        let ports = PORTS.map(|port| PortCase::new(&pump, port, leg));
        // `ExactRun::at` gives the reference, so that the rounding of `ExactRun::every` shows in the table.
        let exact = PORTS.map(|port| {
            let mut run = ExactRun::from_rest(&pump, port, [leg]);
            (0..SAMPLES).map(|n| run.pressure_kpa(sample_s(n))).collect()
        });
        let joint = joined(&ports);
        Self { pump, leg, ports, joint, exact }
    }

    /// Returns the case with a hose's friction at both ports.
    pub(crate) fn with_friction(friction: Friction) -> Self {
        let mut case = Self::new();
        for port in &mut case.ports {
            port.friction = Some(friction);
        }
        case
    }

    /// Returns the case of a model without an exact solution: `solve` fills the reference.
    pub(crate) fn solved_by<E>(
        mut self,
        solve: impl FnOnce(&Self, &mut Samples) -> Result<(), E>,
    ) -> Result<Self, E> {
        let mut reference = room();
        solve(&self, &mut reference)?;
        self.exact = reference;
        Ok(self)
    }

    /// Returns the largest difference to the exact solution, kPa. It is infinite if a solver gave no number.
    pub(crate) fn error_kpa(&self, samples: &Samples) -> f64 {
        let pairs = samples.iter().flatten().zip(self.exact.iter().flatten());
        pairs.fold(0.0, |largest, (p, exact)| {
            let error = (p - exact).abs();
            if error.is_nan() { f64::INFINITY } else { error.max(largest) }
        })
    }
}

/// Returns the segments of both ports, cut at the edges of either.
fn joined(ports: &[PortCase; 2]) -> Vec<JointSegment> {
    let mut ends_s: Vec<f64> = ports.iter().flat_map(|port| &port.segments).map(|s| s.end_s).collect();
    ends_s.sort_by(f64::total_cmp);
    // Both ports have an edge where a roller passes angle 0. Rounding must not make two edges of it.
    ends_s.dedup_by(|next, kept| *next - *kept < 1e-9);
    let starts_s = std::iter::once(0.0).chain(ends_s.iter().copied());
    starts_s
        .zip(&ends_s)
        .map(|(start_s, &end_s)| {
            let flows = ports.each_ref().map(|port| {
                let middle_s = 0.5 * (start_s + end_s);
                let here = port.segments.partition_point(|segment| segment.end_s < middle_s);
                let segment = &port.segments[here];
                through(end_s - start_s, |t| horner(&segment.flow, start_s - segment.start_s + t))
            });
            JointSegment { start_s, end_s, flows }
        })
        .collect()
}

/// Returns the quartic with the values of `f` at five points from 0 to `length`, by Newton's divided
/// differences.
pub(crate) fn through(length: f64, f: impl Fn(f64) -> f64) -> Quartic {
    let at = |n: usize| length * n as f64 / 4.0;
    let mut differences: Quartic = std::array::from_fn(|n| f(at(n)));
    for order in 1..5 {
        for n in (order..5).rev() {
            differences[n] = (differences[n] - differences[n - 1]) / (at(n) - at(n - order));
        }
    }
    let mut c = [0.0; 5];
    for n in (0..5).rev() {
        // The polynomial becomes c(t) (t - t_n) + difference.
        for k in (1..5).rev() {
            c[k] = c[k - 1] - at(n) * c[k];
        }
        c[0] = differences[n] - at(n) * c[0];
    }
    c
}
