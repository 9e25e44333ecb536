//! Meeting a board: who it is, how it is configured, and where its motor stands. Nothing moves.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::{Arc, MutexGuard};
use std::time::Duration;

use super::board::{Board, ConfigState, Talk, reason};
use super::board_motor::{BoardMotor, displaced, left_without_current, motors_of};
use super::board_record::BoardRecord;
use super::commands::Commands;
use super::configuration::Configuration;
use super::driver_line;
use super::objects::Objects;
use super::reset::{ANSWER_LIMIT, STILL, be_still, bring_to_rest, configure, reset};
use super::session_record::SessionRecord;
use super::shared_board::{Known, SharedBoard};
use super::step_rate::{SEVERAL, most_steps_s};
use super::terms::Terms;
use crate::drives::Disturbance;
use crate::drives::board_clock::SharedClock;
use crate::drives::klipper::dictionary::Dictionary;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::link::Link;
use crate::drives::klipper::refit::{RefitError, StepTimer};
use crate::drives::klipper::tmc::{TmcError, TmcSettings};
use crate::drives::known_board::{KnownBoard, MadePlace, RecordedPump};

/// Longest search for a silent board in motion. The queue has ended by then, and the count is exact. The search is
/// short while pumps at other boards wait for its end to stop: the next meeting finds the count.
const SEARCH: Duration = Duration::from_secs(6);
const SHORT_SEARCH: Duration = Duration::from_millis(500);

/// Name of the firmware.
const APP: &str = "Klipper";

/// Frequencies of boards' clocks, in Hz.
const CLOCKS_HZ: RangeInclusive<u32> = 1_000_000..=1_000_000_000;

/// Bytes under way to a board that does not say how many it holds: its port is USB, which holds them back itself.
const USB_WINDOW: u32 = 768;

/// Bits of a byte on a serial line: 8, a start and a stop.
const BITS: u32 = 10;

/// Board that was met, and the state in which it was found.
pub(in crate::drives::klipper) struct Met {
    pub(in crate::drives::klipper) board: Board,
    /// Count of the motor, positive toward the outlet.
    pub(in crate::drives::klipper) position: i64,
    pub(in crate::drives::klipper) disturbed: Option<Disturbance>,
    /// Board that was on record in the place of this one, if that was accepted.
    pub(in crate::drives::klipper) replaced: MadePlace,
    /// Notes on the stepper driver and on the board's other motors, for a person.
    pub(in crate::drives::klipper) of_board: Vec<String>,
}

/// Board as it was found, with what is known of it beside its link.
struct Found {
    hz: u32,
    state: ConfigState,
    record: SessionRecord,
    disturbed: Option<Disturbance>,
    /// File of the record that the motors of the board share.
    shared_path: Option<PathBuf>,
    /// Words for the board's other motors on record, and for what has befallen them.
    of_others: Vec<String>,
}

/// Meets the board at the other end of `link`, which other motors of this process may have met. Returns the link with
/// an error, so that its port stays taken.
pub(in crate::drives::klipper) fn meet(
    mut link: Link,
    terms: &Terms,
    shared: &Arc<SharedBoard>,
) -> Result<Met, (Box<Link>, KlipperError)> {
    let met = meeting(&mut link, shared).and_then(|meeting| Ok((meeting, who(&mut link, terms, shared)?)));
    let (_meeting, (format, dictionary, clock)) = match met {
        Ok(met) => met,
        Err(error) => return Err((Box::new(link), error)),
    };
    let objects = Objects::of(0, 0);
    let mut talk = Talk { link, shared: Arc::clone(shared), dictionary, format, objects };
    // Messages for other motors that came before tell nothing now.
    talk.forget();
    let marks = marks(&talk, terms);
    let recognised = marks.compare(Some(&terms.port), &terms.opening).map_err(KlipperError::from);
    let found = recognised.and_then(|replaced| Ok((take_over(&mut talk, terms)?, replaced)));
    let (found, replaced) = match found {
        Ok(found) => found,
        Err(error) => return Err((Box::new(talk.link), error)),
    };
    let Found { hz, state, record, disturbed, shared_path, of_others } = found;
    let chip = talk.dictionary.constant_text("MCU");
    let clock = clock.map_or_else(|| talk.read_clock(hz), Ok);
    let ready = clock.and_then(|clock| Ok((clock, step_timer(hz, chip.as_deref(), terms)?)));
    let (clock, timer) = match ready {
        Ok(ready) => ready,
        Err(error) => return Err((Box::new(talk.link), error)),
    };
    let (dictionary, format) = (Arc::clone(&talk.dictionary), Arc::clone(&talk.format));
    shared.note(Known { dictionary, format, clock: clock.clone() });
    let mut board = Board {
        talk,
        clock,
        has_drift: false,
        hz,
        slots: state.slots,
        timer,
        motors: terms.opening.beside.len() + 1,
        all_steps_s: SEVERAL * most_steps_s(chip.as_deref(), hz),
        cuts: shared.cuts(),
        record,
        path: terms.record.clone(),
        shared_path,
        is_reversed: terms.pins.dir.inverted != terms.inverts,
        current_on: terms.pins.enable.as_ref().map(|enable| !enable.inverted),
        index_level: terms.pins.index.as_ref().is_some_and(|index| !index.inverted),
        bytes_s: terms.baud / BITS,
        dead_man: terms.dead_man,
        search: if terms.opening.with_other_boards { SHORT_SEARCH } else { SEARCH },
        driver: terms.driver.as_ref().map(|(address, _)| *address),
    };
    match settle(&mut board, terms, (&marks, &replaced)) {
        Ok((position, mut of_board, was_off)) => {
            of_board.extend(of_others.iter().cloned());
            let disturbed = told_of(disturbed, replaced.board.is_some(), was_off);
            // Before another motor meets the board: it need not find it anew then.
            board.talk.link.note_met(true);
            Ok(Met { board, position, disturbed, replaced, of_board })
        }
        Err(error) => Err((Box::new(board.talk.link), error.after_reset(&of_others))),
    }
}

/// Gives the motor its current, and puts board and pins on record. A board whose stepper driver is not reached takes no
/// pump's place.
fn settle(
    board: &mut Board,
    terms: &Terms,
    (marks, replaced): (&KnownBoard, &MadePlace),
) -> Result<(i64, Vec<String>, bool), KlipperError> {
    let ready = energise(board, terms)?;
    marks.settle(replaced, &terms.opening)?;
    BoardRecord::note_met(board.shared_path.as_deref(), terms.opening.pump.as_deref(), &terms.pins)?;
    Ok(ready)
}

/// Returns what a meeting tells of the rotor: more than how the board was found if it was exchanged for another one, or
/// if its stepper driver has lost the current.
fn told_of(found: Option<Disturbance>, is_exchanged: bool, was_off: bool) -> Option<Disturbance> {
    match found {
        Some(Disturbance::Reset) if is_exchanged => Some(Disturbance::TakenOver),
        _ if was_off => Some(Disturbance::CurrentLost),
        found => found,
    }
}

/// Waits until no other thread meets the board.
fn meeting<'a>(link: &mut Link, shared: &'a SharedBoard) -> Result<MutexGuard<'a, ()>, KlipperError> {
    loop {
        if let Some(meeting) = shared.try_meeting() {
            return Ok(meeting);
        }
        link.heed()?;
        link.sleep(STILL / 30);
    }
}

/// Commands, dictionary and clock of a board.
type Who = (Arc<Commands>, Arc<Dictionary>, Option<SharedClock>);

/// Returns who is at the port. A board that another motor of this process has met is known.
fn who(link: &mut Link, terms: &Terms, shared: &SharedBoard) -> Result<Who, KlipperError> {
    if let Some(Known { dictionary, format, clock }) = shared.known().filter(|_| link.is_met_by_others()) {
        return Ok((format, dictionary, Some(clock)));
    }
    let (format, dictionary) = identify(link, terms)?;
    Ok((Arc::new(format), Arc::new(dictionary), None))
}

/// Returns who is at the port, or refuses another firmware and one that lacks what is needed.
fn identify(link: &mut Link, terms: &Terms) -> Result<(Commands, Dictionary), KlipperError> {
    link.refuse_grbl()?;
    link.connect(ANSWER_LIMIT)?;
    let dictionary = link.identify()?;
    if let Some(app) = dictionary.app().filter(|app| *app != APP) {
        let (port, app) = (terms.port.clone(), app.to_owned());
        return Err(KlipperError::OtherFirmware { port, app });
    }
    let window = match dictionary.constant_text("RECEIVE_WINDOW") {
        Some(_) => dictionary.constant("RECEIVE_WINDOW", 64..=u32::MAX)?,
        None => USB_WINDOW,
    };
    link.set_window(usize::try_from(window).unwrap_or(usize::MAX));
    Ok((Commands::of(&dictionary)?, dictionary))
}

/// Returns the marks of a board. It tells no number, and its microcontroller is no more than its kind.
pub(in crate::drives::klipper) fn marks(talk: &Talk, terms: &Terms) -> KnownBoard {
    let device = terms.port.canonicalize().unwrap_or_else(|_| terms.port.clone());
    KnownBoard {
        text: talk.dictionary.constant_text("MCU"),
        device: Some(device.to_string_lossy().into_owned()),
        pins: terms.pins.own_pins(),
        ..terms.at_port.clone()
    }
}

/// Returns the clock of the steps: no two are closer than a pulse and its pause, or than the board makes them.
fn step_timer(hz: u32, chip: Option<&str>, terms: &Terms) -> Result<StepTimer, RefitError> {
    let pulses = (2.0 * terms.pins.pulse_us() * f64::from(hz) * 1e-6).ceil() as u32;
    let steps = (f64::from(hz) / most_steps_s(chip, hz)).ceil() as u32;
    StepTimer::new(hz, pulses.max(steps))
}

/// Brings the board to rest with a configuration that has the pump's motor, and that without current if the board was
/// configured anew.
fn take_over(talk: &mut Talk, terms: &Terms) -> Result<Found, KlipperError> {
    let hz = talk.dictionary.constant("CLOCK_FREQ", CLOCKS_HZ)?;
    let (own, board) = records(terms)?;
    let recorded = claimed(&board.motors, &marks(talk, terms), terms);
    let shared_path = BoardRecord::path(&terms.opening, &terms.port);
    let (motors, place) = motors_of(terms, &recorded, &talk.dictionary);
    let configuration = Configuration::new(&motors, &talk.dictionary, &talk.format, hz)?;
    talk.objects = configuration.objects(place);
    let state = talk.config()?;
    let has = |session: u64| state.is_configured && configuration.checksum(session) == state.checksum;
    let sessions = [own.map(|own| own.session), Some(board.session)];
    if let Some(session) = sessions.into_iter().flatten().find(|session| has(*session)) {
        let mine = own.filter(|own| own.session == session);
        if let Some((record, disturbed)) =
            keep(talk, mine, (session, board.cuts), state, shared_path.as_deref())?
        {
            // Another pump of this bench may have had the board configured since the motor moved last.
            let is_reset_here = own.is_some_and(|own| board.before.contains(&own.session));
            let (disturbed, by) = match disturbed {
                Some(Disturbance::Reset) if is_reset_here => (Some(Disturbance::Reconfigured), board.by),
                disturbed => (disturbed, None),
            };
            let of_others = by.map(|by| format!("the board was reset to configure it for pump `{by}` since"));
            let of_others = of_others.into_iter().collect();
            let state = talk.config()?;
            return Ok(Found { hz, state, record, disturbed, shared_path, of_others });
        }
    }
    if talk.link.is_met_by_others() {
        return Err(KlipperError::Shared { port: terms.port.clone() });
    }
    let mut is_foreign = false;
    if state.is_configured || state.is_shut_down {
        let of_record = Configuration::new(&board.motors, &talk.dictionary, &talk.format, hz);
        let of_board = of_record.ok().map(|of_record| of_record.checksum(board.session));
        let is_of_bench = [own.map(|own| own.checksum), of_board].contains(&Some(state.checksum));
        is_foreign = state.is_configured && !is_of_bench;
        let wanted = configuration.checksum(own.map_or(0, |own| own.session));
        let is_known = is_of_bench || terms.opening.accept_settings;
        bring_to_rest(talk, state, is_known, (board.motors.len(), wanted))?;
        reset(talk)?;
    }
    let mut of_others: Vec<_> = displaced(&motors, &recorded).into_iter().collect();
    let disturbed = match state {
        _ if is_foreign => Disturbance::TakenOver,
        ConfigState { is_configured: true, is_shut_down: false, .. } => Disturbance::Reconfigured,
        _ => Disturbance::Reset,
    };
    let mut before = Vec::new();
    if disturbed == Disturbance::Reconfigured {
        before = board.ended();
        of_others.extend(left_without_current(&board.motors, &terms.opening));
    }
    let session = SessionRecord::draw();
    let checksum = configuration.checksum(session);
    let record = SessionRecord { session, checksum, has_current: false, slip_steps: 0, cuts: 0 };
    // The disk has the session before the board does.
    let of_board = BoardRecord { session, before, by: terms.opening.pump.clone(), cuts: 0, motors };
    shared_path.as_ref().map_or(Ok(()), |path| of_board.write(path))?;
    terms.record.as_ref().map_or(Ok(()), |path| record.write(path))?;
    let state = configure(talk, &configuration, checksum)?;
    talk.objects = configuration.objects(place);
    Ok(Found { hz, state, record, disturbed: Some(disturbed), shared_path, of_others })
}

/// Returns the session of the pump on record, and the record of the board. One that cannot be read is none if a person
/// accepts that.
fn records(terms: &Terms) -> Result<(Option<SessionRecord>, BoardRecord), KlipperError> {
    fn lenient<T>(read: Result<Option<T>, KlipperError>, accepts: bool) -> Result<Option<T>, KlipperError> {
        match read {
            Err(_) if accepts => Ok(None),
            read => read,
        }
    }
    let accepts = terms.opening.accept_settings;
    let own = terms.record.as_deref().map_or(Ok(None), SessionRecord::read);
    let shared_path = BoardRecord::path(&terms.opening, &terms.port);
    let board = shared_path.as_deref().map_or(Ok(None), BoardRecord::read);
    Ok((lenient(own, accepts)?.or(terms.last), lenient(board, accepts)?.unwrap_or_default()))
}

/// Returns the motors on record but those whose pumps have other pins, or another board, by their own records now. A
/// pump that was refused before it moved has no record of its own, and stays.
fn claimed(motors: &[BoardMotor], marks: &KnownBoard, terms: &Terms) -> Vec<BoardMotor> {
    let has_left = |motor: &&BoardMotor| {
        let pins = motor.pins.own_pins();
        let record = motor.pump.as_deref().and_then(|pump| RecordedPump::named(pump, &terms.opening));
        record.is_some_and(|record| {
            !marks.is_surely(&record.board) || !pins.iter().all(|pin| record.board.pins.contains(pin))
        })
    };
    let is_own = |motor: &&BoardMotor| motor.pump == terms.opening.pump;
    motors.iter().filter(|motor| is_own(motor) || !has_left(motor)).cloned().collect()
}

/// Keeps the configuration of a board that has the pump's motor under `session`, with so many shutdowns on record, and
/// ends what an earlier program has left. `mine` is the record of the motor in that session. Returns `None` if the
/// board has shut down and its firmware cannot go on without a reset.
fn keep(
    talk: &mut Talk,
    mine: Option<SessionRecord>,
    (session, cuts): (u64, u32),
    state: ConfigState,
    shared_path: Option<&Path>,
) -> Result<Option<(SessionRecord, Option<Disturbance>)>, KlipperError> {
    let Some(record) = mine else {
        // The board was reset since the motor moved last, and configured for it by another pump of this bench.
        let checksum = state.checksum;
        let fresh = SessionRecord { session, checksum, has_current: false, slip_steps: 0, cuts };
        let kept = keep(talk, Some(fresh), (session, cuts), state, shared_path)?;
        return Ok(kept.map(|(record, _)| (record, Some(Disturbance::Reset))));
    };
    let halted = |without_current| Disturbance::Halted { slip_steps: record.slip_steps, without_current };
    if state.is_shut_down {
        let cuts = BoardRecord::note_cut(shared_path, cuts)?;
        if !talk.clear_shutdown()? {
            return Ok(None);
        }
        // A shutdown takes the current away, and stops a motor without a ramp.
        talk.end_dead_man(reason::MET)?;
        let disturbed = if record.slip_steps > 0 { halted(true) } else { Disturbance::Disabled };
        return Ok(Some((SessionRecord { has_current: false, cuts, ..record }, Some(disturbed))));
    }
    be_still(talk)?;
    let ended = talk.end_dead_man(reason::MET)?;
    let was_cut_off = ended == reason::MET || ended == reason::EXPIRED;
    // A shutdown that another pump has ended has taken the current of this motor too.
    let has_current = record.has_current && record.cuts == cuts;
    let disturbed = match record.slip_steps {
        // A motor that was let go at rest has no slip on record, and one without current otherwise had a shutdown.
        1.. if was_cut_off || !has_current => Some(halted(!has_current)),
        _ if !has_current => Some(Disturbance::Disabled),
        _ => None,
    };
    Ok(Some((SessionRecord { has_current, cuts, ..record }, disturbed)))
}

/// Sets the stepper driver while its motor has no current, and refuses an enable pin that does not take it away. A pin
/// of an earlier pump file may still hold the chip's input on, which would hide that this one leads elsewhere.
fn set_driver(board: &mut Board, driver: &(u8, TmcSettings)) -> Result<Vec<String>, KlipperError> {
    board.set_current(false)?;
    let of_driver = driver_line::set(&mut board.talk, driver)?;
    if board.current_on.is_some() {
        driver_line::check_enable(&mut board.talk, driver.0, false)?;
    }
    Ok(of_driver)
}

/// Sets the stepper driver, and gives the motor current. Returns the count, what a person is to know of the
/// stepper driver, and true if that has lost its motor's current since it was set.
fn energise(board: &mut Board, terms: &Terms) -> Result<(i64, Vec<String>, bool), KlipperError> {
    let mut was_off = false;
    let of_driver = match &terms.driver {
        // The registers are set while the motor has no current, and checked while it has.
        Some(driver) if board.record.has_current => match driver_line::check(&mut board.talk, driver.0) {
            Err(error) if error.cuts_current() => {
                was_off = true;
                // A fault that is still there is refused now.
                let mut of_driver = set_driver(board, driver)?;
                if let KlipperError::Driver(lost @ (TmcError::Reset { .. } | TmcError::Off { .. })) = error {
                    of_driver.insert(0, lost.to_string());
                }
                of_driver
            }
            checked => checked?.into_iter().collect(),
        },
        Some(driver) => set_driver(board, driver)?,
        None => Vec::new(),
    };
    board.set_current(true)?;
    if let Some((address, _)) = &terms.driver {
        driver_line::check_enable(&mut board.talk, *address, true).or_else(|error| {
            board.set_current(false)?;
            Err(error)
        })?;
    }
    if !board.record.has_current || board.record.slip_steps > 0 {
        let record = SessionRecord { has_current: true, slip_steps: 0, ..board.record };
        board.put_on_record(record)?;
    }
    Ok((board.position()?, of_driver, was_off))
}
