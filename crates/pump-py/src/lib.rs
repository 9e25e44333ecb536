//! The compiled half of the Python package `pumpmodel`: a thin layer around `pump_dose`, one file a concept.

mod doser;
mod errors;
mod floats;
mod interrupt;
mod limits;
mod line;
mod plan;
mod plan_output;
mod pump;
mod pump_dimensions;
mod pump_flow;
mod pump_run;
mod run;
mod speed;
mod steady;
mod sweep;

/// Compiled half of `pumpmodel`; import that instead.
#[pyo3::pymodule]
mod _pumpmodel {
    #[pymodule_export]
    use crate::doser::Doser;
    #[pymodule_export]
    use crate::limits::Limits;
    #[pymodule_export]
    use crate::line::Line;
    #[pymodule_export]
    use crate::plan::Plan;
    #[pymodule_export]
    use crate::pump::Pump;
    #[pymodule_export]
    use crate::run::Run;
    #[pymodule_export]
    use crate::steady::SteadyState;
    #[pymodule_export]
    use crate::sweep::_steady_states;

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
