//! The reservoir at a line's end: its pressure, or the height to which the fluid is lifted.

use crate::pump_file::range::{WrongValue, allow};

/// Standard acceleration of free fall, in m/s² (3rd CGPM, 1901; ISO 80000-3).
const GRAVITY_M_S2: f64 = 9.806_65;

/// Largest height between pump and reservoir, in mm.
const MOST_LIFT_MM: f64 = 1e6;

/// Reservoir at the end of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reservoir {
    /// Pressure P_res at the line's end, in kPa absolute.
    Pressure(f64),
    /// Height to which the pump lifts the fluid on this side, in mm. On the inlet it is positive where the supply lies
    /// below the pump, on the outlet where the vessel lies above. The reservoir is open to the air.
    Lift(f64),
}

/// Side of the pump on which a line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// The supply's side.
    Inlet,
    /// The vessel's side.
    Outlet,
}

impl Default for Reservoir {
    fn default() -> Self {
        Self::OPEN
    }
}

impl Reservoir {
    /// Reservoir that is open to the air and as high as the pump.
    pub const OPEN: Self = Self::Lift(0.0);

    /// Returns the pressure at the line's end for a fluid of this density and an ambient pressure, in kPa absolute.
    ///
    /// A column of height h adds rho g h (hydrostatics): the supply's pulls at the inlet, the vessel's presses at the
    /// outlet.
    pub(crate) fn pressure_kpa(self, side: Side, density_kg_m3: f64, ambient_kpa: f64) -> f64 {
        match (self, side) {
            (Self::Pressure(kpa), _) => kpa,
            (Self::Lift(lift_mm), Side::Inlet) => ambient_kpa - column_kpa(lift_mm, density_kg_m3),
            (Self::Lift(lift_mm), Side::Outlet) => ambient_kpa + column_kpa(lift_mm, density_kg_m3),
        }
    }

    /// Returns the height whose column makes a pressure that is stated as such, in mm. `None` for a height. It is the
    /// inverse of [`Self::pressure_kpa`].
    pub(crate) fn column_mm(self, side: Side, density_kg_m3: f64, ambient_kpa: f64) -> Option<f64> {
        let Self::Pressure(kpa) = self else { return None };
        let lifted_kpa = match side {
            Side::Inlet => ambient_kpa - kpa,
            Side::Outlet => kpa - ambient_kpa,
        };
        Some(lifted_kpa / column_kpa(1.0, density_kg_m3))
    }

    /// Reads the keys `reservoir_kpa` and `lift_mm`, at most one of which is given. `None` without either.
    pub(super) fn of_keys(reservoir_kpa: Option<f64>, lift_mm: Option<f64>) -> Result<Option<Self>, String> {
        match (reservoir_kpa, lift_mm) {
            (Some(kpa), None) => Ok(Some(Self::Pressure(kpa))),
            (None, Some(lift_mm)) => Ok(Some(Self::Lift(lift_mm))),
            (None, None) => Ok(None),
            (Some(_), Some(_)) => {
                Err("`reservoir_kpa` and `lift_mm` exclude each other: a lift gives the reservoir's pressure"
                    .to_owned())
            }
        }
    }

    /// Returns the values of the keys `reservoir_kpa` and `lift_mm`.
    pub(super) fn keys(self) -> (Option<f64>, Option<f64>) {
        match self {
            Self::Pressure(kpa) => (Some(kpa), None),
            Self::Lift(lift_mm) => (None, Some(lift_mm)),
        }
    }

    /// Refuses a lift that leaves no pressure above the fluid's vapour pressure, and one beyond 1 km.
    pub(in crate::pump_file) fn check(
        self,
        side: Side,
        density_kg_m3: f64,
        ambient_kpa: f64,
        vapour_kpa: Option<f64>,
    ) -> Result<(), WrongValue> {
        let Self::Lift(lift_mm) = self else { return Ok(()) };
        // Lifting at the inlet takes pressure away, and so does a vessel below the pump.
        let falls = most_lift_mm(density_kg_m3, ambient_kpa, vapour_kpa);
        let vapour_kpa = vapour_kpa.unwrap_or(0.0);
        let (key, least_mm, most_mm) = match side {
            Side::Inlet => ("[inlet] lift_mm", -MOST_LIFT_MM, falls.min(MOST_LIFT_MM)),
            Side::Outlet => ("[outlet] lift_mm", -falls.min(MOST_LIFT_MM), MOST_LIFT_MM),
        };
        let allowed = format!(
            "more than {least_mm:.0} and less than {most_mm:.0}: beyond, the column of fluid would reach its vapour \
             pressure, {vapour_kpa:.4} kPa, or 1 km"
        );
        allow(lift_mm > least_mm && lift_mm < most_mm, key, lift_mm, &allowed)
    }
}

/// Returns the height, in mm, from which on the air's pressure does not lift a fluid: its column then takes all of it
/// but the vapour pressure.
pub(crate) fn most_lift_mm(density_kg_m3: f64, ambient_kpa: f64, vapour_kpa: Option<f64>) -> f64 {
    (ambient_kpa - vapour_kpa.unwrap_or(0.0)) / column_kpa(1.0, density_kg_m3)
}

/// Returns the pressure of a column of fluid, in kPa: rho g h.
fn column_kpa(height_mm: f64, density_kg_m3: f64) -> f64 {
    density_kg_m3 * GRAVITY_M_S2 * height_mm * 1e-6
}

#[cfg(test)]
mod tests {
    use crate::pump_file::PumpFile;

    /// Returns the file of a bought head without lines and surroundings.
    fn bought_head() -> String {
        "schema = \"pump/1\"\n\
         [pump]\nid = \"bought\"\nname = \"A bought head\"\ndefault_rate_ml_s = 0.2\n\
         [head]\nml_per_rev = 0.5\n[rollers]\ncount = 4\n\
         [motor]\nsteps_per_rev = 3200\nmax_speed_rpm = 100.0\nmax_acceleration_rad_s2 = 100.0\n\
         [fluid]\nname = \"water\"\ntemperature_degc = 25.0\ndensity_kg_m3 = 997.0\n"
            .to_owned()
    }

    /// Parses the three-roller pump with these keys in place of each line's reservoir.
    fn parsed(inlet: &str, outlet: &str) -> Result<PumpFile, String> {
        let text = crate::catalogue::built_in("three-roller").unwrap().to_toml();
        let text =
            text.replacen("reservoir_kpa = 88.637", inlet, 1).replacen("reservoir_kpa = 88.637", outlet, 1);
        PumpFile::parse(&text, "a file").map_err(|error| error.to_string())
    }

    #[test]
    fn a_lift_is_the_pressure_of_its_column_of_the_files_fluid() {
        let mut file = parsed("lift_mm = 1200.0", "lift_mm = 500.0").unwrap();
        let pump = file.model().unwrap();
        // A metre of water at 25 °C presses with 997 x 9.80665 Pa = 9.777 kPa.
        assert!((pump.inlet().reservoir_kpa - (85.7 - 1.2 * 9.777)).abs() < 1e-3);
        assert!((pump.outlet().reservoir_kpa - (85.7 + 0.5 * 9.777)).abs() < 1e-3);
        assert_eq!(PumpFile::parse(&file.to_toml(), "the same").unwrap(), file);
        // Ethanol at 25 °C has 785 kg/m³ (CRC Handbook), and its column presses less.
        file.fluid = file.fluid.changed_to(Some("ethanol"), None).unwrap();
        let ethanol_kpa = file.model().unwrap().inlet().reservoir_kpa;
        assert!((ethanol_kpa - (85.7 - 1.2 * 785.0 * 9.80665e-3)).abs() < 0.01, "{ethanol_kpa}");
        // A supply above the pump presses.
        let above = parsed("lift_mm = -300.0", "lift_mm = 0").unwrap().model().unwrap();
        assert!(above.inlet().reservoir_kpa > 88.6 && above.outlet().reservoir_kpa == 85.7);
    }

    #[test]
    fn a_line_of_which_nothing_is_known_has_a_reservoir_of_its_own() {
        let head = bought_head();
        let parsed = |lines: &str| {
            PumpFile::parse(&format!("{head}{lines}"), "a file").map_err(|error| error.to_string())
        };
        let bare = parsed("").unwrap();
        let pump = bare.model().unwrap();
        assert_eq!((pump.inlet().reservoir_kpa, pump.outlet().reservoir_kpa), (101.325, 101.325));
        assert!(!bare.to_toml().contains("[inlet]") && !bare.to_toml().contains("lift_mm"));
        // A level reservoir that is stated is that of a file that says nothing.
        assert_eq!(parsed("[inlet]\nlift_mm = 0.0\n").unwrap(), bare);
        let lifted = parsed("[inlet]\nlift_mm = 1200.0\n[outlet]\nreservoir_kpa = 120.0\n").unwrap();
        assert!(lifted.inlet.is_unknown() && lifted.outlet.line.is_unknown());
        let pump = lifted.model().unwrap();
        assert!((pump.inlet().reservoir_kpa - (101.325 - 1.2 * 9.777)).abs() < 1e-3);
        assert_eq!(pump.outlet().reservoir_kpa, 120.0);
        assert_eq!(PumpFile::parse(&lifted.to_toml(), "the same").unwrap(), lifted);
        let nozzle = parsed("[outlet]\nend = \"air\"\nnozzle_bore_mm = 1.0\n").unwrap();
        assert!(nozzle.outlet.line.is_unknown() && !nozzle.to_toml().contains("lift_mm"));
        assert_eq!(PumpFile::parse(&nozzle.to_toml(), "the same").unwrap(), nozzle);
        let error = parsed("[inlet]\nlift_mm = 10100.0\n").unwrap_err();
        assert!(error.contains("[inlet] lift_mm is 10100"), "{error}");
        let error = parsed("[outlet]\nresistance_kpa_s_ml = 0.1\nlift_mm = 0.0\n").unwrap_err();
        assert!(error.contains("missing field `compliance_ml_kpa` (or a `hose`)"), "{error}");
    }

    #[test]
    fn a_drawn_head_needs_its_lines() {
        let text = crate::catalogue::built_in("three-roller").unwrap().to_toml();
        let (before, rest) = text.split_once("[inlet]\n").unwrap();
        let (_, after) = rest.split_once("[outlet]\n").unwrap();
        let text = format!("{before}[inlet]\nlift_mm = 100.0\n[outlet]\n{after}");
        let error = PumpFile::parse(&text, "a file").unwrap_err().to_string();
        assert!(
            error
                .contains("[inlet] is missing; allowed: R, C and L, or a hose, and reservoir_kpa or lift_mm"),
            "{error}"
        );
    }

    #[test]
    fn a_pressure_is_the_height_of_its_column_in_the_air_that_the_file_states() {
        // 2.937 kPa above the air's 85.7 kPa are 300 mm of water of 997 kg/m³.
        let [suction_mm, discharge_mm] =
            crate::catalogue::built_in("three-roller").unwrap().heights_of_pressures_mm();
        assert!((suction_mm.unwrap() + 300.39).abs() < 0.01, "{suction_mm:?}");
        assert!((discharge_mm.unwrap() - 300.39).abs() < 0.01, "{discharge_mm:?}");
        let lifted = parsed("lift_mm = 1200.0", "lift_mm = 500.0").unwrap();
        assert_eq!(lifted.heights_of_pressures_mm(), [None; 2]);
    }

    #[test]
    fn lifts_that_cannot_be_are_refused_with_the_highest_one() {
        // (85.7 - 3.17) kPa of water at 25 °C is a column of 8.44 m.
        let error = parsed("lift_mm = 8500.0", "lift_mm = 0.0").unwrap_err();
        assert!(
            error.contains("[inlet] lift_mm is 8500; allowed: more than -1000000 and less than 844"),
            "{error}"
        );
        assert!(parsed("lift_mm = 8430.0", "lift_mm = 0.0").is_ok());
        let error = parsed("lift_mm = 0.0", "lift_mm = -9000.0").unwrap_err();
        assert!(error.contains("[outlet] lift_mm is -9000"), "{error}");
        for (keys, part) in [
            ("lift_mm = nan", "[inlet] lift_mm is NaN"),
            ("lift_mm = 100.0\nreservoir_kpa = 88.637", "exclude each other"),
            ("", "missing field `reservoir_kpa` (or a `lift_mm`)"),
        ] {
            let error = parsed(keys, "reservoir_kpa = 88.637").unwrap_err();
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}
