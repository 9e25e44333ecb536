//! `diffsol`: BDF on the equations of both ports with their derivatives by R, C and L, the forward sensitivities.

use std::cell::Cell;

use diffsol::error::DiffsolError;
use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverStopReason};

use super::jumps;
use crate::case::{Case, JointSegment, PortCase, SAMPLES, Samples, horner, sample_s};

/// States of a port: (p, q), and the derivatives of both by R, C and L, each times its parameter.
const STATES: usize = 8;

/// Writes the derivatives of the pressures by R, C and L, each times its parameter, kPa.
pub(crate) fn run(case: &Case, tolerance: f64, found: &mut [Samples; 3]) -> Result<(), DiffsolError> {
    let current = Cell::new(case.joint[0]);
    let rate = |z: &[f64], _: &[f64], t: f64, dz: &mut [f64]| {
        let segment = current.get();
        let flows = segment.flows.map(|flow| horner(&flow, t - segment.start_s));
        slopes(case, flows, z, dz);
    };
    let jacobian = |_: &[f64], _: &[f64], _: f64, v: &[f64], jv: &mut [f64]| slopes(case, [0.0; 2], v, jv);
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .rhs_implicit(rate, jacobian)
        .init(|_, _, z| z.fill(0.0), 2 * STATES)
        .build()?;
    let mut solver = problem.bdf::<NalgebraLU<f64>>()?;
    let mut due = 0;
    for segment in &case.joint {
        let before: JointSegment = current.replace(*segment);
        if jumps(&before, segment) {
            let mut state = solver.state_mut();
            let (mut z, mut dz) = ([0.0; 2 * STATES], [0.0; 2 * STATES]);
            for (n, z) in z.iter_mut().enumerate() {
                *z = state.y[n];
            }
            slopes(case, segment.flows.map(|flow| flow[0]), &z, &mut dz);
            for (n, dz) in dz.into_iter().enumerate() {
                state.dy[n] = dz;
            }
            state.set_step_size(1.0, &problem.atol, problem.rtol, &problem.eqn, 2);
        }
        solver.set_stop_time(segment.end_s)?;
        loop {
            let reason = solver.step()?;
            let end_s = solver.state().t;
            while due < SAMPLES && sample_s(due) <= end_s {
                let z = solver.interpolate(sample_s(due))?;
                for (parameter, samples) in found.iter_mut().enumerate() {
                    for (side, samples) in samples.iter_mut().enumerate() {
                        samples[due] = z[side * STATES + 2 * (1 + parameter)];
                    }
                }
                due += 1;
            }
            if matches!(reason, OdeSolverStopReason::TstopReached) {
                break;
            }
        }
    }
    Ok(())
}

/// Computes dz/dt of both ports.
fn slopes(case: &Case, flows: [f64; 2], z: &[f64], dz: &mut [f64]) {
    let sides = z.chunks_exact(STATES).zip(dz.chunks_exact_mut(STATES)).zip(case.ports.iter().zip(flows));
    for ((z, dz), (port, flow)) in sides {
        let PortCase { line, .. } = port;
        let rate = port.derivative(flow, [z[0], z[1]]);
        dz[..2].copy_from_slice(&rate);
        for (n, (z_by, dz_by)) in z[2..].chunks_exact(2).zip(dz[2..].chunks_exact_mut(2)).enumerate() {
            let [p, q] = port.derivative(0.0, [z_by[0], z_by[1]]);
            // R damps the flow, and C and L divide the rates of pressure and flow.
            let direct = match n {
                0 => [0.0, -line.resistance_kpa_s_ml * z[1] / line.inertance_kpa_s2_ml],
                1 => [-rate[0], 0.0],
                _ => [0.0, -rate[1]],
            };
            dz_by.copy_from_slice(&[p + direct[0], q + direct[1]]);
        }
    }
}
