//! Pumps: what a pump file says, and what follows from it at any angle and speed.

mod dimensions;
mod flow;
mod harmonics;
mod heads;
mod make;
mod pump;
mod renamed;
mod speed_law;
mod volume_fit;

pub(crate) use heads::_heads;
pub(crate) use pump::{Pump, VARIANTS, pump_given};
pub(crate) use speed_law::{_law_check, _law_published, _law_revolution, _law_trapped};
pub(crate) use volume_fit::{_volume_fit, _volume_fit_at, _volume_run_falls, _volume_runs};
pub(crate) use volume_fit::{_volume_polynomial, _volume_polynomial_at};
