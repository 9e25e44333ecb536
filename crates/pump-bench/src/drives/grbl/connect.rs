//! Finding a board, and bringing it to rest.

use std::time::{Duration, Instant};

use super::board::{Board, Heard, POLL};
use super::error::GrblError;
use super::reply::{Reply, State};
use crate::pump_file::DriveTable;

/// Longest wait for a first answer. Bootloaders take two seconds, boards with a network some more.
const ANSWER_LIMIT: Duration = Duration::from_secs(8);

/// Time between questions until the first answer.
const KNOCK: Duration = Duration::from_millis(200);

/// Silence after a banner from which on a board is ready. More lines follow a banner.
const QUIET: Duration = Duration::from_millis(150);

/// Longest wait for a motion that is under way at the start. The jogs that an earlier process sent take a
/// second or two.
const REST_LIMIT: Duration = Duration::from_secs(30);

/// Longest wait for a hold to end by itself.
const HOLD_LIMIT: Duration = Duration::from_secs(2);

/// Byte that resets grbl, without its counter.
pub(super) const RESET: u8 = 0x18;

/// Waits until a board answers. Returns true if the board was reset meanwhile.
pub(super) fn find(board: &mut Board, table: &DriveTable) -> Result<bool, GrblError> {
    let started = Instant::now();
    let mut reset = false;
    let mut noise = String::new();
    while started.elapsed() < ANSWER_LIMIT {
        board.ask()?;
        let until = Instant::now() + KNOCK;
        while let Some(heard) = board.hear(until.saturating_duration_since(Instant::now()))? {
            match heard {
                Heard::Reply(Reply::Banner(_)) => {
                    reset = true;
                    reset |= quiet(board)?;
                    return Ok(reset);
                }
                Heard::Status(..) => {
                    reset |= quiet(board)?;
                    return Ok(reset);
                }
                Heard::Reply(Reply::Unknown(line)) if noise.is_empty() => noise = line,
                Heard::Reply(_) => {}
            }
        }
    }
    let port = table.port.clone().unwrap_or_default();
    let heard: String = noise.chars().take(60).collect();
    let heard = if heard.is_empty() { heard } else { format!(" (it said {heard:?})") };
    Err(GrblError::NoGrbl { port, baud: table.baud, waited_s: ANSWER_LIMIT.as_secs_f64(), heard })
}

/// Waits until the board falls silent. Returns true if a banner was among its lines.
fn quiet(board: &mut Board) -> Result<bool, GrblError> {
    let until = Instant::now() + ANSWER_LIMIT;
    let mut reset = false;
    while let Some(heard) = board.hear(QUIET)? {
        reset |= matches!(heard, Heard::Reply(Reply::Banner(_)));
        if Instant::now() >= until {
            break;
        }
    }
    Ok(reset)
}

/// Brings the board to rest, ready for jogs. Unlocks a board that is locked because it was just reset.
///
/// Sets `reset` to true if the board is reset meanwhile.
pub(super) fn rest(board: &mut Board, reset: &mut bool) -> Result<(), GrblError> {
    let started = Instant::now();
    let mut unlocked = false;
    loop {
        let state = board.state(|| *reset = true)?;
        let waited = started.elapsed();
        match state {
            State::Idle => return Ok(()),
            State::Alarm if *reset && !unlocked => {
                board.command("$X")?;
                unlocked = true;
            }
            State::Sleep if !*reset => {
                board.send_byte(RESET)?;
                quiet(board)?;
                *reset = true;
            }
            State::Run | State::Jog | State::Home if waited < REST_LIMIT => pause(board)?,
            State::Run | State::Jog | State::Home => {
                return Err(GrblError::Moving { waited_s: waited.as_secs_f64() });
            }
            State::Hold { .. } if waited < HOLD_LIMIT => pause(board)?,
            other => return Err(locked(other)),
        }
    }
}

/// Lets a moment pass and discards what is heard.
fn pause(board: &mut Board) -> Result<(), GrblError> {
    std::thread::sleep(POLL);
    board.hear(Duration::ZERO).map(|_| ())
}

/// Returns the refusal of a board in this state, with advice.
fn locked(state: State) -> GrblError {
    let instead = match state {
        State::Alarm => "find out why, make sure that it is safe, then send it `$X` or switch it off and on",
        State::Hold { .. } => "resume it with its button or `~`, or switch it off and on",
        State::Door => "close the safety door",
        State::Check => "it only checks G-code; send it `$C`",
        _ => "switch it off and on",
    };
    let state = match state {
        State::Hold { .. } => "Hold".to_owned(),
        State::Other(word) => word,
        state => format!("{state:?}"),
    };
    GrblError::Locked { state, instead }
}
