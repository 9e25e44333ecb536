//! How long a line needs to come to rest after the last step.

use nalgebra::SVector;

use crate::circuit::{Circuit, NoFlow, options};
use crate::error::ModelError;
use crate::flow_curve::Port;
use crate::integrator::Rodas5p;
use crate::line::Line;
use crate::motion::Leg;
use crate::polynomial::Polynomial;
use crate::port_run::{DEFAULT_TOLERANCE, PortRun};

/// Volume that still may move in a settled line: 1 uL.
pub const SETTLED_ML: f64 = 1e-3;

/// A line that takes longer is said not to settle, s.
const LIMIT_S: f64 = 3600.0;

impl<M: Iterator<Item = Leg>> PortRun<'_, M, 2> {
    /// Time, s, after which the undelivered volume |C p| stays below [`SETTLED_ML`] if the rotor rests from now on.
    ///
    /// The energy C p²/2 + L Q²/2 of a passive line only falls, so once it is below that of the allowed pressure, the
    /// volume stays inside for ever.
    pub fn settling_s(&self) -> Result<f64, ModelError> {
        settling_s(self.line(), self.port(), self.state())
    }
}

fn settling_s(line: &Line, port: Port, state: SVector<f64, 2>) -> Result<f64, ModelError> {
    let compliance = line.compliance_ml_kpa;
    let allowed_kpa = SETTLED_ML / compliance;
    let allowed_energy = compliance * allowed_kpa * allowed_kpa;
    let energy = |y: SVector<f64, 2>| compliance * y[0] * y[0] + line.inertance_kpa_s2_ml * y[1] * y[1];

    let circuit = Circuit { line, port, forcing: NoFlow };
    // Relative to the pressure that is looked for, not to 1 kPa.
    let options = options(line, DEFAULT_TOLERANCE, allowed_kpa.min(1.0));
    let mut solver = Rodas5p::new(0.0, state, options);
    let mut settled_s = 0.0;
    while energy(solver.state()) >= allowed_energy {
        if solver.time_s() > LIMIT_S {
            return Err(ModelError::NeverSettles { limit_s: LIMIT_S });
        }
        let step = solver.step(&circuit, f64::INFINITY)?;
        let pressure = step.polynomial(0);
        for bound in [allowed_kpa, -allowed_kpa] {
            let crossings = pressure.plus(&Polynomial::constant(-bound)).roots_in(0.0, 1.0);
            if let Some(last) = crossings.as_slice().last() {
                settled_s = f64::max(settled_s, step.start_s + last * step.length_s);
            }
        }
    }
    Ok(settled_s)
}
