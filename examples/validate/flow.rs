//! Sets the flow at 60 r/min beside the paper's: the rollers' pulses and their times.

use std::error::Error;

use pump_model::Pump;
use pump_model::units::rad_s;

use crate::page::Section;
use crate::paper::REFERENCE;
use crate::row::{Bound, Row};

/// Speed of the paper's figure, r/min.
pub(crate) const RPM: f64 = 60.0;

/// Returns T1 = T2, T3 and the length of a pulse at 60 r/min, s, and the peak of a pulse, mL/s.
pub(crate) fn pulses(pump: &Pump) -> Result<[f64; 4], Box<dyn Error>> {
    let omega = rad_s(RPM);
    let psi_rad = pump.geometry().inlet_phase_rad(pump.roller_volume())?;
    let (lowest, highest) = pump.outlet_curve().flow_range_ml_rad();
    let pulse_s = pump.roller_volume().engagement_rad() / omega;
    Ok([pump.pitch_rad() / omega, psi_rad / omega, pulse_s, (highest - lowest) * omega])
}

/// Returns the section of the page about the flow.
pub(crate) fn section() -> Result<Section, Box<dyn Error>> {
    let [t1, t3, pulse_s, peak] = pulses(&Pump::three_roller())?;
    let [t1_two, ..] = pulses(&Pump::two_roller())?;
    let reference = |value| (value, REFERENCE);
    let rows = vec![
        Row::computed("T1 = T2, three rollers", "s", reference(0.33333), t1, Bound::Absolute(5e-6)),
        Row::ours("T1 = T2, two rollers", "s", t1_two),
        Row::computed(
            "T3, from the start of an outlet pulse to the start of the next inlet pulse",
            "s",
            reference(0.19297),
            t3,
            Bound::Absolute(5e-6),
        ),
        Row::computed("length of a pulse", "s", reference(0.14036), pulse_s, Bound::Absolute(5e-6)),
        Row::computed(
            "largest flow that a roller displaces",
            "mL/s",
            reference(25.089),
            peak,
            Bound::Absolute(5e-4),
        ),
        Row::computed(
            "volume of a revolution, three rollers",
            "mL",
            reference(21.3185),
            Pump::three_roller().revolution_ml(),
            Bound::Absolute(5e-5),
        ),
        Row::computed(
            "volume of a revolution, two rollers",
            "mL",
            reference(23.4240),
            Pump::two_roller().revolution_ml(),
            Bound::Absolute(5e-5),
        ),
    ];
    let before = "T1 and T2 are the time of a pitch: pitch over speed (Eq. 8). T3 is psi over the speed, with psi = \
                  pi - phi - 2 beta (Eq. 9, Section 2.1.2). The paper draws the pulses of both pumps at 60 r/min \
                  with beta = 30 deg (Fig. 6). It states no time in seconds.\n\n";
    let after = "![Flow at the rollers at 60 r/min, three rollers above, two below](validation/flows.svg)\n";
    Ok(Section { title: "Flow at 60 r/min", before: before.into(), rows, after: after.into() })
}
