//! A motion by the board: moves from rest to rest until the plan is made, or ends before.

use std::time::{Duration, Instant};

use pump_ctl::plan::PlannedMotion;
use pump_ctl::step::{Segment, TickRate};

use super::driver_watch::DriverWatch;
use super::feed::Feed;
use super::index::Index;
use super::outcome::{Ended, Fault, Made};
use super::ramp::{ramp, steps as ramp_steps};
use super::task::{Task, times_of};
use crate::drives::board_clock::Reading;
use crate::drives::klipper::board::{Board, check_driver, reason};
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::fault::fault;
use crate::drives::klipper::link::Arrival;
use crate::drives::klipper::refit::StepCommand;
use crate::drives::sent_lead::SentLead;
use crate::drives::stepped::{Lead, steps_from};
use crate::drives::{BEGIN_LEAD, BeginPlace, CommonBeginError, Met};

/// Time from the first command of a move to its begin, s. The queue is loaded meanwhile.
const BEGIN_S: f64 = 0.15;

/// Time before the end of the queue at which the way to rest is queued, if no further step may follow yet, s. Blocks
/// that are lost are sent again within it.
const RAMP_S: f64 = 0.12;

/// Time before a step is due within which it is not sent any more, s: a late step shuts the board down.
const LATE_S: f64 = 0.01;

/// Time between two readings of the board's clock.
const READ: Duration = Duration::from_millis(200);

/// Time between two delays of the dead-man time.
const PUT_OFF: Duration = Duration::from_millis(50);

/// Longest time for which a search hears of its sensor after its last step. A board looks within 0.2 ms, and is then
/// asked for the time.
const LAST_LOOK: Duration = Duration::from_millis(60);

/// Most blocks that wait for the line. More would hold back what is sent after them.
const WAITING_MOST: usize = 6;

/// Motion by the board.
pub(super) struct Motion<'a> {
    pub(super) board: &'a mut Board,
    plan: PlannedMotion<'a>,
    pub(super) task: Task,
    /// Leave for all steps, by which the steps after a pause are paced.
    free: &'a Lead,
    pub(super) lead: &'a SentLead<'a>,
    /// Count of the motor before the motion.
    pub(super) start: i64,
    seeks: bool,
    /// Place among the motions that begin together, until all have met.
    pub(super) place: Option<BeginPlace>,
    /// Last step that may be sent.
    limit: u64,
    /// Steps of the moves that have ended.
    pub(super) made: u64,
    pub(super) feed: Option<Feed<'a>>,
    index: Index,
    index_at: Option<u64>,
    /// Steps made when the board was last heard.
    pub(super) heard: u64,
    read_at: Duration,
    /// Number of the block that asks for the clock.
    asked: Option<u64>,
    put_off_at: Duration,
    /// Number of the block that has begun the last move.
    begun_in: u64,
    driver: Option<DriverWatch>,
    /// Most steps by which the motor may have slipped, because it was stopped without a ramp.
    pub(super) slipped: u32,
    /// Error with which the motion ends, once the motor stands.
    failed: Option<KlipperError>,
}

impl<'a> Motion<'a> {
    /// Begins with no step made. A motion that `seeks` ends at the index mark.
    pub(super) fn new(
        board: &'a mut Board,
        plan: PlannedMotion<'a>,
        task: Task,
        (lead, free): (&'a SentLead<'a>, &'a Lead),
        start: i64,
        seeks: bool,
    ) -> Self {
        Self {
            driver: board.driver.map(DriverWatch::new),
            slipped: 0,
            board,
            plan,
            task,
            free,
            lead,
            start,
            seeks,
            place: None,
            limit: 0,
            made: 0,
            feed: None,
            index: Index::Leaves,
            index_at: None,
            heard: 0,
            read_at: Duration::ZERO,
            asked: None,
            put_off_at: Duration::ZERO,
            begun_in: 0,
            failed: None,
        }
    }

    fn all(&self) -> u64 {
        self.plan.steps().unsigned_abs()
    }

    /// Goes on for as long as `wait` at most. Returns the steps made once the motion has ended.
    pub(super) fn turn(&mut self, wait: Duration) -> Option<Result<Ended, Fault>> {
        let turned = match self.feed.take() {
            Some(feed) => self.go_on(feed, wait),
            None => match self.stand() {
                Some(outcome) => return Some(outcome),
                None => self.begin(wait),
            },
        };
        match turned {
            Ok(()) => None,
            Err(error) => self.fail(error).map(Err),
        }
    }

    /// Returns the outcome of a motor that stands, if the motion ends there.
    fn stand(&mut self) -> Option<Result<Ended, Fault>> {
        if let Some(error) = self.failed.take() {
            return Some(Err(self.stood(error)));
        }
        if self.made >= self.all() || self.lead.stops() {
            let made = Made { steps: self.made, index_at: self.index_at };
            let checked =
                self.board.driver.map_or(Ok(None), |address| check_driver(&mut self.board.talk, address));
            return Some(checked.map(|warning| (made, warning)).map_err(|error| self.stood(error)));
        }
        // The times of a flow that has come to rest have passed.
        let is_too_late = self.made > 0 && matches!(self.plan, PlannedMotion::Flow(_));
        is_too_late.then(|| Err(Fault::at(self.made, KlipperError::FlowPaused)))
    }

    /// Returns the fault of a motor that stands after `error`. A motor without current has not made the last steps that
    /// the board has counted.
    fn stood(&mut self, error: KlipperError) -> Fault {
        let sure =
            self.driver.as_ref().filter(|_| error.is_of_driver()).map_or(self.made, |driver| driver.sure);
        if error.halts() {
            self.note_slip(self.made);
        }
        Fault { error, least: sure.min(self.made), most: self.made }
    }

    /// Notes by how many steps the motor may have slipped that stood still after `made` steps without a ramp. The plan
    /// itself ends with one.
    pub(super) fn note_slip(&mut self, made: u64) {
        self.slipped = if made < self.all() { self.task.slip_steps } else { 0 };
    }

    /// Begins the next move from rest, if there is leave for one.
    fn begin(&mut self, wait: Duration) -> Result<(), KlipperError> {
        self.limit = self.lead.sendable(self.limit.max(self.made));
        if self.limit <= self.made {
            self.board.talk.link.turn(wait)?;
            return self.hear();
        }
        let Some(base) = self.base()? else {
            self.ask_clock()?;
            self.board.talk.link.turn(wait)?;
            return self.hear();
        };
        // The motor has its current before its first step.
        self.board.check_current()?;
        let is_forward = (self.plan.direction().sign() > 0) != self.board.is_reversed;
        let format = &self.board.talk.format;
        let objects = self.board.talk.objects;
        let (stepper, dead_man) = (objects.stepper.into(), objects.dead_man.into());
        let low = |tick: u64| (tick as u32).into();
        let commands = [
            format.trsync_start.encode(&[dead_man, low(base), 0_u32.into(), reason::EXPIRED.into()])?,
            format.stepper_stop_on_trigger.encode(&[stepper, dead_man])?,
            format.set_next_step_dir.encode(&[stepper, is_forward.into()])?,
            format.reset_step_clock.encode(&[stepper, low(base)])?,
        ];
        self.begun_in = self.board.talk.link.queue_all(&commands)?;
        self.put_off()?;
        if self.seeks && self.index_at.is_none() {
            let phase = if self.index == Index::Finds { Index::Finds } else { Index::Leaves };
            self.index = phase.arm(self.board, base)?;
        }
        self.feed = Some(Feed::new(self.times(), self.board.timer, base));
        Ok(())
    }

    /// Returns the tick of the board's clock at which the next move begins. `None` while it waits for other boards.
    fn base(&mut self) -> Result<Option<u64>, KlipperError> {
        let hz = f64::from(self.board.hz);
        let now = self.board.clock.at(self.board.talk.link.steady_now());
        let Some(place) = &mut self.place else { return Ok(Some(now.value + (BEGIN_S * hz) as u64)) };
        let at = match place.meet(Instant::now(), BEGIN_LEAD) {
            Met::Waits => return Ok(None),
            Met::Failed(error) => return Err(error.into()),
            Met::At(at) => at,
        };
        self.place = None;
        let base = self.board.clock.tick_at(at, self.board.talk.link.steady_at(at));
        let late = now.value as f64 + now.within + LATE_S * hz;
        if (base as f64) < late { Err(CommonBeginError::Missed.into()) } else { Ok(Some(base)) }
    }

    /// Asks for the clock, if it is time to.
    fn ask_clock(&mut self) -> Result<(), KlipperError> {
        let now = self.board.talk.link.now();
        if now.saturating_sub(self.read_at) >= READ && self.asked.is_none() {
            let question = self.board.talk.format.get_clock.encode(&[])?;
            self.asked = Some(self.board.talk.link.queue_alone(&question)?);
            self.read_at = now;
        } else if now.saturating_sub(self.read_at) >= 5 * READ {
            // The board sends no answer twice.
            self.asked = None;
        }
        Ok(())
    }

    /// Returns the times of the steps that are left, in s since the begin of the move.
    fn times(&self) -> Box<dyn Iterator<Item = f64> + Send + 'a> {
        let (PlannedMotion::Dose(plan), 1..) = (self.plan, self.made) else { return times_of(self.plan) };
        let Some(tick_rate) = TickRate::from_hz(self.board.hz) else { return times_of(self.plan) };
        let (hz, mut at_s) = (f64::from(self.board.hz), 0.0);
        let steps = steps_from(plan, tick_rate, self.free, self.made);
        Box::new(steps.map(move |Segment { interval, frac, .. }| {
            at_s += (interval as f64 + f64::from(frac) * 0.5_f64.powi(32)) / hz;
            at_s
        }))
    }

    /// Sends what is due, and takes in what the board tells.
    fn go_on(&mut self, mut feed: Feed<'a>, wait: Duration) -> Result<(), KlipperError> {
        let sent = self.send(&mut feed);
        let ended = sent.as_ref().is_ok_and(|ended| *ended);
        self.feed = Some(feed);
        sent?;
        if ended {
            return self.end_move();
        }
        let now = self.board.talk.link.now();
        if now.saturating_sub(self.put_off_at) >= PUT_OFF {
            self.put_off()?;
        }
        self.ask_clock()?;
        self.board.talk.link.turn(wait)?;
        self.hear()
    }

    /// Sends the steps that may be sent now, and the way to rest where no further one may follow. Returns true once the
    /// move has ended.
    fn send(&mut self, feed: &mut Feed<'a>) -> Result<bool, KlipperError> {
        let hz = f64::from(self.board.hz);
        let now = self.board.clock.at(self.board.talk.link.steady_now());
        let (low, high) = (now.value.saturating_sub(now.within as u64), now.value + now.within as u64);
        let made = self.made + feed.made_at(low);
        self.lead.note_made(made);
        if let (Some(driver), None) = (&mut self.driver, &self.failed) {
            driver.go_on(self.board, made)?;
        }
        feed.forget(low);
        let stops = self.failed.is_some() || self.lead.stops();
        if !feed.is_closed && !stops {
            self.limit = self.lead.sendable(self.limit);
            self.push(feed, self.limit.saturating_sub(self.made), low, high)?;
            feed.is_closed = self.made + feed.pushed >= self.all();
        }
        let speed = feed.speed();
        let is_fast = ramp_steps(speed, self.task.deceleration) > 0;
        let ends_soon = (high as f64 + RAMP_S * hz) >= feed.ends_at as f64;
        if !feed.is_closed && (stops || is_fast && ends_soon) {
            if is_fast && high as f64 + LATE_S * hz >= feed.ends_at as f64 {
                feed.close(std::iter::empty());
                return Err(KlipperError::HeldUp);
            }
            let left = self.all().saturating_sub(self.made + feed.pushed);
            let left = usize::try_from(left).unwrap_or(usize::MAX);
            feed.close(ramp(speed, self.task.deceleration).take(left));
        }
        if feed.is_closed {
            self.push(feed, u64::MAX, low, high)?;
        }
        let has_run_out = low > feed.ends_at && feed.held_at(low) == 0;
        let is_whole = feed.is_closed && feed.next_due(1)?.is_none();
        Ok(has_run_out && (is_whole || feed.pushed > 0 && !feed.is_closed))
    }

    /// Sends steps up to step `reach` of the move, as many as queue and line take. A board that has made all steps
    /// before rests at a slow speed, and the move has ended.
    fn push(&mut self, feed: &mut Feed<'a>, reach: u64, low: u64, high: u64) -> Result<(), KlipperError> {
        let late = high + (LATE_S * f64::from(self.board.hz)) as u64;
        let format = self.board.talk.format.queue_step.clone();
        let stepper = self.board.talk.objects.stepper;
        while feed.pushed < reach
            && self.board.talk.link.waiting() < WAITING_MOST
            && feed.held_at(low) < self.task.slots
        {
            let most = reach - feed.pushed;
            let Some(due) = feed.next_due(most)? else { return Ok(()) };
            if due <= late {
                let is_fast = ramp_steps(feed.speed(), self.task.deceleration) > 0;
                return if is_fast { Err(KlipperError::HeldUp) } else { Ok(()) };
            }
            let Some((reset, StepCommand { interval, count, add })) = feed.next(most, low)? else {
                return Ok(());
            };
            if let Some(tick) = reset {
                let values = [stepper.into(), (tick as u32).into()];
                let reset = self.board.talk.format.reset_step_clock.encode(&values)?;
                self.board.talk.link.queue(&reset)?;
            }
            let values = [stepper.into(), interval.into(), count.into(), add.into()];
            self.board.talk.link.queue(&format.encode(&values)?)?;
        }
        Ok(())
    }

    /// Puts the end of the dead-man time off.
    fn put_off(&mut self) -> Result<(), KlipperError> {
        let link = &mut self.board.talk.link;
        self.put_off_at = link.now();
        let now = self.board.clock.at(link.steady_now());
        let least = self.board.dead_man.as_secs_f64() + BEGIN_S;
        let end = now.value + now.within as u64 + (least * f64::from(self.board.hz)) as u64;
        let values = [self.board.talk.objects.dead_man.into(), (end as u32).into()];
        let command = self.board.talk.format.trsync_set_timeout.encode(&values)?;
        self.board.talk.link.queue(&command)?;
        Ok(())
    }

    /// Takes in what the board has told.
    fn hear(&mut self) -> Result<(), KlipperError> {
        while let Some(arrival) = self.board.talk.link.take() {
            for message in self.board.talk.dictionary.read(&arrival.content)? {
                fault(&message, &self.board.talk.dictionary)?.map_or(Ok(()), Err)?;
                let objects = self.board.talk.objects;
                // The state of a group that was told before is that of the move before.
                let is_of_move = arrival.taken.is_some_and(|taken| taken >= self.begun_in);
                let is_of = |oid: u8| message.number("oid").is_ok_and(|number| number == i64::from(oid));
                match message.name() {
                    "clock" => self.note_clock(&arrival, message.unsigned("clock")?)?,
                    "trsync_state" if message.number("can_trigger")? == 0 => {
                        if is_of(objects.index_group) {
                            self.index = self.index.triggered(self.board)?;
                        } else if is_of(objects.dead_man) && self.feed.is_some() && is_of_move {
                            let dead_man_ms = self.board.dead_man.as_millis();
                            return Err(KlipperError::DeadMan { dead_man_ms });
                        }
                    }
                    "endstop_state" if is_of(objects.index) => {
                        self.note_index(message.unsigned("next_clock")?)?;
                    }
                    "tmcuart_response" if self.failed.is_none() && is_of(objects.driver_line) => {
                        let talk = &self.board.talk;
                        self.driver
                            .as_mut()
                            .map_or(Ok(()), |driver| driver.hear(talk, &arrival, &message))?;
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Notes a reading of the clock.
    fn note_clock(&mut self, arrival: &Arrival, ticks: u32) -> Result<(), KlipperError> {
        let Some(number) = self.asked else { return Ok(()) };
        // The clock of another motor's question is of no use: it tells no time at which it was asked.
        let Some((from, to)) = self.board.talk.link.answered_within(number, arrival) else { return Ok(()) };
        self.asked = None;
        let now = self.board.clock.take(Reading { from, to, ticks })?;
        if let Some(feed) = &self.feed {
            self.heard = self.made + feed.made_at(now);
        }
        Ok(())
    }

    /// Notes the tick after that at which the index sensor had the level.
    fn note_index(&mut self, next: u32) -> Result<(), KlipperError> {
        let Index::Asked { finds } = self.index else { return Ok(()) };
        let steady = self.board.talk.link.steady_now();
        let next = self.board.clock.widen(next, steady)?;
        if !finds {
            let now = self.board.clock.at(steady);
            let soon = now.value + now.within as u64 + u64::from(self.board.hz / 100);
            self.index = Index::Finds.arm(self.board, soon)?;
            return Ok(());
        }
        let tick = Index::tick_of(self.board, next);
        let made = self.feed.as_ref().map_or(0, |feed| feed.made_at(tick));
        (self.index, self.index_at) = (Index::Over, Some(self.made + made));
        self.lead.stop();
        Ok(())
    }

    /// Hears of the sensor of a motor that stands: a turn that begins on the mark ends where it begins.
    fn look_last(&mut self) -> Result<(), KlipperError> {
        if self.index == Index::Leaves {
            let made = self.made + self.feed.as_ref().map_or(0, |feed| feed.pushed);
            let is_whole = made >= self.all() && self.failed.is_none();
            self.failed = is_whole.then_some(KlipperError::IndexStays).or(self.failed.take());
            return Ok(());
        }
        let until = self.board.talk.link.now() + LAST_LOOK;
        while self.index_at.is_none()
            && matches!(self.index, Index::Finds | Index::Asked { finds: true })
            && self.board.talk.link.now() < until
        {
            self.board.talk.link.turn(LAST_LOOK / 20)?;
            self.hear()?;
        }
        Ok(())
    }

    /// Ends a move from rest to rest, and compares the board's count with the steps that were sent. Until the board has
    /// told its count, the move's bounds count.
    fn end_move(&mut self) -> Result<(), KlipperError> {
        if self.seeks && self.index_at.is_none() {
            self.look_last()?;
        }
        let sent = self.made + self.feed.as_ref().map_or(0, |feed| feed.pushed);
        let was_halted = self.failed.as_ref().is_some_and(KlipperError::halts);
        let reason = if was_halted { reason::MET } else { reason::ENDED };
        if self.seeks {
            Index::disarm(self.board)?;
        }
        let ended = self.board.talk.end_dead_man(reason)?;
        let counted = self.counted()?;
        self.feed = None;
        (self.made, self.heard) = (counted, counted);
        self.lead.note_made(counted);
        if ended == reason::EXPIRED && self.failed.is_none() {
            self.failed = Some(KlipperError::DeadMan { dead_man_ms: self.board.dead_man.as_millis() });
        }
        if matches!(self.failed, Some(KlipperError::DeadMan { .. })) {
            // A clock that has jumped ends the dead-man time too, and this computer was not silent.
            let followed = self.board.talk.follow_clock(&self.board.clock);
            self.failed = followed.err().filter(KlipperError::is_of_clock).or(self.failed.take());
        }
        let is_cut = ended == reason::EXPIRED;
        if counted != sent && !is_cut {
            let direction = i64::from(self.plan.direction().sign());
            let at = |steps: u64| self.start + direction * i64::try_from(steps).unwrap_or(i64::MAX);
            self.failed = Some(KlipperError::Count { counted: at(counted), expected: at(sent) });
        }
        Ok(())
    }

    /// Returns the steps of the motion by the board's count.
    pub(super) fn counted(&mut self) -> Result<u64, KlipperError> {
        let direction = i64::from(self.plan.direction().sign());
        let position = self.board.position()?;
        Ok(u64::try_from((position - self.start) * direction).unwrap_or(0))
    }

    /// Treats an error. Returns the fault if the motion ends with it. Otherwise the motor is brought to rest first.
    fn fail(&mut self, error: KlipperError) -> Option<Fault> {
        let is_lost = error.ends_link()
            || self.failed.is_some()
            || matches!(error, KlipperError::Reset | KlipperError::Shutdown { .. });
        if self.feed.is_some() && is_lost {
            let error = match self.failed.take() {
                // The dead-man time was ended by the clock, and not by a silence.
                Some(KlipperError::DeadMan { .. }) if error.is_of_clock() => error,
                failed => failed.unwrap_or(error),
            };
            return Some(self.lost(error));
        }
        if self.feed.is_none() && is_lost {
            return Some(Fault::at(self.made, error));
        }
        self.failed = Some(error);
        if let Some(feed) = &mut self.feed
            && self.failed.as_ref().is_some_and(KlipperError::halts)
        {
            // Later commands would come too late.
            feed.close(std::iter::empty());
        }
        None
    }
}
