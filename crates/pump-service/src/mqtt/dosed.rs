//! The last dose of each pump, from the reports of orders.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::history::HistoryError;
use crate::service::Service;

/// Orders of a pump in which its last dose is looked for.
const LOOKED_THROUGH: u32 = 5;

/// Volumes of a dose, mL.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Volumes {
    pub(super) delivered_ml: f64,
    pub(super) asked_ml: f64,
}

/// Last dose of each pump, by the pump's name.
#[derive(Debug, Default)]
pub(super) struct Dosed(BTreeMap<String, Volumes>);

impl Dosed {
    /// Reads the last doses from the history.
    pub(super) fn of(service: &Service) -> Result<Self, HistoryError> {
        // A rack's orders are of no pump alone.
        let names = service.pumps().map(|pump| pump.name()).chain([""]);
        let read = names.map(|name| service.history().last_orders(Some(name), LOOKED_THROUGH));
        let mut orders = read.collect::<Result<Vec<_>, _>>()?.concat();
        orders.sort_by_key(|order| order.begun);
        let mut dosed = Self::default();
        for report in orders.iter().flat_map(|order| &order.reports) {
            dosed.take(service, report);
        }
        Ok(dosed)
    }

    /// Takes a report, if it is that of a dose that was made. Returns the name of its pump then.
    pub(super) fn take<'a>(&mut self, service: &'a Service, report: &Value) -> Option<&'a str> {
        let text = |key: &str| report.get(key).and_then(Value::as_str);
        let number = |key: &str| report.get(key).and_then(Value::as_f64);
        let is_dose = text("schema") == Some("dose/1") && text("purpose") == Some("dose");
        let volumes = Volumes { delivered_ml: number("delivered_ml")?, asked_ml: number("requested_ml")? };
        // A report names the id of its pump. A plan and a dry run have no time.
        let (id, _) = text("pump").zip(text("time")).filter(|_| is_dose)?;
        let pump = service.pumps().find(|pump| pump.bench().file().pump.id == id)?;
        self.0.insert(pump.name().to_owned(), volumes);
        Some(pump.name())
    }

    /// Returns the last dose of a pump.
    pub(super) fn last(&self, pump: &str) -> Option<Volumes> {
        self.0.get(pump).copied()
    }
}
