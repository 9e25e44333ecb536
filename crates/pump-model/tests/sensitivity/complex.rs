//! An independent integration of a line with complex parameters, for comparison only. The imaginary part of a tiny
//! complex step is the derivative, without a difference.

use pump_model::{Leg, Line, LineState, Port, Pump, Stretches};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Complex {
    pub re: f64,
    pub im: f64,
}

impl Complex {
    pub(crate) fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
    fn times(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
    fn scaled(self, factor: f64) -> Self {
        Self { re: factor * self.re, im: factor * self.im }
    }
    fn inverse(self) -> Self {
        let square = self.re * self.re + self.im * self.im;
        Self { re: self.re / square, im: -self.im / square }
    }
}

/// R, C and L.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parameters(pub [Complex; 3]);

impl Parameters {
    pub(crate) fn of(line: &Line) -> Self {
        Self([line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml].map(Complex::real))
    }
}

type State = [Complex; 2];

fn add(state: State, factor: f64, rate: State) -> State {
    [0, 1].map(|n| state[n].plus(rate[n].scaled(factor)))
}

/// Returns the pressures above the reservoir at rising times, by the classical Runge-Kutta method in every stretch
/// with so many and twice as many steps, extrapolated.
pub(crate) fn pressures_by_steps(
    pump: &Pump,
    port: Port,
    legs: &[Leg],
    start: LineState,
    parameters: Parameters,
    times_s: &[f64],
) -> Vec<Complex> {
    let [coarse, fine] =
        [1500, 3000].map(|steps| integrated(pump, port, legs, start, parameters, times_s, steps));
    coarse
        .into_iter()
        .zip(fine)
        .map(|(coarse, fine)| fine.scaled(16.0 / 15.0).plus(coarse.scaled(-1.0 / 15.0)))
        .collect()
}

fn integrated(
    pump: &Pump,
    port: Port,
    legs: &[Leg],
    start: LineState,
    Parameters([resistance, compliance, inertance]): Parameters,
    times_s: &[f64],
    steps: u32,
) -> Vec<Complex> {
    let sign = if port == Port::Outlet { 1.0 } else { -1.0 };
    let (per_compliance, per_inertance) = (compliance.inverse().scaled(sign), inertance.inverse());
    let rate = |state: State, flow: f64| {
        let [p, q] = state;
        let dp = Complex::real(flow).plus(q.scaled(-1.0)).times(per_compliance);
        let dq = p.scaled(sign).plus(resistance.times(q).scaled(-1.0)).times(per_inertance);
        [dp, dq]
    };
    let mut state = [start.above_reservoir_kpa, start.flow_ml_s].map(Complex::real);
    let mut pressures = Vec::new();
    let mut due = times_s.iter().copied().peekable();
    for stretch in Stretches::new(pump.curve(port), legs.iter().copied()) {
        let mut from_s = stretch.start_s;
        loop {
            let Some(next_s) = due.peek().copied() else { return pressures };
            let asked_s = Some(next_s).filter(|t| *t <= stretch.end_s);
            let to_s = asked_s.unwrap_or(stretch.end_s);
            let h = (to_s - from_s) / f64::from(steps);
            for n in 0..steps {
                let t = from_s + f64::from(n) * h;
                let flow = [t, t + 0.5 * h, t + h].map(|t| stretch.flow_ml_s(t));
                let k1 = rate(state, flow[0]);
                let k2 = rate(add(state, 0.5 * h, k1), flow[1]);
                let k3 = rate(add(state, 0.5 * h, k2), flow[1]);
                let k4 = rate(add(state, h, k3), flow[2]);
                for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
                    state = add(state, h * weight / 6.0, k);
                }
            }
            from_s = to_s;
            if asked_s.is_none() {
                break;
            }
            pressures.push(state[0]);
            due.next();
        }
    }
    pressures
}
