//! `diffsol`: BDF and ESDIRK34, both ports as one system, which here costs half as much as two systems.

use std::cell::Cell;

use diffsol::error::DiffsolError;
use diffsol::{
    NalgebraContext, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquationsImplicit, OdeSolverMethod,
    OdeSolverProblem, OdeSolverStopReason,
};

use super::{Recorder, jumps, slope};
use crate::case::{Case, JointSegment, Samples};

type Matrix = NalgebraMat<f64>;
type Factored = NalgebraLU<f64>;

/// The method of integration.
#[derive(Clone, Copy)]
pub(crate) enum Method {
    Bdf,
    Esdirk34,
}

pub(crate) fn run(
    case: &Case,
    method: Method,
    tolerance: f64,
    samples: &mut Samples,
) -> Result<(), DiffsolError> {
    let segments = &case.joint;
    let current = Cell::new(segments[0]);
    let derivative = |z: &[f64], _: &[f64], t: f64, dz: &mut [f64]| slope(case, &current.get(), t, z, dz);
    let jacobian = |z: &[f64], _: &[f64], _: f64, v: &[f64], jv: &mut [f64]| {
        let sides = z.chunks_exact(2).zip(v.chunks_exact(2)).zip(jv.chunks_exact_mut(2));
        for (port, ((z, v), jv)) in case.ports.iter().zip(sides) {
            jv.copy_from_slice(&port.jacobian_times(z[1], [v[0], v[1]]));
        }
    };
    let problem = OdeBuilder::<Matrix>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .rhs_implicit(derivative, jacobian)
        .init(|_, _, z| z.fill(0.0), 4)
        .build()?;
    match method {
        Method::Bdf => follow(problem.bdf::<Factored>()?, &problem, case, &current, samples),
        Method::Esdirk34 => follow(problem.esdirk34::<Factored>()?, &problem, case, &current, samples),
    }
}

/// Integrates from edge to edge and fills the samples.
fn follow<'a, E, S>(
    mut solver: S,
    problem: &'a OdeSolverProblem<E>,
    case: &Case,
    current: &Cell<JointSegment>,
    samples: &mut Samples,
) -> Result<(), DiffsolError>
where
    E: OdeEquationsImplicit<T = f64, V = NalgebraVec<f64>, M = Matrix, C = NalgebraContext> + 'a,
    S: OdeSolverMethod<'a, E>,
{
    let mut recorder = Recorder::new(case, samples);
    let mut there = solver.state().y.clone();
    for segment in &case.joint {
        let before = current.replace(*segment);
        if jumps(&before, segment) {
            let mut state = solver.state_mut();
            let mut dz = [0.0; 4];
            slope(case, segment, segment.start_s, &[state.y[0], state.y[1], state.y[2], state.y[3]], &mut dz);
            for (n, dz) in dz.into_iter().enumerate() {
                state.dy[n] = dz;
            }
            state.set_step_size(1.0, &problem.atol, problem.rtol, &problem.eqn, 2);
        }
        solver.set_stop_time(segment.end_s)?;
        loop {
            let reason = solver.step()?;
            let mut failure = None;
            recorder.record(solver.state().t, |sample_s| {
                failure = solver.interpolate_inplace(sample_s, &mut there).err().or(failure.take());
                [there[0], there[2]]
            });
            if let Some(failure) = failure {
                return Err(failure);
            }
            if reason == OdeSolverStopReason::TstopReached {
                break;
            }
        }
    }
    Ok(())
}
