//! Other solvers, used as well as possible. They stop at the edges of the flow and use its own polynomial
//! between them. They also use the exact Jacobian, where they need one, and dense output at the samples.

pub(crate) mod explicit;
pub(crate) mod implicit;
pub(crate) mod roller_centric;
pub(crate) mod sensitive;

use crate::case::{Case, JointSegment, SAMPLES, Samples, horner, sample_s};

/// The recorder, which fills the samples in order of time.
struct Recorder<'a> {
    samples: &'a mut Samples,
    base_kpa: [f64; 2],
    due: usize,
}

impl<'a> Recorder<'a> {
    fn new(case: &Case, samples: &'a mut Samples) -> Self {
        Self { samples, base_kpa: case.ports.each_ref().map(|port| port.line.reservoir_kpa), due: 0 }
    }

    /// Records the samples up to `end_s` that are still due. `pressures` gives P - P_res of both ports at a
    /// time.
    fn record(&mut self, end_s: f64, mut pressures: impl FnMut(f64) -> [f64; 2]) {
        while self.due < SAMPLES && sample_s(self.due) <= end_s {
            let [inlet, outlet] = pressures(sample_s(self.due));
            self.samples[0][self.due] = self.base_kpa[0] + inlet;
            self.samples[1][self.due] = self.base_kpa[1] + outlet;
            self.due += 1;
        }
    }
}

/// Computes dz/dt of (p, q) at the inlet and (p, q) at the outlet.
fn slope(case: &Case, segment: &JointSegment, t: f64, z: &[f64], dz: &mut [f64]) {
    let sides = z.chunks_exact(2).zip(dz.chunks_exact_mut(2)).zip(case.ports.iter().zip(&segment.flows));
    for ((z, dz), (port, flow)) in sides {
        dz.copy_from_slice(&port.derivative(horner(flow, t - segment.start_s), [z[0], z[1]]));
    }
}

/// Returns true if a flow jumps between two segments. Over a kink of its slope a solver's history is better than none.
fn jumps(before: &JointSegment, segment: &JointSegment) -> bool {
    let over_s = segment.start_s - before.start_s;
    let flows = before.flows.iter().zip(&segment.flows);
    segment.start_s > 0.0 && flows.into_iter().any(|(a, b)| (horner(a, over_s) - b[0]).abs() > 1e-9)
}
