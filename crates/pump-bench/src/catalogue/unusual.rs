//! The warnings of a pump that is possible and unusual: mostly a slip of a unit, of a digit or of a count.

use std::ops::RangeInclusive;

use pump_model::Port;

use super::microsteps::{is_usual, usual_in_words};
use super::overlap::overlap_warning;
use super::suction::suction_warning;
use super::tube_rating::rated_kpa;
use crate::heads::{path_mm, usual_ml};
use crate::notice::Notice;
use crate::numbers::significant;
use crate::pump_file::PumpFile;

/// Most rollers that bought heads have. The catalogue has 3 to 8, and Ismatec's MS-4/12 has twelve by its name.
const MOST_ROLLERS: u32 = 12;

/// Largest part of the walls' thickness by which rollers press a tube that is not warned of: twice that of the heads of
/// McIntyre et al., whose gap of 3 mm takes two walls of 2 mm.
const MOST_SQUEEZE: f64 = 0.5;

/// Full steps per revolution that stepper motors have: those of 18 deg, as permanent magnet motors make, to those of
/// 0.9 deg of hybrid motors.
const FULL_STEPS: RangeInclusive<u32> = 20..=400;

/// Pressures of the air at places where people work, in kPa absolute: 5500 m up have 50.5 kPa by the standard
/// atmosphere (ISO 2533), and the shore of the Dead Sea, the lowest land, lies below 110 kPa.
const AIR_KPA: RangeInclusive<f64> = 50.0..=110.0;

/// Returns a warning for each value of a pump that is possible and unusual: rollers that overlap or press the tube
/// flat, a volume of a revolution for its bore, a number of rollers, the air's pressure, a height for its tube on
/// either side, full steps of a motor, and microsteps for its driver.
///
/// ```
/// let mut file = pump_bench::built_in("three-roller").unwrap();
/// assert!(pump_bench::catalogue::unusual(&file).is_empty());
/// file.motor.steps_per_rev = 3000;
/// file.motor.confirmed = None;
/// let warnings = pump_bench::catalogue::unusual(&file);
/// assert!(warnings[0].text().starts_with("3000 steps per revolution are 15 microsteps"), "{warnings:?}");
/// ```
pub fn unusual(file: &PumpFile) -> Vec<Notice> {
    let of_head = [overlap(file), of_squeeze(file), of_volume(file), of_one_roller(file), of_rollers(file)];
    let found = of_head.into_iter().chain([
        of_air(file),
        of_suction(file),
        of_height(file),
        of_full_steps(file),
        of_microsteps(file),
    ]);
    found.flatten().map(Notice::from).collect()
}

/// Returns the warnings of [`unusual`] that each dose repeats, since it may deliver something else than it says:
/// rollers that overlap, one roller, and a tube that may collapse. `is_weighed` is true for a pump whose calibration
/// contains what its tube takes in.
pub(crate) fn doubtful(file: &PumpFile, is_weighed: bool) -> impl Iterator<Item = Notice> {
    let suction = of_suction(file).filter(|_| !is_weighed);
    [overlap(file), of_one_roller(file), suction].into_iter().flatten().map(Notice::from)
}

/// Warns of rollers that overlap in space.
fn overlap(file: &PumpFile) -> Option<String> {
    file.model().ok().and_then(|pump| overlap_warning(pump.geometry()))
}

/// Warns of a volume that heads with this bore hardly have.
fn of_volume(file: &PumpFile) -> Option<String> {
    let head = file.head.as_ref()?;
    let bore_mm = head.tube_bore_mm?;
    let (least_ml, most_ml) = usual_ml(bore_mm);
    let around_mm = path_mm(head.ml_per_rev, bore_mm);
    (!(least_ml..=most_ml).contains(&head.ml_per_rev)).then(|| {
        format!(
            "{} mL per revolution fill {} mm of a bore of {bore_mm} mm, and heads that are published have {} to {} mL \
             for such a bore; look at the unit and the decimal point",
            head.ml_per_rev,
            significant(around_mm, 3),
            significant(least_ml, 2),
            significant(most_ml, 2)
        )
    })
}

/// Warns of one roller. A drawing says by itself whether its rollers seal and overlap.
fn of_one_roller(file: &PumpFile) -> Option<String> {
    (file.head.is_some() && file.rollers.count == 1).then(|| {
        "one roller seals the tube only on a bed that goes all the way round: on any other the tube is open for a part \
         of each turn, and liquid runs back; count the rollers again"
            .to_owned()
    })
}

/// Warns of more rollers than bought heads have.
fn of_rollers(file: &PumpFile) -> Option<String> {
    let rollers = file.rollers.count;
    (file.head.is_some() && rollers > MOST_ROLLERS).then(|| {
        format!(
            "{rollers} rollers are more than heads have that are published, 2 to {MOST_ROLLERS}; count the rollers \
             again"
        )
    })
}

/// Warns of a drawing whose rollers press the tube's walls to less than half of their thickness.
fn of_squeeze(file: &PumpFile) -> Option<String> {
    let pump = file.model().ok().filter(|_| file.head.is_none())?;
    let head = pump.geometry();
    let walls_mm = 2.0 * (head.tube_outer_radius_mm - head.bore_radius_mm);
    let gap_mm = head.backplate_radius_mm - head.roller_radius_mm - head.roller_offset_mm;
    let part = 1.0 - gap_mm / walls_mm;
    (part > MOST_SQUEEZE).then(|| {
        format!(
            "the rollers press the tube's two walls, {} mm, into a gap of {} mm, by {:.0} % of their thickness; the \
             heads of McIntyre et al. press by 25 %, and more wears the tube and loads the motor; check offset, roller \
             and backplate, which are radii, and the tube's wall",
            significant(walls_mm, 3),
            significant(gap_mm, 3),
            100.0 * part
        )
    })
}

/// Warns of a pressure that the air has hardly anywhere.
fn of_air(file: &PumpFile) -> Option<String> {
    let kpa = file.ambient.pressure_kpa;
    (!AIR_KPA.contains(&kpa)).then(|| {
        format!(
            "the air's pressure is {} kPa absolute, and where people work it is {} kPa (5500 m up) to {} kPa; look at \
             the unit, the decimal point and the altitude",
            significant(kpa, 4),
            AIR_KPA.start(),
            AIR_KPA.end()
        )
    })
}

/// Warns of a supply so low that the tube may collapse.
fn of_suction(file: &PumpFile) -> Option<String> {
    suction_warning(file, file.ambient.pressure_kpa - file.reservoir_kpa(Port::Inlet))
}

/// Warns of a vessel so high that the column of fluid presses with more than tubes are rated for.
fn of_height(file: &PumpFile) -> Option<String> {
    let head_mm = file.head.as_ref().map(|head| head.tube_bore_mm);
    let bore_mm = head_mm.unwrap_or_else(|| file.tube.bore_radius_mm.map(|radius_mm| 2.0 * radius_mm));
    let above_kpa = file.reservoir_kpa(Port::Outlet) - file.ambient.pressure_kpa;
    let rated_kpa = rated_kpa(bore_mm);
    (above_kpa > rated_kpa).then(|| {
        let bore = bore_mm.map_or_else(|| "any bore".to_owned(), |mm| format!("a bore of {mm} mm"));
        format!(
            "the vessel presses back with {} kPa above the air's pressure, and pump tubes of {bore} are rated at \
             {rated_kpa} kPa at most (Saint-Gobain); look at the height of the vessel",
            significant(above_kpa, 3)
        )
    })
}

/// Returns why a number of full steps per revolution is hardly that of a stepper motor, or `None` if it may be.
///
/// ```
/// use pump_bench::catalogue::unusual_full_steps;
/// assert!(unusual_full_steps(200).is_none());
/// assert!(unusual_full_steps(3200).unwrap().contains("with their microsteps"));
/// ```
pub fn unusual_full_steps(full_steps: u32) -> Option<String> {
    (!FULL_STEPS.contains(&full_steps)).then(|| {
        format!(
            "{full_steps} full steps per revolution are unusual: stepper motors have {} to {}, mostly 200 (1.8 deg) or \
             400 (0.9 deg); the steps of a revolution with their microsteps, or with a gearbox, are another number",
            FULL_STEPS.start(),
            FULL_STEPS.end()
        )
    })
}

/// Returns why microsteps are hardly those of a stepper driver, or `None` if they may be.
///
/// ```
/// use pump_bench::catalogue::unusual_microsteps;
/// assert!(unusual_microsteps(16).is_none());
/// assert!(unusual_microsteps(15).unwrap().starts_with("15 microsteps are unusual"));
/// ```
pub fn unusual_microsteps(microsteps: u32) -> Option<String> {
    (!is_usual(microsteps))
        .then(|| format!("{microsteps} microsteps are unusual: stepper drivers have {}", usual_in_words()))
}

/// Warns of full steps that hardly any motor has.
fn of_full_steps(file: &PumpFile) -> Option<String> {
    let is_said = file.motor.confirmed != Some(false);
    unusual_full_steps(file.motor.full_steps_per_rev).filter(|_| is_said)
}

/// Warns of microsteps that no usual driver has, where the steps are a multiple of the full steps.
fn of_microsteps(file: &PumpFile) -> Option<String> {
    let motor = &file.motor;
    let (steps, full_steps) = (motor.steps_per_rev, motor.full_steps_per_rev);
    let is_said = motor.confirmed != Some(false) && full_steps > 0 && steps % full_steps == 0;
    let microsteps = if is_said { steps / full_steps } else { return None };
    (!is_usual(microsteps)).then(|| {
        format!(
            "{steps} steps per revolution are {microsteps} microsteps of {full_steps} full steps, and motor drivers \
             have {}; look at the driver's switches",
            usual_in_words()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::BoughtPump;
    use crate::pump_file::{AmbientTable, HeadTable, Reservoir};

    /// Warnings of a bought head after a change.
    fn warned(change: impl FnOnce(&mut PumpFile)) -> Vec<String> {
        let mut head = HeadTable::new(0.29);
        head.tube_bore_mm = Some(1.6);
        let mut file = BoughtPump { id: "acid".to_owned(), head, rollers: 3 }.pump_file();
        file.motor.confirmed = None;
        change(&mut file);
        file.check("acid.toml").unwrap();
        unusual(&file).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_usual_pump_has_no_warning_and_each_slip_has_one() {
        assert_eq!(warned(|_| ()), Vec::<String>::new());
        let one = |change: &dyn Fn(&mut PumpFile), part: &str| {
            let said = warned(change);
            assert!(said.len() == 1 && said[0].contains(part), "{part}: {said:?}");
        };
        // 2.9 mL over pi/4 1.6² mm² are 1442 mm.
        let volume = |file: &mut PumpFile| {
            file.head.as_mut().unwrap().ml_per_rev = 2.9;
        };
        one(&volume, "2.9 mL per revolution fill 1442 mm of a bore of 1.6 mm");
        one(&|file| file.rollers.count = 1, "one roller seals the tube only on a bed");
        one(&|file| file.rollers.count = 40, "40 rollers are more");
        // 100 m of 997 kg/m³ press with 977.7 kPa.
        one(&|file| file.outlet.line.reservoir = Reservoir::Lift(100e3), "with 978 kPa");
        // 9.4 m of 997 kg/m³ suck with 91.9 kPa; 4 m with 39.1 kPa, as the tube of the paper stands.
        one(&|file| file.inlet.reservoir = Reservoir::Lift(9400.0), "sucks with 91.9 kPa below");
        one(&|file| file.outlet.line.reservoir = Reservoir::Pressure(600.0), "rated at 482 kPa");
        let air_kpa = |kpa: f64| move |file: &mut PumpFile| file.ambient = AmbientTable::of_pressure_kpa(kpa);
        one(&air_kpa(857.0), "the air's pressure is 857 kPa absolute");
        one(&air_kpa(8.57), "the air's pressure is 8.57 kPa absolute");
        one(&|file| file.motor.steps_per_rev = 3000, "are 15 microsteps of 200 full steps");
        for full_steps in [4, 3200] {
            let motor = |file: &mut PumpFile| {
                (file.motor.steps_per_rev, file.motor.full_steps_per_rev) = (16 * full_steps, full_steps);
            };
            one(&motor, &format!("{full_steps} full steps per revolution are unusual"));
        }
    }

    #[test]
    fn values_that_heads_motors_and_benches_have_are_not_warned_of() {
        for microsteps in [1, 2, 4, 5, 8, 10, 16, 20, 25, 32, 40, 50, 64, 100, 125, 128, 200, 256] {
            assert_eq!(warned(|file| file.motor.steps_per_rev = 200 * microsteps).len(), 0, "{microsteps}");
        }
        for altitude_m in [-430.0, 0.0, 1390.0, 5100.0] {
            let place = |file: &mut PumpFile| file.ambient = AmbientTable::at_altitude_m(altitude_m);
            assert_eq!(warned(place).len(), 0, "{altitude_m}");
        }
        // A 28BYJ-48 with its gearbox: 2048 full steps, which are no multiple of 200.
        assert_eq!(warned(|file| file.motor.steps_per_rev = 2048).len(), 0);
        for full_steps in [20, 24, 48, 96, 200, 400] {
            let motor = |file: &mut PumpFile| {
                (file.motor.steps_per_rev, file.motor.full_steps_per_rev) = (16 * full_steps, full_steps);
            };
            assert_eq!(warned(motor).len(), 0, "{full_steps}");
        }
        for rollers in 2..=12 {
            assert_eq!(warned(|file| file.rollers.count = rollers).len(), 0, "{rollers}");
        }
        assert_eq!(warned(|file| file.outlet.line.reservoir = Reservoir::Lift(20e3)).len(), 0);
        assert_eq!(warned(|file| file.inlet.reservoir = Reservoir::Lift(4000.0)).len(), 0);
        // Nobody has said the steps of a file that the program filled in.
        let assumed = |file: &mut PumpFile| {
            (file.motor.steps_per_rev, file.motor.confirmed) = (3000, Some(false));
        };
        assert_eq!(warned(assumed).len(), 0);
    }

    #[test]
    fn a_drawing_whose_rollers_press_the_tube_flat_is_warned_of() {
        let squeezed = |offset_mm: f64| {
            let mut file = crate::catalogue::built_in("three-roller").unwrap();
            file.rollers.offset_mm = Some(offset_mm);
            unusual(&file).iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        // Two walls of 2 mm in a gap of 3 mm, of 1.8 mm and of 2.2 mm.
        assert!(squeezed(40.0).is_empty());
        let said = squeezed(41.2);
        assert!(said.len() == 1 && said[0].contains("into a gap of 1.8 mm, by 55 % of"), "{said:?}");
        assert!(squeezed(40.8).is_empty());
    }
}
