//! A verification in words and as JSON.

use crate::calibration::{Tolerance, Verification};

impl Verification {
    /// The verification in words: the verdict, then the systematic and the random error.
    pub fn text(&self) -> String {
        let verdict = |passed: bool| if passed { "within" } else { "BEYOND" };
        let Tolerance { systematic_percent, random_percent } = self.tolerance;
        format!(
            "{}: {} doses of {} mL, mean {:.4} mL\n  \
             systematic   {:+.4} mL, {:+.3} %, {} ± {systematic_percent} %\n  \
             random       {:.4} mL, CV {:.3} %, {} {random_percent} %\n",
            if self.passed { "PASSED" } else { "FAILED" },
            self.volumes_ml.len(),
            self.nominal_ml,
            self.mean_ml,
            self.systematic_ml,
            self.systematic_percent,
            verdict(self.systematic_percent.abs() <= systematic_percent),
            self.random_ml,
            self.random_percent,
            verdict(self.random_percent <= random_percent),
        )
    }

    /// One line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self)
            .unwrap_or_else(|error| unreachable!("a verification is plain data: {error}"))
    }
}
