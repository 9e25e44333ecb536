//! Followers of an exact run: its samples, and the vessel at the line's end.

mod block;
pub(crate) mod exact_samples;
pub(crate) mod exact_series;
mod onset;
pub(crate) mod vessel_run;
