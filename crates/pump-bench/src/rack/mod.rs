//! A rack: several pumps that one process moves by one timetable.
//!
//! A [`RackFile`] names the pumps and the steps. A [`Rack`] holds a bench for each pump. It checks every step of every
//! pump before the first one moves. Each pump has a thread with a session, a journal and a lock of its own, and a stop
//! of one stops all.
//!
//! ```
//! use pump_bench::pump_file::Pace;
//! use pump_bench::rack::{Rack, RackFile};
//! use pump_bench::{Bench, config::Config};
//!
//! let text = r#"
//! schema = "rack/1"
//! [pumps]
//! acid = "three-roller"
//! base = "two-roller"
//! [[step]]
//! ratio = { acid = 2, base = 1 }
//! volume = "6mL"
//! rate = "6mL/s"
//! "#;
//! let file = RackFile::parse(text, "mix.toml".as_ref())?;
//! let state = tempfile::tempdir()?;
//! let pumps = file.pump_files(&Config::default())?;
//! let benches = pumps.into_iter().map(|pump| Bench::new(pump, None, state.path()));
//! let rack = Rack::new(file, benches.collect::<Result<_, _>>()?)?.paced(Pace::Fast);
//! let report = rack.run(|_| {})?;
//! assert!(report.completed && (report.pumps[0].delivered_ml - 4.0).abs() < 0.001);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod clock;
mod conductor;
mod error;
mod gradient;
mod member;
mod player;
mod progress;
mod rack;
mod rack_file;
mod rehearsal;
mod report;
mod sharing;
mod step;
mod step_keys;
mod timetable;

pub use error::RackError;
pub use member::Member;
pub use progress::RackProgress;
pub use rack::Rack;
pub use rack_file::RackFile;
pub use report::{RackDose, RackEnd, RackFault, RackPumpReport, RackReport, RackTotal};
pub use step::{Begin, Flow, RackStep};
