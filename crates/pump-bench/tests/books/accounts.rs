//! The accounts of angle, volume and carry.

use pump_bench::pump_file::{DriveTable, DriverName};
use pump_bench::report::Status;
use pump_bench::{DoseError, DoseRequest, Rehearsal};
use pump_ctl::plan::{Phase, PlanError, Ramps};
use pump_model::units::{TURN_RAD, radians};

use crate::bench::{Lab, file, numbers, warning};

/// Returns the smallest and the largest volume of a turn over all start angles, found by looking.
fn looked_up_ml(lab: &Lab, turn_rad: f64) -> (f64, f64) {
    let curve = lab.bench.model().outlet_curve();
    let volumes = (0..3600).map(|n| {
        let start_rad = radians(f64::from(n) / 10.0);
        curve.volume_ml(start_rad + turn_rad) - curve.volume_ml(start_rad)
    });
    volumes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), ml| (a.min(ml), b.max(ml)))
}

#[test]
fn doses_from_an_unknown_angle_add_up_to_what_was_asked_for() {
    for (volume_ml, count) in [(1.0, 21), (0.5, 40), (3.0, 10), (5.0, 7), (-1.0, 12)] {
        let lab = Lab::new();
        lab.home(None);
        let mut steps = 0;
        let mut booked_ml = 0.0;
        for number in 1..=count {
            let (prepared, report) = lab.dose(DoseRequest::dose(volume_ml));
            let plan = &prepared.plan;
            steps += plan.steps();
            booked_ml += plan.planned_ml();
            // The dose itself lies within its bounds, whatever the angle.
            let (least_ml, most_ml) = looked_up_ml(&lab, plan.steps() as f64 * plan.step_rad());
            assert!(plan.least_ml() < least_ml + 1e-6 && most_ml < plan.most_ml() + 1e-6);
            assert!(plan.planned_ml() > plan.least_ml() - 1e-9 && plan.planned_ml() < plan.most_ml() + 1e-9);
            // The total lies within the bounds of the carry.
            let asked_ml = volume_ml * f64::from(number);
            let (least_ml, most_ml) = looked_up_ml(&lab, steps as f64 * plan.step_rad());
            let worst_ml = (most_ml - asked_ml).max(asked_ml - least_ml);
            let step_ml = plan.step_rad() * 4.0;
            assert!(worst_ml < 0.5 * (most_ml - least_ml) + step_ml, "{volume_ml} mL, {number}: {worst_ml}");
            let carry_ml = report["carry_ml"].as_f64().unwrap();
            let within_ml = report["carry_half_width_ml"].as_f64().unwrap_or(0.0);
            for total_ml in [least_ml, most_ml] {
                let off_ml = (asked_ml - total_ml - carry_ml).abs();
                assert!(off_ml < within_ml + 1e-5, "{volume_ml} mL, {number}: {off_ml} of {within_ml}");
            }
        }
        assert!((booked_ml - volume_ml * f64::from(count)).abs() < 0.01);
    }
}

#[test]
fn volumes_that_are_offered_as_exact_are_exact_with_a_carry_too() {
    let lab = Lab::new();
    lab.home(None);
    lab.dose(DoseRequest::dose(2.0).with_retraction(0.7));
    let carry_ml = lab.status()["carry_ml"].as_f64().unwrap();
    assert!(carry_ml > 0.5);
    let prepared = lab.bench.prepare(DoseRequest::dose(3.0)).unwrap();
    let offered = numbers(warning(&prepared, "exact at any angle").split("; to dose").next().unwrap());
    assert!(offered.len() >= 5, "{offered:?}");
    // The volume asked for stands between both lists.
    for volume_ml in offered.into_iter().filter(|volume_ml| *volume_ml != 3.0) {
        let plan = lab.bench.prepare(DoseRequest::dose(volume_ml)).unwrap().plan;
        assert!(
            plan.most_ml() - plan.least_ml() < 0.01,
            "{volume_ml} mL: {} to {}",
            plan.least_ml(),
            plan.most_ml()
        );
    }
}

#[test]
fn an_unknown_angle_stays_unknown_when_the_number_of_rollers_is_corrected() {
    let lab = Lab::new();
    lab.home(None);
    let two = pump_bench::built_in("two-roller").unwrap();
    let mut corrected = file();
    (corrected.rollers, corrected.tube, corrected.backplate) = (two.rollers, two.tube, two.backplate);
    corrected.roller_volume = two.roller_volume;
    let bench = lab.with_file(corrected);
    assert!(!bench.stands().unwrap().phase().is_known(bench.model().pitch_rad()));
}

#[test]
fn a_suck_back_that_was_killed_leaves_a_carry_with_a_width_a_share_and_a_warning() {
    let lab = Lab::new();
    let ramps = Some(Ramps::Fastest);
    lab.killed(DoseRequest::dose(5.0).with_retraction(1.5).with_ramps(ramps), 1);
    let carry = lab.status();
    let (carry_ml, within_ml) =
        (carry["carry_ml"].as_f64().unwrap(), carry["carry_half_width_ml"].as_f64().unwrap_or(0.0));
    assert!(carry_ml > 0.0 && (carry_ml - within_ml).abs() < 1e-3, "{carry_ml} {within_ml}");
    let (prepared, report) = lab.dose(DoseRequest::dose(5.0));
    warning(&prepared, "leave the carry unsure");
    let shares = report["uncertainty_budget"].as_array().unwrap();
    let share = shares.iter().find(|share| share["source"] == "carry").unwrap();
    let standard_ml = share["standard_ml"].as_f64().unwrap();
    assert!(standard_ml > within_ml / 3.0_f64.sqrt() && within_ml > 0.05, "{share} {within_ml}");
}

#[test]
fn a_suck_back_is_warned_of_and_refused_with_the_names_of_its_own_ports() {
    let lab = Lab::new();
    // The pump stands so that the suck-back meets more flow than the dose.
    let mut request = DoseRequest::dose(1.0).with_retraction(1.0);
    request.start_angle_rad = Some(radians(100.0));
    let back = lab.bench.prepare(request).unwrap().retraction.unwrap().prediction;
    // The outlet sucks: a limit that the dose keeps at its inlet and the suck-back breaks at the outlet.
    let dose = lab.bench.prepare(request.with_retraction(None)).unwrap().prediction;
    assert!(back.outlet.min_kpa < dose.inlet.min_kpa);
    request.pressures.min_inlet_kpa = Some(0.5 * (back.outlet.min_kpa + dose.inlet.min_kpa));
    let refused = pump_bench::report::with_sources(&lab.bench.prepare(request).unwrap_err());
    assert!(
        refused.contains("sucked back") && refused.contains("the outlet pressure would fall"),
        "{refused}"
    );
    request.pressures.min_inlet_kpa = Some(back.outlet.min_kpa - 0.1);
    let prepared = lab.bench.prepare(request).unwrap();
    let warned = warning(&prepared, "while it sucks back");
    assert!(warned.contains("the outlet pressure comes close"), "{warned}");
}

#[test]
fn a_rehearsed_dose_is_warned_of_as_a_single_one() {
    let lab = Lab::new();
    let grbl = pump_bench::Bench::new(file(), Some(DriverName::Grbl), lab.bench.folder().path()).unwrap();
    let request = DoseRequest::dose(5.0).with_start_angle(0.2, 0.0);
    let single = grbl.prepare(request).unwrap();
    let mut rehearsal = Rehearsal::new(&grbl).unwrap();
    assert_eq!(rehearsal.prepare(request).unwrap().warnings, single.warnings);
}

#[test]
fn doses_from_an_angle_that_is_known_within_bounds_add_up_within_them() {
    let lab = Lab::new();
    let phase = Phase::within(0.3, 0.25);
    lab.home(Some(phase));
    let curve = *lab.bench.model().outlet_curve();
    let (mut turned_rad, mut asked_ml) = (0.0, 0.0);
    for n in 0..30 {
        let volume_ml = 0.4 + 0.1 * f64::from(n % 7);
        let (prepared, report) = lab.dose(DoseRequest::dose(volume_ml));
        turned_rad += prepared.plan.steps() as f64 * prepared.plan.step_rad();
        asked_ml += volume_ml;
        let carry_ml = report["carry_ml"].as_f64().unwrap();
        let within_ml = report["carry_half_width_ml"].as_f64().unwrap_or(0.0);
        for part in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            let start_rad = phase.angle_rad() + part * phase.half_width_rad() + TURN_RAD;
            let total_ml = curve.volume_ml(start_rad + turned_rad) - curve.volume_ml(start_rad);
            assert!((asked_ml - total_ml - carry_ml).abs() < within_ml + 1e-6, "dose {n} at {part}");
        }
    }
}

#[test]
fn an_angle_that_was_counted_by_other_steps_is_unknown_until_it_is_found() {
    let lab = Lab::new();
    let mut finer = file();
    finer.motor.steps_per_rev *= 2;
    let finer = lab.with_file(finer);
    let is_told = || {
        let session = finer.session().unwrap();
        session.pending_notes().iter().any(|note| note.text().contains("steps per revolution of the head"))
    };
    let is_known = || Status::of(&finer).unwrap().angle_known;
    // An angle that was found and not left since is that of any motor.
    lab.home(Some(Phase::known(1.0)));
    assert!(is_known() && !is_told());
    lab.dose(DoseRequest::dose(2.0));
    assert!(!is_known() && is_told());
    let smooth = finer.prepare(DoseRequest::dose(1.0).with_smooth(true));
    assert!(matches!(smooth, Err(DoseError::Plan(PlanError::SmoothWithoutAngle { .. }))), "{smooth:?}");
    // So is one that was counted in the other direction.
    let mut round = file();
    round.drive = Some(DriveTable::of(DriverName::Sim).with_invert(true));
    assert!(!Status::of(&lab.with_file(round)).unwrap().angle_known);
    // The file as it was has the angle as it was.
    assert!(Status::of(&lab.bench).unwrap().angle_known);
    finer.set_angle(Some(Phase::known(2.0))).unwrap();
    assert!(is_known() && !is_told());
    // A dose that was cut off, too.
    lab.home(Some(Phase::known(1.0)));
    lab.killed(DoseRequest::dose(2.0), 3);
    assert!(!is_known() && is_told());
    finer.session().unwrap().discard().unwrap();
    assert!(!is_known());
}
