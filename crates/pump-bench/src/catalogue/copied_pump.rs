//! A built-in pump on a real motor: a copy of the paper's pump, which nobody has weighed.

use super::built_in::built_in;
use super::drawn_pump::measured_uncertainty;
use crate::pump_file::PumpFile;

/// Returns the pump with the uncertainty of a copy, if it is a built-in pump as the program has it.
///
/// McIntyre et al. measured the 2.4 % of the built-in pumps on their own pump. A real motor turns another one.
pub(crate) fn as_a_copy(mut file: PumpFile) -> PumpFile {
    let is_built_in = file.motor.has_assumed_steps()
        && built_in(&file.pump.id).is_some_and(|paper| paper.uncertainty == file.uncertainty);
    if let (true, Ok(model)) = (is_built_in, file.model()) {
        // The curve of the built-in pumps is a polynomial without residuals.
        const RESIDUALS_ML: f64 = 0.0;
        let roller_ml = model.roller_volume().total_ml();
        file.uncertainty = measured_uncertainty(model.geometry(), roller_ml, RESIDUALS_ML, &file.uncertainty);
    }
    file
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
}
