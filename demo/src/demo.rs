//! One dose: what is set, and all that follows from it.

use core::fmt::Write;

use pump_ctl::plan::{Doser, Plan, PlannedMotion};
use pump_model::Pump;

use crate::cautions::{CAUTIONS, cautions};
use crate::errors::{ANGLES, Errors, errors};
use crate::facts::{FACTS, facts};
use crate::refusal::{Refusal, Words};
use crate::settings::{SETTINGS, Settings};
use crate::trace::{COLUMNS, ROWS, Trace, trace};

/// Largest number of step times that are written at once.
pub const STEPS_AT_ONCE: usize = 4096;

/// The dose that is planned.
#[derive(Debug)]
#[repr(u8)]
#[allow(clippy::large_enum_variant, reason = "there is one, and no allocator")]
enum Planned {
    /// No dose. A number of its own makes it all zeros, so that the module's file holds no empty memory.
    Not = 0,
    /// A dose of a pump.
    Dose(Pump, Plan) = 1,
}

/// One dose. It needs no allocator: every answer has its place.
///
/// ```
/// use pump_demo::Demo;
/// let mut demo = Demo::new();
/// *demo.settings_mut() = [3.0, 3.0, 1.0, 25.0, 17.19, 5.0, 0.0, 0.1108, 0.0361, 0.0042];
/// assert!(demo.plan());
/// assert_eq!(demo.facts()[0], 15_287.0);
/// ```
#[derive(Debug)]
pub struct Demo {
    settings: [f64; SETTINGS],
    planned: Planned,
    facts: [f64; FACTS],
    cautions: [f64; CAUTIONS],
    refusal: Words,
    trace: Trace,
    errors: Errors,
    step_times: [f64; STEPS_AT_ONCE],
}

impl Default for Demo {
    fn default() -> Self {
        Self::new()
    }
}

impl Demo {
    /// Makes a demo without a dose.
    pub const fn new() -> Self {
        Self {
            settings: [0.0; SETTINGS],
            planned: Planned::Not,
            facts: [0.0; FACTS],
            cautions: [0.0; CAUTIONS],
            refusal: Words::NONE,
            trace: [[0.0; ROWS]; COLUMNS],
            errors: [[0.0; ANGLES]; 3],
            step_times: [0.0; STEPS_AT_ONCE],
        }
    }

    /// Returns the settings, to be written: head (3 and 2 are built in, any other is known by its volume), its
    /// rollers, its mL per revolution; volume, mL; start angle, degrees; rate, mL/s; 1 for a smooth flow; R, C and L
    /// of either line.
    pub fn settings_mut(&mut self) -> &mut [f64; SETTINGS] {
        &mut self.settings
    }

    /// Plans the dose that is set. Returns false if it is refused: [`Self::refusal`] then says why.
    pub fn plan(&mut self) -> bool {
        self.refusal = Words::NONE;
        let planned = self.planned();
        let is_planned = planned.is_ok();
        self.planned = match planned {
            Ok((pump, plan, facts)) => {
                self.facts = facts;
                Planned::Dose(pump, plan)
            }
            Err(refusal) => {
                // Words that do not fit are left out.
                let _ = write!(self.refusal, "{refusal}");
                Planned::Not
            }
        };
        is_planned
    }

    fn planned(&self) -> Result<(Pump, Plan, [f64; FACTS]), Refusal> {
        let settings = Settings::read(&self.settings);
        let pump = settings.pump()?;
        let plan = Doser::new(&pump, settings.limits()?)?.plan(settings.start(), &settings.request())?;
        let facts = facts(&pump, &settings.motor(), settings.volume_ml(), &plan)?;
        Ok((pump, plan, facts))
    }

    /// Returns the figures of the planned dose, in the order of `engine.js`.
    pub fn facts(&self) -> &[f64; FACTS] {
        &self.facts
    }

    /// Computes the cautions of a smooth flow. Returns false if there are none to say: the flow is not smooth, there is
    /// no dose, or it cannot be made at constant speed.
    pub fn cautions(&mut self) -> bool {
        let Planned::Dose(pump, plan) = &self.planned else { return false };
        let settings = Settings::read(&self.settings);
        if !settings.is_smooth() {
            return false;
        }
        let found = cautions(pump, plan, settings.motor(), &settings.knowledge());
        found.is_ok_and(|found| {
            self.cautions = found;
            true
        })
    }

    /// Returns the figures of the cautions: ripple where the line ends, in percent peak to peak, at constant speed, as
    /// planned, the median over the pumps that this one may be, and the most in 95 % of them; 1 if the pulse is not
    /// known well enough; pressures at constant speed, kPa absolute, inlet and outlet, least and most; 1 if the inlet's
    /// swing is notably wider than that.
    pub fn caution_figures(&self) -> &[f64; CAUTIONS] {
        &self.cautions
    }

    /// Returns why the dose is refused, as UTF-8.
    pub fn refusal(&self) -> &[u8] {
        self.refusal.as_bytes()
    }

    /// Computes the waveform of the planned dose every `dt_s`, from the start until the line has settled. Returns the
    /// number of rows, or 0 if there are more than [`ROWS`] or no dose.
    pub fn trace(&mut self, dt_s: f64) -> usize {
        let Planned::Dose(pump, plan) = &self.planned else { return 0 };
        let end_s = plan.profile().duration_s() + self.facts[4];
        trace(pump, plan, dt_s, end_s, &mut self.trace).unwrap_or(0)
    }

    /// Returns the columns of the waveform: time, s; angle, rad; speed, rad/s; flow at the rollers of inlet and outlet,
    /// mL/s; pressure at inlet and outlet, kPa absolute; volume in the vessel, mL; flow at the end of the line, mL/s.
    pub fn columns(&self) -> &[[f64; ROWS]; COLUMNS] {
        &self.trace
    }

    /// Computes the errors of the dose over its start angle. Returns the number of angles, 0 without a dose.
    pub fn errors(&mut self) -> usize {
        let Planned::Dose(pump, _) = &self.planned else { return 0 };
        errors(&Settings::read(&self.settings), pump, &mut self.errors).map_or(0, |()| ANGLES)
    }

    /// Returns the columns of the errors: start angle, rad; error by one constant, mL; error as planned, mL.
    pub fn error_columns(&self) -> &[[f64; ANGLES]; 3] {
        &self.errors
    }

    /// Computes the times of the steps after step `made`, s. Returns their number, [`STEPS_AT_ONCE`] at most.
    pub fn steps(&mut self, made: u64) -> usize {
        let Planned::Dose(_, plan) = &self.planned else { return 0 };
        let motion = PlannedMotion::from(plan);
        let left = plan.steps().unsigned_abs().saturating_sub(made);
        let mut count = 0;
        for (to, number) in
            self.step_times.iter_mut().zip(made + 1..).take(left.min(STEPS_AT_ONCE as u64) as usize)
        {
            *to = motion.time_of(number);
            count += 1;
        }
        count
    }

    /// Returns the times of the steps, s.
    pub fn step_times(&self) -> &[f64; STEPS_AT_ONCE] {
        &self.step_times
    }
}
