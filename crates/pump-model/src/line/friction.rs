//! Resistance of a hose at every flow: friction from laminar to turbulent, and the losses of ends and bends.

use libm::{cbrt, log, sqrt};

/// Reynolds number below which Churchill's formula is 64/Re to the last bit.
const LAMINAR_REYNOLDS: f64 = 800.0;

/// Pressure drop of a smooth hose over the flow, dP(Q) = (f l/d + K) rho v|v|/2.
///
/// Darcy's factor f is Churchill's ("Friction-factor equation spans all fluid-flow regimes", Chem. Eng. 84,
/// 1977). His one formula covers laminar flow, turbulence and the range between.
///
/// The drop is not linear in Q, so only the integrator can take it: `PortRun::with_friction`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Reynolds number over flow, s/mL.
    pub(crate) reynolds_per_flow: f64,
    /// Laminar resistance 128 mu l/(pi d⁴), kPa s/mL.
    pub(crate) laminar_kpa_s_ml: f64,
    /// Minor loss over the square of the flow, K rho/(2 A²), kPa s²/mL².
    pub(crate) minor_kpa_s2_ml2: f64,
}

impl Friction {
    /// Returns the Reynolds number rho v d/mu at `flow_ml_s`.
    pub fn reynolds(&self, flow_ml_s: f64) -> f64 {
        self.reynolds_per_flow * flow_ml_s.abs()
    }

    /// Returns the pressure drop in the direction of the flow, kPa: negative at a negative flow.
    pub fn drop_kpa(&self, flow_ml_s: f64) -> f64 {
        self.resistance_kpa_s_ml(flow_ml_s) * flow_ml_s
    }

    /// Returns the drop over the flow, kPa s/mL. At no flow it is that of laminar flow.
    pub fn resistance_kpa_s_ml(&self, flow_ml_s: f64) -> f64 {
        let (excess, _) = excess_over_laminar(self.reynolds(flow_ml_s));
        self.laminar_kpa_s_ml * excess + self.minor_kpa_s2_ml2 * flow_ml_s.abs()
    }

    /// Returns the slope of the drop over the flow, kPa s/mL.
    pub fn slope_kpa_s_ml(&self, flow_ml_s: f64) -> f64 {
        let reynolds = self.reynolds(flow_ml_s);
        let (excess, slope) = excess_over_laminar(reynolds);
        self.laminar_kpa_s_ml * (excess + reynolds * slope) + 2.0 * self.minor_kpa_s2_ml2 * flow_ml_s.abs()
    }
}

/// Returns f Re/64, which is 1 in laminar flow, and its derivative over Re.
///
/// f = 8 ((8/Re)^12 + (A + B)^(-3/2))^(1/12), A = (2.457 ln (Re/7)^0.9)^16 for a smooth wall,
/// B = (37530/Re)^16 (Churchill). So f Re/64 = (1 + (Re/8)^12 (A + B)^(-3/2))^(1/12).
fn excess_over_laminar(reynolds: f64) -> (f64, f64) {
    if reynolds < LAMINAR_REYNOLDS {
        return (1.0, 0.0);
    }
    // Products and roots take a quarter of the time of general powers.
    let logarithm = 0.9 * log(reynolds / 7.0);
    let a = to_the_16th(2.457 * logarithm);
    let b = to_the_16th(37_530.0 / reynolds);
    let turbulent = to_the_12th(reynolds / 8.0) / ((a + b) * sqrt(a + b));
    let excess = sqrt(sqrt(cbrt(1.0 + turbulent)));
    // d ln(turbulent)/d ln(Re) = 12 - 3/2 (16 A 0.9/logarithm - 16 B)/(A + B)
    let growth = 12.0 - 24.0 * (a * 0.9 / logarithm - b) / (a + b);
    let slope = excess / 12.0 * turbulent / (1.0 + turbulent) * growth / reynolds;
    (excess, slope)
}

fn to_the_12th(x: f64) -> f64 {
    let squared = x * x;
    let fourth = squared * squared;
    fourth * fourth * fourth
}

fn to_the_16th(x: f64) -> f64 {
    let squared = x * x;
    let fourth = squared * squared;
    let eighth = fourth * fourth;
    eighth * eighth
}
