//! Derivatives of pressures and delivered volume, sampled over time.

use pump_model::{
    Leg, ModelError, Port, Pump, SensitiveColumns, SensitiveRun, SensitiveSamples, SensitiveState,
    SensitivityParameter,
};

/// Number of parameters by which each quantity is differentiated.
const PARAMETERS: usize = SensitivityParameter::COUNT;

/// Most samples that are computed at once.
const BLOCK: usize = 512;

/// Derivatives of the pressures of both ports and of the delivered volume over a motion, by the parameters of
/// [`SensitivityParameter::ALL`]. Those by R, C and L of the delivered volume are by those of the outlet's line.
#[derive(Debug)]
pub struct SensitiveWaveform<'a, M> {
    pump: &'a Pump,
    inlet: Source<'a, M>,
    outlet: Source<'a, M>,
    /// State of the outlet at the start, and the angle, rad, and flow, mL/rad, of its rollers there.
    start: SensitiveState,
    start_rad: f64,
    start_ml_rad: f64,
}

/// Derivatives that a [`SensitiveWaveform`] writes: a row of samples for each parameter.
#[derive(Debug)]
pub struct Derivatives<'a> {
    /// Derivatives of the pressure at the inlet, kPa over the unit of each parameter.
    pub inlet_kpa_by: [&'a mut [f64]; PARAMETERS],
    /// Derivatives of the pressure at the outlet, kPa over the unit of each parameter.
    pub outlet_kpa_by: [&'a mut [f64]; PARAMETERS],
    /// Derivatives of the volume that has passed the outlet line, mL over the unit of each parameter.
    pub delivered_ml_by: [&'a mut [f64]; PARAMETERS],
}

/// Run of a port.
#[derive(Debug)]
enum Source<'a, M> {
    /// Run at times that are given.
    At(Box<SensitiveRun<'a, M>>),
    /// Samples at equal intervals.
    Every(Box<SensitiveSamples<'a, M>>),
}

/// Returns the states of the lines of inlet and outlet that repeat themselves at a constant speed in rad/s, where the
/// rotor stands at `angle_rad`.
///
/// # Errors
/// Returns the [`ModelError`] of a speed that the model refuses, or of a resonance that nothing damps.
pub fn steady_sensitivities(
    pump: &Pump,
    speed_rad_s: f64,
    angle_rad: f64,
) -> Result<[SensitiveState; 2], ModelError> {
    let steady = |port| SensitiveState::steady(pump, port, speed_rad_s, angle_rad);
    Ok([steady(Port::Inlet)?, steady(Port::Outlet)?])
}

impl<'a, M: Iterator<Item = Leg> + Clone> SensitiveWaveform<'a, M> {
    /// Starts in the states of the lines of inlet and outlet when the first of the `legs` starts. The samples are at
    /// intervals of `every_s` from time 0, or at any times if there is none.
    pub fn new(pump: &'a Pump, legs: M, [inlet, outlet]: [SensitiveState; 2], every_s: Option<f64>) -> Self {
        let first = legs.clone().next().unwrap_or(Leg::rest(0.0, 0.0));
        let start_rad = first.angle_rad;
        let run = |port, start| SensitiveRun::new(pump, port, legs.clone(), start);
        let source = |run: SensitiveRun<'a, M>| match every_s.filter(|_| first.start_s == 0.0) {
            Some(dt_s) => Source::Every(Box::new(run.every(dt_s))),
            None => Source::At(Box::new(run)),
        };
        let at_outlet = run(Port::Outlet, outlet);
        Self {
            pump,
            start_ml_rad: at_outlet.flow_ml_rad(),
            inlet: source(run(Port::Inlet, inlet)),
            outlet: source(at_outlet),
            start: outlet,
            start_rad,
        }
    }

    /// Writes the derivatives of the next samples, whose times in s, angles in rad and delivered volumes in mL these
    /// are.
    pub fn fill(&mut self, [time_s, angle_rad, delivered_ml]: [&[f64]; 3], to: Derivatives<'_>) {
        let Derivatives { mut inlet_kpa_by, mut outlet_kpa_by, mut delivered_ml_by } = to;
        let mut done = 0;
        let blocks = time_s.chunks(BLOCK).zip(angle_rad.chunks(BLOCK)).zip(delivered_ml.chunks(BLOCK));
        for ((times, angles), delivered) in blocks {
            let place = done..done + times.len();
            done = place.end;
            let mut scratch = [[0.0; BLOCK]; 3];
            let [kpa, flow_ml_rad, pushed_ml] = scratch.each_mut().map(|column| &mut column[..times.len()]);
            let kpa_by = inlet_kpa_by.each_mut().map(|column| &mut column[place.clone()]);
            self.inlet.fill(times, SensitiveColumns { kpa, kpa_by, flow_ml_rad: None, rate_kpa_s: None });
            let kpa_by = outlet_kpa_by.each_mut().map(|column| &mut column[place.clone()]);
            let flow = Some(&mut *flow_ml_rad);
            self.outlet.fill(times, SensitiveColumns { kpa, kpa_by, flow_ml_rad: flow, rate_kpa_s: None });
            // The rollers have pushed what was delivered, and what the line holds more than at the start.
            let (compliance, start_kpa) =
                (self.pump.outlet().compliance_ml_kpa, self.start.state.above_reservoir_kpa);
            for ((pushed_ml, delivered_ml), kpa) in pushed_ml.iter_mut().zip(delivered).zip(&*kpa) {
                *pushed_ml = delivered_ml + compliance * (kpa - start_kpa);
            }
            let kpa_by = outlet_kpa_by.each_ref().map(|column| &column[place.clone()]);
            let delivered_by = delivered_ml_by.each_mut().map(|column| &mut column[place.clone()]);
            self.deliver(angles, [kpa, flow_ml_rad, pushed_ml], kpa_by, delivered_by);
        }
    }

    /// Writes the derivatives of the delivered volume: of the volume at the rollers less what the line holds, C p.
    fn deliver(
        &self,
        angle_rad: &[f64],
        [kpa, flow_ml_rad, pushed_ml]: [&mut [f64]; 3],
        kpa_by: [&[f64]; PARAMETERS],
        delivered_by: [&mut [f64]; PARAMETERS],
    ) {
        let compliance = self.pump.outlet().compliance_ml_kpa;
        let (nominal_ml_rad, roller_ml) = (self.pump.nominal_ml_rad(), self.pump.roller_volume().total_ml());
        for (parameter, (kpa_by, delivered_by)) in
            SensitivityParameter::ALL.into_iter().zip(kpa_by.into_iter().zip(delivered_by))
        {
            let start_by = self.start.pressure_by[parameter.index()];
            let start_kpa = self.start.state.above_reservoir_kpa;
            for (n, (delivered_by, kpa_by)) in delivered_by.iter_mut().zip(kpa_by).enumerate() {
                let direct = match parameter {
                    SensitivityParameter::Compliance => start_kpa - kpa[n],
                    SensitivityParameter::StartAngle => flow_ml_rad[n] - self.start_ml_rad,
                    SensitivityParameter::RollerVolume => {
                        let bare_ml = nominal_ml_rad * (angle_rad[n] - self.start_rad);
                        (pushed_ml[n] - bare_ml) / roller_ml
                    }
                    _ => 0.0,
                };
                *delivered_by = direct - compliance * (kpa_by - start_by);
            }
        }
    }
}

impl<M: Iterator<Item = Leg>> Source<'_, M> {
    /// Writes the next samples, whose times in s these are.
    fn fill(&mut self, time_s: &[f64], columns: SensitiveColumns<'_>) {
        let run = match self {
            Self::Every(samples) => return samples.fill(columns),
            Self::At(run) => run,
        };
        let SensitiveColumns { kpa, mut kpa_by, mut flow_ml_rad, .. } = columns;
        for (n, time_s) in time_s.iter().enumerate() {
            let state = run.at(*time_s);
            kpa[n] = state.state.above_reservoir_kpa;
            if let Some(flow_ml_rad) = &mut flow_ml_rad {
                flow_ml_rad[n] = run.flow_ml_rad();
            }
            for (column, by) in kpa_by.iter_mut().zip(state.pressure_by) {
                column[n] = by;
            }
        }
    }
}
