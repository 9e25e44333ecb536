//! Pressures that a duty may not reach, and what would do.

use pump_model::{Port, SteadyState};

use crate::catalogue::beyond_known_kpa;
use crate::pump_file::{HoseTable, LineSource, LineTable, PumpFile, Reservoir};

use super::duty::Duty;
use super::error::{Shortfall, SizingError, WouldDo, origin};
use super::largest_pressure::LargestPressure;
use super::line::{SizedLine, is_hose};
use super::operating::{Operating, lines};

/// Largest bore that is tried for a hose, in mm, and the step between two.
const MOST_BORE_MM: f64 = 50.0;
const BORE_STEP_MM: f64 = 0.5;

/// Step of a lift that is proposed, in mm.
const LIFT_STEP_MM: f64 = 100.0;

/// Ports of a pump.
const BOTH: [Port; 2] = [Port::Inlet, Port::Outlet];

/// Proposals of a lift at most. Each takes the shortfall of the one before away.
const PROPOSALS: usize = 8;

/// Returns the pump at a duty with its steady state, or the pressure that breaks a limit. The mean pressures are looked
/// at first, since a lift too high leaves no pump to compute.
pub(super) fn served(
    file: &PumpFile,
    most: Option<LargestPressure>,
    duty: &Duty,
) -> Result<(Operating, SteadyState), SizingError> {
    tried(file, most, duty, &BOTH).map_err(|error| match error {
        SizingError::Suction(mut shortfall) => {
            shortfall.would_do = would_do(file, most, duty, &shortfall);
            SizingError::Suction(shortfall)
        }
        SizingError::Discharge(mut shortfall) => {
            shortfall.would_do = would_do(file, most, duty, &shortfall);
            SizingError::Discharge(shortfall)
        }
        error => error,
    })
}

/// Returns what [`served`] does, without what would do. The limits of these ports alone count.
fn tried(
    file: &PumpFile,
    most: Option<LargestPressure>,
    duty: &Duty,
    ports: &[Port],
) -> Result<(Operating, SteadyState), SizingError> {
    let [inlet, outlet] = lines(file, duty.flow_ml_s)?;
    check(
        file,
        most,
        ports,
        [(&inlet, inlet.mean_kpa, inlet.mean_kpa), (&outlet, outlet.mean_kpa, outlet.mean_kpa)],
    )?;
    let operating = Operating::of(file.clone(), duty)?;
    operating.check_speed(duty.flow_ml_s)?;
    let steady = operating.steady(duty.flow_ml_s)?;
    let [inlet, outlet] = [&operating.inlet, &operating.outlet];
    check(
        file,
        most,
        ports,
        [
            (inlet, steady.inlet.min_kpa, steady.inlet.max_kpa),
            (outlet, steady.outlet.min_kpa, steady.outlet.max_kpa),
        ],
    )?;
    Ok((operating, steady))
}

/// Refuses the pressures of inlet and outlet, each the smallest and the largest, that break a limit of the file.
fn check(
    file: &PumpFile,
    most: Option<LargestPressure>,
    ports: &[Port],
    [(inlet, inlet_min_kpa, _), (outlet, outlet_min_kpa, outlet_max_kpa)]: [(&SizedLine, f64, f64); 2],
) -> Result<(), SizingError> {
    let limits = file.limits();
    let shortfall = |port: Port, line: &SizedLine, reached_kpa: f64, limit_kpa: f64, set_by: String| {
        let pulse_kpa = (reached_kpa - line.mean_kpa).abs();
        Box::new(Shortfall {
            port: port.name(),
            reached_kpa,
            limit_kpa,
            set_by,
            lift_mm: line.lift_mm,
            lift_kpa: line.lift_kpa,
            friction_kpa: line.friction_kpa,
            pulse_kpa: (pulse_kpa > 0.0).then_some(pulse_kpa),
            would_do: WouldDo::default(),
        })
    };
    let suction = [
        (Port::Inlet, inlet, inlet_min_kpa, limits.lowest_where_it_sucks()),
        (Port::Outlet, outlet, outlet_min_kpa, limits.lowest),
    ];
    for (port, line, reached_kpa, lowest) in suction.into_iter().filter(|(port, ..)| ports.contains(port)) {
        let limit_kpa = lowest.map_or(0.0, |lowest| lowest.kpa);
        if reached_kpa < limit_kpa {
            let set_by = origin(lowest.map(|lowest| lowest.set_by));
            return Err(SizingError::Suction(shortfall(port, line, reached_kpa, limit_kpa, set_by)));
        }
    }
    match most.filter(|most| ports.contains(&Port::Outlet) && outlet_max_kpa > most.kpa) {
        Some(most) => {
            let set_by = most.source.told().to_owned();
            Err(SizingError::Discharge(shortfall(Port::Outlet, outlet, outlet_max_kpa, most.kpa, set_by)))
        }
        None => Ok(()),
    }
}

/// Returns the lift and the bore, each by itself, with which the duty is served.
fn would_do(file: &PumpFile, most: Option<LargestPressure>, duty: &Duty, short: &Shortfall) -> WouldDo {
    let port = if short.port == Port::Inlet.name() { Port::Inlet } else { Port::Outlet };
    WouldDo {
        most_lift_mm: short
            .lift_mm
            .and_then(|lift_mm| most_lift_mm(file, most, duty, (port, lift_mm, short))),
        least_bore_mm: is_hose(file, port).then(|| least_bore_mm(file, most, duty, port)).flatten(),
    }
}

/// Returns the line of a port to be changed.
fn line_of(file: &mut PumpFile, port: Port) -> &mut LineTable {
    match port {
        Port::Inlet => &mut file.inlet,
        Port::Outlet => &mut file.outlet.line,
    }
}

/// Returns the largest lift with which the duty is served without a warning of the tube's collapse, in steps of 0.1 m.
/// `None` where less lift does not help: the
/// pressure breaks its limit without a lift too, or a vessel lies too deep.
fn most_lift_mm(
    file: &PumpFile,
    most: Option<LargestPressure>,
    duty: &Duty,
    (port, mut lift_mm, short): (Port, f64, &Shortfall),
) -> Option<f64> {
    let per_mm = short.lift_kpa / lift_mm;
    let lacking = |short: &Shortfall| (short.reached_kpa - short.limit_kpa).abs();
    let mut lacking_kpa = lacking(short);
    for _ in 0..PROPOSALS {
        lift_mm = LIFT_STEP_MM * ((lift_mm - lacking_kpa / per_mm) / LIFT_STEP_MM - 1e-9).floor();
        let less = lift_mm > 0.0 && per_mm.is_finite();
        let mut other = file.clone();
        line_of(&mut other, port).reservoir = Reservoir::Lift(lift_mm);
        match tried(&other, most, duty, &[port]) {
            _ if !less => return None,
            Ok((_, steady)) => match beyond_known(&other, port, &steady) {
                Some(kpa) => lacking_kpa = kpa,
                None => return Some(lift_mm),
            },
            Err(SizingError::Suction(next) | SizingError::Discharge(next)) if next.port == short.port => {
                lacking_kpa = lacking(&next);
            }
            Err(_) => return None,
        }
    }
    None
}

/// Returns the smallest bore of a port's hose with which the duty is served, in steps of 0.5 mm. The wall stays as
/// thick.
fn least_bore_mm(file: &PumpFile, most: Option<LargestPressure>, duty: &Duty, port: Port) -> Option<f64> {
    let mut other = file.clone();
    let LineSource::Hose(hose) = line_of(&mut other, port).source else { return None };
    let own_mm = 2.0 * hose.bore_radius_mm;
    let wider = |n: u32| BORE_STEP_MM * (f64::from(n) + (own_mm / BORE_STEP_MM).floor());
    (1..).map(wider).take_while(|bore_mm| *bore_mm <= MOST_BORE_MM).find(|bore_mm| {
        let wall_mm = hose.outer_radius_mm - hose.bore_radius_mm;
        let bore_radius_mm = 0.5 * bore_mm;
        let wide = HoseTable { bore_radius_mm, outer_radius_mm: bore_radius_mm + wall_mm, ..hose };
        line_of(&mut other, port).source = LineSource::Hose(wide);
        let served = tried(&other, most, duty, &[port]);
        served.is_ok_and(|(_, steady)| beyond_known(&other, port, &steady).is_none())
    })
}

/// Returns by how many kPa a suction lies beyond what the pump's tube is known to stand. What would do is not warned
/// of.
fn beyond_known(file: &PumpFile, port: Port, steady: &SteadyState) -> Option<f64> {
    let below_kpa = file.ambient.pressure_kpa - steady.inlet.min_kpa;
    if port == Port::Inlet { beyond_known_kpa(file, below_kpa) } else { None }
}
