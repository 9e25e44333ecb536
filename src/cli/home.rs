//! `dose home --set <ANGLE>`, `dose home --unknown`, `dose tube --new` and `dose discard`: what a person says of the rotor, of
//! the tube and of an unfinished dose.

use pump_ctl::plan::Phase;
use pump_dose::journal::{JournalError, State};
use pump_dose::{Bench, DoseError, Session};
use pump_model::math::degrees;

use super::args::Options;
use super::{Failure, print};

/// Records the angle, or that it is unknown.
pub(crate) fn home(angle_rad: Option<f64>, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose home", &["--driver"])?;
    let bench = options.bench()?;
    let (mut session, aside) = match bench.session() {
        Err(DoseError::Journal(JournalError::Damaged { .. })) => {
            let aside = bench.folder().lock()?.set_journal_aside()?;
            let aside = format!("the damaged journal is now {}\n", aside.display());
            (bench.session()?, aside)
        }
        session => (session?, String::new()),
    };
    let owed_ml = owed(&session);
    let unknown = || Phase::unknown(bench.model().pitch_rad());
    let state = session.set_angle(angle_rad.map_or_else(unknown, Phase::known))?;
    print(&format!("{aside}{}{}", stands(&bench, &state), zeroed(owed_ml)))
}

pub(crate) fn new_tube(options: &Options) -> Result<(), Failure> {
    options.accept_only("dose tube", &["--driver"])?;
    let bench = options.bench()?;
    let mut session = bench.session()?;
    let owed_ml = owed(&session);
    let worn_ml = session.state().map_or(0.0, |state| state.wear.volume_ml);
    let state = session.new_tube()?;
    print(&format!(
        "a new tube is on record; the one before pumped {worn_ml:.1} mL\n{}{}warning: a new tube gives another volume per \
         revolution: calibrate it\nif the rotor was turned by hand, say where it stands with `dose home --set <ANGLE>`\n",
        stands(&bench, &state),
        zeroed(owed_ml)
    ))
}

pub(crate) fn discard(options: &Options) -> Result<(), Failure> {
    options.accept_only("dose discard", &["--driver"])?;
    let bench = options.bench()?;
    let mut session = bench.session()?;
    let owed_ml = owed(&session);
    let state = session.discard()?;
    print(&format!("the unfinished dose is accepted as it is\n{}{}", stands(&bench, &state), zeroed(owed_ml)))
}

fn owed(session: &Session<'_>) -> f64 {
    session.state().map_or(0.0, |state| state.carry_ml)
}

fn stands(bench: &Bench, state: &State) -> String {
    if !state.phase().is_known(bench.model().pitch_rad()) {
        return "the rollers stand at an unknown angle; `dose home --set <ANGLE>` says where\n".to_owned();
    }
    let width = match degrees(state.half_width_rad) {
        0.0 => String::new(),
        width => format!(" ± {width:.2}°"),
    };
    format!("the rollers stand at {:.2}°{width}\n", degrees(state.angle_rad))
}

fn zeroed(owed_ml: f64) -> String {
    match owed_ml {
        0.0 => String::new(),
        owed => format!("warning: {:.2} µL that doses owed are forgotten\n", 1e3 * owed),
    }
}
