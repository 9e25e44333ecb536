//! Finding a board, and bringing it to rest.

use std::time::Duration;

use super::board::{Board, Heard, POLL};
use super::error::GrblError;
use super::reply::{BoardState, Reply};
use crate::pump_file::DriveTable;

/// Longest wait for a first answer. Bootloaders take two seconds, boards with a network some more.
pub(super) const ANSWER_LIMIT: Duration = Duration::from_secs(8);

/// Time between questions until the first answer.
const KNOCK: Duration = Duration::from_millis(200);

/// Silence after a banner from which on a board is ready. More lines follow a banner.
const QUIET: Duration = Duration::from_millis(150);

/// Longest wait for that silence. Some boards never fall silent.
const QUIET_LIMIT: Duration = Duration::from_secs(2);

/// Longest wait for a motion that is under way at the start. The jogs that an earlier process sent take a
/// second or two.
const REST_LIMIT: Duration = Duration::from_secs(30);

/// Longest wait for a hold to end by itself.
const HOLD_LIMIT: Duration = Duration::from_secs(2);

/// Byte that resets grbl, without its counter.
pub(super) const RESET: u8 = 0x18;

/// Waits for as long as `limit` until a board answers. Returns true if the board was reset meanwhile.
pub(super) fn find(board: &mut Board, table: &DriveTable, limit: Duration) -> Result<bool, GrblError> {
    let started = board.now();
    let mut reset = false;
    let mut noise = String::new();
    while board.now() - started < limit {
        board.ask()?;
        let until = board.now() + KNOCK;
        loop {
            let left = until.saturating_sub(board.now());
            if left.is_zero() {
                break;
            }
            match board.hear(left)? {
                Some(Heard::Reply(Reply::Banner(_))) => {
                    reset = true;
                    reset |= quiet(board)?;
                    return Ok(reset);
                }
                Some(Heard::Status(..)) => {
                    reset |= quiet(board)?;
                    return Ok(reset);
                }
                Some(Heard::Reply(Reply::Unknown(line))) if noise.is_empty() => noise = line,
                _ => {}
            }
        }
    }
    let port = table.port.clone().unwrap_or_default();
    let heard: String = noise.chars().take(60).collect();
    let heard = if heard.is_empty() { heard } else { format!(" (it said {heard:?})") };
    Err(GrblError::NoGrbl { port, baud: table.rate_baud(), waited_s: limit.as_secs_f64(), heard })
}

/// Waits until the board says nothing but status reports. Returns true if a banner was among its lines.
fn quiet(board: &mut Board) -> Result<bool, GrblError> {
    let until = board.now() + QUIET_LIMIT;
    let mut quiet_at = board.now() + QUIET;
    let mut reset = false;
    loop {
        let left = quiet_at.min(until).saturating_sub(board.now());
        if left.is_zero() {
            return Ok(reset);
        }
        if let Some(Heard::Reply(reply)) = board.hear(left)? {
            reset |= matches!(reply, Reply::Banner(_));
            quiet_at = board.now() + QUIET;
        }
    }
}

/// Brings the board to rest, ready for jogs. Unlocks a board that is locked because it was just reset.
///
/// Sets `reset` to true if the board is reset meanwhile.
pub(super) fn rest(board: &mut Board, reset: &mut bool) -> Result<(), GrblError> {
    let started = board.now();
    let mut unlocked = false;
    loop {
        let state = board.state(|| *reset = true)?;
        let waited = board.now() - started;
        match state {
            BoardState::Idle => return Ok(()),
            BoardState::Alarm if *reset && !unlocked => {
                board.first_command("$X")?;
                unlocked = true;
            }
            BoardState::Sleep if !*reset => {
                board.send_byte(RESET)?;
                quiet(board)?;
                *reset = true;
            }
            BoardState::Run | BoardState::Jog | BoardState::Home if waited < REST_LIMIT => {
                board.pass(POLL)?;
            }
            BoardState::Run | BoardState::Jog | BoardState::Home => {
                return Err(GrblError::Moving { waited_s: waited.as_secs_f64() });
            }
            BoardState::Hold { .. } if waited < HOLD_LIMIT => board.pass(POLL)?,
            other => return Err(locked(other)),
        }
    }
}

/// Returns the refusal of a board in this state, with advice.
fn locked(state: BoardState) -> GrblError {
    let instead = match &state {
        BoardState::Alarm => {
            "find out why, make sure that it is safe, then send it `$X` or switch it off and on"
        }
        BoardState::Hold { .. } => "resume it with its button or `~`, or switch it off and on",
        BoardState::Door => "close the safety door",
        BoardState::Check => "it only checks G-code; send it `$C`",
        _ => "switch it off and on",
    };
    GrblError::Locked { state: state.word(), instead }
}
