//! The solvers of this project: the exact solution and the two integrators.

use pump_model::circuit::Resistance;
use pump_model::integrator::IntegrationError;
use pump_model::{ExactRun, Leg, LineState, ModelError, PortRun, RollerCentric, RollerRun};

use crate::case::{Case, DT_S, END_S, PORTS, SAMPLES, Samples, sample_s};

/// Samples the exact solution.
pub(crate) fn exact(case: &Case, samples: &mut Samples) {
    for (port, kpa) in PORTS.into_iter().zip(samples) {
        ExactRun::from_rest(&case.pump, port, [case.leg]).every(DT_S).fill_pressure_kpa(kpa);
    }
}

/// Samples the exact solution at times that it is given.
pub(crate) fn exact_at(case: &Case, times_s: &[f64], samples: &mut Samples) {
    for (port, kpa) in PORTS.into_iter().zip(samples) {
        ExactRun::from_rest(&case.pump, port, [case.leg]).in_series().fill_pressure_kpa(times_s, kpa);
    }
}

/// The integrator's method.
#[derive(Clone, Copy)]
pub(crate) enum Method {
    Rodas5p,
    Radau,
}

/// Samples an integrator's solution, with its dense output.
pub(crate) fn integrated(
    case: &Case,
    method: Method,
    tolerance: f64,
    samples: &mut Samples,
) -> Result<(), IntegrationError> {
    for (port, kpa) in PORTS.into_iter().zip(samples) {
        let base_kpa = case.pump.line(port).reservoir_kpa;
        let run = PortRun::<_, 2>::from_rest(&case.pump, port, [case.leg], tolerance)?;
        let mut run = match method {
            Method::Rodas5p => run,
            Method::Radau => run.with_radau()?,
        };
        sampled(&mut run, base_kpa, kpa)?;
    }
    Ok(())
}

/// Samples the integrator's solution with the friction of the case's hoses.
pub(crate) fn rubbed(case: &Case, tolerance: f64, samples: &mut Samples) -> Result<(), IntegrationError> {
    for ((port, friction), kpa) in
        PORTS.into_iter().zip(case.ports.iter().filter_map(|p| p.friction)).zip(samples)
    {
        let base_kpa = case.pump.line(port).reservoir_kpa;
        let rest = LineState::AT_REST;
        let mut run =
            PortRun::<_, 2, _>::with_friction(&case.pump, friction, port, [case.leg], rest, tolerance)?;
        sampled(&mut run, base_kpa, kpa)?;
    }
    Ok(())
}

/// Samples the integrator's solution of the roller-centric model.
pub(crate) fn roller_centric(case: &Case, tolerance: f64, samples: &mut Samples) -> Result<(), ModelError> {
    let mut run = RollerRun::new(&case.pump, RollerCentric::PUBLISHED, [case.leg], tolerance)?;
    let [inlet, outlet] = samples;
    for (n, (inlet, outlet)) in inlet.iter_mut().zip(outlet).enumerate() {
        let sample = run.at(sample_s(n))?;
        (*inlet, *outlet) = (sample.inlet_kpa, sample.outlet_kpa);
    }
    Ok(())
}

/// Samples a run by its dense output.
fn sampled<R: Resistance>(
    run: &mut PortRun<'_, impl Iterator<Item = Leg>, 2, R>,
    base_kpa: f64,
    kpa: &mut [f64],
) -> Result<(), IntegrationError> {
    let mut due = 0;
    while let Some(step) = run.step(END_S)? {
        let pressure = step.polynomial(0);
        while due < SAMPLES && sample_s(due) <= step.end_s() {
            kpa[due] = base_kpa + pressure.at((sample_s(due) - step.start_s) / step.length_s);
            due += 1;
        }
    }
    Ok(())
}
