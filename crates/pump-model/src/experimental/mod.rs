//! Models that are not validated against raw measurements: the roller-centric model and the speed law.

pub(crate) mod roller_centric;
pub(crate) mod speed_law;
pub(crate) mod speed_law_flow;
