//! A dose by weight under way: stretch after stretch, each weighed.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_ctl::plan::Cruise;

use super::aim::{Aim, Next};
use super::delivered::DeliveredByWeight;
use super::lookout::{Lookout, Stop};
use super::prepared::PreparedByWeight;
use super::readings::Readings;
use crate::balance::{Balance, BalanceError, BalanceReading};
use crate::bench::bench::Bench;
use crate::bench::recorded_motion::{Moved, RecordedMotion};
use crate::bench::session::Session;
use crate::dosing::{DoseError, DoseRequest, Prepared, WeightFault};
use crate::drives::StopRequest;
use crate::record::{AfterStop, DoseTerms, PumpState, Purpose, Why};

/// Most stretches of a dose. A stretch leaves a few percent of what was missing, and drops take a few more.
const MOST_STRETCHES: u32 = 30;

/// Time between two readings that must agree, for a balance at rest.
const AGREES_AFTER: Duration = Duration::from_millis(300);

/// Least time from the motor's last step to a reading at rest. A balance may call itself still before the last drop has
/// fallen.
const FALLEN_AFTER: Duration = Duration::from_millis(800);

/// Time in which a drop falls 0.1 m: sqrt(2 h/g).
const FALL_S: f64 = 0.143;

/// Delay of a balance's filter where nobody knows it, in s. Makers state settling times of 1 to 3 s for a load that is
/// put on at once (Mettler-Toledo, data sheets of the MS-TS and ME lines), a few time constants.
const FILTER_S: f64 = 0.5;

/// Volume that is expected after a stop, in drops and digits, from which on its time is learned: a drop more or less is
/// then a quarter of it.
const CLEARLY: f64 = 4.0;

/// Steps beyond the ceiling to which the journal's announced plan leads. They are never made: the dose stays unfinished
/// until the balance ends it.
const BEYOND_CEILING: f64 = 16.0;

/// Dose by weight under way.
#[derive(Debug)]
struct Course<'p> {
    prepared: &'p PreparedByWeight,
    aim: Aim,
    tare_g: f64,
    /// Last reading at rest, in g.
    shown_g: f64,
    digit_g: f64,
    turned_ml: f64,
    stretches: u32,
    stopped_by_balance: u32,
    made: u64,
    end_angle_rad: f64,
    measured_s: f64,
    after_stop: Option<AfterStop>,
    reckoned_s: Option<(f64, bool)>,
}

impl Course<'_> {
    fn weighed_g(&self) -> f64 {
        self.shown_g - self.tare_g
    }

    fn weighed_ml(&self) -> f64 {
        self.weighed_g() * self.prepared.z_ml_g
    }

    /// Returns the error of a fault after `shown_g` were read last.
    fn fault(&self, fault: WeightFault, turned_ml: f64, shown_g: f64) -> DoseError {
        DoseError::ByWeight { fault, turned_ml, weighed_g: Some(shown_g - self.tare_g) }
    }
}

/// One stretch: the plan that the motor makes, and the longer one that the journal announces.
#[derive(Debug)]
struct Stretch {
    part: Prepared,
    announced: Prepared,
}

/// End of one stretch.
struct StretchEnd {
    moved: Moved,
    stop: Option<Stop>,
    /// Reading when the motor came to rest, in g.
    at_rest_g: Option<f64>,
    /// Volumes by the model that the pump had turned for, in mL, and when.
    notes: VecDeque<(Instant, f64)>,
    /// Instant at which the motor came to rest.
    stood: Instant,
    /// Last reading, in g.
    last_g: Option<f64>,
    stopped_by_user: bool,
}

impl Session<'_> {
    /// Makes a dose that `balance` ends, and records its end. The vessel stands on the balance with whatever it holds.
    ///
    /// `watch` is called now and then with the steps of the stretch under way. When it breaks, the motor decelerates
    /// and holds, and the dose stays unfinished. A simulated motor takes no time, so no reading follows it: each of its
    /// stretches is weighed at its end.
    ///
    /// # Errors
    ///
    /// [`DoseError::Balance`] if the balance cannot be read before anything moves. [`DoseError::ByWeight`] if the dose
    /// was stopped before the balance showed what was asked for: it is then unfinished on record. Other [`DoseError`]s
    /// if the device cannot be used or fails, or the dose cannot be recorded.
    pub fn run_by_weight(
        &mut self,
        prepared: &PreparedByWeight,
        balance: &mut dyn Balance,
        mut watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<DeliveredByWeight, DoseError> {
        self.finished()?;
        self.connect()?;
        let user_stop = self.bench.opening().stop.clone();
        let simulated = self.bench.is_simulated();
        let longest = prepared.order.longest;
        let tare = at_rest(balance, longest, &user_stop, simulated)?;
        let mut course = Course::begin(prepared, tare, self.stands().after_stop);
        if !simulated {
            course.reckoned_s = Some(course.reckoned());
        }
        loop {
            let next = course.aim.next(course.weighed_ml(), course.turned_ml);
            let next = next.map_err(|fault| course.fault(fault, course.turned_ml, course.shown_g))?;
            let Next::Turn { volume_ml, slowly } = next else { break };
            if course.stretches == MOST_STRETCHES {
                let rest_ml = course.aim.target_ml - course.weighed_ml();
                let fault = WeightFault::Endless { stretches: course.stretches, rest_ml };
                return Err(course.fault(fault, course.turned_ml, course.shown_g));
            }
            let stretch = self.plan_stretch(&course, volume_ml, slowly)?;
            let end = self.run_stretch(&course, &stretch, balance, &user_stop, &mut watch)?;
            course.add(&stretch, &end, self.turned_ml());
            if let Some(Stop::Fault(fault)) = end.stop {
                return Err(course.fault(fault, course.turned_ml, end.last_g.unwrap_or(course.shown_g)));
            }
            let settled = if end.stopped_by_user {
                Err(BalanceError::Stopped)
            } else {
                self.wait_for_drops(simulated, &mut watch);
                at_rest(balance, longest, &user_stop, simulated)
            };
            match settled {
                Ok(reading) => course.weigh(&stretch, &end, reading),
                Err(BalanceError::Stopped) => {
                    course.shown_g = end.last_g.unwrap_or(course.shown_g);
                    return Ok(course.delivered(false, std::mem::take(&mut self.notes)));
                }
                Err(error) => {
                    let last_g = end.last_g.unwrap_or(course.shown_g);
                    return Err(course.fault(WeightFault::Balance(error), course.turned_ml, last_g));
                }
            }
            let checked = course.aim.check(course.weighed_ml(), course.turned_ml, prepared.z_ml_g);
            checked.map_err(|fault| course.fault(fault, course.turned_ml, course.shown_g))?;
        }
        let state =
            PumpState { unfinished: None, after_stop: course.after_stop, ..self.stands().without_carry() };
        self.rest(Why::Weighed, state).map_err(|source| DoseError::NotRecorded {
            delivered_ml: course.weighed_ml(),
            end_angle_deg: pump_model::units::degrees(course.end_angle_rad),
            source,
        })?;
        Ok(course.delivered(true, std::mem::take(&mut self.notes)))
    }

    /// Returns the volume by the model of the dose so far, in mL.
    fn turned_ml(&self) -> f64 {
        self.stands().unfinished.map_or(0.0, |dose| dose.booked_ml(self.bench.model()))
    }

    /// Plans a stretch of `volume_ml`, and the announced plan that leads beyond the ceiling.
    fn plan_stretch(
        &mut self,
        course: &Course<'_>,
        volume_ml: f64,
        slowly: bool,
    ) -> Result<Stretch, DoseError> {
        let prepared = course.prepared;
        let cruise = if slowly { Some(prepared.slow) } else { prepared.order.request.cruise };
        let begun = self.stands().unfinished;
        let state = PumpState { unfinished: None, ..self.stands().without_carry() };
        let request = DoseRequest { cruise, ..prepared.order.request };
        let (bench, file) = (self.bench, self.file());
        let part =
            bench.plan_from(file, Some(state), DoseRequest { volume_ml, whole_ml: None, ..request }, None)?;
        // A speed that follows from the volume must be the same in both plans, since it sets the displacement.
        let rad_s = part.plan.profile().cruise_rad_s();
        let cruise = if cruise == Some(Cruise::Fastest) { Some(Cruise::Speed { rad_s }) } else { cruise };
        let beyond_ml = BEYOND_CEILING * course.aim.step_ml + 0.01 * course.aim.unsure_ml;
        let to_end_ml = prepared.most_ml - course.turned_ml + beyond_ml;
        let asked_ml = prepared.order.request.volume_ml;
        let rest = DoseRequest {
            cruise,
            volume_ml: asked_ml - course.turned_ml,
            whole_ml: begun.map(|_| asked_ml),
            ..request
        };
        let announced = bench.plan_from(file, Some(state), rest, Some(to_end_ml))?;
        let notes = std::mem::take(&mut self.notes);
        let part = self.checked(part)?;
        self.notes = notes;
        Ok(Stretch { part, announced })
    }

    /// Makes a stretch with a lookout on the balance.
    fn run_stretch(
        &mut self,
        course: &Course<'_>,
        stretch: &Stretch,
        balance: &mut dyn Balance,
        user_stop: &StopRequest,
        watch: &mut dyn FnMut(u64) -> ControlFlow<()>,
    ) -> Result<StretchEnd, DoseError> {
        let Stretch { part, announced } = stretch;
        let motion = RecordedMotion {
            plan: &part.plan,
            announced: Some(&announced.plan),
            model: &announced.model,
            correction: announced.correction(),
            purpose: Purpose::Dose,
            carry_out_ml: 0.0,
            given: false,
            retract_ml: None,
            whole: self.whole_of_rest(announced),
            terms: DoseTerms { by_weight: true, ..announced.terms(self.file()) },
            settle_s: part.prediction.settle_s,
            seeks: false,
            may_pause: true,
        };
        let mut stopped_by_user = false;
        let mut user = |made| {
            let flow = watch(made);
            stopped_by_user |= flow.is_break();
            flow
        };
        let (mut stop, steps) = (None, part.plan.steps().unsigned_abs());
        if self.bench.is_simulated() {
            let moved = self.perform(&motion, &mut user)?;
            let (notes, stood) = (VecDeque::new(), Instant::now());
            let unread =
                StretchEnd { moved, stop, at_rest_g: None, notes, stood, last_g: None, stopped_by_user };
            return Ok(unread);
        }
        let (moved, at_rest_g, last_g, notes, stood) =
            Readings::while_running(balance, user_stop, |readings| {
                let read_g = [course.tare_g, course.shown_g];
                let (lag, factor) = (Duration::from_secs_f64(course.reckoned().0), course.factor());
                let z_ml_g = course.prepared.z_ml_g;
                let mut lookout = Lookout::new(&course.aim, readings, read_g, z_ml_g, lag, factor);
                let moved = self.perform(&motion, |made| {
                    if user(made).is_break() {
                        return ControlFlow::Break(());
                    }
                    // The motor has been told to stop, or has made all: the line settles now.
                    if stop.is_some() || made >= steps {
                        return ControlFlow::Continue(());
                    }
                    let turned_ml = part.plan.delivered_ml(&part.model, made);
                    let stop_ml = || part.plan.stop(&part.model, made).map_or(0.0, |plan| plan.planned_ml());
                    stop = lookout.look(turned_ml, stop_ml);
                    if stop.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                })?;
                let stood = self.device.as_ref().map_or(Instant::now(), |device| device.holds_since);
                let mass_g = |sample: super::readings::Sample| sample.reading.mass_g;
                let at_rest_g = readings.last_until(stood).map(mass_g);
                Ok::<_, DoseError>((moved, at_rest_g, readings.last().map(mass_g), lookout.notes(), stood))
            })?;
        Ok(StretchEnd { moved, stop, at_rest_g, notes, stood, last_g, stopped_by_user })
    }

    /// Waits until the last drop has fallen, or `watch` breaks.
    fn wait_for_drops(&self, simulated: bool, watch: &mut dyn FnMut(u64) -> ControlFlow<()>) {
        let Some(device) = self.device.as_ref().filter(|_| !simulated) else { return };
        while device.holds_since.elapsed() < FALLEN_AFTER && watch(0).is_continue() {
            sleep(Duration::from_millis(20));
        }
    }
}

impl<'p> Course<'p> {
    fn begin(prepared: &'p PreparedByWeight, tare: BalanceReading, after_stop: Option<AfterStop>) -> Self {
        let plan = &prepared.whole.plan;
        let aim = Aim {
            target_ml: prepared.order.request.volume_ml,
            most_ml: prepared.most_ml,
            unsure_ml: prepared.unsure_ml,
            drop_ml: prepared.whole.drop_ml,
            digit_ml: tare.step_g * prepared.z_ml_g,
            step_ml: Bench::largest_step_ml(&prepared.whole),
        };
        Self {
            prepared,
            aim,
            tare_g: tare.mass_g,
            shown_g: tare.mass_g,
            digit_g: tare.step_g,
            turned_ml: 0.0,
            stretches: 0,
            stopped_by_balance: 0,
            made: 0,
            end_angle_rad: plan.start().angle_rad(),
            measured_s: 0.0,
            after_stop,
            reckoned_s: None,
        }
    }

    /// Returns the time of flow that still arrives after a stop, in s, and whether it was learned: mean and spread of
    /// what doses have found, or the model's. The line empties with its time constant R C; then come fall and filter.
    fn reckoned(&self) -> (f64, bool) {
        match self.after_stop {
            Some(found) => (found.mean_s + found.spread_s(), true),
            None => {
                let line = self.prepared.whole.model.outlet();
                (line.resistance_kpa_s_ml * line.compliance_ml_kpa + FALL_S + FILTER_S, false)
            }
        }
    }

    /// Returns the factor of the pump's volumes by what has arrived.
    fn factor(&self) -> f64 {
        self.aim.factor(self.weighed_ml(), self.turned_ml).0
    }

    /// Adds a stretch that was made.
    fn add(&mut self, stretch: &Stretch, end: &StretchEnd, turned_ml: f64) {
        self.stretches += 1;
        self.stopped_by_balance += u32::from(matches!(end.stop, Some(Stop::Enough)));
        self.made += end.moved.made;
        self.measured_s += end.moved.measured_s;
        self.turned_ml = turned_ml;
        let (part, start_rad) = (&stretch.part.plan, stretch.part.plan.start().angle_rad());
        self.end_angle_rad += part.angle_after(end.moved.made) - start_rad;
    }

    /// Takes the reading at rest after a stretch, and learns how much still arrived after the stop.
    fn weigh(&mut self, stretch: &Stretch, end: &StretchEnd, reading: BalanceReading) {
        let begun_ml = self.weighed_ml();
        self.shown_g = reading.mass_g;
        self.digit_g = reading.step_g;
        self.aim.digit_ml = reading.step_g * self.prepared.z_ml_g;
        let Some(at_rest_g) = end.at_rest_g else { return };
        let (part, arrived_ml) = (&stretch.part, self.weighed_ml() - begun_ml);
        let turned_ml = part.plan.delivered_ml(&part.model, end.moved.made);
        // The flow pulsates, so the model tells how long ago the pump had turned for what was still missing.
        let missing_ml = (reading.mass_g - at_rest_g) * self.prepared.z_ml_g * turned_ml / arrived_ml;
        let before = end.notes.iter().rev().find(|(_, noted_ml)| turned_ml - noted_ml >= missing_ml);
        // Drops and digits hide what follows a slow stretch. The expected volume decides: the one found has their
        // scatter.
        let lag_ago = end.stood.checked_sub(Duration::from_secs_f64(self.reckoned().0));
        let then = end.notes.iter().rev().find(|(at, _)| lag_ago.is_some_and(|ago| *at <= ago));
        let expected_ml = turned_ml - then.map_or(0.0, |(_, noted_ml)| *noted_ml);
        let is_clear = expected_ml > CLEARLY * (self.aim.drop_ml + self.aim.digit_ml);
        if let Some((at, _)) = before.filter(|_| is_clear) {
            let after_s = end.stood.saturating_duration_since(*at).as_secs_f64();
            self.after_stop = Some(AfterStop::with(self.after_stop, after_s));
        }
    }

    fn delivered(self, completed: bool, warnings: Vec<crate::notice::Notice>) -> DeliveredByWeight {
        DeliveredByWeight {
            mass_g: self.weighed_g(),
            digit_g: self.digit_g,
            volume_ml: self.weighed_ml(),
            turned_ml: self.turned_ml,
            stretches: self.stretches,
            stopped_by_balance: self.stopped_by_balance,
            made: self.made,
            end_angle_rad: self.end_angle_rad,
            measured_s: self.measured_s,
            completed,
            after_stop: self.after_stop,
            reckoned_s: self.reckoned_s,
            dropped_ml: self.prepared.dropped_ml,
            warnings,
        }
    }
}

impl Bench {
    /// Returns the largest volume of a motor step, in mL.
    fn largest_step_ml(prepared: &Prepared) -> f64 {
        let (_, most_ml_rad) = prepared.model.outlet_curve().flow_range_ml_rad();
        most_ml_rad * prepared.plan.step_rad()
    }
}

/// Reads a balance at rest: two readings that stand still and agree to a digit. A balance may call a slow trickle
/// still.
fn at_rest(
    balance: &mut dyn Balance,
    longest: Duration,
    stop: &StopRequest,
    simulated: bool,
) -> Result<BalanceReading, BalanceError> {
    let until = Instant::now() + longest;
    let mut before = balance.read_still(longest, stop)?;
    loop {
        if !simulated {
            sleep(AGREES_AFTER);
        }
        let left = until.saturating_duration_since(Instant::now());
        let reading = balance.read_still(left.max(AGREES_AFTER), stop)?;
        if (reading.mass_g - before.mass_g).abs() < 1.5 * reading.step_g {
            return Ok(reading);
        }
        if left.is_zero() {
            let last = format!("{} g", reading.mass_g);
            return Err(BalanceError::NotStill { within: longest, last });
        }
        before = reading;
    }
}
