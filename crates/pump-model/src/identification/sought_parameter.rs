//! The parameters that measurements can determine.

crate::named_quantities! {
    /// Parameter that a fit seeks. `Display` writes its name as errors say it.
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    pub enum SoughtParameter {
        Resistance = "resistance",
        Compliance = "compliance",
        Inertance = "inertance",
        StartAngle = "start angle",
        StartTime = "start time",
        ReservoirPressure = "reservoir pressure",
    }
}
