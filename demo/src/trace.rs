//! The waveform of a dose: motion, flows, pressures and delivered volume over time.

use pump_ctl::plan::Plan;
use pump_model::{ExactRun, Leg, Port, Pump};

/// Largest number of rows.
pub const ROWS: usize = 8192;

/// Number of columns.
pub const COLUMNS: usize = 9;

/// Columns of [`ROWS`]: time, s; angle, rad; speed, rad/s; flow at the rollers of inlet and outlet, mL/s; pressure at
/// inlet and outlet, kPa absolute; volume in the vessel, mL; flow at the end of the outlet line, mL/s.
pub(crate) type Trace = [[f64; ROWS]; COLUMNS];

/// Writes a row every `dt_s` from the start to `end_s`, s. The end of the motion and `end_s` have rows too, as in the
/// trace of the command. Returns the number of rows, or `None` if there are more than [`ROWS`].
pub(crate) fn trace(pump: &Pump, plan: &Plan, dt_s: f64, end_s: f64, to: &mut Trace) -> Option<usize> {
    let rows = times(dt_s, plan.profile().duration_s(), end_s, &mut to[0])?;
    let [time_s, angle_rad, speed_rad_s, q_in, q_out, p_in, p_out, vessel_ml, leaves] = to;
    let (mut legs, mut leg) = (plan.legs(), Leg::rest(0.0, plan.start().angle_rad()));
    if let Some(first) = legs.next() {
        leg = first;
    }
    let [mut inlet, mut outlet] =
        [Port::Inlet, Port::Outlet].map(|port| ExactRun::from_rest(pump, port, plan.legs()).in_series());
    let start_ml = pump.outlet_curve().volume_ml(leg.angle_rad);
    for n in 0..rows {
        let t_s = time_s[n];
        while t_s >= leg.end_s() {
            leg = legs.next().unwrap_or(Leg::rest(leg.end_s(), leg.end_angle_rad()));
        }
        (angle_rad[n], speed_rad_s[n]) = (leg.angle_at(t_s), leg.speed_at(t_s));
        let (inlet_ml_rad, outlet_ml_rad, outlet_ml) = pump.at_angle(angle_rad[n]);
        (q_in[n], q_out[n]) = (inlet_ml_rad * speed_rad_s[n], outlet_ml_rad * speed_rad_s[n]);
        let (mut sucked_kpa, mut pushed_kpa) = ([0.0], [0.0]);
        inlet.fill_kpa(&[t_s], &mut sucked_kpa);
        outlet.fill_kpa(&[t_s], &mut pushed_kpa);
        p_in[n] = sucked_kpa[0] + pump.inlet().reservoir_kpa;
        p_out[n] = pushed_kpa[0] + pump.outlet().reservoir_kpa;
        // The volume that the line holds has not passed it.
        vessel_ml[n] = outlet_ml - start_ml - pump.outlet().compliance_ml_kpa * pushed_kpa[0];
        leaves[n] = outlet.state().flow_ml_s;
    }
    Some(rows)
}

/// Writes the times n `dt_s`, with `also_s` and `end_s` among them, s. Returns their number.
fn times(dt_s: f64, also_s: f64, end_s: f64, to: &mut [f64; ROWS]) -> Option<usize> {
    // Two rows more than the grid has.
    if !(dt_s > 0.0 && end_s / dt_s < (ROWS - 2) as f64) {
        return None;
    }
    let (mut rows, mut n, mut is_also_due) = (0, 0.0, also_s < end_s);
    while rows < ROWS {
        let grid_s = (n * dt_s).min(end_s);
        if is_also_due && also_s <= grid_s {
            is_also_due = false;
            if also_s < grid_s {
                to[rows] = also_s;
                rows += 1;
                continue;
            }
        }
        to[rows] = grid_s;
        rows += 1;
        if grid_s >= end_s {
            return Some(rows);
        }
        n += 1.0;
    }
    None
}
