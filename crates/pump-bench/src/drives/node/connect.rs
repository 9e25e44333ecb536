//! Meeting a board: who it is, which session it holds, and how its axis is configured.

use std::path::PathBuf;
use std::time::Duration;

use pump_ctl::step::{Brake, TickRate};
use pump_link::message::{
    Answer, AxisConfig, AxisState, AxisStatus, FaultCounts, Identity, MAX_PACKED, Refusal, Request,
};
use pump_link::packing::{Codec, Grain};

use super::board::Board;
use super::error::NodeError;
use super::link::Link;
use super::session_record::SessionRecord;
use crate::drives::known_board::KnownBoard;
use crate::drives::{Disturbance, Opening};
use crate::pump_file::{Axis, DriveTable};

/// Longest wait for a first answer.
const ANSWER_LIMIT: Duration = Duration::from_secs(3);

/// Longest wait for a motion that is under way at the start. An earlier process's ends by the dead-man time.
const REST_LIMIT: Duration = Duration::from_secs(15);

/// Time between two questions to a board that moves.
const POLL: Duration = Duration::from_millis(20);

/// Time without a word of this program after which the board decelerates, ms.
const DEAD_MAN_MS: u16 = 500;

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
            at_port: KnownBoard::at_port(table.port.as_deref(), opening),
            opening: opening.clone(),
        }
    }

    /// Returns the configuration of the axis.
    fn config(&self, energised: bool, brake: &Brake) -> AxisConfig {
        let idle_ms = |hold_s: f64| (hold_s * 1e3).min(f64::from(u32::MAX / 2)) as u32 + IDLE_MARGIN_MS;
        let mut config = AxisConfig::new(brake.climb().count() as u8);
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
    /// Words for the board that was on record, if this one was accepted in its place.
    pub(super) replaced: Option<String>,
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
    let (identity, held) = given!(identify(&mut link, terms));
    let axis = terms.axis as u8;
    if axis >= identity.axes {
        let (axis, axes) = (format!("{:?}", terms.axis).chars().next().unwrap_or('?'), identity.axes);
        return Err((Box::new(link), NodeError::NoAxis { axis, axes }));
    }
    let tick_rate = given!(TickRate::from_hz(identity.tick_hz).ok_or(NodeError::NoTimer));
    let brake = given!(make_brake(tick_rate));
    let replaced = given!(recognise(&identity, terms));
    let (record, holds) = given!(session(&identity, held, terms));
    link.begin(record.session);
    let (baud, dead_man_ms) = (terms.baud, DEAD_MAN_MS);
    let mut board = Board { link, identity, tick_rate, axis, move_number: 0, revision: 0, baud, dead_man_ms };
    match take_over(&mut board, terms, &brake, holds) {
        Ok((status, disturbed)) => {
            let (position, unread) = (status.position, status.unread);
            Ok(Met { board, brake, position, disturbed, unread, replaced })
        }
        Err(error) => Err((Box::new(board.link), error)),
    }
}

/// Waits until a board says who it is. Returns that, and the session that it holds.
fn identify(link: &mut Link, terms: &Terms) -> Result<(Identity, u64), NodeError> {
    link.begin(0);
    let began = link.now();
    loop {
        match link.ask(&Request::Identify) {
            Ok(reply) => match reply.answer {
                Answer::Identity(identity) => return Ok((identity, reply.session)),
                Answer::Refused(refusal) => return Err(NodeError::of(refusal)),
                _ => {}
            },
            Err(NodeError::Quiet { .. }) => link.clear(),
            Err(error) => return Err(error),
        }
        if let Some(theirs) = link.other_version {
            return Err(NodeError::Version { theirs });
        }
        let waited = link.now() - began;
        if waited < ANSWER_LIMIT {
            continue;
        }
        let (port, baud) = (terms.port.clone(), terms.baud);
        return Err(match link.bytes {
            0 => NodeError::Silent { port, baud, waited_s: waited.as_secs_f64() },
            bytes => NodeError::Foreign { port, baud, bytes },
        });
    }
}

/// Refuses another board than the one on record, unless it is accepted. Returns words for that one then.
fn recognise(identity: &Identity, terms: &Terms) -> Result<Option<String>, NodeError> {
    // A board whose flash chip tells no number says 0.
    let number = Some(identity.board).filter(|number| *number != 0);
    let found = KnownBoard { number, ..terms.at_port.clone() };
    Ok(found.recognise(Some(&terms.port), &terms.opening)?)
}

/// Returns the record of the board, and true if the board holds its session. The disk has a new session before the
/// board does.
fn session(identity: &Identity, held: u64, terms: &Terms) -> Result<(SessionRecord, bool), NodeError> {
    let path = terms.record.as_deref();
    let recorded = match path.map(SessionRecord::read).transpose() {
        Err(_) if terms.opening.accept_settings => None,
        read => read?.flatten(),
    };
    let same = recorded.filter(|recorded| recorded.board == identity.board);
    if let Some(same) = same.filter(|same| same.session == held) {
        return Ok((same, true));
    }
    let record = SessionRecord::new(identity.board);
    if let Some(path) = path {
        record.write(path)?;
    }
    Ok((record, false))
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
