//! Figures of others, with their sources: McIntyre, van Schoor, Uren, Kloppers, "Modelling the pulsatile
//! flow rate and pressure response of a roller-type peristaltic pump", Sensors and Actuators A (preprint
//! arXiv 2011.13167, doi:10.48550/arXiv.2011.13167), and their published code. Sections, equations, tables
//! and figures are numbered as in the preprint.

/// Place of the pump's dimensions.
pub(crate) const TABLE_1: &str = "Table 1";
/// Place of the specifications of the tests.
pub(crate) const TABLE_2: &str = "Table 2";
/// Place of the lines' values.
pub(crate) const TABLE_3: &str = "Table 3";
/// Places of the numbers of rollers.
pub(crate) const ROLLERS: &str = "Section 3.1, Table 2";
/// Place of the measurement of the roller volume.
pub(crate) const ROLLER_TEST: &str = "Section 3.3";
/// Place of the densities of water.
pub(crate) const DENSITIES: &str = "Section 4.2, Eq. 19";
/// Place of the measurement of R.
pub(crate) const RESISTANCE_TEST: &str = "Section 4.2, Eq. 17";
/// Place of the measurement of C.
pub(crate) const COMPLIANCE_TEST: &str = "Section 4.2, Eq. 20";
/// Place of the fit of L.
pub(crate) const INERTANCE_TEST: &str = "Section 4.2";
/// Place of the results of the flow tests as numbers. Fig. 12 draws them.
pub(crate) const FLOW_RESULTS: &str = "Section 5.1";
/// Place of the correlations of pressures as numbers. Fig. 14 draws them.
pub(crate) const PRESSURE_RESULTS: &str = "Section 5.2";
/// Source of a figure in github.com/MPMcIntyre/Roller-pump-model-and-simulation.
pub(crate) const CODE: &str = "authors' code";
/// Source of a figure that was computed outside this code from the paper's equations and data.
pub(crate) const REFERENCE: &str = "reference";

/// Dimensions of the pump: name, unit, value in Table 1, value in the authors' code.
pub(crate) const DIMENSIONS: [(&str, &str, f64, f64); 6] = [
    ("tube bore radius r_i", "mm", 5.0, 5.0),
    ("tube outer radius r_o", "mm", 7.0, 7.0),
    ("backplate radius r_b", "mm", 63.0, 62.76),
    ("contact angle beta", "deg", 30.0, 30.0),
    ("roller radius r_roller", "mm", 20.0, 19.87),
    ("roller offset r_offset", "mm", 40.0, 39.5),
];

/// Roller volume V_r, mL.
pub(crate) const ROLLER_ML: f64 = 2.06;
/// Engagement angle phi, deg.
pub(crate) const ENGAGEMENT_DEG: f64 = 50.53;

/// Means of seven measured roller volumes, from the data of the authors' code: angle in deg, volume in mL. The
/// paper draws their curve alone (Fig. 9).
pub(crate) const POINTS: [(f64, f64); 15] = [
    (0.0, 0.0),
    (3.37, 0.0207143),
    (6.92, 0.1057143),
    (10.62, 0.2528571),
    (13.98, 0.4357143),
    (17.68, 0.6842857),
    (21.2, 0.9007143),
    (24.93, 1.175),
    (28.5, 1.4014286),
    (32.25, 1.6157143),
    (35.75, 1.815),
    (39.59, 1.9542857),
    (42.87, 2.0242857),
    (46.53, 2.08),
    (50.53, 2.1064286),
];

/// Coefficients of the volume V in mL over deg, highest order first, as the authors' code fits them. The paper
/// draws V alone (Fig. 9).
pub(crate) const POLYNOMIAL: [f64; 6] = [
    1.315_768_247_757_037_1e-8,
    -1.238_105_747_404_483_3e-6,
    -8.751_039_956_479_692e-6,
    2.792_627_225_484_081_7e-3,
    -3.158_742_581_049_441e-3,
    -2.870_791_521_667_906e-4,
];

/// Temperature of the water in °C and its density in kg/m³, at room temperature and in FT4.
pub(crate) const WATER: [(f64, f64); 2] = [(25.0, 997.0), (40.0, 992.0)];

/// Figures that were measured of a pump.
pub(crate) struct Measured {
    pub rollers: u32,
    /// Fastest speed of the flow tests, r/min. The speeds begin at 10 r/min.
    pub fastest_rpm: u32,
    /// Volume of ten revolutions, mean over the speeds, mL.
    pub ten_revolutions_ml: f64,
    /// NRMSE of the linear model, %: with three rollers against the average of the three-roller tests.
    pub nrmse_percent: f64,
    /// Largest deviation of the linear model, roughly, %.
    pub largest_percent: f64,
    /// Mean Pearson correlation of measured and modelled pressures at inlet and outlet.
    pub pearson: [f64; 2],
}

/// Measured figures of the pumps with three and with two rollers.
pub(crate) const MEASURED: [Measured; 2] = [
    Measured {
        rollers: 3,
        fastest_rpm: 170,
        ten_revolutions_ml: 212.53,
        nrmse_percent: 2.37,
        largest_percent: 9.02,
        pearson: [0.83, 0.74],
    },
    Measured {
        rollers: 2,
        fastest_rpm: 300,
        ten_revolutions_ml: 231.75,
        nrmse_percent: 1.97,
        largest_percent: 4.03,
        pearson: [0.80, 0.79],
    },
];

/// Values of the line: name, unit, value in Table 3, value in the authors' code.
pub(crate) const LINE: [(&str, &str, f64, f64); 4] = [
    ("reservoir pressure P_res", "kPa", 88.637, 88.6372),
    ("resistance R", "kPa s/mL", 0.1108, 0.1108),
    ("compliance C", "mL/kPa", 0.0361, 0.036108499),
    ("inertance L", "kPa s²/mL", 0.0042, 0.0042),
];

/// Pressures of the periodic steady state: rollers, r/min, then max, min, mean of P_in and of P_out, kPa.
/// Extremes are true ones. The values are references to 1e-4 kPa, not the paper's.
pub(crate) const STEADY_KPA: [(u32, f64, [f64; 6]); 6] = [
    (3, 50.0, [90.5879, 84.8782, 86.6686, 93.3473, 87.8604, 90.6054]),
    (3, 100.0, [95.3347, 73.7963, 84.7002, 104.5105, 83.5685, 92.5738]),
    (3, 150.0, [100.3254, 61.4112, 82.7318, 116.2201, 77.4455, 94.5422]),
    (2, 50.0, [90.5578, 84.8847, 86.4742, 93.3369, 87.8931, 90.7998]),
    (2, 100.0, [96.3518, 73.0388, 84.3114, 105.3520, 82.4483, 92.9626]),
    (2, 150.0, [99.8906, 61.0270, 82.1486, 116.6113, 78.3548, 95.1254]),
];

/// Pressures from rest to 100 r/min with three rollers from angle 0: min and max of P_in, then of P_out, kPa.
/// The values are references, not the paper's.
pub(crate) const START_KPA: [f64; 4] = [71.725, 98.109, 78.519, 108.568];
