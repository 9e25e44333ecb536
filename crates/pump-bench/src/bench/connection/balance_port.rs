//! The port of the balance, which is another one than the board's.

use std::path::Path;

use crate::balance::BalanceError;
use crate::bench::bench::Bench;

impl Bench {
    /// Refuses the port of the pump's board as that of its balance, whatever links lead to it. Opens neither.
    ///
    /// # Errors
    ///
    /// [`BalanceError::AtBoard`] if both are one device.
    pub fn refuse_port_of_board(&self, balance: &Path) -> Result<(), BalanceError> {
        let Some(board) = self.drive().port.as_deref().filter(|_| !self.is_simulated()) else {
            return Ok(());
        };
        let device = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if device(board) == device(balance) {
            return Err(BalanceError::AtBoard { port: balance.to_owned() });
        }
        Ok(())
    }
}
