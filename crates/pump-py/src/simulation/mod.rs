//! Pumps over time, in the steady state, and the steady states of many pumps.

mod cavitation;
mod checked;
mod followed;
mod motion;
mod run;
mod sensitivity;
mod simulate;
mod steady_state;
mod sweep;

pub(crate) use cavitation::_cavitation;
pub(crate) use run::Run;
pub(crate) use simulate::INITIALS;
pub(crate) use steady_state::SteadyState;
pub(crate) use sweep::_steady_states;
