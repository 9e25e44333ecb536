//! The JSON of a sizing (`schema` `size/1`).

use serde::Serialize;
use serde_json::{Value, json};

use crate::simulation::SteadyReport;
use crate::sizing::{CurvePoint, SizedLine, Sizing};

/// A sizing as JSON.
#[derive(Serialize)]
struct SizeReport<'a> {
    schema: &'static str,
    pump: &'a str,
    rollers: u32,
    ml_per_rev: f64,
    /// Source of the head's figures; null for the pump of a file.
    source: Value,
    flow_ml_s: f64,
    speed_rpm: f64,
    least_rpm: Option<f64>,
    most_rpm: Option<f64>,
    expanded_uncertainty_percent: f64,
    fluid: Value,
    ambient_kpa: f64,
    inlet: Value,
    outlet: Value,
    method: &'static str,
    steady: SteadyReport,
    suction: Value,
    outlet_limit_kpa: Option<f64>,
    outlet_limit: Option<&'static str>,
    pulsation: Value,
    settle_s: f64,
    curve: Vec<Value>,
    others: &'a [String],
    unknown: &'a [&'static str],
    warnings: Vec<&'a str>,
}

/// Returns a sizing as one line of JSON. `docs/sizing.md` documents its keys.
pub fn sizing_json(sizing: &Sizing) -> String {
    let suction = &sizing.suction;
    let pulsation = &sizing.pulsation;
    let report = SizeReport {
        schema: "size/1",
        pump: &sizing.head.name,
        rollers: sizing.head.rollers,
        ml_per_rev: sizing.head.ml_per_rev,
        source: sizing.head.catalogued.as_ref().map_or(Value::Null, |head| {
            json!({
                "kind": head.source.kind.as_str(),
                "document": head.source.document,
                "table": head.source.table,
                "quoted_by": head.source.quoted_by,
                "published": head.published,
            })
        }),
        flow_ml_s: sizing.flow_ml_s,
        speed_rpm: sizing.speed_rpm,
        least_rpm: sizing.head.least_rpm,
        most_rpm: sizing.head.most_rpm,
        expanded_uncertainty_percent: 100.0 * sizing.expanded,
        fluid: json!({
            "name": sizing.fluid.name,
            "temperature_degc": sizing.fluid.temperature_degc,
            "density_kg_m3": sizing.fluid.density_kg_m3,
            "viscosity_mpa_s": sizing.viscosity_mpa_s,
            "vapour_kpa": suction.vapour_kpa,
        }),
        ambient_kpa: sizing.ambient_kpa,
        inlet: line(&sizing.inlet),
        outlet: line(&sizing.outlet),
        method: sizing.method,
        steady: sizing.steady,
        suction: json!({
            "npsh_m": suction.npsh_m,
            "npsh_mean_m": suction.npsh_mean_m,
            "collapse_kpa": suction.collapse_kpa,
            "hose_collapse_kpa": suction.hose_collapse_kpa,
            "limit_kpa": suction.limit_kpa,
            "margin_kpa": suction.margin_kpa,
            "own_kpa": suction.own_kpa,
        }),
        outlet_limit_kpa: sizing.largest.map(|most| most.kpa),
        outlet_limit: sizing.largest.map(|most| most.source.name()),
        pulsation: json!({
            "rollers_peak_to_peak": pulsation.rollers.peak_to_peak,
            "rollers_rms": pulsation.rollers.rms,
            "end_peak_to_peak": pulsation.end.map(|ripple| ripple.peak_to_peak),
            "end_rms": pulsation.end.map(|ripple| ripple.rms),
            "end_peak_to_peak_between": pulsation.end_between,
        }),
        settle_s: sizing.settle_s,
        curve: sizing.curve.iter().map(point).collect(),
        others: &sizing.others,
        unknown: &sizing.unknown,
        warnings: sizing.warnings.iter().map(|warning| warning.text()).collect(),
    };
    serde_json::to_string(&report).unwrap_or_else(|error| unreachable!("a report is plain data: {error}"))
}

fn line(line: &SizedLine) -> Value {
    json!({
        "bore_mm": line.hose.map(|hose| 2.0 * hose.bore_radius_mm),
        "outer_mm": line.hose.map(|hose| 2.0 * hose.outer_radius_mm),
        "length_mm": line.hose.map(|hose| hose.length_mm),
        "modulus_mpa": line.hose.map(|hose| hose.modulus_mpa),
        "minor_loss": line.hose.map(|hose| hose.minor_loss),
        "reynolds": line.reynolds,
        "law": line.law.map(|law| law.name()),
        "lift_mm": line.lift_mm,
        "lift_kpa": line.lift_kpa,
        "friction_kpa": line.friction_kpa,
        "resistance_kpa_s_ml": line.line.resistance_kpa_s_ml,
        "compliance_ml_kpa": line.line.compliance_ml_kpa,
        "inertance_kpa_s2_ml": line.line.inertance_kpa_s2_ml,
        "reservoir_kpa": line.line.reservoir_kpa,
    })
}

fn point(point: &CurvePoint) -> Value {
    json!({
        "speed_rpm": point.speed_rpm,
        "flow_ml_s": point.flow_ml_s,
        "inlet_min_kpa": point.inlet.min_kpa,
        "inlet_max_kpa": point.inlet.max_kpa,
        "inlet_mean_kpa": point.inlet_mean_kpa,
        "outlet_min_kpa": point.outlet.min_kpa,
        "outlet_max_kpa": point.outlet.max_kpa,
        "outlet_mean_kpa": point.outlet_mean_kpa,
    })
}
