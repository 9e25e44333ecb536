//! Errors of pumps, lines and motions.

use thiserror::Error;

use super::allowed::Allowed;
use super::integration::IntegrationError;
use super::parameter::Parameter;
use super::shown::Shown;
use crate::port::Port;

/// Rounds up to a part of 1/`parts`: what is to change by a value must change by as much at least. A whole part that a
/// sum missed by its rounding stays.
fn up(value: f64, parts: f64) -> f64 {
    (libm::ceil(value * parts - ROUNDING)).max(1.0) / parts
}

/// Part of the last digit that is rounding.
const ROUNDING: f64 = 1e-6;

/// Reason why the model refuses a pump, line or motion. It names the value and the allowed range.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ModelError {
    /// One parameter lies outside its range.
    #[error("{parameter} is {}; allowed: {allowed}", Shown(*value))]
    OutOfRange {
        /// Parameter that was given.
        parameter: Parameter,
        /// Value that was given.
        value: f64,
        /// Values that are accepted.
        allowed: Allowed,
    },
    /// The head is known by its volume alone, and the request needs its dimensions.
    #[error(
        "this head of {rollers} rollers is known by its volume per revolution alone, and this needs its \
         dimensions: give tube, rollers and backplate"
    )]
    DimensionsUnknown {
        /// Number of rollers.
        rollers: u32,
    },
    /// At some angle no roller closes the tube.
    #[error(
        "{rollers} rollers stand {pitch_deg:.1} deg apart but each seals over {span_deg:.1} deg of the \
         backplate, so at some angles no roller seals; use more rollers, or a contact angle larger by {:.1} deg",
        up(0.5 * (pitch_deg - span_deg), 10.0)
    )]
    NotSealing {
        /// Number of rollers.
        rollers: u32,
        /// Angle between rollers, degrees.
        pitch_deg: f64,
        /// Angle over which a roller is fully engaged, degrees.
        span_deg: f64,
    },
    /// The tube is thicker than the backplate's radius.
    #[error(
        "the backplate's radius of {backplate_radius_mm} mm is not more than the tube's outer diameter of \
         {outer_diameter_mm} mm, by {:.3} mm; look at the units of both",
        up(outer_diameter_mm - backplate_radius_mm, 1000.0)
    )]
    BackplateTooSmall {
        /// Radius of the backplate r_b, mm.
        backplate_radius_mm: f64,
        /// Outer diameter of the tube 2 r_o, mm.
        outer_diameter_mm: f64,
    },
    /// Roller and backplate overlap.
    #[error(
        "the rollers press {depth_mm:.3} mm deeper than the tube's walls: roller offset + roller radius is \
         {reach_mm:.3} mm, beyond the backplate radius of {backplate_radius_mm} mm; make the offset smaller by at \
         least as much",
        depth_mm = up(reach_mm - backplate_radius_mm, 1000.0)
    )]
    RollersHitBackplate {
        /// Reach of the rollers, r_offset + r_roller, mm.
        reach_mm: f64,
        /// Radius of the backplate r_b, mm.
        backplate_radius_mm: f64,
    },
    /// The rollers do not close the tube.
    #[error(
        "the gap between roller and backplate is {gap_mm:.3} mm but the tube closes at {closed_mm:.3} mm \
         (twice its wall), so it stays open by {:.3} mm; use a smaller backplate, or a larger roller, \
         offset or wall (backplate and roller are radii)",
        up(gap_mm - closed_mm, 1000.0)
    )]
    NotOccluding {
        /// Gap between roller and backplate, r_b - r_roller - r_offset, mm.
        gap_mm: f64,
        /// Gap at which the tube closes, 2 (r_o - r_i), mm.
        closed_mm: f64,
    },
    /// Rollers engage and leave at the same time on one straight: psi is negative.
    #[error(
        "rollers engage over {engagement_deg:.2} deg and seal over {span_deg:.2} deg, which leaves \
         psi = 360 - {span_deg:.2} - {engagement_deg:.2} = {psi_deg:.2} deg; it must not be negative: use a \
         contact angle smaller by {:.2} deg",
        -0.5 * psi_deg
    )]
    EngagementTooLong {
        /// Engagement angle phi, degrees.
        engagement_deg: f64,
        /// Angle over which a roller is fully engaged, degrees.
        span_deg: f64,
        /// Inlet phase psi, degrees.
        psi_deg: f64,
    },
    /// A roller is so small that it dips into the tube with its flank.
    #[error(
        "a roller radius of {radius_mm:.3} mm is {:.3} mm too small: the roller dips into the tube with its flank, and \
         its volume does not follow from the drawing; use more than {least_mm:.3} mm, or measure the volume",
        least_mm - radius_mm
    )]
    RollerTooSmall {
        /// Radius of the roller, mm.
        radius_mm: f64,
        /// Smallest radius that the drawing describes, sqrt(offset² - (backplate radius - tube diameter)²), mm.
        least_mm: f64,
    },
    /// The roller-centric model cannot start from other lines than those at rest.
    #[error("the roller-centric model starts from lines at rest; allowed: no other state at the start")]
    StartsFromRest,
    /// The rollers take as much as the tube delivers, so the head does not pump.
    #[error(
        "a revolution delivers {revolution_ml:.4} mL: the tube holds {nominal_ml:.4} mL, and {rollers} rollers take \
         {roller_ml:.4} mL each; it must be positive: use fewer rollers or a smaller roller volume"
    )]
    NotPumping {
        /// Number of rollers.
        rollers: u32,
        /// Volume of a revolution without rollers V_nom, mL.
        nominal_ml: f64,
        /// Volume of a roller V_r, mL.
        roller_ml: f64,
        /// Volume of a revolution V_rot, mL.
        revolution_ml: f64,
    },
    /// The roller-volume curve does not rise.
    #[error(
        "the roller volume does not rise anywhere between 0 and {engagement_deg:.2} deg; check its \
         coefficients"
    )]
    RollerVolumeFlat {
        /// Engagement angle phi, degrees.
        engagement_deg: f64,
    },
    /// A curve has too few measured points.
    #[error("there are measured points at {angles} different angles; the curve needs {needed} at least")]
    TooFewPoints {
        /// Number of different angles.
        angles: usize,
        /// Number of different angles that the curve needs.
        needed: usize,
    },
    /// A roller-volume curve has more pieces than there are places.
    #[error(
        "the roller volume needs more than {allowed} pieces; give fewer measured points (or their fit), or \
         check the dimensions"
    )]
    TooManyPieces {
        /// Largest number allowed.
        allowed: usize,
    },
    /// A periodic steady state does not exist.
    #[error(
        "at {speed_rad_s:.6} rad/s the pulses meet a resonance of the {port} line that nothing damps: there \
         is no steady state; give the line a resistance or change the speed"
    )]
    UndampedResonance {
        /// Port of the pump.
        port: Port,
        /// Speed, rad/s.
        speed_rad_s: f64,
    },
    /// A line swings all through a long pitch.
    #[error(
        "at {speed_rad_s:.3e} rad/s the {port} line swings all through the pitch, and its extremes take \
         {steps:.1e} steps; allowed: {allowed:.0e}; give the line more resistance, or choose a faster speed"
    )]
    RingsTooLong {
        /// Port of the pump.
        port: Port,
        /// Speed, rad/s.
        speed_rad_s: f64,
        /// Largest number of steps that the search for the extremes takes.
        steps: f64,
        /// Largest number allowed.
        allowed: f64,
    },
    /// Integrating does not come to a periodic steady state.
    #[error(
        "no periodic steady state after {pitches} pitches: the last one still changed by {change_kpa:.2e} \
         kPa; give the lines more resistance, less inertance or less compliance, or a speed at which a \
         pitch takes longer"
    )]
    NotPeriodic {
        /// Number of pitches that were tried.
        pitches: u32,
        /// Change over the last pitch, kPa.
        change_kpa: f64,
    },
    /// The line swings or creeps for longer than the search follows it.
    #[error(
        "the outlet line has not settled {waited_s:.3} s after the last step: it is damped too weakly (L/R) \
         or too strongly (R C)"
    )]
    NeverSettles {
        /// Time after which the search gave up, s.
        waited_s: f64,
    },
    /// The integrator stopped before the end.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
}
