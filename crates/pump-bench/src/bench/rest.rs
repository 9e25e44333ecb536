//! The rest of an unfinished dose.

use pump_ctl::plan::{Finish, Phase};

use super::bench::Bench;
use super::session::Session;
use crate::dosing::{DoseError, DoseRequest, Prepared, Stands, Swept};
use crate::notice::{Notice, Remedy};
use crate::numbers::{between, significant};
use crate::pump_file::PumpFile;
use crate::record::{Account, Intent, PhaseSource, PumpState, Purpose, Unfinished, Whole};

impl Session<'_> {
    /// Plans the rest of the unfinished dose on the terms of the whole dose, in what `request` leaves open:
    /// cruise, finish and limits. A smooth flow stays smooth unless the request names a speed.
    ///
    /// The rest leads to the planned end if the delivered volume is known, and to the most probable one
    /// otherwise. If the device has finished the dose since, the rest is the retraction after the dose.
    ///
    /// # Errors
    ///
    /// [`DoseError::NothingUnfinished`] if no dose is unfinished. [`DoseError::WasFinished`] if the device
    /// has finished the dose since, and nothing is to be sucked back. Other [`DoseError`]s if the device
    /// cannot be used or the rest cannot be planned.
    pub fn prepare_rest(&mut self, request: DoseRequest) -> Result<Prepared, DoseError> {
        if self.stands().unfinished.or(self.finished_by_device).is_none() {
            return Err(DoseError::NothingUnfinished("resume"));
        }
        self.check_stand()?;
        self.check_confirmed()?;
        self.connect()?;
        let state = self.stands();
        match (state.unfinished, self.finished_by_device) {
            (Some(dose), _) => {
                let prepared = self.bench.plan_rest(self.file(), &dose, state, request)?;
                self.keep_safe(prepared.plan.planned_ml())?;
                self.checked(prepared)
            }
            (None, Some(dose)) => self.prepare_suck_back(&dose, state, request),
            (None, None) => Err(DoseError::WasFinished),
        }
    }

    /// Plans the retraction after a dose that the device finished by itself.
    fn prepare_suck_back(
        &mut self,
        dose: &Unfinished,
        state: PumpState,
        request: DoseRequest,
    ) -> Result<Prepared, DoseError> {
        let Some(retract_ml) = dose.intent.retract_ml else { return Err(DoseError::WasFinished) };
        let request = DoseRequest {
            purpose: Purpose::Retract,
            volume_ml: -retract_ml,
            asked: None,
            smooth: false,
            finish: None,
            ..request.for_rest(&dose.intent.terms)
        };
        let mut prepared = self.bench.plan_from(self.file(), Some(state), request, None)?;
        prepared.warnings.push(
            "the device has finished the dose that was cut off: it is on record as done, and the volume to suck \
             back is left to make"
                .into(),
        );
        self.checked(prepared)
    }

    /// Returns the whole dose of which `prepared` makes the rest. `None` if it makes no rest.
    pub(super) fn whole_of_rest(&self, prepared: &Prepared) -> Option<Whole> {
        let dose = self.stands().unfinished.filter(|_| prepared.request.whole_ml.is_some())?;
        Some(self.bench.whole_before(&dose, prepared))
    }
}

impl Bench {
    /// Refuses unless the unfinished dose is the named one: by its number in the log, or by the order of a service that
    /// made it or its last part. The caller holds the pump's lock, so that no other dose comes after the check.
    ///
    /// # Errors
    ///
    /// [`DoseError::NotUnfinished`] if another dose is unfinished, or none, and [`DoseError::Journal`] where the record
    /// cannot be read.
    pub fn check_is_unfinished(&self, dose: &str) -> Result<(), DoseError> {
        let open = self.story()?.state.and_then(|state| state.unfinished).map(|open| open.intent);
        let told = open.and_then(|intent| intent.told);
        let is_it = told.is_some_and(|told| {
            told.number.to_string() == dose || told.order.is_some_and(|order| order.as_str() == dose)
        });
        if is_it {
            return Ok(());
        }
        let now = open.map_or_else(
            || "no dose is".to_owned(),
            |intent| {
                let number = told.map_or(String::new(), |told| format!(" {}", told.number));
                format!("dose{number} of {} mL is", significant(intent.whole_requested_ml(), 6))
            },
        );
        Err(DoseError::NotUnfinished { dose: dose.to_owned(), now })
    }

    /// Plans the rest of the unfinished dose from the record, as [`Session::prepare_rest`] does. Moves and writes
    /// nothing, and does not ask the device.
    ///
    /// The device of a dose that was cut off may know the exact steps, and [`Session::prepare_rest`] asks it first.
    /// Where the bounds on record allow no plan, the rest is planned as if the device told the middle of them, with a
    /// warning.
    ///
    /// # Errors
    ///
    /// [`DoseError::NothingUnfinished`] if no dose is unfinished. [`DoseError::Folder`] if another process moves the
    /// pump. Other [`DoseError`]s if the rest cannot be planned.
    pub fn prepare_rest(&self, request: DoseRequest) -> Result<Prepared, DoseError> {
        let unfinished = self.state_to_plan_from()?.and_then(|state| Some((state, state.unfinished?)));
        let (state, dose) = unfinished.ok_or(DoseError::NothingUnfinished("resume"))?;
        let file = self.file_for_dry_run()?;
        let counted = self.as_counted(&state, &dose)?;
        let by_record = self.plan_rest(&file, &dose, state, request);
        let (mut prepared, is_of_record) = match (by_record, counted) {
            (Ok(prepared), _) => (prepared, true),
            (Err(refused), Some((state, counted))) => {
                let mut planned = self.plan_rest(&file, &counted, state, request).map_err(|_| refused)?;
                // The count is a guess, and the range of the whole dose is that of the record.
                let of_guess = self.unsure_rest(&counted, &planned);
                planned.warnings.retain(|warning| Some(warning) != of_guess.as_ref());
                planned.warnings.extend(self.unsure_rest(&dose, &planned));
                (planned, false)
            }
            (Err(refused), None) => return Err(refused),
        };
        self.would_be_safe(Some(&state), prepared.plan.planned_ml())?;
        let asks_first = counted.map(|(_, counted)| self.asks_first(&dose, &counted, is_of_record));
        prepared.warnings.extend(asks_first);
        prepared.warnings.extend(self.changes_on_record()?);
        prepared.warnings.extend(self.device_not_asked());
        prepared.warnings.extend(self.confirmation_missing(Some(&state)));
        Ok(prepared)
    }

    /// Returns the state and the unfinished dose as they are if the device, which is met before the rest, tells that it
    /// made the middle of the steps on record. `None` if no device can tell more than the record.
    fn as_counted(
        &self,
        state: &PumpState,
        dose: &Unfinished,
    ) -> Result<Option<(PumpState, Unfinished)>, DoseError> {
        if dose.made_least >= dose.made_most || !self.identity().abilities.readback {
            return Ok(None);
        }
        let made = i64::midpoint(dose.made_least, dose.made_most).min(dose.intent.steps.abs() - 1);
        let counted = match self.story()?.cut_off {
            Some((before, part)) => {
                before.count.map(|_| before.after(&part.intent, made, made, self.model()))
            }
            None => dose.count_before.map(|_| state.recounted(dose, made, self.fall_rad(), self.model())),
        };
        Ok(counted.and_then(|state| Some((state, state.unfinished?))))
    }

    /// Tells that the rest of `dose` begins with a question to the device, whose answer is nearer to the truth than the
    /// record. The plan is that of the record, or of the dose as `counted`.
    fn asks_first(&self, dose: &Unfinished, counted: &Unfinished, is_of_record: bool) -> Notice {
        let asks =
            "the rest first asks the board, which knows the exact steps and the angle unless it was reset";
        if is_of_record {
            return format!("{asks}; this plan is by the record alone").into();
        }
        let (least_ml, most_ml) = dose.delivered_ml(self.model());
        let middle_ml = significant(counted.booked_ml(self.model()), 4);
        let record = between(least_ml, most_ml);
        Notice::from(format!(
            "{asks}; the record has {record} delivered, and this plan takes {middle_ml} mL; after a reset the rest is \
             refused until the angle is found",
        ))
    }

    /// Plans the rest of `dose` with the pump file as the device allows it.
    fn plan_rest(
        &self,
        file: &PumpFile,
        dose: &Unfinished,
        state: PumpState,
        request: DoseRequest,
    ) -> Result<Prepared, DoseError> {
        let (intent, model) = (&dose.intent, self.model());
        if intent.terms.profile {
            let (least_ml, most_ml) = dose.delivered_ml(model);
            return Err(DoseError::NoRestOfProfile { least_ml, most_ml });
        }
        let request = request.for_rest(&intent.terms);
        let carry_ml = if intent.purpose == Purpose::Dose { intent.carry_in_ml } else { state.carry_ml };
        let (requested_ml, booked_ml) = (intent.whole_requested_ml(), dose.booked_ml(model));
        let rest = DoseRequest {
            purpose: intent.purpose,
            volume_ml: requested_ml - booked_ml,
            whole_ml: Some(requested_ml),
            asked: intent.told.and_then(|told| told.asked),
            retract_ml: intent.retract_ml,
            ..request
        };
        // A dose that was to end at low flow may end elsewhere if the request says so.
        let elsewhere = intent.terms.low_flow && request.finish == Some(Finish::Any);
        // The announced steps of a dose by weight lead to the most that may be delivered, and no balance is asked now.
        let elsewhere = elsewhere || intent.terms.by_weight;
        let settled_ml = if intent.purpose == Purpose::Dose { carry_ml } else { 0.0 };
        if elsewhere && (rest.volume_ml + settled_ml) * intent.steps as f64 <= 0.0 {
            if intent.terms.by_weight {
                let (least_ml, most_ml) = dose.delivered_ml(model);
                return Err(DoseError::NoRest { requested_ml, least_ml, most_ml });
            }
            return Err(DoseError::BeyondRequest { requested_ml, delivered_ml: booked_ml });
        }
        let to_end_ml = (!elsewhere).then(|| intent.planned_ml - dose.motion_booked_ml(model));
        if to_end_ml.is_some_and(|to_end_ml| to_end_ml * intent.steps as f64 <= 0.0) {
            let (least_ml, most_ml) = dose.delivered_ml(model);
            return Err(DoseError::NoRest { requested_ml, least_ml, most_ml });
        }
        let state = PumpState { unfinished: None, carry_ml, ..state };
        let mut prepared = self.plan_from(file, Some(state), rest, to_end_ml).map_err(DoseError::of_rest)?;
        // The dose stays on record while its angle is said.
        for warning in &mut prepared.warnings {
            warning.swap_remedy(Remedy::TurnAndSayAngle, Remedy::FindAngleOfUnfinished);
        }
        prepared.warnings.extend(searched(dose));
        prepared.warnings.extend(self.unsure_rest(dose, &prepared));
        if intent.terms.until_stopped {
            prepared.warnings.push("the rest of a run goes on until it is stopped, as the run did".into());
        }
        if intent.terms.by_weight {
            let text = format!(
                "a balance was to end this dose; its rest is made by volume, up to {} mL by the model",
                significant(requested_ml, 6)
            );
            prepared.warnings.push(Notice::from(text).with_remedy(Remedy::AcceptAndWeigh));
        }
        Ok(prepared)
    }

    /// Plans the motion of `intent` anew, as it was announced. `None` if it cannot be planned so: it followed a flow
    /// over time, which is not on record, or the pump file or the calibration has changed since.
    pub(super) fn planned_anew(&self, file: &PumpFile, intent: &Intent) -> Option<Prepared> {
        if intent.terms.profile {
            return None;
        }
        let stored = self.calibrations().active().ok()?;
        let account = intent.turned.map(|turned| Account { turned, correction: intent.correction });
        let open_ml = account.map_or(0.0, |account| account.half_width_ml(self.model()));
        let request = DoseRequest {
            purpose: intent.purpose,
            whole_ml: intent.whole.map(|whole| whole.requested_ml),
            ..DoseRequest::dose(intent.requested_ml).for_rest(&intent.terms)
        };
        let stands = Stands {
            carry_half_width_ml: (intent.carry_in_half_width_ml - open_ml).max(0.0),
            account,
            to_end_ml: intent.whole.map(|_| intent.planned_ml),
            ..Stands::at(intent.start(), PhaseSource::Given, intent.carry_in_ml)
        };
        let prepared = Prepared::standing(file, self.model(), stored.as_ref(), request, stands).ok()?;
        let is_same = prepared.plan.steps() == intent.steps && prepared.correction() == intent.correction;
        is_same.then_some(prepared)
    }

    /// Warns of a rest after a part whose volume is known within bounds only.
    fn unsure_rest(&self, dose: &Unfinished, prepared: &Prepared) -> Option<Notice> {
        let model = self.model();
        let (least_ml, most_ml) = dose.delivered_ml(model);
        if dose.intent.terms.until_stopped {
            let text = format!("{} of this run were delivered before", between(least_ml, most_ml));
            return Some(Notice::from(text));
        }
        if most_ml - least_ml <= prepared.plan.end_step_ml(&prepared.model) {
            return None;
        }
        let pump_ml = self.pump_unsure_ml(dose, prepared);
        let whole = self.whole_before(dose, prepared);
        let turn_rad = prepared.plan.end_angle_rad() - prepared.plan.start().angle_rad();
        let turned = whole.turned.by(turn_rad, turn_rad);
        let range_ml = Account { turned, correction: prepared.correction() }.range_ml(model);
        let (least_all_ml, most_all_ml) =
            (whole.least_ml + range_ml.0 - pump_ml, whole.most_ml + range_ml.1 + pump_ml);
        // A dose delivers nothing the other way.
        let (least_all_ml, most_all_ml) = match whole.requested_ml > 0.0 {
            true => (least_all_ml.max(0.0), most_all_ml),
            false => (least_all_ml, most_all_ml.min(0.0)),
        };
        let text = format!(
            "{} of the {} mL asked for were delivered before, by the model; with this rest it comes to {} \
             in all, the pump's own ± {} mL (k = 2) included",
            between(least_ml, most_ml),
            significant(whole.requested_ml, 6),
            between(least_all_ml, most_all_ml),
            significant(pump_ml, 2),
        );
        Some(Notice::from(text).with_remedy(Remedy::AcceptInstead))
    }

    /// Returns the expanded uncertainty of the whole dose, in mL, that comes from the pump and not from the angle or
    /// the steps: its parts are as far off as each other.
    fn pump_unsure_ml(&self, dose: &Unfinished, prepared: &Prepared) -> f64 {
        let (model, plan) = (&prepared.model, &prepared.plan);
        let volume_ml = dose.booked_ml(self.model()) + plan.planned_ml();
        // The dose's own turn, back from its end.
        let turn_rad = volume_ml * model.pitch_rad() / model.outlet_curve().pitch_ml();
        let start = Phase::known(plan.end_angle_rad() - turn_rad);
        let range_ml = (volume_ml, volume_ml);
        let whole = Swept { start, volume_ml, range_ml, ..Swept::whole(model, plan) };
        prepared.budget(self.file(), &whole, prepared.back_flow.backflow_ml).expanded_ml()
    }

    /// Returns the unfinished dose as the whole of which `prepared` makes the rest.
    fn whole_before(&self, dose: &Unfinished, prepared: &Prepared) -> Whole {
        dose.whole_for_rest(self.model(), prepared.plan.start(), prepared.correction())
    }
}

/// Tells the volume that turns to find the angle pumped since the dose was stopped, which the rest does not make up
/// for.
fn searched(dose: &Unfinished) -> Option<Notice> {
    let searched_ml = Some(dose.searched_ml()).filter(|ml| *ml != 0.0)?;
    let text = Notice::from(format!(
        "turns to find the angle pumped {} mL while this dose was unfinished, which count as not delivered: if they \
         got into the vessel, it will hold as much more than {} mL",
        significant(searched_ml, 3),
        significant(dose.intent.whole_requested_ml(), 6),
    ));
    Some(text.with_remedy(Remedy::AcceptInstead))
}
