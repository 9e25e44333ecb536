//! The compiled half of the Python package `pumpmodel`: a thin layer around `pump_bench`, one file a concept.

mod asked;
mod bench;
mod bench_calibration;
mod bench_home;
mod calibration;
mod doser;
mod errors;
mod floats;
mod hose;
mod identification;
mod interrupt;
mod limits;
mod line;
mod metrics;
mod plan;
mod plan_output;
mod pump;
mod pump_dimensions;
mod pump_flow;
mod pump_make;
mod pump_run;
mod repeated;
mod run;
mod speed;
mod speed_law;
mod steady;
mod sweep;
mod volume_fit;
mod worker;

/// Compiled half of `pumpmodel`; import that instead.
#[pyo3::pymodule]
mod _pumpmodel {
    #[pymodule_export]
    use crate::bench::Bench;
    #[pymodule_export]
    use crate::calibration::{_reading, Calibration};
    #[pymodule_export]
    use crate::doser::Doser;
    #[pymodule_export]
    use crate::hose::{_fluid_check, _fluid_water, _hose_drop, _hose_line, _hose_reynolds, _hose_volume};
    #[pymodule_export]
    use crate::identification::{_identify_compliance, _identify_line, _identify_resistance};
    #[pymodule_export]
    use crate::limits::Limits;
    #[pymodule_export]
    use crate::line::Line;
    #[pymodule_export]
    use crate::metrics::{nrmse, pearson, rmse};
    #[pymodule_export]
    use crate::plan::Plan;
    #[pymodule_export]
    use crate::pump::Pump;
    #[pymodule_export]
    use crate::repeated::Schedule;
    #[pymodule_export]
    use crate::run::Run;
    #[pymodule_export]
    use crate::speed_law::{_law_check, _law_published, _law_revolution, _law_trapped};
    #[pymodule_export]
    use crate::steady::SteadyState;
    #[pymodule_export]
    use crate::sweep::_steady_states;
    #[pymodule_export]
    use crate::volume_fit::{_volume_fit, _volume_fit_at, _volume_run_falls, _volume_runs};

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
