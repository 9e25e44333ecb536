//! Doses that a balance ends.

use std::sync::Arc;

use pump_bench::balance::{self, BalanceError, BalanceReading};
use pump_bench::record::Purpose;
use pump_bench::units::{self, Amount};
use pump_bench::{
    DeliveredByWeight, DoseError, DoseReport, DoseRequest, OrderByWeight, PreparedByWeight, Session,
};
use pyo3::prelude::*;

use super::balance::{Balance, lock};
use super::bench::{Bench, call_off, find_angle_of_rest};
use super::request::AskedDose;
use super::worker::{Named, Signal};
use crate::argument::quantity;
use crate::python::advice;
use crate::python::errors;

/// Keywords of a dose by weight, read from a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct AskedByWeight<'py> {
    balance: Py<Balance>,
    max_volume: Option<Bound<'py, PyAny>>,
    slow_rate: Option<Bound<'py, PyAny>>,
    scale: Option<Bound<'py, PyAny>>,
}

impl AskedByWeight<'_> {
    /// Returns the order of a dose.
    fn order(&self, request: DoseRequest) -> PyResult<OrderByWeight> {
        let most_ml = self.max_volume.as_ref();
        let most_ml =
            most_ml.map(|most| quantity("max_volume", "27mL", most, units::volume_ml)).transpose()?;
        let slow = self.slow_rate.as_ref();
        let slow = slow.map(|slow| quantity("slow_rate", "0.5 mL/s", slow, units::rate)).transpose()?;
        let wait = self.balance.get().wait;
        Ok(OrderByWeight::new(request).with_most_ml(most_ml).with_slow(slow).with_longest(wait))
    }

    /// Returns the standard uncertainty of a reading, if it is given.
    fn scale(&self) -> PyResult<Option<Amount>> {
        let scale = self.scale.as_ref();
        scale.map(|scale| quantity("scale", "0.01g", scale, units::amount)).transpose()
    }
}

#[pymethods]
impl Bench {
    /// Plans a dose by weight from the record without moving. Returns the JSON of a dry run.
    fn prepare_by_weight(
        &self,
        py: Python<'_>,
        asked: AskedDose<'_>,
        by_weight: AskedByWeight<'_>,
    ) -> PyResult<String> {
        let order = by_weight.order(asked.request(Purpose::Dose, &self.weighing())?)?;
        by_weight.scale()?;
        let bench = &self.bench;
        let prepared =
            py.detach(|| bench.prepare_by_weight(&order)).map_err(|error| errors::dose(py, error))?;
        Ok(DoseReport::planned_by_weight(bench, &prepared).worded(advice::words).json())
    }

    /// Runs a dose that a balance ends. Returns the JSON of the command.
    #[pyo3(signature = (asked, by_weight, progress))]
    fn dose_by_weight(
        &self,
        py: Python<'_>,
        asked: AskedDose<'_>,
        by_weight: AskedByWeight<'_>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let order = by_weight.order(asked.request(Purpose::Dose, &self.weighing())?)?;
        self.weighed(py, &by_weight, progress, move |session, balance, signal| {
            if session.state().is_none_or(|state| state.unfinished.is_none()) {
                call_off(session, signal);
                session.follow_home_policy(|_| signal.flow())?;
            }
            let prepared = session.prepare_by_weight(&order)?;
            let tare = session.tare_by_weight(&prepared, balance)?;
            Ok((prepared, tare))
        })
    }

    /// Runs the rest of a dose that a balance was to end. Returns the JSON of the command.
    #[pyo3(signature = (asked, by_weight, progress))]
    fn resume_by_weight(
        &self,
        py: Python<'_>,
        asked: AskedDose<'_>,
        by_weight: AskedByWeight<'_>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let order = by_weight.order(asked.request(Purpose::Dose, &self.weighing())?)?;
        self.weighed(py, &by_weight, progress, move |session, balance, signal| {
            find_angle_of_rest(session, signal)?;
            session.prepare_rest_by_weight(&order, balance)
        })
    }
}

impl Bench {
    /// Runs what `prepare` plans from a reading of the balance at rest. Returns the JSON of the command.
    fn weighed(
        &self,
        py: Python<'_>,
        by_weight: &AskedByWeight<'_>,
        progress: Option<&Bound<'_, PyAny>>,
        prepare: impl FnOnce(
            &mut Session<'_>,
            &mut dyn balance::Balance,
            &Arc<Signal>,
        ) -> Result<(PreparedByWeight, BalanceReading), DoseError>
        + Send
        + 'static,
    ) -> PyResult<String> {
        let (scale, device) = (by_weight.scale()?, by_weight.balance.get().device()?);
        self.keep_last(None);
        self.warn_before(py, "dose")?;
        let (json, _) = self.worker.call(
            py,
            Named::Motion("dose"),
            progress,
            |(json, delivered): &(String, DeliveredByWeight)| {
                self.keep_last(Some(json));
                note(delivered)
            },
            move |held, signal| {
                let bench = held.bench;
                let session = held.session()?;
                let mut device = lock(&device);
                // The balance was open when the call began.
                let Some(balance) = device.as_mut() else { return Err(BalanceError::Stopped.into()) };
                let (prepared, tare) = prepare(session, balance.as_mut(), signal)?;
                call_off(session, signal);
                signal.plans(prepared.whole.plan.steps().unsigned_abs());
                let (mut before, mut last) = (0, 0);
                let delivered = session.run_from_tare(&prepared, tare, balance.as_mut(), |made| {
                    // Each stretch counts its own steps.
                    if made < last {
                        before += last;
                    }
                    last = made;
                    signal.made(before + made)
                })?;
                signal.ends(delivered.made);
                let difference_g = delivered.difference_standard_g(scale, bench.file());
                let report = DoseReport::by_weight(bench, &prepared, &delivered, difference_g);
                Ok((report.worded(advice::words).json(), delivered))
            },
        )?;
        self.keep_last(Some(&json));
        Ok(json)
    }
}

/// Returns the note on an interrupted caller's exception: the mass that was delivered.
fn note(delivered: &DeliveredByWeight) -> String {
    let DeliveredByWeight { mass_g, turned_ml, completed, .. } = *delivered;
    let made = format!("{mass_g:.3} g by the balance and {turned_ml:.4} mL by the model were delivered");
    match completed {
        true => format!("{made}, the whole dose"),
        false => format!(
            "{made} and are on record; bench.resume(until_scale=balance) makes the rest by weight, bench.resume() by \
             volume, bench.discard() accepts the dose as it is"
        ),
    }
}
