//! What is remembered of a pump: its journal, the folder of it, and the lock that gives it to one process at a time.

mod entry;
mod folder;
mod journal;
mod line;
mod phase_source;
mod purpose;
mod terms;

pub use entry::{Entry, Intent, State, Unfinished, Wear, Why};
pub use folder::{Folder, FolderError, Lock, default_state_dir};
pub use journal::{Journal, JournalError, Story};
pub(crate) use line::{decode, encode};
pub use phase_source::PhaseSource;
pub use purpose::Purpose;
pub use terms::Terms;
