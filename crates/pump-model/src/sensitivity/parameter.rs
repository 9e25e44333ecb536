//! Parameters by which a run is differentiated.

/// Parameter by which pressures, flows and volumes are differentiated.
///
/// ```
/// use pump_model::SensitivityParameter;
///
/// let names = SensitivityParameter::ALL.map(SensitivityParameter::name);
/// assert_eq!(names[0], "resistance_kpa_s_ml");
/// assert_eq!(names[4], "roller_volume_ml");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SensitivityParameter {
    /// Resistance R of the port's line, kPa s/mL.
    Resistance,
    /// Compliance C of the port's line, mL/kPa.
    Compliance,
    /// Inertance L of the port's line, kPa s²/mL.
    Inertance,
    /// Angle that is added to that of the whole motion, rad.
    StartAngle,
    /// Roller volume V_r, mL. The shape of the pulse stays, and so does the flow between pulses.
    RollerVolume,
}

impl SensitivityParameter {
    /// Number of parameters.
    pub const COUNT: usize = 5;

    /// Parameters in the order of all arrays of derivatives.
    pub const ALL: [Self; Self::COUNT] =
        [Self::Resistance, Self::Compliance, Self::Inertance, Self::StartAngle, Self::RollerVolume];

    /// Returns the name of the parameter with its unit.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Resistance => "resistance_kpa_s_ml",
            Self::Compliance => "compliance_ml_kpa",
            Self::Inertance => "inertance_kpa_s2_ml",
            Self::StartAngle => "start_angle_rad",
            Self::RollerVolume => "roller_volume_ml",
        }
    }

    /// Returns the place of the parameter in [`Self::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
}
