//! The compiled half of the Python package `pumpmodel`: a thin layer around `pump_bench`, one file a concept.
//!
//! The rooms build on one another in this order: `python` (exceptions, interrupts, arrays), `argument` (values that
//! Python passes), `line`, `pump`, then `simulation`, `identification` and `calibration`, `dosing`, and `bench`.
//! `choices` has the words of them all.

mod argument;
mod bench;
mod calibration;
mod choices;
mod dosing;
mod identification;
mod line;
mod pump;
mod python;
mod simulation;

/// Compiled half of `pumpmodel`; import that instead.
#[pyo3::pymodule]
mod _pumpmodel {
    #[pymodule_export]
    use crate::argument::{_number, _numbers};
    #[pymodule_export]
    use crate::bench::{Balance, Bench, Call, Rack, Schedule};
    #[pymodule_export]
    use crate::calibration::{_reading, Calibration};
    #[pymodule_export]
    use crate::choices::_choices;
    #[pymodule_export]
    use crate::dosing::{Doser, Limits, Plan};
    #[pymodule_export]
    use crate::identification::{
        _identify_compliance, _identify_line, _identify_line_jointly, _identify_resistance, LineLikelihood,
    };
    #[pymodule_export]
    use crate::identification::{nrmse, pearson, rmse};
    #[pymodule_export]
    use crate::line::{_fluid_check, _fluid_water, Line};
    #[pymodule_export]
    use crate::line::{_hose_drop, _hose_line, _hose_reynolds, _hose_volume};
    #[pymodule_export]
    use crate::pump::_heads;
    #[pymodule_export]
    use crate::pump::{_law_check, _law_published, _law_revolution, _law_trapped, Pump};
    #[pymodule_export]
    use crate::pump::{_volume_fit, _volume_fit_at, _volume_run_falls, _volume_runs};
    #[pymodule_export]
    use crate::pump::{_volume_polynomial, _volume_polynomial_at};
    #[pymodule_export]
    use crate::simulation::{_cavitation, _steady_states, Run, SteadyState};

    /// Takes the memory of first calls.
    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        crate::python::first::take(module.py())
    }

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
