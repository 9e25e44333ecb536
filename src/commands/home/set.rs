//! `dose home --set` and `--unknown`: a person says where the rollers stand.

use pump_bench::AngleSet;
use pump_bench::report::{carry_dropped_text, rotor_text};
use pump_bench::units::StatedAngle;
use pump_bench::{Bench, DoseError};
use pump_ctl::plan::Phase;

use crate::advice;
use crate::failure::Failure;
use crate::options::start_angle::{assumed_of_set, or_assumed_rad};
use crate::terminal::{tell, warn};

/// Records the angle, or that it is unknown. A journal that cannot be read is moved aside, once all else is well.
///
/// `tolerance_rad` is that of `--tolerance`; the angle may have its own.
pub(super) fn set(
    stated: Option<StatedAngle>,
    tolerance_rad: Option<f64>,
    bench: impl FnOnce() -> Result<Bench, Failure>,
) -> Result<(), Failure> {
    let within_rad = stated.and_then(|stated| stated.tolerance_rad);
    if tolerance_rad.is_some() && within_rad.is_some() {
        return Err(Failure::refused(
            "--tolerance and the tolerance in --set both say how well the angle is known; give one of them",
        ));
    }
    let within_rad = tolerance_rad.or(within_rad);
    let bench = bench()?;
    let assumed = |stated: StatedAngle| Phase::within(stated.angle_rad, or_assumed_rad(within_rad, &bench));
    let phase = stated.map(assumed);
    let set = bench.set_angle(phase).map_err(|error| {
        let is_kept = matches!(error, DoseError::Unfinished { .. } | DoseError::UnfinishedRun { .. });
        let failure = Failure::from(error);
        if is_kept {
            failure.with("; or add --unfinished to this command, which keeps the dose")
        } else {
            failure
        }
    });
    let (mut session, AngleSet { state, owed_ml, aside, .. }) = set?;
    warn(&session.notes());
    let aside = aside.map(|aside| format!("the damaged journal is now {}\n", aside.display()));
    let assumed = (stated.is_some() && within_rad.is_none()).then(|| assumed_of_set(&bench));
    let (rotor, dropped) = (rotor_text(&bench, &state, advice::words), carry_dropped_text(owed_ml));
    tell(&format!("{}{rotor}{}{dropped}", aside.unwrap_or_default(), assumed.unwrap_or_default()))
}
