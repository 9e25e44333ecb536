//! Names of the quantities that a plan or a brake checks, each with its unit.

pump_model::named_quantities! {
    /// Quantity of a plan or a motor that has an allowed range. Errors name it, and `Display` writes its name with
    /// the unit.
    ///
    /// ```
    /// use pump_ctl::Parameter;
    /// use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, PlanError, Request};
    /// use pump_model::Pump;
    ///
    /// let pump = Pump::three_roller();
    /// let doser = Doser::new(&pump, Limits::new(Motor::new(12_800.0, 17.8, 500.0)))?;
    /// let refused = doser.plan(Phase::known(0.0), &Request::new(25.0, Cruise::Flow { ml_s: -5.0 }));
    /// let Err(PlanError::OutOfRange { parameter, value, .. }) = refused else { panic!("it is refused") };
    /// assert_eq!((parameter, value), (Parameter::Rate, -5.0));
    /// assert_eq!(parameter.to_string(), "rate in mL/s");
    /// # Ok::<(), PlanError>(())
    /// ```
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    pub enum Parameter {
        Volume = "volume in mL",
        Carry = "carry of earlier doses in mL",
        Rate = "rate in mL/s",
        Speed = "speed in rad/s",
        Time = "time in s",
        StartAngle = "start angle in rad",
        StartHalfWidth = "half width of the start angle in rad",
        LeastTurn = "least turn of earlier doses in rad",
        MostTurn = "most turn of earlier doses in rad",
        StepsPerRev = "steps per revolution",
        StepsPerRevUnderWay = "steps per revolution of a dose under way",
        LargestSpeed = "largest speed in rad/s",
        LargestAcceleration = "largest acceleration in rad/s2",
        OutletLimit = "outlet pressure limit in kPa absolute",
        InletLimit = "inlet pressure limit in kPa absolute",
        SmallestPressure = "smallest pressure in kPa absolute",
        OcclusionTorque = "occlusion torque in N m",
        Inertia = "inertia in kg m2",
        AmbientPressure = "ambient pressure in kPa absolute",
        Retraction = "retraction in mL",
        RetractedDose = "dose in mL before a retraction",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_stands_once_and_carries_the_units_that_it_has() {
        let counts = [Parameter::StepsPerRev, Parameter::StepsPerRevUnderWay];
        for (n, parameter) in Parameter::ALL.iter().enumerate() {
            let name = parameter.name();
            assert!(Parameter::ALL.iter().skip(n + 1).all(|other| other.name() != name), "{name}");
            assert_eq!(name.contains(" in "), !counts.contains(parameter), "{name}");
        }
    }
}
