//! The back flow of doses with either ramps, on the pump's line and on lines that are stiffer or softer.

use std::error::Error;

use pump_ctl::plan::Ramps;
use pump_model::Pump;
use pump_model::units::degrees;

use crate::trial::Trial;

/// Back flow and time of doses of one volume, each over the start angle in degrees.
pub(crate) struct BackFlows {
    /// Back flow on the pump's own line, uL.
    pub(crate) nominal_ul: Vec<(f64, f64)>,
    /// Back flow on a line of 20 % less compliance, uL.
    pub(crate) stiffer_ul: Vec<(f64, f64)>,
    /// Back flow on a line of 20 % more compliance, uL.
    pub(crate) softer_ul: Vec<(f64, f64)>,
    /// Volume that the outlet takes back on the way, uL.
    pub(crate) reverse_ul: Vec<(f64, f64)>,
    /// Time of motion and settling, s.
    pub(crate) time_s: Vec<(f64, f64)>,
}

impl BackFlows {
    pub(crate) fn new(
        trial: &Trial,
        (volume_ml, rate_ml_s): (f64, f64),
        ramps: Ramps,
        angles: u32,
    ) -> Result<Self, Box<dyn Error>> {
        let mut all = Self {
            nominal_ul: Vec::new(),
            stiffer_ul: Vec::new(),
            softer_ul: Vec::new(),
            reverse_ul: Vec::new(),
            time_s: Vec::new(),
        };
        let [stiffer, softer] = [trial.with_compliance(0.8)?, trial.with_compliance(1.2)?];
        for start_rad in trial.start_angles(angles) {
            let deg = degrees(start_rad);
            let plan = trial.plan(start_rad, volume_ml, rate_ml_s, ramps)?;
            let back_flow = |pump: &Pump| plan.back_flow(pump);
            let nominal = back_flow(&trial.pump)?;
            all.nominal_ul.push((deg, 1e3 * nominal.backflow_ml));
            all.reverse_ul.push((deg, 1e3 * nominal.reverse_flow_ml));
            all.stiffer_ul.push((deg, 1e3 * back_flow(&stiffer)?.backflow_ml));
            all.softer_ul.push((deg, 1e3 * back_flow(&softer)?.backflow_ml));
            let time_s = plan.profile().duration_s() + plan.predict(&trial.pump)?.settle_s;
            all.time_s.push((deg, time_s));
        }
        Ok(all)
    }
}
