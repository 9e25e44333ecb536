//! Tables of measurements as CSV, from which lines are identified.

use pump_model::Port;
use pump_model::identification::{FlowPoint, InjectionPoint, PressureSample};

use crate::export::TRACE_HEADER;
use crate::files::{Row, Table, TableError};

/// Columns of a run's table of `pumpmodel` that a trace names otherwise.
const OF_PUMPMODEL: [&str; 4] = ["inlet_flow_ml_s", "outlet_flow_ml_s", "inlet_kpa", "outlet_kpa"];

/// Returns the columns of the pressure at a port, in kPa absolute: that of a trace, and that of a table which
/// `pumpmodel` wrote.
fn pressure_columns(port: Port) -> [&'static str; 2] {
    match port {
        Port::Inlet => ["p_in_kpa", "inlet_kpa"],
        Port::Outlet => ["p_out_kpa", "outlet_kpa"],
    }
}

/// Reads steady flows and their pressure drops.
///
/// The column `flow_ml_s` has the flow. The drop over the line stands in `drop_kpa`, or else the absolute
/// pressure at the pump stands in the port's `p_in_kpa` or `p_out_kpa`, which may be named `inlet_kpa` and
/// `outlet_kpa` too. An optional `standard_kpa` has the standard uncertainty of the pressure.
///
/// # Errors
/// Returns the [`TableError`] of the first line that cannot be used.
pub fn flow_points_of_csv(text: &str, port: Port, reservoir_kpa: f64) -> Result<Vec<FlowPoint>, TableError> {
    let [at_pump, at_port] = pressure_columns(port);
    let table = Table::parse(text, &["flow_ml_s", "drop_kpa", at_pump, at_port, "standard_kpa"])?;
    // The drop is along the flow: towards the pump at the inlet, away from it at the outlet.
    let sign = match port {
        Port::Inlet => -1.0,
        Port::Outlet => 1.0,
    };
    let point = |row: Row<'_>| {
        let (_, kpa, is_drop) = row.one_of([("drop_kpa", true), (at_pump, false), (at_port, false)])?;
        let standard_kpa = match row.number("standard_kpa")? {
            Some(_) => row.positive("standard_kpa")?,
            None => 1.0,
        };
        let drop_kpa = if is_drop { kpa } else { sign * (kpa - reservoir_kpa) };
        Ok(FlowPoint { flow_ml_s: row.required("flow_ml_s")?, drop_kpa, standard_kpa })
    };
    table.rows().map(point).collect()
}

/// Reads an injection into the closed line of a port.
///
/// The column `volume_ml` has the injected volume. The pressure stands in `pressure_kpa` or in the port's
/// `p_in_kpa` or `p_out_kpa`, which may be named `inlet_kpa` and `outlet_kpa` too.
///
/// # Errors
/// Returns the [`TableError`] of the first line that cannot be used.
pub fn injection_of_csv(text: &str, port: Port) -> Result<Vec<InjectionPoint>, TableError> {
    let [at_pump, at_port] = pressure_columns(port);
    let table = Table::parse(text, &["volume_ml", "pressure_kpa", at_pump, at_port])?;
    let point = |row: Row<'_>| {
        let (_, pressure_kpa, ()) = row.one_of([("pressure_kpa", ()), (at_pump, ()), (at_port, ())])?;
        Ok(InjectionPoint { volume_ml: row.required("volume_ml")?, pressure_kpa })
    };
    table.rows().map(point).collect()
}

/// Waveforms of the pressure at inlet and outlet. Either may be missing.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Waveforms {
    /// Samples of the inlet. Empty if the table has no such column.
    pub inlet: Vec<PressureSample>,
    /// Samples of the outlet. Empty if the table has no such column.
    pub outlet: Vec<PressureSample>,
}

/// Reads waveforms of the absolute pressure: `time_s`, which rises, and `p_in_kpa`, `p_out_kpa` or both.
///
/// The pressures may be named `inlet_kpa` and `outlet_kpa` too. The other columns of a trace, or of a run's table of
/// `pumpmodel`, may stand beside them. They are ignored.
///
/// # Errors
/// Returns the [`TableError`] of the first line that cannot be used.
pub fn waveforms_of_csv(text: &str) -> Result<Waveforms, TableError> {
    let known: Vec<&str> = TRACE_HEADER.split(',').chain(OF_PUMPMODEL).collect();
    let table = Table::parse(text, &known)?;
    let mut last_s = f64::NEG_INFINITY;
    let mut waveforms = Waveforms::default();
    for row in table.rows() {
        let time_s = row.required("time_s")?;
        if time_s <= last_s {
            return Err(row.error(format!("time_s is {time_s} after {last_s}; times must rise")));
        }
        last_s = time_s;
        let mut given = false;
        for (port, samples) in [(Port::Inlet, &mut waveforms.inlet), (Port::Outlet, &mut waveforms.outlet)] {
            let [at_pump, at_port] = pressure_columns(port);
            let column = match (table.has(at_pump), table.has(at_port)) {
                (false, false) => continue,
                (true, false) => at_pump,
                (false, true) => at_port,
                (true, true) => {
                    return Err(row.error(format!("{at_pump} and {at_port} are both given; give one")));
                }
            };
            given = true;
            samples.push(PressureSample { time_s, pressure_kpa: row.required(column)? });
        }
        if !given {
            return Err(row.error("give p_in_kpa, p_out_kpa or both".to_owned()));
        }
    }
    Ok(waveforms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressures_at_the_pump_become_drops_along_the_flow() {
        let columns = "drop_kpa,standard_kpa\n10,87.637,,\n10,,1,0.5\n-10,89.637,,\n";
        let points = |port, column, text: &str| {
            flow_points_of_csv(&format!("flow_ml_s,{column},{text}"), port, 88.637).unwrap()
        };
        let inlet = points(Port::Inlet, "p_in_kpa", columns);
        let mirrored = columns.replace("87.637", "x").replace("89.637", "87.637").replace('x', "89.637");
        let outlet = points(Port::Outlet, "p_out_kpa", &mirrored);
        for points in [inlet, outlet] {
            for (point, sign) in points.iter().zip([1.0, 1.0, -1.0]) {
                assert!((point.drop_kpa - sign).abs() < 1e-12 && point.flow_ml_s == 10.0 * sign, "{point:?}");
            }
            assert_eq!(points.iter().map(|point| point.standard_kpa).collect::<Vec<_>>(), [1.0, 0.5, 1.0]);
        }
    }

    #[test]
    fn a_trace_is_a_waveform_of_both_ports() {
        let text = format!("{TRACE_HEADER}\n0,0,0,0,0,88,89,0\n0.001,0,0,0,0,88.5,89.5,0\n");
        let waveforms = waveforms_of_csv(&text).unwrap();
        let at = |time_s, pressure_kpa| PressureSample { time_s, pressure_kpa };
        assert_eq!(waveforms.inlet, [at(0.0, 88.0), at(0.001, 88.5)]);
        assert_eq!(waveforms.outlet, [at(0.0, 89.0), at(0.001, 89.5)]);
        let outlet = waveforms_of_csv("time_s,p_out_kpa\n0,89\n").unwrap();
        assert_eq!((outlet.inlet.len(), outlet.outlet.len()), (0, 1));
    }

    #[test]
    fn a_table_of_pumpmodel_is_read_as_a_trace_is() {
        let header =
            "time_s,angle_rad,speed_rad_s,inlet_flow_ml_s,outlet_flow_ml_s,inlet_kpa,outlet_kpa,delivered_ml";
        let numbers = "0,0,0,0,0,88,89,0\n0.001,0,0,0,0,88.5,89.5,0\n";
        let of = |header| waveforms_of_csv(&format!("{header}\n{numbers}")).unwrap();
        assert_eq!(of(header), of(TRACE_HEADER));
        let flows =
            |column| flow_points_of_csv(&format!("flow_ml_s,{column}\n1,88\n"), Port::Inlet, 88.637).unwrap();
        assert_eq!(flows("inlet_kpa"), flows("p_in_kpa"));
        let injected =
            |column| injection_of_csv(&format!("volume_ml,{column}\n1,88\n"), Port::Outlet).unwrap();
        assert_eq!(injected("outlet_kpa"), injected("p_out_kpa"));
    }

    #[test]
    fn what_is_refused_is_named_with_its_line() {
        let flow = |text| flow_points_of_csv(text, Port::Inlet, 88.637).unwrap_err().to_string();
        let injection = |text| injection_of_csv(text, Port::Outlet).unwrap_err().to_string();
        let waveform = |text| waveforms_of_csv(text).unwrap_err().to_string();
        for (said, part) in [
            (flow("flow,drop_kpa\n1,1\n"), "line 1: unknown column `flow`"),
            (flow("flow_ml_s,drop_kpa\n1,1\n2,x\n"), "line 3: drop_kpa is `x`"),
            (flow("flow_ml_s,drop_kpa,p_in_kpa\n1,1,88\n"), "line 2: give one of drop_kpa, p_in_kpa"),
            (
                flow("flow_ml_s,p_out_kpa\n1,1\n"),
                "line 1: unknown column `p_out_kpa`; known: flow_ml_s, drop_kpa, p_in_kpa",
            ),
            (flow("flow_ml_s,drop_kpa\n,1\n"), "line 2: flow_ml_s is missing"),
            (flow("flow_ml_s,drop_kpa,standard_kpa\n1,1,0\n"), "line 2: standard_kpa is 0"),
            (injection("volume_ml\n1\n"), "line 2: give one of pressure_kpa"),
            (injection("volume_ml,pressure_kpa\n1,1\n\n# a comment\n2\n"), "line 5: 1 cells under 2 columns"),
            (waveform("time_s\n0\n"), "line 2: give p_in_kpa, p_out_kpa or both"),
            (waveform("time_s,p_out_kpa\n0,88\n0,89\n"), "line 3: time_s is 0 after 0"),
            (waveform("time_s,p_out_kpa\n0,\n"), "line 2: p_out_kpa is missing"),
            (waveform("time_s,p_out_kpa,outlet_kpa\n0,88,88\n"), "p_out_kpa and outlet_kpa are both given"),
            (waveform("time_ms,p_out_kpa\n0,88\n"), "unknown column `time_ms`"),
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
}
