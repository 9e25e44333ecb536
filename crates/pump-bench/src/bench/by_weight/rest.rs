//! The rest of a dose by weight: the balance goes on where an earlier command left it.
//!
//! The record has what the balance showed before the dose. As long as the vessel stands on it untouched, its reading
//! tells what has arrived, also after a kill. A reading that no pump of this model explains is refused.

use super::begun::BegunByWeight;
use super::course::Course;
use super::prepared::{OrderByWeight, PreparedByWeight, known_unsure_ml};
use crate::balance::{Balance, BalanceReading};
use crate::bench::bench::Bench;
use crate::bench::session::Session;
use crate::dosing::{DoseError, DoseRequest, NoRestByWeight, Prepared};
use crate::pump_file::PumpFile;
use crate::record::{PumpState, Purpose, Unfinished, WeighingTerms};

impl Session<'_> {
    /// Reads the balance, and plans the rest of an unfinished dose that a balance was to end. Moves nothing.
    ///
    /// The vessel stands on the balance as the dose left it. The request of `order` fills what is to be other than in
    /// the dose: cruise and limits. [`Self::run_from_tare`] makes the rest from the reading.
    ///
    /// # Errors
    ///
    /// [`DoseError::NothingUnfinished`] if no dose is unfinished. [`DoseError::NoRestByWeight`] if no balance was to
    /// end it, or the balance does not show what the pump can have delivered. [`DoseError::Balance`] if the balance
    /// cannot be read. Other [`DoseError`]s if the device cannot be used or the rest cannot be planned.
    pub fn prepare_rest_by_weight(
        &mut self,
        order: &OrderByWeight,
        balance: &mut dyn Balance,
    ) -> Result<(PreparedByWeight, BalanceReading), DoseError> {
        self.begun_by_weight()?;
        self.check_stand()?;
        self.check_confirmed()?;
        self.connect()?;
        let (dose, weighing) = self.begun_by_weight()?;
        let reading = self.reading_at_rest(balance, order.longest)?;
        let least_rad_s = self.speed_range_rad_s().0;
        let rest = Rest { dose, weighing, state: self.stands(), order: *order, reading };
        let (mut found, slow) = self.bench.plan_rest_by_weight(self.file(), &rest, least_rad_s)?;
        found.whole = self.checked(found.whole)?;
        self.checked(slow)?;
        let course = Course::begin(&found, reading, None);
        if course.next().is_err() {
            let (turned_ml, most_ml) = (course.whole_turned_ml(), found.most_ml);
            return Err(DoseError::NoRestByWeight(NoRestByWeight::Ceiling { turned_ml, most_ml }));
        }
        self.keep_safe(found.most_ml - course.whole_turned_ml())?;
        Ok((found, reading))
    }

    /// Returns the unfinished dose and its terms, if a balance was to end it.
    fn begun_by_weight(&self) -> Result<(Unfinished, WeighingTerms), DoseError> {
        let nothing = match self.finished_by_device {
            Some(_) => DoseError::WasFinished,
            None => DoseError::NothingUnfinished("resume"),
        };
        let dose = self.stands().unfinished.ok_or(nothing)?;
        let terms = dose.intent.terms;
        let why = if terms.by_weight { NoRestByWeight::NoTare } else { NoRestByWeight::ByVolume };
        let weighing = terms.weighing.filter(|_| terms.by_weight);
        Ok((dose, weighing.ok_or(DoseError::NoRestByWeight(why))?))
    }
}

/// Unfinished dose by weight, and what the balance shows of it.
struct Rest {
    dose: Unfinished,
    weighing: WeighingTerms,
    state: PumpState,
    order: OrderByWeight,
    reading: BalanceReading,
}

impl Bench {
    /// Plans the rest of a dose by weight, once the reading is one that the pump can have brought about.
    fn plan_rest_by_weight(
        &self,
        file: &PumpFile,
        rest: &Rest,
        least_rad_s: f64,
    ) -> Result<(PreparedByWeight, Prepared), DoseError> {
        let Rest { dose, weighing, reading, .. } = rest;
        let intent = &dose.intent;
        let request = DoseRequest {
            purpose: Purpose::Dose,
            volume_ml: intent.whole_requested_ml(),
            asked: intent.told.and_then(|told| told.asked),
            ..rest.order.request.for_rest(&intent.terms)
        };
        let state = PumpState { unfinished: None, account: None, ..rest.state };
        let begun = BegunByWeight {
            tare_g: weighing.tare_g,
            shown_g: reading.mass_g,
            target_g: weighing.target_g,
            most_ml: weighing.most_ml,
            turned_ml: dose.booked_ml(self.model()),
        };
        let order = OrderByWeight { request, ..rest.order };
        let (found, slow) = self.plan_by_weight(file, Some(state), &order, Some(begun), least_rad_s)?;
        let whole = self.plan_from(file, Some(state.without_carry()), request, None)?;
        self.check_load(dose, &begun, &found, known_unsure_ml(file, &whole), reading.step_g)?;
        Ok((found, slow))
    }

    /// Refuses a reading that no pump of this model explains, twice its uncertainty being allowed.
    fn check_load(
        &self,
        dose: &Unfinished,
        begun: &BegunByWeight,
        found: &PreparedByWeight,
        unsure_ml: f64,
        digit_g: f64,
    ) -> Result<(), DoseError> {
        let (turned_least_ml, turned_most_ml) = dose.delivered_ml(self.model());
        // A drop may hang at the beginning and another at the end.
        let allowed_ml = 2.0 * unsure_ml + 2.0 * found.whole.drop_ml;
        let shows_g = |ml: f64| begun.tare_g + ml / found.z_ml_g;
        let least_g = shows_g((turned_least_ml - allowed_ml).max(0.0)) - 10.0 * digit_g;
        let most_g = shows_g(turned_most_ml + allowed_ml) + 10.0 * digit_g;
        if (least_g..=most_g).contains(&begun.shown_g) {
            return Ok(());
        }
        Err(DoseError::NoRestByWeight(NoRestByWeight::OtherLoad {
            shown_g: begun.shown_g,
            tare_g: begun.tare_g,
            least_g,
            most_g,
            digit_g,
        }))
    }
}
