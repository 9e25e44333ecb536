//! `dose home --set` and `--unknown`: a person says where the rollers stand.

use pump_bench::AngleSet;
use pump_bench::Bench;
use pump_bench::report::{carry_dropped_text, rotor_text};
use pump_ctl::plan::Phase;

use crate::failure::Failure;
use crate::terminal::{tell, warn};

/// Records the angle, or that it is unknown. A journal that cannot be read is moved aside, once all else is well.
pub(super) fn set(angle_rad: Option<f64>, bench: &Bench) -> Result<(), Failure> {
    let (mut session, AngleSet { state, owed_ml, aside, .. }) =
        bench.set_angle(angle_rad.map(Phase::known))?;
    warn(&session.notes());
    let aside = aside.map(|aside| format!("the damaged journal is now {}\n", aside.display()));
    let (rotor, dropped) = (rotor_text(bench, &state), carry_dropped_text(owed_ml));
    tell(&format!("{}{rotor}{dropped}", aside.unwrap_or_default()))
}
