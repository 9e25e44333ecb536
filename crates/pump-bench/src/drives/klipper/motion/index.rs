//! The search for the index mark, which the board's own trigger tells.
//!
//! Source: Klipper3d/klipper, `docs/MCU_Commands.md`, `endstop_home` and the trigger synchronisation commands.

use crate::drives::klipper::board::{Board, reason};
use crate::drives::klipper::error::KlipperError;

/// Samples that must agree, and the time between two of them, in parts of a second: 15 us.
const SAMPLES: u8 = 4;
const SAMPLE_PARTS: u32 = 66_667;

/// Time between two looks at a sensor that has not the level, in parts of a second: 100 us.
const REST_PARTS: u32 = 10_000;

/// Phase of the search. A rotor that begins on the mark leaves it first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Index {
    /// The sensor is waited for to be off the mark.
    Leaves,
    /// The mark is waited for.
    Finds,
    /// The board was asked for the tick at which the sensor had the level.
    Asked { finds: bool },
    /// The search is over.
    Over,
}

impl Index {
    /// Has the board wait for the sensor's level of this phase, from a tick on.
    pub(super) fn arm(self, board: &mut Board, tick: u64) -> Result<Self, KlipperError> {
        let level = if self == Self::Finds { board.index_level } else { !board.index_level };
        let (hz, format, objects) = (board.hz, &board.talk.format, board.talk.objects);
        let start = format.trsync_start.encode(&[
            objects.index_group.into(),
            (tick as u32).into(),
            0_u32.into(),
            reason::EXPIRED.into(),
        ])?;
        let home = format.endstop_home.encode(&[
            objects.index.into(),
            (tick as u32).into(),
            (hz / SAMPLE_PARTS).into(),
            SAMPLES.into(),
            (hz / REST_PARTS).into(),
            level.into(),
            objects.index_group.into(),
            reason::INDEX.into(),
        ])?;
        board.talk.link.queue(&start)?;
        board.talk.link.queue(&home)?;
        Ok(self)
    }

    /// Asks for the tick at which the sensor had the level, once the group has told that it had.
    pub(super) fn triggered(self, board: &mut Board) -> Result<Self, KlipperError> {
        let finds = match self {
            Self::Leaves => false,
            Self::Finds => true,
            other => return Ok(other),
        };
        let question = board.talk.format.endstop_query_state.encode(&[board.talk.objects.index.into()])?;
        board.talk.link.queue(&question)?;
        Ok(Self::Asked { finds })
    }

    /// Ends the search.
    pub(super) fn disarm(board: &mut Board) -> Result<(), KlipperError> {
        let zero = || 0_u32.into();
        let values =
            [board.talk.objects.index.into(), zero(), zero(), zero(), zero(), zero(), zero(), zero()];
        let end = board.talk.format.endstop_home.encode(&values)?;
        board.talk.link.queue(&end)?;
        Ok(())
    }

    /// Returns the tick of the sensor's level by the tick of the next look that the board told: the look before.
    pub(super) fn tick_of(board: &Board, next: u64) -> u64 {
        next.saturating_sub(u64::from(board.hz / REST_PARTS))
    }
}
