//! Every number that the crate takes from the paper and its authors' published code, with its place there.
//!
//! The paper is McIntyre, van Schoor, Uren, Kloppers, "Modelling the pulsatile flow rate and pressure
//! response of a roller-type peristaltic pump", Sensors and Actuators A (preprint arXiv 2011.13167, whose sections,
//! tables and figures are named here). Where the paper's figures contradict one another, both stand here and
//! [`crate::Variant`] chooses.

use crate::units::TURN_RAD;

/// Inner radius of the tube r_i, mm: Table 1.
pub const BORE_RADIUS_MM: f64 = 5.0;

/// Outer radius of the tube r_o, mm: Table 1.
pub const TUBE_OUTER_RADIUS_MM: f64 = 7.0;

/// Radius of the backplate r_b, mm: Table 1.
pub const BACKPLATE_RADIUS_MM: f64 = 63.0;

/// Contact angle beta, degrees: Table 1.
pub const CONTACT_ANGLE_DEG: f64 = 30.0;

/// Radius of a roller r_roller, mm: Table 1.
pub const ROLLER_RADIUS_MM: f64 = 20.0;

/// Distance from the shaft to a roller's axis r_offset, mm: Table 1.
pub const ROLLER_OFFSET_MM: f64 = 40.0;

/// Radius of the backplate r_b in the authors' published code, mm.
pub const AS_BUILT_BACKPLATE_RADIUS_MM: f64 = 62.76;

/// Radius of a roller r_roller in the authors' published code, mm.
pub const AS_BUILT_ROLLER_RADIUS_MM: f64 = 19.87;

/// Distance from the shaft to a roller's axis r_offset in the authors' published code, mm.
pub const AS_BUILT_ROLLER_OFFSET_MM: f64 = 39.5;

/// Volumes that a roller has displaced at angles after first contact: (deg, mL), the means of seven measured
/// curves. They come from the data of the authors' published code. The paper describes the measurement (Section
/// 3.3) and draws the curve alone (Fig. 9).
pub const VOLUME_POINTS: [(f64, f64); 15] = [
    (0.0, 0.0),
    (3.37, 0.0207143),
    (6.92, 0.1057143),
    (10.62, 0.2528571),
    (13.98, 0.4357143),
    (17.68, 0.6842857),
    (21.20, 0.9007143),
    (24.93, 1.175),
    (28.50, 1.4014286),
    (32.25, 1.6157143),
    (35.75, 1.815),
    (39.59, 1.9542857),
    (42.87, 2.0242857),
    (46.53, 2.08),
    (50.53, 2.1064286),
];

/// Coefficients of V in mL over degrees, highest order first: least squares of 5th order through
/// [`VOLUME_POINTS`] (residual 0.0074 mL RMS), as the authors' published code fits them.
pub const VOLUME_COEFFICIENTS_DEG: [f64; 6] = [
    1.315_768_247_757_037_1e-8,
    -1.238_105_747_404_483_3e-6,
    -8.751_039_956_479_692e-6,
    2.792_627_225_484_081_7e-3,
    -3.158_742_581_049_441e-3,
    -2.870_791_521_667_906e-4,
];

/// Engagement angle phi, degrees, measured: Section 3.3.
pub const ENGAGEMENT_DEG: f64 = 50.53;

/// Roller volume V_r, mL: Table 1. It is not the maximum of the authors' own data (2.1064).
pub const ROLLER_VOLUME_ML: f64 = 2.06;

/// Resistance R of the line at either port, kPa s/mL: Table 3.
pub const LINE_RESISTANCE_KPA_S_ML: f64 = 0.1108;

/// Compliance C of the line at either port, mL/kPa: Table 3.
pub const LINE_COMPLIANCE_ML_KPA: f64 = 0.0361;

/// Inertance L of the line at either port, kPa s²/mL: Table 3.
pub const LINE_INERTANCE_KPA_S2_ML: f64 = 0.0042;

/// Pressure P_res of both reservoirs, kPa absolute: Table 3.
pub const RESERVOIR_KPA: f64 = 88.637;

/// Volume s between two rollers over that of the round tube. It is fitted to the means and deviations that
/// the paper publishes.
pub const SEGMENT_SCALE: f64 = 0.953;

/// Distensibility D of a segment, 1/kPa. It is fitted to the means and deviations that the paper publishes.
pub const DISTENSIBILITY_PER_KPA: f64 = 2.05e-3;

/// Angle theta_c at which an engaging roller closes the lumen, rad: drawn from the dimensions of Table 1.
pub const CLOSURE_RAD: f64 = 30.692_584 * (TURN_RAD / 360.0);

/// Ambient pressure P_atm of the measurements, kPa absolute. The paper does not print it. It follows from
/// [`RESERVOIR_KPA`] less the 30 cm of water in the reservoir (Section 4.1).
pub const AMBIENT_KPA: f64 = 85.7;
