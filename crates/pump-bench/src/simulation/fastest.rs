//! The fastest run at constant speed that holds the limits of its pump.

use pump_ctl::plan::{Cruise, Doser, LimitedBy, Limits, Phase, Request};
use pump_model::units::{rad_s, rpm};
use pump_model::{Extremes, Pump, SteadyState};

use super::reached::Reached;
use crate::displacement::{DisplacementError, SpeedDependentPump};

/// Slowest speed that is tried, as a part of the fastest.
const SLOWEST: f64 = 1.0 / 1024.0;

/// Factor from one speed that is tried to the next.
const RATIO: f64 = 1.01;

/// Accuracy of the speed, as a part of it.
const ACCURACY: f64 = 1e-6;

/// Revolutions of the dose whose torque stands for that of a run.
const REVOLUTIONS: f64 = 5.0;

/// The fastest run that holds every limit, and the limit that binds it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FastestRun {
    /// Speed, in rad/s, negative in reverse. `None` if even the slowest speed breaks a limit.
    pub speed_rad_s: Option<f64>,
    /// Limit that a faster run would break.
    pub limited_by: LimitedBy,
}

/// Finds the fastest constant speed at which a run from lines at rest and the steady state after it hold every limit,
/// and below which every slower speed holds them.
///
/// Speeds are tried upwards, each 1 % faster, up to the motor's largest and to that of the speed law. The first one
/// that breaks a limit ends the search, and bisection refines it to 1e-6. Start-up is that of a run whose speed stands
/// at once. `steady` gives the steady state where hoses resist more at more flow; the torque is that of a dose of five
/// revolutions. Pressures are not checked where a line is not known, as in a dose.
///
/// # Errors
/// Returns the [`DisplacementError`] of a pump without a speed, or that of `steady`.
pub fn fastest_run(
    pump: &SpeedDependentPump,
    limits: &Limits,
    is_reverse: bool,
    steady: impl Fn(&Pump, f64) -> Result<Option<SteadyState>, DisplacementError>,
) -> Result<FastestRun, DisplacementError> {
    let sign = if is_reverse { -1.0 } else { 1.0 };
    let law = pump.law().map(|law| law.range_rpm());
    let motor_rpm = rpm(limits.motor.max_speed_rad_s);
    let top_rad_s = rad_s(law.map_or(motor_rpm, |(_, most_rpm)| most_rpm.min(motor_rpm)));
    let slowest_rad_s =
        law.map_or(0.0, |(least_rpm, _)| rad_s(least_rpm)).max(SLOWEST * top_rad_s).min(top_rad_s);
    let of_start = |speed_rad_s: f64| -> Result<Option<LimitedBy>, DisplacementError> {
        let reached = Reached::of(&pump.at(sign * speed_rad_s)?, sign * speed_rad_s, f64::INFINITY);
        Ok(broken(limits, [reached.inlet, reached.outlet], is_reverse))
    };
    let later = |speed_rad_s: f64| -> Result<Option<LimitedBy>, DisplacementError> {
        let at = pump.at(sign * speed_rad_s)?;
        let steady = steady(&at, sign * speed_rad_s)?;
        let by_pressure = steady.and_then(|s| broken(limits, [s.inlet, s.outlet], is_reverse));
        Ok(by_pressure.or(of_torque(&at, limits, sign * speed_rad_s)))
    };
    let none = |limited_by| Ok(FastestRun { speed_rad_s: None, limited_by });
    if let Some(by) = of_start(slowest_rad_s)? {
        return none(by);
    }
    let (mut good, mut limited_by) = (slowest_rad_s, LimitedBy::Speed);
    while good < top_rad_s {
        let next = (good * RATIO).min(top_rad_s);
        if of_start(next)?.is_some() {
            (good, limited_by) = refined(good, next, of_start)?;
            break;
        }
        good = next;
    }
    if later(good)?.is_some() {
        if let Some(by) = later(slowest_rad_s)? {
            return none(by);
        }
        (good, limited_by) = refined(slowest_rad_s, good, later)?;
    }
    Ok(FastestRun { speed_rad_s: Some(sign * good), limited_by })
}

/// Returns the fastest speed between one that holds and one that breaks a limit, and that limit.
fn refined(
    mut good: f64,
    mut bad: f64,
    broken: impl Fn(f64) -> Result<Option<LimitedBy>, DisplacementError>,
) -> Result<(f64, LimitedBy), DisplacementError> {
    let mut limited_by = broken(bad)?.unwrap_or(LimitedBy::Speed);
    while bad - good > ACCURACY * bad {
        let middle = 0.5 * (good + bad);
        match broken(middle)? {
            Some(by) => (bad, limited_by) = (middle, by),
            None => good = middle,
        }
    }
    Ok((good, limited_by))
}

/// Returns the limit that the pressures at inlet and outlet break.
fn broken(limits: &Limits, [inlet, outlet]: [Extremes; 2], is_reverse: bool) -> Option<LimitedBy> {
    use LimitedBy::{InletPressure, InletSuction, OutletPressure, OutletSuction};
    let (sucking, pushing) = if is_reverse { (outlet, inlet) } else { (inlet, outlet) };
    let [sucks, pushes, runs_on] = match is_reverse {
        false => [InletSuction, OutletPressure, OutletSuction],
        true => [OutletSuction, InletPressure, InletSuction],
    };
    let below = |pressure: Extremes, limit: Option<f64>| limit.is_some_and(|kpa| pressure.min_kpa < kpa);
    let of_suction = limits.lowest_where_it_sucks().map(|lowest| lowest.kpa);
    if below(sucking, of_suction) {
        Some(sucks)
    } else if limits.pressures.max_outlet_kpa.is_some_and(|kpa| pushing.max_kpa > kpa) {
        Some(pushes)
    } else {
        below(pushing, limits.lowest.map(|lowest| lowest.kpa)).then_some(runs_on)
    }
}

/// Returns the torque as the limit that a dose at this speed breaks.
fn of_torque(pump: &Pump, limits: &Limits, speed_rad_s: f64) -> Option<LimitedBy> {
    limits.torque?;
    let volume_ml = (REVOLUTIONS * pump.revolution_ml()).copysign(speed_rad_s);
    let request = Request::new(volume_ml, Cruise::Speed { rad_s: speed_rad_s.abs() });
    let plan = Doser::new(pump, Limits::new(limits.motor)).ok()?.plan(Phase::known(0.0), &request).ok()?;
    let margin = limits.margins(pump, &plan).torque?;
    (margin.used > 1.0).then_some(LimitedBy::Torque)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::built_in;
    use crate::pump_file::PumpFile;

    fn fastest(file: &PumpFile, is_reverse: bool) -> FastestRun {
        let pump = file.speed_dependent_pump().unwrap();
        fastest_run(&pump, &file.limits(), is_reverse, |_, _| Ok(None)).unwrap()
    }

    #[test]
    fn the_motors_largest_speed_binds_where_no_pressure_does() {
        for (name, most_rpm) in [("three-roller", 170.0), ("two-roller", 300.0)] {
            let found = fastest(&built_in(name).unwrap(), false);
            // From 170 and 300 r/min the suction stays above the collapse at 43.05 kPa only for a slow start.
            match found.limited_by {
                LimitedBy::Speed => {
                    assert!((rpm(found.speed_rad_s.unwrap()) - most_rpm).abs() < 1e-9, "{name}");
                }
                by => assert_eq!(by, LimitedBy::InletSuction, "{name}"),
            }
        }
    }

    #[test]
    fn the_pressure_of_the_fastest_run_just_holds_its_limit() {
        let mut file = built_in("three-roller").unwrap();
        file.limits.max_outlet_kpa = Some(100.0);
        for is_reverse in [false, true] {
            let found = fastest(&file, is_reverse);
            let speed_rad_s = found.speed_rad_s.unwrap();
            let reached = Reached::of(&file.model().unwrap(), speed_rad_s, f64::INFINITY);
            let (pushing, by) = match is_reverse {
                false => (reached.outlet, LimitedBy::OutletPressure),
                true => (reached.inlet, LimitedBy::InletPressure),
            };
            assert_eq!((found.limited_by, speed_rad_s < 0.0), (by, is_reverse));
            assert!((pushing.max_kpa - 100.0).abs() < 1e-3, "{pushing:?}");
        }
        // The paper's table: at 50 r/min 93.35 kPa, at 100 r/min 104.51 kPa in the steady state.
        let rpm = rpm(fastest(&file, false).speed_rad_s.unwrap());
        assert!(rpm > 50.0 && rpm < 100.0, "{rpm}");
    }

    #[test]
    fn a_limit_that_even_rest_breaks_leaves_no_speed() {
        let mut file = built_in("three-roller").unwrap();
        file.limits.max_outlet_kpa = Some(80.0);
        let found = fastest(&file, false);
        assert_eq!((found.speed_rad_s, found.limited_by), (None, LimitedBy::OutletPressure));
    }

    #[test]
    fn the_motors_torque_binds_where_it_is_known() {
        let mut file = built_in("three-roller").unwrap();
        let text = file.to_toml().replacen(
            "max_acceleration_rad_s2",
            "inertia_kg_m2 = 1e-4\nocclusion_torque_n_m = 0.3\n\
             torque_curve_rpm_n_m = [[0.0, 1.0], [80.0, 0.6], [100.0, 0.01]]\nmax_acceleration_rad_s2",
            1,
        );
        file = match PumpFile::parse(&text, "torque") {
            Ok(file) => file,
            Err(error) => panic!("{error}"),
        };
        let found = fastest(&file, false);
        assert_eq!(found.limited_by, LimitedBy::Torque);
        let speed = rpm(found.speed_rad_s.unwrap());
        // 0.3 N m for the tube alone are there up to 90.2 r/min.
        assert!(speed > 70.0 && speed < 90.4, "{speed}");
    }
}
