//! Names of the quantities that the model checks, each with its unit.

/// Makes an enum of named quantities with `ALL`, `name` and `Display` from one list of names.
///
/// Only the crates of this workspace use this macro. It is not part of the interface.
#[doc(hidden)]
#[macro_export]
macro_rules! named_quantities {
    ($(#[$about:meta])* pub enum $choice:ident { $($variant:ident = $name:literal),+ $(,)? }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum $choice {
            $(#[doc = concat!("Quantity that messages call `", $name, "`.")] $variant),+
        }

        impl $choice {
            /// Every quantity of the list.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Returns the name of the quantity, with its unit if it has one.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        impl ::core::fmt::Display for $choice {
            fn fmt(&self, to: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                to.pad(self.name())
            }
        }
    };
}

named_quantities! {
    /// Quantity of the model that has an allowed range. Errors name it, and `Display` writes its name with the
    /// unit.
    ///
    /// ```
    /// use pump_model::{Line, ModelError, Parameter};
    ///
    /// let line = Line { resistance_kpa_s_ml: -1.0, ..Line::PUBLISHED };
    /// let Err(ModelError::OutOfRange { parameter, .. }) = line.validate() else { panic!("it is refused") };
    /// assert_eq!(parameter, Parameter::LineResistance);
    /// assert_eq!(parameter.to_string(), "line resistance in kPa s/mL");
    /// ```
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    pub enum Parameter {
        Rollers = "number of rollers",
        BoreRadius = "bore radius in mm",
        TubeOuterRadius = "tube outer radius in mm",
        BackplateRadius = "backplate radius in mm",
        RollerRadius = "roller radius in mm",
        RollerOffset = "roller offset in mm",
        ContactAngle = "contact angle in deg",
        EngagementAngle = "engagement angle in deg",
        RollerVolume = "roller volume in mL",
        MlPerRevolution = "volume per revolution in mL",
        PulseShare = "share of a roller's pulse",
        RollerVolumeCoefficient = "roller volume coefficient",
        MeasuredAngle = "measured angle in deg",
        SmallestMeasuredAngle = "smallest measured angle in deg",
        MeasuredVolume = "measured volume in mL",
        DisplacementFactor = "displacement factor",
        ZeroShift = "shift of the zero in rad",
        LineResistance = "line resistance in kPa s/mL",
        StartLineResistance = "line resistance to start from in kPa s/mL",
        LineCompliance = "line compliance in mL/kPa",
        LineInertance = "line inertance in kPa s2/mL",
        ReservoirPressure = "reservoir pressure in kPa absolute",
        AmbientPressure = "ambient pressure in kPa absolute",
        HoseBoreRadius = "bore radius of the hose in mm",
        HoseOuterRadius = "outer radius of the hose in mm",
        HoseLength = "length of the hose in mm",
        HoseModulus = "modulus of the hose in MPa",
        HosePoissonRatio = "Poisson ratio of the hose",
        HoseMinorLoss = "minor-loss coefficient of the hose",
        WaterTemperature = "temperature of water in degC",
        EthanolTemperature = "temperature of ethanol in degC",
        IsopropanolTemperature = "temperature of isopropanol in degC",
        GlycerolTemperature = "temperature of glycerol and water in degC",
        GlycerolPart = "part of glycerol by mass",
        Density = "density in kg/m3",
        SurfaceTension = "surface tension in mN/m",
        NozzleBore = "bore of the nozzle in mm",
        Viscosity = "viscosity in mPa s",
        BulkModulus = "bulk modulus in MPa",
        VapourPressure = "vapour pressure in kPa absolute",
        Speed = "speed in rad/s",
        SpeedWithoutSign = "speed in rad/s, without sign",
        SlowestSpeed = "slowest speed in rad/s",
        FastestSpeed = "fastest speed in rad/s",
        Flow = "flow in mL/s",
        Legs = "number of legs of the motion",
        Duration = "duration in s",
        SampleInterval = "dt in s",
        Samples = "number of samples",
        SpeedLawScale = "scale of the speed law",
        SpeedLawRevolution = "volume per revolution of the speed law in mL",
        ClosureAngle = "closure angle in rad",
        Distensibility = "distensibility in 1/kPa",
        SegmentScale = "scale of the segments",
        SegmentVolume = "volume between two rollers in mL",
        OpenRollerResistance = "resistance of an open roller in kPa s/mL",
        RollersInContact = "number of rollers in contact at once",
        FlowMismatch = "flow at the rollers less that of the flow curves in mL/rad",
        Tolerance = "tolerance of a step",
        RelativeTolerance = "relative tolerance of a state",
        AbsoluteTolerance = "absolute tolerance of a state",
        LongestStep = "longest step in s",
        Time = "time in s",
        Volume = "volume in mL",
        Pressure = "pressure in kPa",
        AbsolutePressure = "pressure in kPa absolute",
        PressureDrop = "pressure drop in kPa",
        PressureUncertainty = "standard uncertainty of the pressure in kPa",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantities that are counts, ratios or tolerances, so they have no unit.
    const NO_UNIT: [Parameter; 15] = [
        Parameter::Rollers,
        Parameter::PulseShare,
        Parameter::RollerVolumeCoefficient,
        Parameter::DisplacementFactor,
        Parameter::HosePoissonRatio,
        Parameter::HoseMinorLoss,
        Parameter::GlycerolPart,
        Parameter::Legs,
        Parameter::Samples,
        Parameter::SpeedLawScale,
        Parameter::SegmentScale,
        Parameter::RollersInContact,
        Parameter::Tolerance,
        Parameter::RelativeTolerance,
        Parameter::AbsoluteTolerance,
    ];

    #[test]
    fn every_name_stands_once_and_carries_the_units_that_it_has() {
        for (n, parameter) in Parameter::ALL.iter().enumerate() {
            let name = parameter.name();
            assert!(Parameter::ALL.iter().skip(n + 1).all(|other| other.name() != name), "{name}");
            let unit = name.rsplit_once(" in ").map(|(_, unit)| unit.trim_end_matches(", without sign"));
            let units =
                ["mm", "deg", "rad", "mL", "kPa", "MPa", "degC", "s", "1/kPa", "kg/m3", "mPa s", "mN/m"];
            let is_unit = |unit: &str| units.iter().any(|first| unit.starts_with(first));
            assert_eq!(unit.is_some_and(is_unit), !NO_UNIT.contains(parameter), "{name}");
        }
    }
}
