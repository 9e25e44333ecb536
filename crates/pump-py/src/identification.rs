//! What `pumpmodel.identify_resistance`, `identify_compliance` and `identify_line` compute: lines from measurements.

use numpy::{PyArray1, PyArrayMethods};
use pump_bench::identification::{
    Begin, Identified, Turning, identified_compliance, identified_line, identified_resistance,
};
use pump_model::Port;
use pump_model::identification::{FlowPoint, IdentificationError, InjectionPoint, PressureSample, Sought};
use pyo3::prelude::*;

use crate::errors::{self, value};
use crate::floats::Floats;
use crate::line::Line;
use crate::pump::{Pump, one_of};
use crate::speed::{Argument, speed_rad_s};

/// JSON and text of the command, the line, then what was varied, measured and fitted.
type Answer<'py> =
    (String, String, Line, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// R from steady flows, and the absolute pressures at the pump or the drops along the flow.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
pub(crate) fn _identify_resistance<'py>(
    py: Python<'py>,
    pump: &Pump,
    port: &str,
    flow_ml_s: &Bound<'py, PyAny>,
    pressure_kpa: Argument<'_, 'py>,
    drop_kpa: Argument<'_, 'py>,
    standard_kpa: Argument<'_, 'py>,
    offset: bool,
) -> PyResult<Answer<'py>> {
    let port = port_named(port)?;
    let line = pump.model.line(port);
    let flows = column("flow_ml_s", flow_ml_s, None)?;
    let count = Some(flows.len());
    // The drop is along the flow: to the pump at the inlet, from it at the outlet.
    let sign = if port == Port::Inlet { -1.0 } else { 1.0 };
    let drops = match (pressure_kpa, drop_kpa) {
        (Some(kpa), None) => {
            let at_pump = column("pressure_kpa", kpa, count)?.into_iter();
            at_pump.map(|kpa| sign * (kpa - line.reservoir_kpa)).collect()
        }
        (None, Some(kpa)) => column("drop_kpa", kpa, count)?,
        _ => return Err(value("give exactly one of pressure_kpa and drop_kpa")),
    };
    let errors = match standard_kpa {
        Some(kpa) => column("standard_kpa", kpa, count)?,
        None => vec![1.0; flows.len()],
    };
    let points: Vec<_> = flows
        .into_iter()
        .zip(drops)
        .zip(errors)
        .map(|((flow_ml_s, drop_kpa), standard_kpa)| FlowPoint { flow_ml_s, drop_kpa, standard_kpa })
        .collect();
    let rate_ml_s = pump.default_rate_ml_s();
    answer(py, py.detach(|| identified_resistance(&points, offset, (port, line), rate_ml_s)))
}

/// C from volumes injected and pressures.
#[pyfunction]
pub(crate) fn _identify_compliance<'py>(
    py: Python<'py>,
    pump: &Pump,
    port: &str,
    volume_ml: &Bound<'py, PyAny>,
    pressure_kpa: &Bound<'py, PyAny>,
    total_ml: Option<f64>,
) -> PyResult<Answer<'py>> {
    let port = port_named(port)?;
    if let Some(total_ml) = total_ml.filter(|ml| !(ml.is_finite() && *ml > 0.0)) {
        return Err(value(format_args!("total_ml is {total_ml}; allowed: a positive number")));
    }
    let volumes = column("volume_ml", volume_ml, None)?;
    let pressures = column("pressure_kpa", pressure_kpa, Some(volumes.len()))?;
    let points: Vec<_> = volumes
        .into_iter()
        .zip(pressures)
        .map(|(volume_ml, pressure_kpa)| InjectionPoint { volume_ml, pressure_kpa })
        .collect();
    answer(py, py.detach(|| identified_compliance(&points, total_ml, (port, pump.model.line(port)))))
}

/// R, C and L from a waveform.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
pub(crate) fn _identify_line<'py>(
    py: Python<'py>,
    pump: &Pump,
    port: &str,
    time_s: &Bound<'py, PyAny>,
    pressure_kpa: &Bound<'py, PyAny>,
    speed_rpm: Argument<'_, 'py>,
    speed_rad: Argument<'_, 'py>,
    fit: Vec<String>,
    begin: &str,
    start_s: Option<f64>,
    start_angle_rad: Option<f64>,
) -> PyResult<Answer<'py>> {
    let port = port_named(port)?;
    let begin = match begin {
        "ramp" => Begin::Ramp { acceleration_rad_s2: pump.file.limits().motor.max_acceleration_rad_s2 },
        "step" => Begin::Step,
        "steady" => Begin::Steady,
        _ => return Err(value(format_args!("begin is '{begin}'; allowed: 'ramp', 'step', 'steady'"))),
    };
    if begin == Begin::Steady && start_s.is_some() {
        return Err(value("start_s means nothing to a steady record; leave it out"));
    }
    for (name, number) in [("start_s", start_s), ("start_angle_rad", start_angle_rad)] {
        if let Some(number) = number.filter(|number| !number.is_finite()) {
            return Err(value(format_args!("{name} is {number}; allowed: a finite number")));
        }
    }
    for name in &fit {
        one_of("a name in fit", name, &["R", "C", "L", "reservoir", "start"])?;
    }
    let has = |name: &str| fit.iter().any(|given| given == name);
    let sought = Sought {
        resistance: has("R"),
        compliance: has("C"),
        inertance: has("L"),
        angle: start_angle_rad.is_none(),
        start: has("start"),
        pressure: has("reservoir"),
    };
    let turning = Turning {
        begin,
        start_s: start_s.unwrap_or(0.0),
        angle_rad: start_angle_rad.unwrap_or(0.0),
        speed_rad_s: speed_rad_s(speed_rpm, speed_rad)?,
    };
    let times = column("time_s", time_s, None)?;
    let pressures = column("pressure_kpa", pressure_kpa, Some(times.len()))?;
    let samples: Vec<_> = times
        .into_iter()
        .zip(pressures)
        .map(|(time_s, pressure_kpa)| PressureSample { time_s, pressure_kpa })
        .collect();
    answer(py, py.detach(|| identified_line(&pump.model, port, &samples, &turning, sought)))
}

fn answer(py: Python<'_>, found: Result<Identified, IdentificationError>) -> PyResult<Answer<'_>> {
    let found = found.map_err(|error| match error {
        IdentificationError::Model(error) => errors::model(error),
        _ => value(error),
    })?;
    let array = |number: fn(&pump_bench::export::Fitted) -> f64| {
        let array = PyArray1::from_iter(py, found.points.iter().map(number));
        array.try_readwrite()?.make_nonwriteable();
        PyResult::Ok(array)
    };
    Ok((
        found.json(),
        found.text(),
        Line(found.line),
        array(|point| point.x)?,
        array(|point| point.measured)?,
        array(|point| point.fitted)?,
    ))
}

fn port_named(port: &str) -> PyResult<Port> {
    match port {
        "inlet" => Ok(Port::Inlet),
        "outlet" => Ok(Port::Outlet),
        _ => Err(value(format_args!("port is '{port}'; allowed: 'inlet', 'outlet'"))),
    }
}

/// Numbers of shape (n,); as many as `count`, where there are others already.
fn column(name: &str, argument: &Bound<'_, PyAny>, count: Option<usize>) -> PyResult<Vec<f64>> {
    let (shape, values) = match Floats::extract(name, argument)? {
        Floats::Many { shape, values } => (shape, values),
        Floats::One(_) => (Vec::new(), Vec::new()),
    };
    if shape.len() != 1 || count.is_some_and(|count| shape[0] != count) {
        let allowed = count.map_or("(n,)".to_owned(), |count| format!("({count},)"));
        return Err(value(format_args!("{name} has the shape {shape:?}; allowed: {allowed}")));
    }
    Ok(values)
}
