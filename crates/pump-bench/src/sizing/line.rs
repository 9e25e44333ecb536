//! One line of a duty: its hose, the law of its friction, and the mean pressure at the pump.

use pump_model::{Line, Port};

use crate::pump_file::{HoseTable, LineSource, LineTable, PumpFile, Reservoir};

use super::error::SizingError;

/// Reynolds number up to which the flow in a round hose is laminar (Perry's Chemical Engineers' Handbook, 8th edition,
/// section 6).
const LAMINAR: f64 = 2100.0;

/// Reynolds number from which on it is turbulent (as above).
const TURBULENT: f64 = 4000.0;

/// Law that the friction in a hose follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlowLaw {
    /// Laminar flow, up to a Reynolds number of 2100: Hagen and Poiseuille.
    Laminar,
    /// Flow between laminar and turbulent: Churchill's formula, which joins the two.
    Between,
    /// Turbulent flow in a smooth hose, from a Reynolds number of 4000: Churchill's formula.
    Turbulent,
}

impl FlowLaw {
    /// Returns the law at a Reynolds number.
    fn of(reynolds: f64) -> Self {
        if reynolds <= LAMINAR {
            Self::Laminar
        } else if reynolds < TURBULENT {
            Self::Between
        } else {
            Self::Turbulent
        }
    }

    /// Returns the law's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Laminar => "laminar",
            Self::Between => "between",
            Self::Turbulent => "turbulent",
        }
    }

    /// Returns the law in words.
    pub fn told(self) -> &'static str {
        match self {
            Self::Laminar => "laminar (Hagen-Poiseuille)",
            Self::Between => "between laminar and turbulent (Churchill)",
            Self::Turbulent => "turbulent (Churchill, smooth wall)",
        }
    }
}

/// A line at the duty's mean flow.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SizedLine {
    /// Hose of the line. `None` where the pump file gives R, C and L.
    pub hose: Option<HoseTable>,
    /// Reynolds number of the mean flow in the hose.
    pub reynolds: Option<f64>,
    /// Law of the friction in the hose.
    pub law: Option<FlowLaw>,
    /// Friction and end losses at the mean flow, in kPa.
    pub friction_kpa: f64,
    /// Height that the pump lifts on this side, in mm. `None` where the reservoir has a pressure.
    pub lift_mm: Option<f64>,
    /// Difference that the reservoir makes to the air, in kPa: what the lift costs the pump.
    pub lift_kpa: f64,
    /// Mean pressure at the pump, in kPa absolute.
    pub mean_kpa: f64,
    /// R, C, L and the reservoir's pressure of the model at the mean flow.
    pub line: Line,
}

impl SizedLine {
    /// Returns the line at a port of a pump file at a flow in mL/s.
    pub(super) fn of(file: &PumpFile, port: Port, flow_ml_s: f64) -> Result<Self, SizingError> {
        let table = table(file, port);
        let reservoir_kpa = file.reservoir_kpa(port);
        // The way of the pressure: the inlet's falls and the outlet's rises from the reservoir to the pump.
        let sign = if port == Port::Inlet { -1.0 } else { 1.0 };
        let friction = table.friction(|| file.fluid.fluid())?;
        // The line is taken at the air's pressure first, since a lift too high leaves its reservoir none.
        let at_air = table.line(|| file.fluid.fluid(), flow_ml_s, file.ambient.pressure_kpa)?;
        let line = Line { reservoir_kpa, ..at_air };
        let friction_kpa = match &friction {
            Some(friction) => friction.drop_kpa(flow_ml_s),
            None => line.resistance_kpa_s_ml * flow_ml_s,
        };
        let reynolds = friction.map(|friction| friction.reynolds(flow_ml_s));
        Ok(Self {
            hose: table.hose().copied(),
            reynolds,
            law: reynolds.map(FlowLaw::of),
            friction_kpa,
            lift_mm: match table.reservoir {
                Reservoir::Lift(mm) => Some(mm),
                Reservoir::Pressure(_) => None,
            },
            lift_kpa: sign * (reservoir_kpa - file.ambient.pressure_kpa),
            mean_kpa: reservoir_kpa + sign * friction_kpa,
            line,
        })
    }
}

/// Returns the table of the line at a port.
fn table(file: &PumpFile, port: Port) -> &LineTable {
    match port {
        Port::Inlet => &file.inlet,
        Port::Outlet => &file.outlet.line,
    }
}

/// Returns true if the line at a port is a hose.
pub(super) fn is_hose(file: &PumpFile, port: Port) -> bool {
    matches!(table(file, port).source, LineSource::Hose(_))
}
