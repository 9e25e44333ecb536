//! A recording of a joint fit, and what the fit found of it alone.

use super::super::error::IdentificationError;
use super::super::estimate::Estimate;
use super::super::recording::Recording;
use super::blocks::{Block, OWN, SHARED};
use crate::line::line::Line;
use crate::pump::pump::Pump;

/// Recording of a joint fit: what is sought of it alone, and how sure its samples are. It has room for the search,
/// so that the fit needs no allocator.
#[derive(Debug, Clone, Copy)]
pub struct JointRecording<'a> {
    /// Recording.
    pub recording: Recording<'a>,
    /// True if the fit seeks an angle, which it adds to that of this recording's motion.
    pub seeks_angle: bool,
    /// True if the fit seeks a start, which it adds to the time of this recording's motion.
    pub seeks_start: bool,
    /// Standard deviation of the noise of a sample, kPa. Only the ratios between recordings count.
    pub standard_kpa: f64,
    pub(super) room: Room,
    pub(super) found: Option<RecordingFit>,
}

/// Numbers of the search for one recording.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room {
    /// Angle and start where the search is.
    pub(super) own: [f64; OWN],
    /// Angle and start of the next step.
    pub(super) next: [f64; OWN],
    /// Angle and start of the best search so far.
    pub(super) best: [f64; OWN],
    /// Rows where the search is.
    pub(super) block: Block,
    /// Rows of the next step.
    pub(super) next_block: Block,
}

impl<'a> JointRecording<'a> {
    /// Makes a recording of which nothing is sought alone. Its samples are as sure as those of others.
    pub fn new(recording: Recording<'a>) -> Self {
        let (none, block) = ([0.0; OWN], Block::new());
        let room = Room { own: none, next: none, best: none, block, next_block: block };
        Self { recording, seeks_angle: false, seeks_start: false, standard_kpa: 1.0, room, found: None }
    }

    /// Says whether the fit seeks an angle of this recording.
    #[must_use]
    pub fn with_angle(self, seeks_angle: bool) -> Self {
        Self { seeks_angle, ..self }
    }

    /// Says whether the fit seeks a start of this recording.
    #[must_use]
    pub fn with_start(self, seeks_start: bool) -> Self {
        Self { seeks_start, ..self }
    }

    /// Says how large the noise of a sample is, kPa.
    #[must_use]
    pub fn with_standard_kpa(self, standard_kpa: f64) -> Self {
        Self { standard_kpa, ..self }
    }

    /// Returns what the last joint fit found of this recording alone, or `None` before a fit has succeeded.
    pub fn found(&self) -> Option<&RecordingFit> {
        self.found.as_ref()
    }
}

/// Result of a joint fit for one of its recordings.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RecordingFit {
    /// Angle that is added to that of the motion, rad, within half a pitch either way.
    pub angle_rad: Estimate,
    /// Time that is added to that of the motion, s.
    pub start_s: Estimate,
    /// Root of the mean square of the residuals, kPa.
    pub rms_kpa: f64,
    /// Standard deviation of the samples, kPa.
    pub spread_kpa: f64,
    /// Number of neighbouring samples that say as much as one independent sample.
    pub correlated_samples: f64,
    /// Change of angle and start with resistance, compliance, inertance and reservoir pressure, in their units: the
    /// best angle and start for another line.
    pub responses: [[f64; SHARED]; OWN],
    /// Covariances of angle and start, as those of [`super::super::LineFit`] are.
    pub covariance: [[f64; OWN]; OWN],
}

impl RecordingFit {
    /// Returns the pressures of the fit at the times of its recording, kPa absolute.
    ///
    /// # Errors
    ///
    /// Refuses a line that is not physical, and an undamped resonance at a steady speed.
    pub fn pressures_kpa<'a>(
        &self,
        pump: &'a Pump,
        recording: &Recording<'a>,
        line: &'a Line,
    ) -> Result<impl Iterator<Item = f64> + use<'a>, IdentificationError> {
        let curve = pump.curve(recording.port);
        let above = recording.model_kpa(curve, line, self.angle_rad.value, self.start_s.value, None)?;
        Ok(above.map(|kpa| line.reservoir_kpa + kpa))
    }
}
