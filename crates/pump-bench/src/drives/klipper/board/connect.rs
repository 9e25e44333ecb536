//! Meeting a board: who it is, how it is configured, and where its motor stands. Nothing moves.

use std::ops::RangeInclusive;
use std::time::Duration;

use super::board::{Board, ConfigState, Talk, reason};
use super::commands::Commands;
use super::configuration::Configuration;
use super::driver_line;
use super::session_record::SessionRecord;
use super::step_rate::most_steps_s;
use super::terms::Terms;
use crate::drives::Disturbance;
use crate::drives::klipper::dictionary::Dictionary;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::link::Link;
use crate::drives::klipper::refit::{RefitError, StepTimer};
use crate::drives::klipper::tmc::TmcError;
use crate::drives::known_board::{KnownBoard, MadePlace};

/// Longest wait for a first answer.
const ANSWER_LIMIT: Duration = Duration::from_secs(3);

/// Longest wait for a motion of an earlier program. Its steps end without that program, by the dead-man time.
const REST_LIMIT: Duration = Duration::from_secs(15);

/// Time for which a count stays as it is where no step is under way at a speed at which a motor could slip.
const STILL: Duration = Duration::from_millis(150);

/// Time that a board takes to start after a reset.
const START: Duration = Duration::from_millis(500);

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
    /// Notes on the stepper driver, for a person.
    pub(in crate::drives::klipper) of_driver: Vec<String>,
}

/// Board as it was found, with what is known of it beside its link.
struct Found {
    hz: u32,
    state: ConfigState,
    record: SessionRecord,
    disturbed: Option<Disturbance>,
    is_reversed: bool,
}

/// Meets the board at the other end of `link`. Returns the link with an error, so that its port stays taken.
pub(in crate::drives::klipper) fn meet(
    mut link: Link,
    terms: &Terms,
) -> Result<Met, (Box<Link>, KlipperError)> {
    let (format, dictionary) = match identify(&mut link, terms) {
        Ok(identified) => identified,
        Err(error) => return Err((Box::new(link), error)),
    };
    let mut talk = Talk { link, dictionary, format };
    let marks = marks(&talk, terms);
    let recognised = marks.compare(Some(&terms.port), &terms.opening).map_err(KlipperError::from);
    let found = recognised.and_then(|replaced| Ok((take_over(&mut talk, terms)?, replaced)));
    let (found, replaced) = match found {
        Ok(found) => found,
        Err(error) => return Err((Box::new(talk.link), error)),
    };
    let Found { hz, state, record, disturbed, is_reversed } = found;
    let chip = talk.dictionary.constant_text("MCU");
    let ready = talk.read_clock(hz).and_then(|clock| Ok((clock, step_timer(hz, chip.as_deref(), terms)?)));
    let (clock, timer) = match ready {
        Ok(ready) => ready,
        Err(error) => return Err((Box::new(talk.link), error)),
    };
    let mut board = Board {
        talk,
        clock,
        hz,
        slots: state.slots,
        timer,
        record,
        path: terms.record.clone(),
        is_reversed,
        current_on: terms.pins.enable.as_ref().map(|enable| !enable.inverted),
        index_level: terms.pins.index.as_ref().is_some_and(|index| !index.inverted),
        bytes_s: terms.baud / BITS,
        dead_man: terms.dead_man,
        driver: terms.driver.as_ref().map(|(address, _)| *address),
    };
    let ready = energise(&mut board, terms);
    // A board whose stepper driver is not reached takes no pump's place.
    let settled = ready.and_then(|ready| Ok((ready, marks.settle(&replaced, &terms.opening)?).0));
    match settled {
        Ok((position, of_driver, was_off)) => {
            let disturbed = if was_off { Some(Disturbance::CurrentLost) } else { disturbed };
            Ok(Met { board, position, disturbed, replaced, of_driver })
        }
        Err(error) => Err((Box::new(board.talk.link), error)),
    }
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

/// Brings the board to rest with the configuration of the pump, and without current if it was configured anew.
fn take_over(talk: &mut Talk, terms: &Terms) -> Result<Found, KlipperError> {
    let hz = talk.dictionary.constant("CLOCK_FREQ", CLOCKS_HZ)?;
    let mut configuration =
        Configuration::new(&terms.pins, terms.inverts, &talk.dictionary, &talk.format, hz)?;
    driver_line::add(&mut configuration, terms.pins.tmc.as_ref(), &talk.dictionary, hz)?;
    let is_reversed = configuration.is_reversed();
    let path = terms.record.as_deref();
    let lenient = |read: Result<Option<SessionRecord>, KlipperError>| match read {
        Err(_) if terms.opening.accept_settings => Ok(None),
        read => read,
    };
    let own = lenient(path.map_or(Ok(None), SessionRecord::read))?.or(terms.last);
    let shared = SessionRecord::of_board(&terms.opening, &terms.port);
    let last = lenient(shared.as_deref().map_or(Ok(None), SessionRecord::read))?;
    let state = talk.config()?;
    let mine = own.filter(|own| {
        state.is_configured
            && own.checksum == state.checksum
            && configuration.checksum(own.session) == own.checksum
    });
    if let Some(record) = mine
        && let Some((record, disturbed)) = keep(talk, record, state)?
    {
        let state = talk.config()?;
        return Ok(Found { hz, state, record, disturbed, is_reversed });
    }
    let is_of_bench = [own, last].into_iter().flatten().any(|record| record.checksum == state.checksum);
    if state.is_configured || state.is_shut_down {
        let session = own.map_or(0, |own| own.session);
        let wanted = configuration.checksum(session);
        bring_to_rest(talk, state, is_of_bench || terms.opening.accept_settings, wanted)?;
        reset(talk)?;
    }
    let session = SessionRecord::draw();
    let checksum = configuration.checksum(session);
    let record = SessionRecord { session, checksum, has_current: false, slip_steps: 0 };
    // The disk has the session before the board does.
    for path in [shared.as_deref(), path].into_iter().flatten() {
        record.write(path)?;
    }
    let state = configure(talk, &configuration, checksum)?;
    Ok(Found { hz, state, record, disturbed: Some(Disturbance::Reset), is_reversed })
}

/// Keeps the configuration of a board that has the pump's own, and ends what an earlier program has left. Returns
/// `None` if the board has shut down and its firmware cannot go on without a reset.
fn keep(
    talk: &mut Talk,
    record: SessionRecord,
    state: ConfigState,
) -> Result<Option<(SessionRecord, Option<Disturbance>)>, KlipperError> {
    if state.is_shut_down {
        if !talk.clear_shutdown()? {
            return Ok(None);
        }
        // A shutdown takes the current away, and stops a motor without a ramp.
        talk.end_dead_man(reason::MET)?;
        let halted = Disturbance::Halted { slip_steps: record.slip_steps };
        let disturbed = if record.slip_steps > 0 { halted } else { Disturbance::Disabled };
        return Ok(Some((SessionRecord { has_current: false, ..record }, Some(disturbed))));
    }
    be_still(talk)?;
    let ended = talk.end_dead_man(reason::MET)?;
    let was_cut_off = ended == reason::MET || ended == reason::EXPIRED;
    let disturbed = match record {
        // A motor that was let go at rest has no slip on record, and one without current otherwise had a shutdown.
        SessionRecord { slip_steps, has_current, .. } if (was_cut_off || !has_current) && slip_steps > 0 => {
            Some(Disturbance::Halted { slip_steps })
        }
        SessionRecord { has_current: false, .. } => Some(Disturbance::Disabled),
        _ => None,
    };
    Ok(Some((record, disturbed)))
}

/// Waits until the count of the stepper stays as it is.
pub(in crate::drives::klipper) fn be_still(talk: &mut Talk) -> Result<(), KlipperError> {
    let began = talk.link.now();
    let (mut position, mut since) = (talk.position()?, began);
    loop {
        talk.link.sleep(STILL / 5);
        let (now, at) = (talk.position()?, talk.link.now());
        if now != position {
            (position, since) = (now, at);
        }
        if at.saturating_sub(since) >= STILL {
            return Ok(());
        }
        let waited = at.saturating_sub(began);
        if waited > REST_LIMIT {
            return Err(KlipperError::Moving { waited_s: waited.as_secs_f64() });
        }
    }
}

/// Brings a board to rest that is configured otherwise, or refuses one that is not known to stand. One of this bench
/// has the same objects, and a person may accept any other.
fn bring_to_rest(
    talk: &mut Talk,
    state: ConfigState,
    is_known: bool,
    wanted: u32,
) -> Result<(), KlipperError> {
    if state.is_shut_down {
        return Ok(());
    }
    if !is_known {
        return Err(KlipperError::Configured { found: state.checksum, wanted });
    }
    // A board of another program may have no stepper of this number, and then shuts down, which is a rest too.
    match be_still(talk) {
        Ok(()) | Err(KlipperError::Shutdown { .. } | KlipperError::NoAnswer { .. }) => {}
        Err(error) => return Err(error),
    }
    if !talk.config()?.is_shut_down {
        let stop = talk.format.emergency_stop.clone();
        talk.tell(&stop, &[])?;
    }
    Ok(())
}

/// Resets a board that has shut down, so that it forgets its configuration.
fn reset(talk: &mut Talk) -> Result<(), KlipperError> {
    let began = talk.link.now();
    if talk.dictionary.has_command("config_reset") {
        let command = talk.dictionary.command("config_reset")?;
        talk.tell(&command, &[])?;
    } else {
        let command = talk.dictionary.command("reset")?;
        talk.link.queue(&command.encode(&[])?)?;
        // The board does not confirm it, and counts blocks anew.
        talk.link.turn(Duration::ZERO)?;
        talk.link.sleep(START);
        talk.link.connect(ANSWER_LIMIT)?;
    }
    loop {
        talk.forget();
        let state = talk.config()?;
        if !state.is_configured && !state.is_shut_down {
            return Ok(());
        }
        if talk.link.now().saturating_sub(began) > ANSWER_LIMIT {
            return Err(KlipperError::NoReset);
        }
        talk.link.sleep(STILL / 5);
    }
}

/// Configures the board.
fn configure(
    talk: &mut Talk,
    configuration: &Configuration,
    checksum: u32,
) -> Result<ConfigState, KlipperError> {
    talk.forget();
    for command in configuration.commands() {
        talk.link.queue(command)?;
    }
    let finalize = talk.format.finalize_config.clone();
    talk.tell(&finalize, &[checksum.into()])?;
    talk.hear()?;
    let state = talk.config()?;
    match state {
        ConfigState { is_configured: true, is_shut_down: false, checksum: told, .. } if told == checksum => {
            Ok(state)
        }
        _ => Err(KlipperError::Configured { found: state.checksum, wanted: checksum }),
    }
}

/// Sets the stepper driver, and gives the motor current. Returns the count, what a person is to know of the
/// stepper driver, and true if that has lost its motor's current since it was set.
fn energise(board: &mut Board, terms: &Terms) -> Result<(i64, Vec<String>, bool), KlipperError> {
    let mut was_off = false;
    let of_driver = match &terms.driver {
        // The registers are set while the motor has no current, and checked while it has.
        Some(driver) if board.record.has_current => match driver_line::check(&mut board.talk, driver.0) {
            Err(KlipperError::Driver(lost @ (TmcError::Reset { .. } | TmcError::Off { .. }))) => {
                was_off = true;
                board.set_current(false)?;
                // A fault that is still there is refused now.
                let mut of_driver = driver_line::set(&mut board.talk, driver)?;
                of_driver.insert(0, lost.to_string());
                of_driver
            }
            checked => checked?.into_iter().collect(),
        },
        Some(driver) => driver_line::set(&mut board.talk, driver)?,
        None => Vec::new(),
    };
    board.set_current(true)?;
    if !board.record.has_current || board.record.slip_steps > 0 {
        let record = SessionRecord { has_current: true, slip_steps: 0, ..board.record };
        board.put_on_record(record)?;
    }
    Ok((board.position()?, of_driver, was_off))
}
