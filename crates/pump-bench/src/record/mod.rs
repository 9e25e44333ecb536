//! The record of a pump: its journal, the journal's folder, and the lock that admits one process at a time.

mod account;
mod after_stop;
mod backup;
mod delivered_range;
mod folder;
mod intent;
mod journal;
mod last_dose;
mod log;
mod phase_source;
mod purpose;
mod state;
mod terms;
mod unfinished;
mod wear;
mod whole;

pub(crate) use account::Account;
pub use after_stop::AfterStop;
pub use backup::{BackedUp, BackupError, Position, Restored, backup, is_backup, restore};
pub(crate) use delivered_range::DeliveredRange;
pub(crate) use folder::BOARDS;
pub use folder::{Folder, FolderError, Lock, default_state_dir, is_of_record};
pub use intent::Intent;
pub(crate) use journal::{Announcer, Entry, Journal, Why, decode, encode};
pub use journal::{JournalError, Storage, Story};
pub use last_dose::{DoseByWeight, DosedFluid, LastDose};
pub use log::{
    Clock, ClockJump, ClockWatch, LogEnd, LogEntry, LogError, LogLine, MomentError, Stamp, SystemClock,
    moment,
};
pub(crate) use log::{Log, LogPlace, LogTail, Told, pending};

pub use crate::cut_text::{CutText, ShortText};
pub use phase_source::PhaseSource;
pub use purpose::Purpose;
pub use state::{AngleLoss, PumpState};
pub(crate) use state::{MotorWay, motor_way};
pub(crate) use terms::{DoseTerms, WeighingTerms};
pub use unfinished::Unfinished;
pub use wear::Wear;
pub(crate) use whole::Whole;
