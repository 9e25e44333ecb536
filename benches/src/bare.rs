//! The bare loop: the recurrences of the exact solution with every coefficient known beforehand.
//!
//! The loop shows the least that the exact solution can cost. Between edges each port's state makes
//! z <- M z + u(t) a sample, where u is a quartic by Horner's rule. Over an edge it makes z <- M z + u with numbers
//! for that edge. Both ports run in one loop, so that neither waits for the other.

use std::array;

use crate::case::{Case, DT_S, PortCase, Quartic, SAMPLES, Samples, Segment, horner, sample_s, through};

/// The affine map z -> M z + u.
#[derive(Clone, Copy)]
struct Affine {
    matrix: [[f64; 2]; 2],
    shift: [f64; 2],
}

impl Affine {
    #[inline]
    fn apply(&self, [p, q]: [f64; 2], [u, v]: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = self.matrix;
        [(a * p + u) + b * q, (c * p + v) + d * q]
    }
}

/// The samples between two edges of either port.
struct Block {
    /// Map from the sample before the block to its first sample, over the edges.
    entry: [Affine; 2],
    samples: usize,
    /// Change of (p, q) by the flow from sample to sample, over time since the block's first sample.
    input: [[Quartic; 2]; 2],
}

/// The prepared recurrences.
pub(crate) struct Bare {
    blocks: Vec<Block>,
    inside: [[[f64; 2]; 2]; 2],
    base_kpa: [f64; 2],
}

impl Bare {
    pub(crate) fn new(case: &Case) -> Self {
        let segment_of = |port: &PortCase, t: f64| port.segments.partition_point(|segment| segment.end_s < t);
        let place = |n: usize| case.ports.each_ref().map(|port| segment_of(port, sample_s(n)));
        let inside =
            case.ports.each_ref().map(|port| affine(|z| advance(port, &SILENT, 0.0, DT_S, z)).matrix);
        let mut blocks = Vec::new();
        let mut first = 1;
        while first < SAMPLES {
            let here = place(first);
            let samples = (first..SAMPLES).take_while(|n| place(*n) == here).count();
            let start_s = sample_s(first);
            let entry =
                case.ports.each_ref().map(|port| affine(|z| over_edges(port, start_s - DT_S, start_s, z)));
            let input = array::from_fn(|side| {
                let port = &case.ports[side];
                let segment = &port.segments[here[side]];
                let added = |t| advance(port, segment, start_s + t, DT_S, [0.0; 2]);
                array::from_fn(|state| through(samples as f64 * DT_S, |t| added(t)[state]))
            });
            blocks.push(Block { entry, samples, input });
            first += samples;
        }
        Self { blocks, inside, base_kpa: case.ports.each_ref().map(|port| port.line.reservoir_kpa) }
    }

    pub(crate) fn run(&self, [inlet, outlet]: &mut Samples) {
        let [inside_in, inside_out] = self.inside.map(|matrix| Affine { matrix, shift: [0.0; 2] });
        let [base_in, base_out] = self.base_kpa;
        let mut kpa = inlet.iter_mut().zip(outlet);
        let mut write = |p_in: f64, p_out: f64| {
            if let Some((inlet, outlet)) = kpa.next() {
                (*inlet, *outlet) = (base_in + p_in, base_out + p_out);
            }
        };
        let (mut z_in, mut z_out) = ([0.0; 2], [0.0; 2]);
        write(z_in[0], z_out[0]);
        for Block { entry: [entry_in, entry_out], samples, input: [input_in, input_out] } in &self.blocks {
            z_in = entry_in.apply(z_in, entry_in.shift);
            z_out = entry_out.apply(z_out, entry_out.shift);
            write(z_in[0], z_out[0]);
            for n in 0..samples - 1 {
                let t = n as f64 * DT_S;
                z_in = inside_in.apply(z_in, [horner(&input_in[0], t), horner(&input_in[1], t)]);
                z_out = inside_out.apply(z_out, [horner(&input_out[0], t), horner(&input_out[1], t)]);
                write(z_in[0], z_out[0]);
            }
        }
    }
}

const SILENT: Segment = Segment { start_s: 0.0, end_s: f64::INFINITY, flow: [0.0; 5] };

/// Returns the affine map that `f` computes.
fn affine(f: impl Fn([f64; 2]) -> [f64; 2]) -> Affine {
    let shift = f([0.0; 2]);
    let (first, second) = (f([1.0, 0.0]), f([0.0, 1.0]));
    let matrix = array::from_fn(|row| [first[row] - shift[row], second[row] - shift[row]]);
    Affine { matrix, shift }
}

/// Advances a state from `start_s` to `end_s`, over any edges between.
fn over_edges(port: &PortCase, start_s: f64, end_s: f64, state: [f64; 2]) -> [f64; 2] {
    let met = port.segments.iter().filter(|segment| segment.end_s > start_s && segment.start_s < end_s);
    met.fold(state, |z, segment| {
        let from_s = start_s.max(segment.start_s);
        advance(port, segment, from_s, end_s.min(segment.end_s) - from_s, z)
    })
}

/// Makes a short step inside a segment by Taylor series. The n-th term is h/n times the derivative of the
/// term before.
fn advance(port: &PortCase, segment: &Segment, start_s: f64, h: f64, state: [f64; 2]) -> [f64; 2] {
    let since_s = start_s - segment.start_s;
    let mut flow = segment.flow;
    for stop in 0..4 {
        for k in (stop..4).rev() {
            flow[k] += since_s * flow[k + 1];
        }
    }
    let (mut term, mut sum, mut power) = (state, state, 1.0);
    for n in 0..18 {
        let forcing = flow.get(n).map_or(0.0, |c| c * power);
        power *= h;
        let factor = h / (n + 1) as f64;
        term = port.derivative(forcing, term).map(|x| factor * x);
        sum = [sum[0] + term[0], sum[1] + term[1]];
    }
    sum
}
