//! The host's half of the link: the window of requests, the clocks, the stream of segments, and where the motor may
//! be.

mod bracket;
mod clocks;
mod demand;
mod stream;
mod window;

pub use bracket::Bracket;
pub use clocks::{Clocks, Relation};
pub use demand::{Demand, FRAME_OVERHEAD, RESERVE_MS, TooFast};
pub use stream::{Chunk, Stream, StreamError, Takeover};
pub use window::{Answered, LOST_ANSWERS, LinkLost, MOST_SENDS, RESEND_NS, Window, WindowError};
