//! Meeting a board: who it is, which session it holds, and how its axis is configured.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use pump_ctl::step::{Brake, TickRate};
use pump_link::message::{
    Answer, AxisConfig, AxisState, AxisStatus, FaultCounts, FaultOutput, Identity, MAX_PACKED, Refusal,
    Request,
};
use pump_link::packing::{Codec, Grain};

use super::board::Board;
use super::board_record::BoardRecord;
use super::error::NodeError;
use super::line::Line;
use super::link::{Link, PATIENCE};
use super::session_record::SessionRecord;
use crate::drives::known_board::{KnownBoard, MadePlace};
use crate::drives::{Disturbance, Opening};
use crate::pump_file::{Axis, DriveTable, DriverFault, Pins};

/// Longest wait for a first answer.
const ANSWER_LIMIT: Duration = Duration::from_secs(3);

/// Longest wait for a motion that is under way at the start. An earlier process's ends by the dead-man time.
const REST_LIMIT: Duration = Duration::from_secs(15);

/// Longest search for a silent board in motion while pumps at other boards wait for its end to stop.
const SHORT_PATIENCE: Duration = Duration::from_secs(1);

/// Time between two questions to a board that moves.
const POLL: Duration = Duration::from_millis(20);

/// Margin by which the board lets go of an idle motor later than the session does, which puts it on record, ms.
const IDLE_MARGIN_MS: u32 = 5_000;

/// Terms on which a board is met.
#[derive(Debug, Clone)]
pub(super) struct Terms {
    pub(super) port: PathBuf,
    pub(super) baud: u32,
    pub(super) axis: Axis,
    pub(super) invert: bool,
    pub(super) has_index: bool,
    pub(super) hold_timeout_s: Option<f64>,
    /// File that holds the board's number and its session.
    pub(super) record: Option<PathBuf>,
    /// Terms on which the device is opened.
    pub(super) opening: Opening,
    /// Marks of the board that its port tells.
    at_port: KnownBoard,
    /// Times and polarity of the pins.
    pins: Pins,
    /// Time without a word of this program after which the board decelerates, ms.
    dead_man_ms: u16,
}

impl Terms {
    /// Returns the terms of a drive table.
    pub(super) fn new(table: &DriveTable, opening: &Opening) -> Self {
        Self {
            port: table.port.clone().unwrap_or_default(),
            baud: table.rate_baud(),
            axis: table.axis,
            invert: table.invert,
            has_index: table.index_angle_deg.is_some(),
            hold_timeout_s: table.hold_timeout_s,
            record: opening.settings_record.clone(),
            at_port: KnownBoard {
                axis: Some(table.axis),
                ..KnownBoard::at_port(table.port.as_deref(), opening)
            },
            opening: opening.clone(),
            pins: table.pins_or_usual(),
            dead_man_ms: table.dead_man_or_usual_ms(),
        }
    }

    /// Returns the configuration of the axis.
    pub(super) fn config(&self, energised: bool, brake: &Brake) -> AxisConfig {
        let idle_ms = |hold_s: f64| (hold_s * 1e3).min(f64::from(u32::MAX / 2)) as u32 + IDLE_MARGIN_MS;
        let mut config = AxisConfig::new(brake.climb().count() as u8);
        let (pins, ns) = (self.pins, |time_us: f64| (1e3 * time_us).round() as u32);
        config.step_high_ns = ns(pins.step_pulse_us);
        config.step_low_ns = ns(pins.step_pause_us);
        config.direction_setup_ns = ns(pins.direction_setup_us);
        config.direction_hold_ns = ns(pins.direction_hold_us);
        config.enable_setup_ns = ns(1e3 * pins.enable_setup_ms);
        config.step_active_low = pins.step_active_low;
        config.enable_active_low = pins.enable_active_low;
        config.index_active_low = pins.index_active_low;
        config.driver_fault = match pins.driver_fault {
            DriverFault::None => FaultOutput::None,
            DriverFault::Low => FaultOutput::ActiveLow,
            DriverFault::High => FaultOutput::ActiveHigh,
        };
        config.reversed = self.invert;
        config.has_index = self.has_index;
        config.energised = energised;
        config.idle_release_ms = self.hold_timeout_s.map_or(0, idle_ms);
        config
    }
}

/// Board that was met, and the state in which its axis was found.
pub(super) struct Met {
    pub(super) board: Board,
    pub(super) brake: Brake,
    /// Steps that the axis counts.
    pub(super) position: i64,
    pub(super) disturbed: Option<Disturbance>,
    /// Faults that nobody had read.
    pub(super) unread: FaultCounts,
    /// Board and pumps that were on record in the place of these, if that was accepted.
    pub(super) replaced: MadePlace,
    /// True if the record says that the pump's journal counts by this axis.
    pub(super) is_axis_recorded: bool,
}

/// Session of a board.
struct Found {
    session: u64,
    /// True if the board holds it.
    holds: bool,
    /// Axis by which the pump's journal counts, as far as the record tells.
    counted_by: Option<Axis>,
}

/// Meets the board at the other end of `link`, and configures its axis. Nothing moves.
pub(super) fn meet(
    mut link: Link,
    terms: &Terms,
    make_brake: impl FnOnce(TickRate) -> Result<Brake, NodeError>,
) -> Result<Met, (Box<Link>, NodeError)> {
    macro_rules! given {
        ($result:expr) => {
            match $result {
                Ok(value) => value,
                Err(error) => return Err((Box::new(link), error)),
            }
        };
    }
    let shared = Arc::clone(link.shared());
    let _meeting = given!(link.meeting(&shared));
    let (identity, held) = given!(who(&mut link, terms));
    let axis = terms.axis as u8;
    if axis >= identity.axes {
        let (axis, axes) = (format!("{:?}", terms.axis).chars().next().unwrap_or('?'), identity.axes);
        return Err((Box::new(link), NodeError::NoAxis { axis, axes }));
    }
    let tick_rate = given!(TickRate::from_hz(identity.tick_hz).ok_or(NodeError::NoTimer));
    let brake = given!(make_brake(tick_rate));
    // Another board than the one on record is refused, unless it is accepted.
    let recognised = marks(&identity, terms).recognise(Some(&terms.port), &terms.opening);
    let replaced = given!(recognised.map_err(NodeError::from));
    let found = session(&mut link.line(), &identity, held, terms);
    let Found { session, holds, counted_by } = given!(found);
    if session != link.session() {
        link.begin(session);
    }
    let mut line = link.line();
    if let Some(lane) = line.lane(axis) {
        lane.dead_man_ms = Some(terms.dead_man_ms);
    }
    let dead_man_ms = line.dead_man_ms().unwrap_or(terms.dead_man_ms);
    drop(line);
    let baud = terms.baud;
    // While pumps at other boards wait for its end to stop, the search is short: the next meeting finds the count.
    let patience = if terms.opening.with_other_boards { SHORT_PATIENCE } else { PATIENCE };
    let (move_number, revision) = (0, 0);
    let mut board =
        Board { link, identity, tick_rate, axis, move_number, revision, baud, dead_man_ms, patience };
    match take_over(&mut board, terms, &brake, holds) {
        Ok((status, disturbed)) => {
            let is_taken = held != 0 && !holds || replaced.board.is_some();
            let disturbed = match disturbed {
                Some(Disturbance::Reset) if is_taken => Some(Disturbance::TakenOver),
                disturbed => disturbed,
            };
            let is_elsewhere = counted_by.is_some_and(|axis| axis != terms.axis);
            let disturbed = if holds && is_elsewhere { Some(Disturbance::OtherAxis) } else { disturbed };
            let (position, unread) = (status.position, status.unread);
            if let Some(lane) = board.link.line().lane(axis) {
                lane.is_met = true;
            }
            let is_axis_recorded = counted_by == Some(terms.axis);
            Ok(Met { board, brake, position, disturbed, unread, replaced, is_axis_recorded })
        }
        Err(error) => Err((Box::new(board.link), error)),
    }
}

/// Returns the board and the session that it holds. A board that other axes of the line have met, and that was not
/// reset since, is not disturbed.
fn who(link: &mut Link, terms: &Terms) -> Result<(Identity, u64), NodeError> {
    let lane = link.lane();
    let line = link.line();
    let known = line.identity.filter(|_| line.others(lane).any(|other| other.is_met));
    drop(line);
    if let Some(identity) = known {
        link.join();
        let held = link.ask(&Request::Status { axis: lane })?.session;
        if held == link.session() {
            return Ok((identity, held));
        }
    }
    let (identity, held) = identify(link, &terms.port, terms.baud, ANSWER_LIMIT)?;
    link.line().identity = Some(identity);
    Ok((identity, held))
}

/// Waits for as long as `limit` until a board says who it is. Returns that, and the session that it holds.
pub(super) fn identify(
    link: &mut Link,
    port: &Path,
    baud: u32,
    limit: Duration,
) -> Result<(Identity, u64), NodeError> {
    link.begin(0);
    let began = link.now();
    loop {
        match link.ask_once(&Request::Identify) {
            Ok(reply) => match reply.answer {
                Answer::Identity(identity) => return Ok((identity, reply.session)),
                Answer::Refused(Refusal::Version { known: theirs }) => {
                    return Err(NodeError::Version { port: port.to_owned(), theirs });
                }
                Answer::Refused(refusal) => return Err(NodeError::of(refusal)),
                _ => {}
            },
            Err(NodeError::Quiet { .. }) => link.clear(),
            Err(error) => return Err(error),
        }
        let Line { other_version, bytes, .. } = *link.line();
        if let Some(theirs) = other_version {
            return Err(NodeError::Version { port: port.to_owned(), theirs });
        }
        let waited = link.now() - began;
        if waited < limit {
            continue;
        }
        let port = port.to_owned();
        return Err(match bytes {
            0 => NodeError::Silent { port, baud, waited_s: waited.as_secs_f64() },
            bytes => NodeError::Foreign { port, baud, bytes },
        });
    }
}

/// Returns the marks of a board.
pub(super) fn marks(identity: &Identity, terms: &Terms) -> KnownBoard {
    // A board whose flash chip tells no number says 0.
    let number = Some(identity.board).filter(|number| *number != 0);
    KnownBoard { number, ..terms.at_port.clone() }
}

/// Returns the session of the board, and whether the board holds it. The disk has a new session before the board does.
/// All pumps of the board share it, so none takes the board from another.
fn session(line: &mut Line, identity: &Identity, held: u64, terms: &Terms) -> Result<Found, NodeError> {
    let lenient = |read: Result<Option<SessionRecord>, NodeError>| match read {
        Err(_) if terms.opening.accept_settings => Ok(None),
        read => read,
    };
    let path = terms.record.as_deref();
    let of_pump = lenient(path.map_or(Ok(None), SessionRecord::read))?;
    // Number 0 is that of a board whose firmware knew none.
    let same = of_pump.filter(|recorded| [0, identity.board].contains(&recorded.board));
    let boards = terms.opening.boards.as_deref();
    let record = boards.map(|folder| BoardRecord::of(folder, identity.board, &terms.port));
    if let Some(record) = &record
        && !line.hold.as_ref().is_some_and(|hold| hold.is_of(record))
    {
        line.hold = None;
        line.hold = Some(record.hold(&terms.port)?);
    }
    let of_board = lenient(record.as_ref().map_or(Ok(None), |record| SessionRecord::read(record.path())))?;
    let known = [of_board, same].into_iter().flatten().map(|recorded| recorded.session).chain([line.given]);
    let holds = held != 0 && known.into_iter().any(|session| session == held);
    let session = if holds { held } else { SessionRecord::new(identity.board).session };
    let now = |axis| SessionRecord { board: identity.board, session, axis };
    let counted_by = same.and_then(|recorded| recorded.axis);
    for (path, before, now) in
        [(record.as_ref().map(BoardRecord::path), of_board, now(None)), (path, of_pump, now(counted_by))]
    {
        if let Some(path) = path.filter(|_| before != Some(now)) {
            now.write(path)?;
        }
    }
    line.given = session;
    Ok(Found { session, holds, counted_by })
}

/// Puts on record that the pump's journal counts by this axis. The journal has noted before that it counts anew.
pub(super) fn record_axis(board: &Board, terms: &Terms) -> Result<(), NodeError> {
    let Some(path) = terms.record.as_deref() else { return Ok(()) };
    let (number, session) = (board.identity.board, board.link.session());
    SessionRecord { board: number, session, axis: Some(terms.axis) }.write(path)
}

/// Brings the board to rest, gives it the session, and configures its axis.
fn take_over(
    board: &mut Board,
    terms: &Terms,
    brake: &Brake,
    holds: bool,
) -> Result<(AxisStatus, Option<Disturbance>), NodeError> {
    adopt(board)?;
    let status = rest(board)?;
    let was_configured = holds && status.revision != 0;
    let disturbed = match () {
        () if status.unread.estop > 0 => Some(Disturbance::EmergencyStop),
        () if !was_configured => Some(Disturbance::Reset),
        () if status.angle_lost || !status.energised => Some(Disturbance::Disabled),
        () => None,
    };
    (board.move_number, board.revision) = (status.move_number, status.revision);
    configure(board, terms, brake, true)?;
    confirm(board, &status)?;
    // The count is that of the axis as it is configured now.
    let (now, _) = board.status()?;
    Ok((AxisStatus { unread: status.unread, ..now }, disturbed))
}

/// Gives the board the session. A board that another session moves is waited for.
fn adopt(board: &mut Board) -> Result<(), NodeError> {
    let began = board.link.now();
    loop {
        let reply = board.link.ask(&Request::Adopt { dead_man_ms: board.dead_man_ms })?;
        match reply.answer {
            Answer::Adopted => return Ok(()),
            Answer::Refused(Refusal::Moving) => wait(board, began)?,
            Answer::Refused(refusal) => return Err(NodeError::of(refusal)),
            // A late answer to the question who the board is.
            _ => {}
        }
    }
}

/// Stops what an earlier process of this session has left, and waits until the axis stands.
fn rest(board: &mut Board) -> Result<AxisStatus, NodeError> {
    let began = board.link.now();
    loop {
        let reply = board.link.ask(&Request::Status { axis: board.axis })?;
        let status = match reply.answer {
            Answer::Status(status) => status,
            Answer::Refused(refusal) => return Err(NodeError::of(refusal)),
            _ => continue,
        };
        board.holds(&reply)?;
        match status.state {
            AxisState::Moving | AxisState::Prepared => {
                board.move_number = status.move_number;
                let moves = board.moves();
                board.ask(&Request::Stop { moves })?;
            }
            AxisState::Ending(_) => wait(board, began)?,
            _ => return Ok(status),
        }
    }
}

fn wait(board: &mut Board, began: Duration) -> Result<(), NodeError> {
    let waited = board.link.now().saturating_sub(began);
    if waited > REST_LIMIT {
        return Err(NodeError::Moving { waited_s: waited.as_secs_f64() });
    }
    board.link.heed()?;
    board.link.pass(POLL)
}

/// Configures the axis under a new revision. Its motor is energised, or let go.
pub(super) fn configure(
    board: &mut Board,
    terms: &Terms,
    brake: &Brake,
    energised: bool,
) -> Result<(), NodeError> {
    let (axis, revision) = (board.axis, board.revision + 1);
    let config = terms.config(energised, brake);
    let taken = |answer| match answer {
        Answer::Configured { brake_entries } => Ok(brake_entries),
        Answer::Refused(refusal) => Err(NodeError::of(refusal)),
        _ => Err(NodeError::Answer),
    };
    let mut first = taken(board.ask(&Request::Configure { axis, revision, config })?.answer)?;
    let entries: Vec<_> = brake.climb().copied().collect();
    // A board that holds all entries of an attempt that it refused takes the configuration by an empty rest.
    loop {
        let rest = entries.get(usize::from(first)..).unwrap_or_default();
        let mut packed = [0; MAX_PACKED];
        let mut room = &mut packed[..];
        let mut codec = Codec::new(Grain::Exact);
        let written = rest.iter().take_while(|entry| codec.write(entry, &mut room).is_ok()).count();
        let used = MAX_PACKED - room.len();
        let part = packed.get(..used).unwrap_or_default();
        let there = taken(board.ask(&Request::Brake { axis, revision, first, entries: part })?.answer)?;
        if usize::from(there) >= entries.len() {
            board.revision = revision;
            return Ok(());
        }
        if written == 0 || there <= first {
            return Err(NodeError::Answer);
        }
        first = there;
    }
}

/// Confirms the faults that were read, so that the board forgets them.
pub(super) fn confirm(board: &mut Board, status: &AxisStatus) -> Result<(), NodeError> {
    if !status.unread.is_empty() {
        board.ask(&Request::FaultsRead { axis: board.axis, read: status.faults })?;
    }
    Ok(())
}

/// Confirms the faults that an axis has counted, which are on record: a board that is met again tells them as new
/// otherwise.
pub(super) fn confirm_faults(link: &mut Link, axis: u8) -> Result<(), NodeError> {
    if let Answer::Status(status) = link.ask(&Request::Status { axis })?.answer {
        link.ask(&Request::FaultsRead { axis, read: status.faults })?;
    }
    Ok(())
}
