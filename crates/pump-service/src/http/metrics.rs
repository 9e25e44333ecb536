//! Numbers for Prometheus and the like.

use std::fmt::Write;

use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;

use super::shared::Shared;
use crate::service::PumpView;

/// A number of each pump: its name, its type, its help, and its value.
type Metric = (&'static str, &'static str, &'static str, Vec<(String, f64)>);

/// The state of each pump in numbers.
#[utoipa::path(get, path = "/metrics", tag = "events",
    responses((status = 200, description = "Prometheus exposition format 0.0.4", content_type = "text/plain")))]
pub(super) async fn metrics(State(shared): State<Shared>) -> impl IntoResponse {
    let service = &shared.service;
    let views: Vec<_> = service.pumps().map(|pump| service.view(pump)).collect();
    let is = |so: fn(&PumpView) -> bool| {
        views.iter().map(|view| (view.name.clone(), f64::from(u8::from(so(view))))).collect()
    };
    let stands = service.pumps().zip(&views).filter_map(|(pump, view)| {
        let is_on_record = view.status.as_ref()?.safety.stand.is_some();
        Some((view.name.clone(), f64::from(u8::from(is_on_record || service.is_kept_still(pump)))))
    });
    let mut metrics: Vec<Metric> = vec![
        (
            "dose_pump_readable",
            "gauge",
            "1 if the record of the pump can be read.",
            is(|view| view.error.is_none()),
        ),
        (
            "dose_pump_ordered",
            "gauge",
            "1 while the pump carries out an order.",
            is(|view| view.order.is_some()),
        ),
        (
            "dose_pump_silent",
            "gauge",
            "1 while the process of an order is silent although its motor turned.",
            is(|view| view.silent_since.is_some()),
        ),
        (
            "dose_tube_volume_ml_total",
            "counter",
            "Most that the tube may have pumped, in mL. It never falls: after a stop it waits for the record.",
            service.pumps().map(|pump| (pump.name().to_owned(), pump.tube_ml())).collect(),
        ),
        (
            "dose_stands",
            "gauge",
            "1 if the pump stands at a safety limit or by order, or the guard holds it.",
            stands.collect(),
        ),
    ];
    metrics.extend(of_records(&views));
    let mut text = String::new();
    for (name, kind, help, values) in metrics {
        let _ = write!(text, "# HELP {name} {help}\n# TYPE {name} {kind}\n");
        for (pump, value) in values {
            let pump = pump.replace('\\', "\\\\").replace('"', "\\\"");
            let _ = writeln!(text, "{name}{{pump=\"{pump}\"}} {value}");
        }
    }
    ([(CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")], text)
}

/// Returns the numbers of the pumps' records.
fn of_records(views: &[PumpView]) -> [Metric; 6] {
    let of = |value: fn(&pump_bench::report::Status) -> f64| {
        let values = views.iter().filter_map(|view| Some((view.name.clone(), value(view.status.as_ref()?))));
        values.collect()
    };
    [
        (
            "dose_day_ml",
            "gauge",
            "Volume that the limit of 24 hours counts by now, in mL.",
            of(|status| status.safety.day_ml),
        ),
        (
            "dose_received_ml",
            "gauge",
            "Volume that the vessel has received since it was emptied, in mL.",
            of(|status| status.safety.received_ml),
        ),
        (
            "dose_under_way_ml",
            "gauge",
            "Volume that the motion under way will still pump at most, in mL.",
            of(|status| status.safety.under_way_ml),
        ),
        ("dose_carry_ml", "gauge", "Volume that the next dose owes, in mL.", of(|status| status.carry_ml)),
        (
            "dose_angle_known",
            "gauge",
            "1 if the rollers' angle is known.",
            of(|status| f64::from(u8::from(status.angle_known))),
        ),
        (
            "dose_unfinished",
            "gauge",
            "1 if a dose is unfinished.",
            of(|status| f64::from(u8::from(status.unfinished.is_some()))),
        ),
    ]
}
