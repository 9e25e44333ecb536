//! The record of a pump: its journal, the journal's folder, and the lock that admits one process at a time.

mod entry;
mod folder;
mod intent;
mod journal;
mod line;
mod phase_source;
mod purpose;
mod state;
mod terms;
mod unfinished;
mod wear;

pub use entry::{Entry, Why};
pub use folder::{Folder, FolderError, Lock, default_state_dir};
pub use intent::Intent;
pub use journal::{Journal, JournalError, Story};
pub(crate) use line::{decode, encode};
pub use phase_source::PhaseSource;
pub use purpose::Purpose;
pub use state::State;
pub use terms::Terms;
pub use unfinished::Unfinished;
pub use wear::Wear;
