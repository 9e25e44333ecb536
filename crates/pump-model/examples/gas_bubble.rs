//! A line model of one's own: a gas bubble beside the outlet. A small bubble brings the line nearer to a
//! resonance, and a large one softens the pulses.
//!
//! `cargo run -p pump-model --features integrator --example gas_bubble`

use pump_model::circuit::LineModel;
use pump_model::{Line, ModelError, Port, Pump};

/// Line with a bubble at its port. The gas follows p V = const (isothermal), so its compliance is
/// p_res V_res/p² at the absolute pressure p. The states are p - p_res, kPa, and the line's flow, mL/s.
struct Bubble {
    line: Line,
    /// Volume of the gas at the reservoir's pressure, mL.
    gas_ml: f64,
}

impl Bubble {
    /// Returns the compliance of line and gas, mL/kPa, and its slope over the pressure.
    fn compliance(&self, above_kpa: f64) -> (f64, f64) {
        let kpa = self.line.reservoir_kpa + above_kpa;
        let gas = self.line.reservoir_kpa * self.gas_ml / (kpa * kpa);
        (self.line.compliance_ml_kpa + gas, -2.0 * gas / kpa)
    }
}

impl LineModel<2> for Bubble {
    fn derivative(&self, inflow_ml_s: f64, [p, q]: &[f64; 2]) -> [f64; 2] {
        let (c, _) = self.compliance(*p);
        let Line { resistance_kpa_s_ml: r, inertance_kpa_s2_ml: l, .. } = self.line;
        [(inflow_ml_s - q) / c, (p - r * q) / l]
    }
    fn jacobian(&self, inflow_ml_s: f64, [p, q]: &[f64; 2]) -> [[f64; 2]; 2] {
        let (c, slope) = self.compliance(*p);
        let Line { resistance_kpa_s_ml: r, inertance_kpa_s2_ml: l, .. } = self.line;
        [[(q - inflow_ml_s) / (c * c) * slope, -1.0 / c], [1.0 / l, -r / l]]
    }
    fn per_inflow(&self, _inflow_ml_s: f64, [p, _]: &[f64; 2]) -> [f64; 2] {
        [1.0 / self.compliance(*p).0, 0.0]
    }
    fn scale(&self) -> [f64; 2] {
        [1.0, (self.line.compliance_ml_kpa / self.line.inertance_kpa_s2_ml).sqrt()]
    }
}

/// Returns the height of the outlet's pulses at 10 rad/s with a bubble, kPa.
fn pulses_kpa(gas_ml: f64) -> Result<f64, ModelError> {
    let pump = Pump::three_roller();
    let model = Bubble { line: *pump.outlet(), gas_ml };
    let found = pump.periodic_line(Port::Outlet, model, 10.0)?;
    Ok(found.pressure.max_kpa - found.pressure.min_kpa)
}

#[allow(clippy::print_stdout, reason = "an example shows its result")]
fn main() -> Result<(), ModelError> {
    for gas_ml in [0.0, 1.0, 10.0] {
        println!("{gas_ml:4} mL of gas: pulses of {:.3} kPa", pulses_kpa(gas_ml)?);
    }
    Ok(())
}

#[test]
fn much_gas_softens_the_pulses() -> Result<(), ModelError> {
    let pump = Pump::three_roller();
    let without = pump.steady_state(10.0)?.outlet;
    assert!((pulses_kpa(0.0)? - (without.max_kpa - without.min_kpa)).abs() < 1e-4);
    assert!(pulses_kpa(10.0)? < 0.6 * pulses_kpa(0.0)?);
    Ok(())
}
