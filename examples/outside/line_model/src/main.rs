//! A pulsation damper at the end of the outlet line, which the library does not know: an air chamber that empties
//! through a needle valve.

use pump_model::circuit::LineModel;
use pump_model::{Line, ModelError, Port, Pump};

/// Line with a damper. The states are the pressure at the pump, the flow in the line and the pressure in the chamber,
/// both pressures above the reservoir's.
struct Damped {
    line: Line,
    /// Compliance of the chamber, mL/kPa.
    chamber_ml_kpa: f64,
    /// Resistance of the needle valve, kPa s/mL.
    valve_kpa_s_ml: f64,
}

impl LineModel<3> for Damped {
    fn derivative(&self, inflow_ml_s: f64, [p, q, chamber]: &[f64; 3]) -> [f64; 3] {
        let Line { resistance_kpa_s_ml: r, compliance_ml_kpa: c, inertance_kpa_s2_ml: l, .. } = self.line;
        let out = chamber / self.valve_kpa_s_ml;
        [(inflow_ml_s - q) / c, (p - chamber - r * q) / l, (q - out) / self.chamber_ml_kpa]
    }

    fn jacobian(&self, _inflow_ml_s: f64, _state: &[f64; 3]) -> [[f64; 3]; 3] {
        let Line { resistance_kpa_s_ml: r, compliance_ml_kpa: c, inertance_kpa_s2_ml: l, .. } = self.line;
        let filling = 1.0 / self.chamber_ml_kpa;
        [[0.0, -1.0 / c, 0.0], [1.0 / l, -r / l, -1.0 / l], [0.0, filling, -filling / self.valve_kpa_s_ml]]
    }

    fn per_inflow(&self, _inflow_ml_s: f64, _state: &[f64; 3]) -> [f64; 3] {
        [1.0 / self.line.compliance_ml_kpa, 0.0, 0.0]
    }

    fn scale(&self) -> [f64; 3] {
        [1.0, (self.line.compliance_ml_kpa / self.line.inertance_kpa_s2_ml).sqrt(), 1.0]
    }
}

fn main() -> Result<(), ModelError> {
    let pump = Pump::three_roller();
    let speed_rad_s = 10.0;
    let swing_kpa = |chamber_ml_kpa| {
        let model = Damped { line: *pump.outlet(), chamber_ml_kpa, valve_kpa_s_ml: 0.2 };
        let found = pump.periodic_line(Port::Outlet, model, speed_rad_s)?;
        Ok::<f64, ModelError>(found.pressure.max_kpa - found.pressure.min_kpa)
    };
    for chamber_ml_kpa in [0.1, 1.0, 10.0, 100.0] {
        println!(
            "{chamber_ml_kpa:5} mL/kPa of air: the pump's pressure swings by {:.3} kPa",
            swing_kpa(chamber_ml_kpa)?
        );
    }
    // A large chamber is a reservoir: it leaves the swing of the line alone.
    let alone = pump.steady_state(speed_rad_s)?.outlet;
    let alone_kpa = alone.max_kpa - alone.min_kpa;
    assert!((swing_kpa(100.0)? / alone_kpa - 1.0).abs() < 0.01, "{alone_kpa}");
    assert!((swing_kpa(0.1)? / alone_kpa - 1.0).abs() > 0.1, "{alone_kpa}");
    Ok(())
}
