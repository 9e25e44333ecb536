//! A board that several drives of this process share, each for one axis. One of them talks to it at a time.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::meeting::Share;
use crate::drives::grbl::board::Board;
use crate::drives::grbl::error::GrblError;
use crate::drives::wire::{BoardPort, NotShared, OpenPorts, Wire};
use crate::drives::{DriveError, Opening, StopRequest};
use crate::pump_file::{Axis, DriveTable};

/// Boards whose ports this process has open.
static OPEN: OpenPorts<SharedBoard> = OpenPorts::new();

/// Time between two looks at a board with which another axis talks.
const LOOK: Duration = Duration::from_millis(1);

/// Longest wait of a question that may be left out, in which another axis talks with the board.
const IDLE_LIMIT: Duration = Duration::from_secs(10);

/// Board with the axes that have a drive.
#[derive(Debug)]
pub(super) struct SharedBoard {
    board: Mutex<Board>,
    /// Axes that have a drive.
    taken: Mutex<Vec<Axis>>,
    /// Number of the resets of which each record was told.
    told: Mutex<Vec<(AxisRecord, u32)>>,
    /// Shares of the axes that wait for a line.
    pub(super) shares: Mutex<Vec<Share>>,
}

/// Axis with the record of the pump that it turns.
type AxisRecord = (Axis, PathBuf);

/// Board that several drives share, each for one axis and from a thread of its own.
#[doc(hidden)]
#[derive(Debug, Clone)]
pub struct GrblBoard(Arc<SharedBoard>);

impl GrblBoard {
    /// Takes the board at the other end of `wire`.
    pub fn over(wire: Box<dyn Wire>) -> Self {
        Self(Arc::new(SharedBoard::new(wire)))
    }

    /// Opens the port of a board, or shares it with the drives of this process that have it open.
    pub(in crate::drives::grbl) fn open(port: Option<&Path>, baud: u32) -> Result<Self, DriveError> {
        let opened = || Ok(SharedBoard::new(Box::new(BoardPort::open(port, baud)?)));
        let is_broken = |shared: &SharedBoard| match shared.board.try_lock() {
            Ok(board) => board.is_gone(),
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner().is_gone(),
            Err(TryLockError::WouldBlock) => false,
        };
        match OPEN.share(port, baud, is_broken, opened) {
            Ok(shared) => Ok(Self(shared)),
            Err(NotShared::Rate { device, open_baud }) => {
                Err(GrblError::Rate { port: device, baud, open_baud }.into())
            }
            Err(NotShared::Open(error)) => Err(error),
        }
    }
}

impl SharedBoard {
    fn new(wire: Box<dyn Wire>) -> Self {
        // The axis that talks says which it is.
        let board = Board::new(wire, 0, StopRequest::default());
        Self {
            board: Mutex::new(board),
            taken: Mutex::default(),
            told: Mutex::default(),
            shares: Mutex::default(),
        }
    }
}

/// Board as one of its axes has it.
#[derive(Debug)]
pub(in crate::drives::grbl) struct AxisBoard {
    pub(super) shared: Arc<SharedBoard>,
    pub(super) axis: Axis,
    /// Record of the pump. `None` if the drive does not know it.
    record: Option<PathBuf>,
    stop: StopRequest,
}

impl AxisBoard {
    /// Takes the axis that `table` names.
    ///
    /// # Errors
    ///
    /// [`DriveError::Busy`] if another drive has it.
    pub(in crate::drives::grbl) fn take(
        board: &GrblBoard,
        table: &DriveTable,
        opening: &Opening,
    ) -> Result<Self, DriveError> {
        let GrblBoard(shared) = board;
        let mut taken = shared.taken.lock().unwrap_or_else(PoisonError::into_inner);
        if taken.contains(&table.axis) {
            let device = table.port.clone().unwrap_or_default();
            let holder = format!("this process (pid {})", std::process::id());
            return Err(DriveError::Busy { device, holder });
        }
        taken.push(table.axis);
        let (record, stop) = (opening.settings_record.clone(), opening.stop.clone());
        Ok(Self { shared: Arc::clone(shared), axis: table.axis, record, stop })
    }

    /// Returns the number of resets of which the pump's record was told while this process had the port.
    pub(in crate::drives::grbl) fn told_resets(&self) -> u32 {
        let told = self.shared.told.lock().unwrap_or_else(PoisonError::into_inner);
        let own = |(key, _): &&(AxisRecord, u32)| self.is_own(key);
        told.iter().find(own).map_or(0, |(_, resets)| *resets)
    }

    /// Notes that the pump's record was told of this number of resets. The next drive of the pump tells no more of
    /// them.
    pub(in crate::drives::grbl) fn note_told(&self, resets: u32) {
        let Some(record) = &self.record else { return };
        let mut told = self.shared.told.lock().unwrap_or_else(PoisonError::into_inner);
        told.retain(|(key, _)| !self.is_own(key));
        told.push(((self.axis, record.clone()), resets));
    }

    fn is_own(&self, (axis, record): &AxisRecord) -> bool {
        *axis == self.axis && self.record.as_ref() == Some(record)
    }

    /// Talks to the board for this axis, once no other axis does. The motion of another axis may take long.
    ///
    /// # Errors
    ///
    /// [`GrblError::Interrupted`] if the user asks to stop meanwhile.
    pub(in crate::drives::grbl) fn lock(&self) -> Result<MutexGuard<'_, Board>, GrblError> {
        loop {
            match self.try_lock() {
                Some(board) => return Ok(board),
                None if self.stop.is_made() => return Err(GrblError::Interrupted),
                None => sleep(LOOK),
            }
        }
    }

    /// Talks to the board for this axis if no other axis does within [`IDLE_LIMIT`].
    pub(in crate::drives::grbl) fn lock_if_idle(&self) -> Option<MutexGuard<'_, Board>> {
        let began = Instant::now();
        loop {
            match self.try_lock() {
                None if began.elapsed() < IDLE_LIMIT && !self.stop.is_made() => sleep(LOOK),
                board => return board,
            }
        }
    }

    fn try_lock(&self) -> Option<MutexGuard<'_, Board>> {
        let mut board = match self.shared.board.try_lock() {
            Ok(board) => board,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return None,
        };
        board.attend(self.axis.number(), &self.stop);
        Some(board)
    }

    /// Lets the other axes of the board talk to it, if there are any: they look once a [`LOOK`].
    pub(in crate::drives::grbl) fn yield_to_others(&self) {
        let is_shared = self.shared.taken.lock().unwrap_or_else(PoisonError::into_inner).len() > 1;
        if is_shared {
            sleep(3 * LOOK);
        }
    }

    /// Returns true if the user asked to stop.
    pub(in crate::drives::grbl) fn is_stopped(&self) -> bool {
        self.stop.is_made()
    }
}

impl Drop for AxisBoard {
    fn drop(&mut self) {
        let mut taken = self.shared.taken.lock().unwrap_or_else(PoisonError::into_inner);
        taken.retain(|axis| *axis != self.axis);
    }
}
