//! The words of every choice, by which a test checks the types of `pumpmodel.choices`.

use std::fmt::Display;

use pump_bench::balance::Protocol;
use pump_bench::calibration::Fit;
use pump_bench::dosing::{Missed, ShareSource};
use pump_bench::heads::Provenance;
use pump_bench::pump_file::{CurveFit, DriverName, Pace, UncheckedLimit};
use pump_bench::rack::RackEnd;
use pump_bench::record::{AngleLoss, LogEnd, PhaseSource, Purpose};
use pump_bench::report::VolumeBasis;
use pump_bench::simulation::{AskedMethod, ModelName};
use pump_ctl::plan::{Finish, LimitedBy, Ramps, SetBy};
use pyo3::prelude::*;

use crate::argument::PORTS;
use crate::identification::{BEGINS, PARAMETERS};
use crate::pump::VARIANTS;
use crate::simulation::INITIALS;

/// Returns the name of each type of `pumpmodel.choices`, with the words that the library takes or gives.
#[pyfunction]
pub(crate) fn _choices() -> Vec<(&'static str, Vec<String>)> {
    vec![
        ("AngleLoss", words(AngleLoss::ALL)),
        ("Begin", words(&BEGINS)),
        ("BalanceProtocol", words(Protocol::ALL)),
        ("CalibrationFit", words(Fit::ALL)),
        ("Driver", words(DriverName::ALL)),
        ("Finish", words(&Finish::ALL)),
        ("Initial", words(&INITIALS)),
        ("InletLimit", words(&[SetBy::Given, SetBy::TubeCollapse, SetBy::Vapour].map(SetBy::name))),
        ("LimitedBy", words(&LimitedBy::ALL)),
        ("LineParameter", words(&PARAMETERS)),
        ("LogEnd", words(LogEnd::ALL)),
        ("Method", words(AskedMethod::ALL)),
        ("Missed", words(Missed::ALL)),
        ("Model", words(ModelName::ALL)),
        ("Pace", words(Pace::ALL)),
        ("PhaseSource", words(PhaseSource::ALL)),
        ("Port", words(&PORTS.map(|(word, _)| word))),
        ("Provenance", words(&Provenance::ALL)),
        ("Purpose", words(Purpose::ALL)),
        ("RackEnd", words(RackEnd::ALL)),
        ("Ramps", words(&Ramps::ALL)),
        ("UncertaintySource", words(ShareSource::ALL)),
        ("UncheckedLimit", words(UncheckedLimit::ALL)),
        ("Variant", words(&VARIANTS.map(|(word, _)| word))),
        ("VolumeBasis", words(VolumeBasis::ALL)),
        ("VolumeMethod", words(CurveFit::ALL)),
    ]
}

/// Returns the words of choices.
fn words(choices: &[impl Display]) -> Vec<String> {
    choices.iter().map(ToString::to_string).collect()
}
