//! The port of a balance, which is another one than the board's.

use std::path::Path;

use super::error::BalanceError;

/// Refuses the port of a pump's board as that of a balance, whatever links lead to it. Opens neither.
///
/// # Errors
///
/// [`BalanceError::AtBoard`] if both are one device.
pub fn refuse_port_of_board(balance: &Path, board: Option<&Path>) -> Result<(), BalanceError> {
    let device = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    match board {
        Some(board) if device(board) == device(balance) => {
            Err(BalanceError::AtBoard { port: balance.to_owned() })
        }
        _ => Ok(()),
    }
}
