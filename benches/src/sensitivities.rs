//! The rows of sensitivities and likelihoods, beside finite differences and an integrator.

use std::cell::RefCell;
use std::error::Error;
use std::hint::black_box;

use pump_model::identification::{PressureSample, Recording, RotorMotion};
use pump_model::{
    ExactRun, Leg, Line, ModelError, Port, Pump, RollerVolume, SensitiveColumns, SensitiveRun,
    SensitiveState, SensitivityParameter,
};

use crate::case::{Case, DT_S, PORTS, SAMPLES, Samples, room};
use crate::peers::sensitive;
use crate::solvers::loosest;
use crate::timing::Row;

/// Number of parameters: R, C, L, angle and roller volume.
const PARAMETERS: usize = SensitivityParameter::COUNT;

/// Number of samples of a likelihood.
const RECORDED: usize = 1_000;

/// Error to reach, kPa a unit of the parameter.
const GOAL_KPA: f64 = 1e-6;

/// Derivatives of the pressures of inlet and outlet by every parameter, in the unit of each: a whole R, C, L or roller
/// volume, and a radian.
pub(crate) type Derivatives = [Samples; PARAMETERS];

/// Rows in the order of [`rows`].
pub(crate) const EXACT: usize = 0;
pub(crate) const DIFFERENCES: usize = 1;
pub(crate) const DIFFSOL: usize = 2;
pub(crate) const LIKELIHOOD: usize = 3;

pub(crate) fn rows(case: &Case) -> Result<Vec<Row<'_>>, Box<dyn Error>> {
    let mut reference = derivatives();
    exact(case, &mut reference);
    let error_kpa = |found: &[Samples]| {
        let pairs = found.iter().flatten().flatten().zip(reference.iter().flatten().flatten());
        pairs.fold(0.0, |largest: f64, (one, other)| largest.max((one - other).abs()))
    };
    let mut found = derivatives();
    by_differences(case, &mut found)?;
    let differences_kpa = error_kpa(&found);
    let by_line = |tolerance, found: &mut [Samples; 3]| sensitive::run(case, tolerance, found);
    let mut line = [room(), room(), room()];
    let tolerance =
        loosest(|tolerance| by_line(*tolerance, &mut line).is_ok() && error_kpa(&line) <= GOAL_KPA)
            .ok_or("diffsol reaches the sensitivities at no tolerance")?;
    by_line(tolerance, &mut line)?;
    let diffsol_kpa = error_kpa(&line);
    let found = [RefCell::new(derivatives()), RefCell::new(found)];
    let line = RefCell::new(line);
    let [of_exact, of_differences] = found;
    let makes = (2.0 * SAMPLES as f64, "samples");
    let mut rows = vec![
        Row {
            name: "sensitivities by R, C, L, angle and V_r".into(),
            tolerance: None,
            error_kpa: None,
            makes,
            run: Box::new(move || {
                exact(case, black_box(&mut of_exact.borrow_mut()));
                Ok(())
            }),
        },
        Row {
            name: "the same by central differences of the exact solution".into(),
            tolerance: None,
            error_kpa: Some(differences_kpa),
            makes,
            run: Box::new(move || Ok(by_differences(case, black_box(&mut of_differences.borrow_mut()))?)),
        },
        Row {
            name: "sensitivities by R, C and L alone, diffsol BDF".into(),
            tolerance: Some(tolerance),
            error_kpa: Some(diffsol_kpa),
            makes,
            run: Box::new(move || Ok(by_line(tolerance, black_box(&mut line.borrow_mut()))?)),
        },
    ];
    rows.push(likelihood(case, "likelihood of 1,000 samples at equal intervals", |n| 0.01 * n as f64)?);
    // Times that a program rounded to a millisecond.
    let rounded = |n: usize| (1e3 * 0.009_7 * n as f64).round() * 1e-3;
    rows.push(likelihood(case, "likelihood of 1,000 samples at rounded times", rounded)?);
    Ok(rows)
}

fn derivatives() -> Derivatives {
    std::array::from_fn(|_| room())
}

/// Returns the units of the parameters at a port.
fn units(case: &Case, port: Port) -> [f64; PARAMETERS] {
    let line = case.pump.line(port);
    let roller_ml = case.pump.roller_volume().total_ml();
    [line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml, 1.0, roller_ml]
}

/// Samples the exact derivatives.
fn exact(case: &Case, found: &mut Derivatives) {
    let (mut kpa, mut flow_ml_rad) = ([0.0; SAMPLES], [0.0; SAMPLES]);
    for (side, port) in PORTS.into_iter().enumerate() {
        let mut samples =
            SensitiveRun::new(&case.pump, port, [case.leg], SensitiveState::AT_REST).every(DT_S);
        let kpa_by = found.each_mut().map(|samples| samples[side].as_mut_slice());
        samples.fill(SensitiveColumns {
            kpa: &mut kpa,
            kpa_by,
            flow_ml_rad: Some(&mut flow_ml_rad),
            rate_kpa_s: None,
        });
        for (samples, unit) in found.iter_mut().zip(units(case, port)) {
            samples[side].iter_mut().for_each(|by| *by *= unit);
        }
    }
}

/// Samples central differences: two exact runs for each parameter and port.
fn by_differences(case: &Case, found: &mut Derivatives) -> Result<(), ModelError> {
    const PART: f64 = 1e-5;
    let mut scratch = [0.0; SAMPLES];
    for (parameter, samples) in found.iter_mut().enumerate() {
        let [below, above] = [-PART, PART].map(|part| changed(case, parameter, part));
        let ((below, below_leg), (above, above_leg)) = (below?, above?);
        for (port, place) in PORTS.into_iter().zip(samples) {
            ExactRun::from_rest(&above, port, [above_leg]).every(DT_S).fill_kpa(place);
            ExactRun::from_rest(&below, port, [below_leg]).every(DT_S).fill_kpa(&mut scratch);
            for (place, below) in place.iter_mut().zip(&scratch) {
                *place = (*place - below) / (2.0 * PART);
            }
        }
    }
    Ok(())
}

/// Returns the pump and the leg with a parameter changed by a part of its unit.
fn changed(case: &Case, parameter: usize, part: f64) -> Result<(Pump, Leg), ModelError> {
    let pump = &case.pump;
    let by = |line: &Line| {
        let mut line = *line;
        match parameter {
            0 => line.resistance_kpa_s_ml *= 1.0 + part,
            1 => line.compliance_ml_kpa *= 1.0 + part,
            2 => line.inertance_kpa_s2_ml *= 1.0 + part,
            _ => {}
        }
        line
    };
    let roller: RollerVolume = match parameter {
        4 => pump.roller_volume().scaled_to(pump.roller_volume().total_ml() * (1.0 + part))?,
        _ => *pump.roller_volume(),
    };
    let leg = if parameter == 3 { case.leg.beside(part) } else { case.leg };
    Ok((Pump::new(*pump.geometry(), roller, by(pump.inlet()), by(pump.outlet()))?, leg))
}

/// Returns the row of one likelihood, with the parameters as they are: most of a fit's time.
fn likelihood<'a>(
    case: &'a Case,
    name: &str,
    time_s: impl Fn(usize) -> f64,
) -> Result<Row<'a>, Box<dyn Error>> {
    let mut run = ExactRun::from_rest(&case.pump, Port::Outlet, [case.leg]);
    let samples: Vec<PressureSample> = (0..RECORDED)
        .map(|n| PressureSample { time_s: time_s(n), pressure_kpa: 0.1 + run.pressure_kpa(time_s(n)) })
        .collect();
    let legs = [case.leg];
    let line = *case.pump.outlet();
    let run = move || {
        let recording =
            Recording { port: Port::Outlet, samples: &samples, motion: RotorMotion::FromRest(&legs) };
        black_box(recording.residual_squares_kpa2(&case.pump, black_box(&line), 0.0, 0.0)?);
        Ok(())
    };
    Ok(Row {
        name: name.into(),
        tolerance: None,
        error_kpa: None,
        makes: (1.0, "values"),
        run: Box::new(run),
    })
}
