//! `dose <VOLUME> --until-scale` and `dose resume --until-scale`: a dose that a balance ends, and the rest of one.

use std::cell::LazyCell;

use pump_bench::balance::{Balance, BalanceReading};
use pump_bench::{Bench, DoseError, DoseReport, DoseRequest, PreparedByWeight, Session};

use super::delivery::{Said, Untold, before_dose, failed_untold, find_angle_of_rest, report_once};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::balance::{BalanceOptions, ByWeightOptions};
use crate::options::dosing::DosingOptions;
use crate::progress::MotionBar;
use crate::progress::supervised::{self, Reached};
use crate::terminal::{announcing, noted, waiting, warn};
use crate::warned::Warned;

/// The message after a signal.
const STOPPED: &str = "stopped by the user; `dose resume --until-scale` with the vessel on its balance makes the rest \
                       by weight, `dose resume` makes the rest by volume, `dose accept` accepts the dose as it is";

/// Makes one dose by weight, or with `--dry-run` plans it.
pub(super) fn run(
    bench: &Bench,
    request: DoseRequest,
    typed: &str,
    options: &ByWeightOptions,
    balance: &BalanceOptions,
    dosing: &DosingOptions,
) -> Result<(), Failure> {
    if let Some((option, _)) = dosing.files().into_iter().find(|(_, path)| path.is_some()) {
        return Err(Failure::refused(format!(
            "{option} writes a plan, and a balance ends this dose; leave it out, or leave out --until-scale"
        )));
    }
    let json = dosing.format.json();
    let said = Said { json, verbose: dosing.verbose.verbose, asked: Some(typed) };
    let order = options.order(request, balance);
    if dosing.dry_run {
        let prepared = bench.prepare_by_weight(&order)?;
        let report = DoseReport::planned_by_weight(bench, &prepared);
        return report_once(bench, report, &said, None, Vec::new(), &mut Warned::default());
    }
    make(bench, &said, options, balance, |session, scale, interrupt| {
        let before = before_dose(bench, session, dosing, interrupt)?;
        let prepared = session.prepare_by_weight(&order);
        let mut prepared = noted(session, prepared)?;
        prepared.whole.warnings.extend(before.notices());
        let tare = at_rest(json, || session.tare_by_weight(&prepared, scale));
        Ok((prepared, of_session(session, tare)?, before))
    })
}

/// Makes the rest of a dose by weight.
pub(super) fn resume(
    bench: &Bench,
    request: DoseRequest,
    options: &ByWeightOptions,
    balance: &BalanceOptions,
    said: &Said<'_>,
) -> Result<(), Failure> {
    let order = options.order(request, balance);
    make(bench, said, options, balance, |session, scale, interrupt| {
        find_angle_of_rest(session, interrupt)?;
        let found = at_rest(said.json, || session.prepare_rest_by_weight(&order, scale));
        let (prepared, reading) = of_session(session, found)?;
        Ok((prepared, reading, Untold::default()))
    })
}

/// Makes what `prepare` plans from a reading at rest, and reports it with what came before.
fn make(
    bench: &Bench,
    said: &Said<'_>,
    options: &ByWeightOptions,
    balance: &BalanceOptions,
    prepare: impl FnOnce(
        &mut Session<'_>,
        &mut dyn Balance,
        &Interrupt,
    ) -> Result<(PreparedByWeight, BalanceReading, Untold), Failure>,
) -> Result<(), Failure> {
    let json = said.json;
    let mut scale =
        balance.open(bench.board_port())?.ok_or_else(|| Failure::refused("--until-scale needs a balance"))?;
    let interrupt = Interrupt::watch()?;
    let mut session = bench.session()?;
    let (prepared, reading, mut untold) = prepare(&mut session, scale.as_mut(), &interrupt)?;
    let (steps, whole_ml) = (prepared.whole.plan.steps().unsigned_abs(), prepared.whole.plan.planned_ml());
    let bar = LazyCell::new(|| MotionBar::new(&bench.file().pump.id, steps, whole_ml, None, json));
    let (mut before, mut last) = (0, 0);
    supervised::begun(|| DoseReport::new(bench, &prepared.whole, None));
    let (made, was_told) = announcing(&mut session, json, &prepared.whole.warnings, |session| {
        session.run_from_tare(&prepared, reading, scale.as_mut(), |made| {
            // Each stretch counts its own steps.
            if made < last {
                before += last;
            }
            last = made;
            bar.made(before + made, || Reached {
                delivered_ml: whole_ml * (before + made) as f64 / steps as f64,
                angle_rad: prepared.whole.plan.angle_after(before + made),
            });
            interrupt.flow()
        })
    })?;
    bar.end();
    if failed_untold(&made, was_told) {
        warn(&prepared.whole.warnings);
    }
    let delivered = of_session(&mut session, made);
    untold.told(delivered.as_ref().err());
    let delivered = delivered?;
    if !bench.is_simulated() {
        warn(&delivered.warnings);
    }
    let difference_g = delivered.difference_standard_g(options.scale, bench.file());
    let report = DoseReport::by_weight(bench, &prepared, &delivered, difference_g);
    let range_ml = report.delivered_range_ml();
    let printed = report_once(bench, report, said, None, Vec::new(), &mut Warned::default());
    match (printed, delivered.completed) {
        (Err(failure), _) => Err(failure.after_motion().delivered(range_ml)),
        (Ok(()), true) => Ok(()),
        (Ok(()), false) => {
            Err(Failure::stopped(interrupt.signal().unwrap_or(0), true, STOPPED).delivered(range_ml))
        }
    }
}

/// Reads the balance with a sign of life. It waits for its load to stand still, and is read before the motor is said to
/// move.
fn at_rest<T>(json: bool, read: impl FnOnce() -> T) -> T {
    let sign = (!json).then(|| waiting("waiting for the balance to stand still"));
    let found = read();
    if let Some(sign) = sign {
        sign.finish_and_clear();
    }
    found
}

/// Returns what a session gives, or its failure.
fn of_session<T>(session: &mut Session<'_>, found: Result<T, DoseError>) -> Result<T, Failure> {
    noted(session, found).map_err(|error| Failure::from(error).of_session(session))
}
