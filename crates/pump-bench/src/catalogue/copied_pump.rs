//! The uncertainty of McIntyre et al. in a file of another pump: it is of their own pump alone.

use super::built_in::{BUILT_IN, built_in};
use super::drawn_pump::measured_uncertainty;
use crate::pump_file::PumpFile;

/// Returns the pump with the uncertainty of a copy, if it is a built-in pump as the program has it.
///
/// McIntyre et al. measured the 2.4 % of the built-in pumps on their own pump. A real motor turns another one.
pub(crate) fn as_a_copy(mut file: PumpFile) -> PumpFile {
    let is_built_in = file.motor.has_assumed_steps()
        && built_in(&file.pump.id).is_some_and(|paper| paper.uncertainty == file.uncertainty);
    if is_built_in {
        take_that_of_a_copy(&mut file, false);
    }
    file
}

/// Returns the pump with the uncertainty of a copy, if its file states that of the built-in pumps for another head.
///
/// A file that began as a copy of a built-in pump keeps the 2.4 % when rollers, tube or backplate are changed. Nobody
/// has measured it for such a head.
pub(crate) fn with_own_uncertainty(mut file: PumpFile) -> PumpFile {
    let papers = || BUILT_IN.into_iter().filter_map(|(name, _)| built_in(name));
    let is_of_paper = papers().any(|paper| paper.uncertainty == file.uncertainty);
    let geometry = |file: &PumpFile| file.model().ok().map(|pump| *pump.geometry());
    if is_of_paper && papers().all(|paper| geometry(&paper) != geometry(&file)) {
        take_that_of_a_copy(&mut file, true);
    }
    file
}

/// Writes the uncertainty of a copy that nobody weighed in place of that of the built-in pumps.
fn take_that_of_a_copy(file: &mut PumpFile, replaces: bool) {
    let Ok(model) = file.model() else { return };
    // The curve of the built-in pumps is a polynomial without residuals.
    const RESIDUALS_ML: f64 = 0.0;
    let roller_ml = model.roller_volume().total_ml();
    file.uncertainty = measured_uncertainty(model.geometry(), roller_ml, RESIDUALS_ML, &file.uncertainty);
    file.uncertainty.replaces_papers = replaces;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_accuracy_is_of_the_papers_pump_alone() {
        let copy = as_a_copy(built_in("three-roller").unwrap());
        // sqrt(20² + 10²)/sqrt(3) between pumps and tubes of 10 mm bore (Omega FPU5MT, table 9-3), and
        // 2 x 0.1/10/sqrt(3) of the bore; 15/sqrt(3) over the speed.
        assert!((copy.uncertainty.model_percent - 13.0).abs() < 0.05, "{:?}", copy.uncertainty);
        assert_eq!(copy.uncertainty.speed_percent, Some(8.7));
        // 2.1 % of 2.1055 mL.
        assert!((copy.uncertainty.roller_volume_ml.unwrap() - 0.044).abs() < 1e-9);

        let mut stated = built_in("three-roller").unwrap();
        stated.motor.confirmed = Some(true);
        assert_eq!(as_a_copy(stated.clone()), stated, "its owner wrote it");
    }

    #[test]
    fn the_papers_accuracy_holds_for_no_head_of_other_dimensions() {
        let changed = |change: &dyn Fn(&mut PumpFile)| {
            let mut file = built_in("three-roller").unwrap();
            change(&mut file);
            with_own_uncertainty(file).uncertainty
        };
        for other in [&|file: &mut PumpFile| file.rollers.count = 4, &|file: &mut PumpFile| {
            file.tube.bore_radius_mm = Some(4.8);
        }] as [&dyn Fn(&mut PumpFile); 2]
        {
            let own = changed(other);
            // Both heads take the spread of drawings that nobody weighed.
            assert!((own.model_percent - 13.0).abs() < 0.15 && own.speed_percent == Some(8.7), "{own:?}");
            assert!(own.replaces_papers);
        }
        // The paper has a pump of two rollers too, and an owner's own figure is kept.
        assert_eq!(changed(&|file| file.rollers.count = 2).model_percent, 2.4);
        let stated = changed(&|file| (file.rollers.count, file.uncertainty.model_percent) = (4, 3.0));
        assert_eq!((stated.model_percent, stated.speed_percent), (3.0, None));
        for (name, _) in BUILT_IN {
            let paper = built_in(name).unwrap();
            assert_eq!(with_own_uncertainty(paper.clone()), paper, "{name}");
        }
    }
}
