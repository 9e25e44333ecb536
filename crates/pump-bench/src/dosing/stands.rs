//! The place from which a dose is planned, by the record.

use pump_ctl::plan::Phase;

use crate::record::{Account, PhaseSource};

/// Place from which a dose is planned, by the record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stands {
    /// Angle of the rotor.
    pub(crate) start: Phase,
    /// Source of the angle.
    pub(crate) source: PhaseSource,
    /// Carry on record, in mL.
    pub(crate) carry_ml: f64,
    /// Half width of the range around the carry, in mL, without the doses of `account`.
    pub(crate) carry_half_width_ml: f64,
    /// Earlier doses whose sum with this dose is to be right.
    pub(crate) account: Option<Account>,
    /// Volume to the planned end, in mL, if this is the rest of a dose and ends where the whole was to end.
    pub(crate) to_end_ml: Option<f64>,
}

impl Stands {
    /// Makes a place with a carry that is known exactly.
    pub(crate) fn at(start: Phase, source: PhaseSource, carry_ml: f64) -> Self {
        Self { start, source, carry_ml, carry_half_width_ml: 0.0, account: None, to_end_ml: None }
    }
}
