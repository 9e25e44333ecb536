//! Widening of a standard uncertainty from a few readings, so that a coverage factor of 2 means 95 %.

/// Student's t for 95.45 %, over the degrees of freedom (JCGM 100:2008, table G.2).
const T: [(u32, f64); 28] = [
    (1, 13.97),
    (2, 4.53),
    (3, 3.31),
    (4, 2.87),
    (5, 2.65),
    (6, 2.52),
    (7, 2.43),
    (8, 2.37),
    (9, 2.32),
    (10, 2.28),
    (11, 2.25),
    (12, 2.23),
    (13, 2.21),
    (14, 2.20),
    (15, 2.18),
    (16, 2.17),
    (17, 2.16),
    (18, 2.15),
    (19, 2.14),
    (20, 2.13),
    (25, 2.11),
    (30, 2.09),
    (35, 2.07),
    (40, 2.06),
    (45, 2.06),
    (50, 2.05),
    (100, 2.025),
    (u32::MAX, 2.0),
];

/// Returns t/2 for the next smaller number of degrees of freedom in the table; 1 for none, where there is no
/// estimate to widen.
pub fn widening(degrees_of_freedom: u32) -> f64 {
    let row = T.iter().rev().find(|(least, _)| *least <= degrees_of_freedom);
    row.map_or(1.0, |(_, t)| 0.5 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_readings_widen_much_and_many_hardly() {
        assert_eq!(widening(0), 1.0);
        assert_eq!(widening(1), 6.985);
        assert_eq!(widening(8), 1.185);
        assert_eq!(widening(24), 1.065);
        assert_eq!(widening(1_000_000), 1.0125);
    }
}
