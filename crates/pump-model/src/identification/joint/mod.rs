//! One line from several recordings at once.

mod blocks;
mod fit;
mod recording;
mod search;

pub use fit::JointFit;
pub use recording::{JointRecording, RecordingFit};
