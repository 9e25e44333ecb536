//! Claims about the log of a dose by weight that several commands made.

use std::ops::ControlFlow;

use pump_bench::record::{LogEnd, LogEntry, LogLine};
use pump_bench::{Bench, DoseRequest, OrderByWeight, Session};
use pump_ctl::plan::Cruise;

use crate::plant::{Plant, Truth};
use crate::{bench, file, session, truth};

fn logged(bench: &Bench) -> Vec<LogEntry> {
    let lines = bench.log().unwrap().map(Result::unwrap);
    lines.map(|line| if let LogLine::Dose(dose) = line { dose } else { panic!("{line:?}") }).collect()
}

/// Finishes what is left of the dose, or stops after `steps` of a stretch.
fn go_on(session: &mut Session<'_>, plant: &Plant, order: &OrderByWeight, steps: u64) -> bool {
    let watch = |made| if made >= steps { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let mut balance = plant.balance();
    let begun = session.state().is_some_and(|state| state.unfinished.is_some());
    let made = if begun {
        let (prepared, shown) = session.prepare_rest_by_weight(order, &mut balance).unwrap();
        session.run_from_tare(&prepared, shown, &mut balance, watch)
    } else {
        let prepared = session.prepare_by_weight(order).unwrap();
        session.run_by_weight(&prepared, &mut balance, watch)
    };
    made.unwrap().completed
}

#[test]
fn the_shares_of_a_dose_that_was_stopped_twice_add_up_to_what_was_weighed() {
    for (processes, factor) in [(1, 1.03), (3, 0.98)] {
        let folder = tempfile::tempdir().unwrap();
        let file = file(1.6, 1000.0);
        let plant = Plant::new(Truth { factor, ..truth(&file) });
        let bench = bench(file, &plant, folder.path());
        let order = OrderByWeight::new(DoseRequest::dose(6.0).with_cruise(Cruise::Flow { ml_s: 2.0 }));
        let mut one = session(&bench, &plant);
        one.set_angle(Some(pump_ctl::plan::Phase::known(0.3))).unwrap();
        for (part, steps) in [600, 500, u64::MAX].into_iter().enumerate() {
            if part > 0 && processes > 1 {
                drop(one);
                one = session(&bench, &plant);
            }
            assert_eq!(go_on(&mut one, &plant, &order, steps), steps == u64::MAX);
        }
        drop(one);
        let found = logged(&bench);
        let [first, second, last] = &found[..] else { panic!("{found:?}") };
        assert_eq!(
            [first, second, last].map(|dose| (dose.end, dose.resumed)),
            [(LogEnd::Stopped, false), (LogEnd::Stopped, true), (LogEnd::Weighed, true)]
        );
        let weighed_ml = bench.story().unwrap().state.unwrap().last.unwrap().by_weight.unwrap().weighed_ml;
        let sum_ml: f64 = found.iter().map(|dose| dose.delivered_ml).sum();
        assert!((sum_ml - weighed_ml).abs() < 1e-9, "{sum_ml} {weighed_ml}: {found:?}");
        assert!((weighed_ml - 6.0).abs() < 0.05, "{weighed_ml}");
        // Each was asked for what lacked then.
        assert!((second.requested_ml - (6.0 - first.delivered_ml)).abs() < 1e-9, "{found:?}");
        let shares = found.iter().all(|dose| (0.1..5.9).contains(&dose.delivered_ml));
        assert!(shares, "{found:?}");
    }
}
