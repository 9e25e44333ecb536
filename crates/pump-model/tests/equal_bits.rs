//! Claims about bits: the runs of the built-in line are those recorded, to the last bit and step.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_model::circuit::Loss;
use pump_model::integrator::Statistics;
use pump_model::{Fluid, Hose, Leg, Line, LineState, Port, PortRun, Pump};

/// Hose of McIntyre et al. as far as it is known.
const HOSE: Hose = Hose {
    bore_radius_mm: 5.0,
    outer_radius_mm: 7.0,
    length_mm: 331.0,
    modulus_mpa: 3.5,
    poisson_ratio: 0.5,
    minor_loss: 5.75,
};

/// A start-up, a reversal and a rest.
fn motion() -> [Leg; 3] {
    let ramp =
        Leg { start_s: 0.0, duration_s: 0.3, angle_rad: 0.4, speed_rad_s: 0.0, acceleration_rad_s2: 40.0 };
    let turn = Leg { start_s: 0.3, angle_rad: ramp.end_angle_rad(), speed_rad_s: 12.0, ..ramp };
    let back = Leg { start_s: 0.6, angle_rad: turn.end_angle_rad(), speed_rad_s: -7.0, ..ramp };
    [ramp, Leg { acceleration_rad_s2: -60.0, ..turn }, Leg { acceleration_rad_s2: 0.0, ..back }]
}

/// Mixes numbers into one, bit by bit (FNV-1a).
fn mixed(numbers: impl IntoIterator<Item = f64>) -> u64 {
    let bytes = numbers.into_iter().flat_map(|number| number.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// Returns the mixed states of a run at every millisecond of 1.2 s, and its cost.
fn run(pump: &Pump, port: Port, loss: Loss) -> (u64, Statistics) {
    let start = LineState { above_reservoir_kpa: 2.0, flow_ml_s: -1.0 };
    let mut run = PortRun::<_, 3, _>::resisted(pump, loss, port, motion(), start, 1e-6).unwrap();
    let mut numbers = Vec::new();
    for n in 0..1200 {
        let (state, volume_ml) = run.passed_at(f64::from(n) * 1e-3).unwrap();
        numbers.extend([state.above_reservoir_kpa, state.flow_ml_s, volume_ml]);
    }
    let extremes = run.extremes(1.4).unwrap();
    numbers.extend([extremes.min_kpa, extremes.max_kpa]);
    (mixed(numbers), run.statistics())
}

fn losses() -> [(Pump, Loss); 2] {
    let water = Fluid::water(25.0).unwrap();
    let line = HOSE.line(&water, 88.637, 35.0).unwrap();
    let friction = Some(HOSE.friction(&water).unwrap());
    let three = Pump::three_roller();
    let hosed = Pump::new(*three.geometry(), *three.roller_volume(), line, line).unwrap();
    [(three, Loss::of(&Line::PUBLISHED)), (hosed, Loss::with_friction(&line, friction))]
}

#[test]
fn runs_are_those_recorded() {
    // Mixed bits; steps, rejections and evaluations. R before friction, inlet before outlet.
    let expected = [
        (0xa1c0_6534_8536_655c, [311, 32, 2721]),
        (0x1f82_27e7_0f73_2871, [311, 32, 2720]),
        (0x2a28_0da8_af66_ca5b, [530, 188, 5565]),
        (0xd535_8a71_f276_5424, [549, 195, 5765]),
    ];
    let mut found = Vec::new();
    for (pump, loss) in losses() {
        for port in [Port::Inlet, Port::Outlet] {
            let (bits, Statistics { steps, rejections, evaluations, .. }) = run(&pump, port, loss);
            found.push((bits, [steps, rejections, evaluations]));
        }
    }
    assert_eq!(found, expected, "{found:#x?}");
}

#[test]
fn periodic_states_are_those_recorded() {
    // R is integrated by Radau's method, the friction by RODAS5P.
    let expected = [0x2fbb_04b0_8eee_42ca, 0xfaf1_f17e_f7da_dc14];
    let found = losses().map(|(pump, loss)| {
        let steady = pump.resisted_steady_state([loss; 2], 9.0).unwrap();
        mixed([
            steady.inlet.min_kpa,
            steady.inlet.max_kpa,
            steady.inlet_mean_kpa,
            steady.outlet.min_kpa,
            steady.outlet.max_kpa,
            steady.outlet_mean_kpa,
        ])
    });
    assert_eq!(found, expected, "{found:#x?}");
}
