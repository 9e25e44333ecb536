//! `ivp`: the explicit Runge-Kutta methods of Dormand and Prince, of order 5 and 8, both ports as one system.

use ivp::dense::StepInterpolant;
use ivp::error::Error;
use ivp::ivp::FirstOrderSystem;
use ivp::methods::{DOP853, DOPRI5};
use ivp::solout::{ControlFlag, SolOut};

use super::{Recorder, slope};
use crate::case::{Case, JointSegment, Samples};

/// The system of both ports between two edges.
struct Between<'a> {
    case: &'a Case,
    segment: &'a JointSegment,
}

impl FirstOrderSystem for Between<'_> {
    fn derivative(&self, t: f64, z: &[f64], dz: &mut [f64]) {
        slope(self.case, self.segment, t, z, dz);
    }
}

/// The observer of a solver. It keeps the samples, the state reached and the longest step.
struct Watch<'a> {
    recorder: Recorder<'a>,
    state: [f64; 4],
    longest_s: f64,
}

impl SolOut for Watch<'_> {
    fn solout(
        &mut self,
        old: f64,
        t: &mut f64,
        z: &mut [f64],
        step: Option<&StepInterpolant<'_>>,
    ) -> ControlFlag {
        self.state.copy_from_slice(z);
        self.longest_s = self.longest_s.max(*t - old);
        let mut there = self.state;
        self.recorder.record(*t, |sample_s| {
            if let Some(step) = step {
                step.interpolate(sample_s, &mut there);
            }
            [there[0], there[2]]
        });
        ControlFlag::Continue
    }
}

/// The method of integration.
#[derive(Clone, Copy)]
pub(crate) enum Method {
    Dopri5,
    Dop853,
}

pub(crate) fn run(case: &Case, method: Method, tolerance: f64, samples: &mut Samples) -> Result<(), Error> {
    let mut watch = Watch { recorder: Recorder::new(case, samples), state: [0.0; 4], longest_s: 0.0 };
    for segment in &case.joint {
        let (system, state) = (Between { case, segment }, watch.state);
        let (start_s, end_s) = (segment.start_s, segment.end_s);
        // The longest step before is a better guess for the first step than the derivatives alone.
        let room_s = end_s - start_s;
        let first_step = (watch.longest_s > 0.0).then_some(watch.longest_s.min(room_s));
        if room_s > watch.longest_s {
            watch.longest_s = 0.0;
        }
        let (relative, absolute) = (tolerance.into(), tolerance.into());
        let watch = Some(&mut watch);
        match method {
            Method::Dopri5 => DOPRI5 { first_step, ..DOPRI5::default() }
                .solve(&system, start_s, &state, end_s, relative, absolute, watch)?,
            Method::Dop853 => DOP853 { first_step, ..DOP853::default() }
                .solve(&system, start_s, &state, end_s, relative, absolute, watch)?,
        };
    }
    Ok(())
}
