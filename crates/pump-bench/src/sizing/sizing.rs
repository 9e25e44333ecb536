//! The sizing of a pump for a duty.

use pump_model::Port;
use pump_model::SteadyState;
use pump_model::units::rpm;

use crate::catalogue::{CataloguedPump, overlap_warning, suction_warning, with_own_uncertainty};
use crate::heads::BoughtHead;
use crate::notice::Notice;
use crate::numbers::significant;
use crate::pump_file::{FluidTable, PumpFile, THICK_MPA_S};
use crate::simulation::{Method, SteadyReport};

use super::candidates::{heads_for, speed_rpm};
use super::curve::{CurvePoint, points};
use super::duty::Duty;
use super::error::SizingError;
use super::largest_pressure::{LargestPressure, largest_pressure};
use super::line::SizedLine;
use super::operating::Operating;
use super::pulsation::{Pulsation, pulsation};
use super::refusal::served;
use super::settling::settling_s;
use super::suction::{Suction, suction};

/// Heads of the catalogue that are tried at most, and those that are named beside the one that serves.
const TRIED: usize = 12;
const NAMED: usize = 3;

/// Longest time of a pitch, in s, at which a flow is one. Beyond it the liquid comes in lumps that are an hour apart.
pub(crate) const LONGEST_PITCH_S: f64 = 3600.0;

/// Friction in the pump's own tube that is noted, in kPa.
const NOTED_KPA: f64 = 1.0;

/// A pump with its speed, pressures, margins and pulsation at a duty.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Sizing {
    /// Pump, or head of the catalogue.
    pub head: SizedHead,
    /// Mean flow, in mL/s.
    pub flow_ml_s: f64,
    /// Speed, in r/min.
    pub speed_rpm: f64,
    /// Fluid.
    pub fluid: FluidTable,
    /// Viscosity of the fluid, in mPa s. `None` if no hose needs it and nobody knows it.
    pub viscosity_mpa_s: Option<f64>,
    /// Pressure of the air, in kPa absolute.
    pub ambient_kpa: f64,
    /// Line at the inlet.
    pub inlet: SizedLine,
    /// Line at the outlet.
    pub outlet: SizedLine,
    /// Pressures of the steady state.
    pub steady: SteadyReport,
    /// Method of the steady state, as in the reports of runs.
    pub method: &'static str,
    /// Suction margin.
    pub suction: Suction,
    /// Largest pressure that is allowed at the outlet. `None` if none is known.
    pub largest: Option<LargestPressure>,
    /// Pulsation at the end of the outlet's hose.
    pub pulsation: Pulsation,
    /// Time after an abrupt stop until less than 1 µL is still to come, in s: at the worst angle.
    pub settle_s: f64,
    /// Expanded uncertainty (k = 2) of the flow at the speed, as a part of it, until somebody weighs it.
    pub expanded: f64,
    /// Curve of the pump over its speed.
    pub curve: Vec<CurvePoint>,
    /// Other heads of the catalogue that give the flow, the next first.
    pub others: Vec<String>,
    /// Values that nobody knows.
    pub unknown: Vec<&'static str>,
    /// Warnings.
    pub warnings: Vec<Notice>,
}

/// The pump of a sizing.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SizedHead {
    /// Name of the head in the catalogue, or id of the pump.
    pub name: String,
    /// Head of the catalogue. `None` for the pump of a file.
    pub catalogued: Option<BoughtHead>,
    /// Number of rollers.
    pub rollers: u32,
    /// Volume of a revolution at the speed, in mL.
    pub ml_per_rev: f64,
    /// Slowest speed, in r/min, if one is stated.
    pub least_rpm: Option<f64>,
    /// Fastest speed, in r/min, if one is stated.
    pub most_rpm: Option<f64>,
}

impl Sizing {
    /// Sizes a head of the catalogue for a duty: the nearest one that serves it (see [`heads_for`]).
    ///
    /// ```
    /// use pump_bench::sizing::{Duty, Sizing};
    /// use pump_bench::units::hose_size;
    ///
    /// let hoses = (Some(hose_size("6x10mm,1m")?), Some(hose_size("6x10mm,3m")?));
    /// let duty = Duty::new(2000.0 / 3600.0).with_hoses(hoses.0, hoses.1).with_lifts(Some(1200.0), Some(500.0));
    /// let sizing = Sizing::of_catalogue(&duty)?;
    /// assert!((sizing.speed_rpm * sizing.head.ml_per_rev / 60.0 - 2000.0 / 3600.0).abs() < 1e-9);
    /// assert!(sizing.suction.npsh_m.unwrap() > 8.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SizingError::NoHead`] if no head gives the flow. Otherwise the error of the nearest head, if none serves.
    pub fn of_catalogue(duty: &Duty) -> Result<Self, SizingError> {
        let heads = heads_for(duty.flow_ml_s)?;
        let (mut first, mut thin) = (None, None);
        for (n, head) in heads.iter().take(TRIED).enumerate() {
            match Self::of_head(head, head.rollers.unwrap_or_default(), duty) {
                Ok(mut sizing) => {
                    let rest = heads.iter().skip(n + 1).take(NAMED);
                    sizing.others = rest.map(|other| other.name.clone()).collect();
                    // A wider head may suck what the friction in this one's tube leaves no pressure for.
                    if sizing.suction.is_used_up() {
                        thin = thin.or(Some(sizing));
                        continue;
                    }
                    return Ok(sizing);
                }
                // Mean pressures are those of any head.
                Err(SizingError::Suction(short)) if short.pulse_kpa.is_none() => {
                    return Err(first.unwrap_or(SizingError::Suction(short)));
                }
                Err(error) => first = first.or(Some(error)),
            }
        }
        thin.map_or_else(
            || Err(first.unwrap_or_else(|| unreachable!("a flow that no head gives is refused before"))),
            Ok,
        )
    }

    /// Sizes a head of the catalogue that has so many rollers.
    ///
    /// # Errors
    /// Returns the [`SizingError`] of a duty that this head does not serve.
    pub fn of_head(head: &BoughtHead, rollers: u32, duty: &Duty) -> Result<Self, SizingError> {
        let mut file = CataloguedPump::new(head.name.clone(), head, rollers).pump_file()?;
        let needed_rpm = speed_rpm(head, duty.flow_ml_s);
        let least_rpm = head.least_rpm.unwrap_or(0.0);
        if let Some(most_rpm) =
            head.most_rpm.filter(|most_rpm| needed_rpm < least_rpm || needed_rpm > *most_rpm)
        {
            return Err(SizingError::Speed {
                pump: head.name.clone(),
                flow_ml_s: duty.flow_ml_s,
                needed_rpm,
                least_rpm,
                most_rpm,
                most_ml_s: head.ml_per_rev * most_rpm / 60.0,
            });
        }
        file.motor.max_speed_rpm = head.most_rpm.unwrap_or(f64::max(file.motor.max_speed_rpm, needed_rpm));
        Self::of(duty.file(file)?, duty, Some(head))
    }

    /// Sizes the pump of a file. Its hoses, lifts and limits stay where the duty gives no others.
    ///
    /// # Errors
    /// Returns the [`SizingError`] of a duty that this pump does not serve.
    pub fn of_pump(file: PumpFile, duty: &Duty) -> Result<Self, SizingError> {
        let file = duty.file(with_own_uncertainty(file))?;
        Self::of(file, duty, None)
    }

    fn of(file: PumpFile, duty: &Duty, head: Option<&BoughtHead>) -> Result<Self, SizingError> {
        let largest = largest_pressure(&file, head);
        let (at, steady) = served(&file, largest, duty)?;
        let needed_rpm = rpm(at.speed_rad_s);
        let motor_rpm = file.motor.max_speed_rpm;
        let most_rpm = head.map_or(Some(motor_rpm), |head| head.most_rpm);
        let suction = suction(&file, &steady, at.pump.revolution_ml(), duty.flow_ml_s);
        let pulsation = pulsation(&at)?;
        let viscosity_mpa_s = file.fluid.fluid().ok().map(|fluid| fluid.viscosity_mpa_s);
        Ok(Self {
            head: SizedHead {
                name: head.map_or(file.pump.id.clone(), |head| head.name.clone()),
                catalogued: head.cloned(),
                rollers: file.rollers.count,
                ml_per_rev: at.pump.revolution_ml(),
                least_rpm: head.and_then(|head| head.least_rpm),
                most_rpm,
            },
            flow_ml_s: duty.flow_ml_s,
            speed_rpm: needed_rpm,
            viscosity_mpa_s,
            ambient_kpa: file.ambient.pressure_kpa,
            inlet: at.inlet,
            outlet: at.outlet,
            steady: steady.into(),
            method: at.method(duty.flow_ml_s)?.name(),
            suction,
            largest,
            pulsation,
            settle_s: settling_s(&at.pump, at.speed_rad_s)?,
            expanded: 2.0 * file.model_standard(),
            curve: points(&at, most_rpm)?,
            others: Vec::new(),
            unknown: unknown(&suction, largest, most_rpm, viscosity_mpa_s),
            warnings: warnings(&at, &suction, &steady, &pulsation),
            fluid: file.fluid,
        })
    }

    /// Returns true if the closed form gave the steady state.
    pub fn is_exact(&self) -> bool {
        self.method == Method::Exact.name()
    }
}

/// Returns the values that nobody knows, in words.
fn unknown(
    suction: &Suction,
    largest: Option<LargestPressure>,
    most_rpm: Option<f64>,
    viscosity_mpa_s: Option<f64>,
) -> Vec<&'static str> {
    let is_thick = viscosity_mpa_s.is_some_and(|mpa_s| mpa_s > THICK_MPA_S);
    let all = [
        (suction.collapse_kpa.is_none(), "the pressure at which the pump's tube collapses"),
        (suction.vapour_kpa.is_none(), "the fluid's vapour pressure"),
        (largest.is_none(), "the largest pressure that the pump's tube stands"),
        (most_rpm.is_none(), "the largest speed of the head"),
        (is_thick, "how much less the tube takes in of a thick fluid than of water"),
        (true, "the suction head that the pump itself needs, which no maker of such heads publishes"),
    ];
    all.into_iter().filter_map(|(missing, name)| missing.then_some(name)).collect()
}

/// Returns the warnings of a sizing.
fn warnings(at: &Operating, suction: &Suction, steady: &SteadyState, pulsation: &Pulsation) -> Vec<Notice> {
    let file = &at.file;
    let hose = suction.hose_collapse_kpa.filter(|kpa| steady.inlet.min_kpa < *kpa).map(|kpa| {
        Notice::from(format!(
            "the inlet pressure falls to {:.2} kPa absolute, and the inlet's hose collapses at {kpa:.2} kPa by a \
             modulus of {} MPa; a thicker wall stands more",
            steady.inlet.min_kpa,
            file.inlet.hose().map_or(0.0, |hose| hose.modulus_mpa),
        ))
    });
    let overlap = overlap_warning(at.pump.geometry()).map(Notice::from);
    let sucks = suction_warning(file, file.ambient.pressure_kpa - steady.inlet.min_kpa).map(Notice::from);
    let own = suction.own_kpa.filter(|kpa| *kpa >= NOTED_KPA).map(|kpa| {
        Notice::from(format!(
            "the friction in the pump's own tube takes at least {} kPa more of the suction at this flow{}",
            significant(kpa, 2),
            if suction.is_used_up() {
                ", and the margin is smaller: the tube does not fill, and less is delivered; a wider tube or a smaller \
                 flow sucks it"
            } else {
                ""
            }
        ))
    });
    let of_pump = file.resistance_warning().into_iter().chain(overlap).chain(sucks).chain(own);
    of_pump.chain(hose).chain(slow(at)).chain(swings(at, pulsation)).collect()
}

/// Warns of a head that is far too large for the flow: it turns so slowly that the flow comes in lumps.
fn slow(at: &Operating) -> Option<Notice> {
    let pitch_s = at.pump.pitch_rad() / at.speed_rad_s;
    (pitch_s > LONGEST_PITCH_S).then(|| {
        Notice::from(format!(
            "the head turns at {} r/min, and a pitch takes {} h: it is far too large for this flow, which comes in \
             lumps of {} mL; look at the unit of the flow, or take a head with less volume per revolution",
            significant(rpm(at.speed_rad_s), 2),
            significant(pitch_s / 3600.0, 2),
            significant(at.pump.revolution_ml() * at.pump.pitch_rad() / std::f64::consts::TAU, 2)
        ))
    })
}

/// Warns of a line that swings with the rollers' pulses, so that the flow at its end pulsates more than at the rollers.
fn swings(at: &Operating, pulsation: &Pulsation) -> Option<Notice> {
    let end = pulsation.end.map_or(f64::INFINITY, |ripple| ripple.peak_to_peak);
    (end > pulsation.rollers.peak_to_peak).then(|| {
        let pulses_hz = at.speed_rad_s / at.pump.pitch_rad();
        let line_hz = at.pump.line(Port::Outlet).natural_rad_s() / std::f64::consts::TAU;
        Notice::from(format!(
            "the outlet's line swings by itself at {line_hz:.2} Hz, and the rollers' {pulses_hz:.2} pulses a second, \
             or a \
             multiple of them, drive it; the friction of the mean flow alone damps it here, so a real hose swings \
             less; \
             another length or another speed avoids it"
        ))
    })
}
