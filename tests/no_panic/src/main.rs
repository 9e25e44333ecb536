//! Calls everything that firmware may call, with inputs of which the compiler knows nothing. The panic handler calls a
//! function that does not exist, so a program in which any panic can be reached does not link.
//!
//! That this test can fail is tested too: feature `index` adds an index that may be out of range, and `make embedded`
//! wants that link to name the missing function.
#![no_std]
#![no_main]

mod node;

use core::hint::black_box;
use core::panic::PanicInfo;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorKind, ErrorType, InputPin, OutputPin};
use libm::{ceil, floor, pow, sqrt};
use pump_ctl::drive::{Actuator, Clock, OnFault, StepDir, StepMotor, Timing};
use pump_ctl::generated::torque_curve;
use pump_ctl::plan::{
    Cruise, Doser, Finish, FlowPlan, FlowRow, LimitedBy, Limits, Lowest, Motor, Phase, PlanError, Request,
    Retarget, SetBy, speed_for_flow,
};
use pump_ctl::plan::{Torque, TorqueCurve};
use pump_ctl::step::{Brake, BrakeError, Direction, Feed, Segment, Stepper, TickRate, Ticks};
use pump_model::generated;
use pump_model::polynomial::Polynomial;
use pump_model::units::{degrees, rad_s, radians, rpm, wrap};
use pump_model::{DefaultPulse, ExactRun, FlowCurve, Geometry, Leg, Line, LineState, ModelError, Port, Pump};
use pump_model::{RollerVolume, Stretches, Variant};

unsafe extern "C" {
    safe fn a_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    a_panic_is_reachable()
}

#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    loop {
        black_box(everything().is_ok());
    }
}

/// A number that may be anything.
fn any() -> f64 {
    black_box(0.0)
}

fn any_port() -> Port {
    if black_box(true) { Port::Inlet } else { Port::Outlet }
}

fn any_leg() -> Leg {
    Leg {
        start_s: any(),
        duration_s: any(),
        angle_rad: any(),
        speed_rad_s: any(),
        acceleration_rad_s2: any(),
    }
}

fn everything() -> Result<(), PlanError> {
    numbers();
    node::node();
    node::host();
    let generated = generated_pump().unwrap_or(Pump::three_roller());
    for pump in [own_pump()?, preset()?, generated, Pump::three_roller(), Pump::two_roller()] {
        let pump = black_box(pump);
        curve(pump.inlet_curve());
        curve(pump.outlet_curve());
        curve(pump.curve(any_port()));
        pressures(&pump)?;
        dose(&pump)?;
    }
    #[cfg(feature = "index")]
    black_box([1.0, 2.0][black_box(0_usize)]);
    Ok(())
}

fn numbers() {
    black_box((floor(any()), ceil(any()), sqrt(any()), pow(any(), any()), wrap(any(), any())));
    black_box((radians(any()), degrees(any()), rpm(any()), rad_s(any())));
    let p = Polynomial { c: [(); 6].map(|()| any()) };
    black_box((p.at(any()), p.derivative(), p.shifted(any()), p.stretched(any()), p.scaled(any())));
    black_box((p.plus(&Polynomial::constant(any())), p.roots_in(any(), any()).as_slice()));
    black_box((p.solve_monotone(any(), any(), any()), p.range_in(any(), any())));
    let leg = any_leg();
    black_box((leg.end_s(), leg.end_angle_rad(), leg.angle_at(any()), leg.speed_at(any())));
}

fn own_pump() -> Result<Pump, ModelError> {
    let geometry = Geometry {
        rollers: black_box(3),
        bore_radius_mm: any(),
        tube_outer_radius_mm: any(),
        backplate_radius_mm: any(),
        contact_angle_rad: any(),
        roller_radius_mm: any(),
        roller_offset_mm: any(),
    };
    geometry.validate()?;
    let volume = RollerVolume::from_polynomial_deg([(); 6].map(|()| any()), any())?;
    let volume = volume.scaled_to(any())?.stretched_to(any())?;
    black_box((geometry.pitch_rad(), geometry.nominal_ml_rad(), geometry.inlet_phase_rad(&volume)?));
    black_box((
        volume.at(any()),
        volume.inset_rad(),
        volume.total_ml(),
        volume.engagement_deg(),
        volume.engagement_rad(),
    ));
    let line = Line {
        resistance_kpa_s_ml: any(),
        compliance_ml_kpa: any(),
        inertance_kpa_s2_ml: any(),
        reservoir_kpa: any(),
    };
    line.validate()?;
    black_box((
        line.natural_rad_s(),
        line.damping_ratio(),
        line.slowest_decay_per_s(),
        line.worst_kpa_s_ml(),
    ));
    Pump::new(geometry, volume, line, Line::PUBLISHED)?.shifted(any())?.scaled(any())
}

/// Makes a pump as a generated source does, but at run time.
fn generated_pump() -> Option<Pump> {
    let flows = [(); 40].map(|()| (any(), any(), [(); 6].map(|()| any())));
    let volumes = [(); 40].map(|()| (any(), [(); 6].map(|()| any())));
    let flows = flows.get(..black_box(2)).unwrap_or(&flows);
    let volumes = volumes.get(..black_box(2)).unwrap_or(&volumes);
    let curve = || generated::flow_curve(any(), any(), flows);
    let volume = generated::roller_volume(any(), any(), any(), volumes);
    let geometry = Geometry::published(black_box(3), Variant::Measured);
    black_box(torque_curve([(); 8].map(|()| (any(), any()))));
    generated::pump(geometry, volume, [Line::PUBLISHED; 2], [curve(), curve()])
}

fn preset() -> Result<Pump, ModelError> {
    let variant = match black_box(0) {
        0 => Variant::Measured,
        1 => Variant::Published,
        _ => Variant::AsBuilt,
    };
    let geometry = Geometry::published(black_box(3), variant);
    black_box(Pump::new(geometry, RollerVolume::measured()?, Line::PUBLISHED, Line::PUBLISHED)?);
    Pump::preset(black_box(3), variant)
}

fn curve(curve: &FlowCurve) {
    black_box((curve.flow_ml_rad(any()), curve.volume_ml(any()), curve.angle_rad(any())));
    black_box((curve.pitch_rad(), curve.pitch_ml(), curve.flow_range_ml_rad(), curve.ripple()));
    black_box((curve.turn_range_ml(any(), any(), any()), curve.uneven_part()));
    black_box(curve.speed_for_flow(any(), any()));
    black_box((curve.reverses(), curve.largest_flow_ml_rad(), curve.volume_range_ml(any(), any())));
    black_box(curve.turns_range_ml(any(), any(), any(), any()));
    for reach in curve.reaches(any(), any(), any()).take(black_box(1000)) {
        black_box(reach);
    }
}

fn pressures(pump: &Pump) -> Result<(), ModelError> {
    let port = any_port();
    black_box((pump.at_angle(any()), pump.pitch_rad(), pump.revolution_ml(), pump.nominal_ml_rad()));
    let (inlet, outlet) = (*pump.inlet(), *pump.outlet());
    let pulse = DefaultPulse::new(any(), any());
    let bought = Pump::from_ml_per_rev(any(), black_box(4), pulse, inlet, outlet)?;
    let other = bought.with_roller_volume(pulse.roller_volume(any())?)?.with_lines(inlet, outlet)?;
    black_box((DefaultPulse::of(&other), DefaultPulse::shape(), pump.geometry().is_known()));
    black_box((pump.geometry(), pump.roller_volume(), pump.inlet(), pump.outlet(), pump.line(port)));
    black_box((pump.steady_state(any())?, pump.periodic_state(port, any())?, port.name()));
    let state = LineState { above_reservoir_kpa: any(), flow_ml_s: any() };
    black_box(state.pressure_kpa(pump.line(port)));
    let legs = [any_leg(), Leg::constant_speed(any(), any()), Leg::rest(any(), any())];
    let mut run = ExactRun::new(pump, port, legs, state);
    black_box((run.at(any()), run.pressure_kpa(any()), run.time_s(), run.state(), run.settling_s()?));
    black_box(run.extremes(any()).and(run.extremes(any())));
    for sample in run.every(any()).take(black_box(1000)) {
        black_box(sample);
    }
    black_box(ExactRun::from_rest(pump, port, legs).at(any()));
    for stretch in Stretches::new(pump.curve(port), legs) {
        black_box((stretch.flow_ml_s(any()), stretch.flow_ml_rad(any()), stretch.flow_rate_ml_s2(any())));
    }
    Ok(())
}

fn dose(pump: &Pump) -> Result<(), PlanError> {
    let motor = Motor::new(any(), any(), any());
    let mut limits = Limits::new(motor);
    limits.pressures.max_outlet_kpa = black_box(true).then(any);
    limits.pressures.min_inlet_kpa = black_box(true).then(any);
    let points = [(any(), any()), (any(), any()), (any(), any())];
    if let Some(curve) = TorqueCurve::new(points.get(..black_box(3)).unwrap_or(&points)) {
        black_box(curve.at(any()));
        let [occlusion_n_m, inertia_kg_m2, ambient_kpa] = [(); 3].map(|()| any());
        let torque = Torque::new(ambient_kpa, curve);
        limits =
            limits.with_torque(torque.with_occlusion_n_m(occlusion_n_m).with_inertia_kg_m2(inertia_kg_m2));
    }
    let set_by = if black_box(true) { SetBy::Vapour } else { SetBy::TubeCollapse };
    limits.lowest = black_box(true).then(|| Lowest { kpa: any(), set_by });
    limits.validate()?;
    let cruise = match black_box(0) {
        0 => Cruise::Flow { ml_s: any() },
        1 => Cruise::Speed { rad_s: any() },
        2 => Cruise::Within { time_s: any() },
        _ => Cruise::Fastest,
    };
    let finish = black_box("low-flow").parse().unwrap_or(Finish::Any);
    if let Err(unknown) = black_box("torque").parse::<LimitedBy>() {
        black_box(unknown);
    }
    let request =
        Request::new(any(), cruise).with_carry_in_ml(any()).with_smooth(black_box(true)).with_finish(finish);
    let start = Phase::within(any(), any());
    let plan = Doser::new(pump, limits)?.plan(start, &request)?;
    black_box((plan.predict(pump)?, plan.end_step_ml(pump), plan.end_angle_rad()));
    for leg in plan.legs() {
        black_box(leg);
    }
    black_box((plan.angle_after(black_box(1)), plan.direction(), start.is_known(any())));
    black_box((Phase::unknown(any()), start.range_ml(pump, any()), plan.range_ml(pump, black_box(1))));
    black_box((
        Phase::from_index(any(), black_box(1), any()),
        plan.after(pump, black_box(1)),
        plan.stop_at(any()),
    ));
    black_box((speed_for_flow(pump, any()), motor.step_rad()));
    flow(pump, motor);
    for step in plan.each_step() {
        black_box(step);
    }
    let profile = plan.profile();
    black_box((profile.time_of(any()), profile.duration_s(), profile.cruise_rad_s()));
    black_box((profile.peak_rad_s(), profile.reaches_limit(), profile.acceleration_rad_s2()));
    black_box(limits.margins(pump, &plan).nearest(plan.direction()));
    black_box(plan.low_flow_volumes_ml(pump)?);
    black_box((plan.is_smooth(), plan.cruise_flow_ml_s(pump), plan.ripples(pump)));
    black_box((plan.angle_at(any()), plan.speed_at(any()), plan.speed_after(black_box(1))));
    black_box(Doser::new(pump, limits)?.retarget(&plan, &Retarget::new(black_box(1), any(), cruise))?);
    let rest = Doser::new(pump, limits)?
        .retarget(&plan, &Retarget::new(black_box(1), any(), cruise).with_smooth(black_box(true)))?;
    black_box((rest.delivered_ml(pump, black_box(1)), rest.stop(pump, black_box(1)), rest.predict(pump)?));
    let Some(tick_rate) = TickRate::from_hz(black_box(1)) else { return Ok(()) };
    for segment in rest.segments(tick_rate) {
        black_box(segment);
    }
    black_box(rest.segments(tick_rate).steps_by(black_box(1)));
    black_box(moves(motor, rest.segments(tick_rate).feed()).is_ok());
    Ok(())
}

/// A flow over time of which nothing is known.
fn flow(pump: &Pump, motor: Motor) {
    let Ok(mut plan) = FlowPlan::new(pump, motor, Phase::within(any(), any())) else { return };
    while black_box(true) {
        let Ok(stretch) = plan.take(FlowRow::new(any(), any())) else { break };
        for step in stretch.into_iter().flatten() {
            black_box(step);
        }
    }
    black_box((plan.end().is_ok(), plan.volume_ml(), plan.steps()));
}

/// A pin, a delay and a clock of which nothing is known.
struct Any;

impl ErrorType for Any {
    type Error = ErrorKind;
}

impl OutputPin for Any {
    fn set_low(&mut self) -> Result<(), ErrorKind> {
        black_box(Ok(()))
    }

    fn set_high(&mut self) -> Result<(), ErrorKind> {
        black_box(Ok(()))
    }
}

impl InputPin for Any {
    fn is_high(&mut self) -> Result<bool, ErrorKind> {
        black_box(Ok(true))
    }

    fn is_low(&mut self) -> Result<bool, ErrorKind> {
        black_box(Ok(true))
    }
}

impl DelayNs for Any {
    fn delay_ns(&mut self, ns: u32) {
        black_box(ns);
    }
}

impl Clock for Any {
    fn now(&mut self) -> u64 {
        black_box(0)
    }
}

fn any_segment() -> Segment {
    Segment { count: black_box(1), interval: black_box(1), add: black_box(1), frac: black_box(1) }
}

fn moves(motor: Motor, mut feed: Feed<impl Iterator<Item = Segment>>) -> Result<(), BrakeError> {
    let tick_rate = feed.tick_rate();
    let brake = match Brake::from_climb(tick_rate, [any_segment(), any_segment()]) {
        Ok(brake) => brake,
        Err(_) => motor.brake(tick_rate)?,
    };
    let mut carry = black_box(0);
    let interval = Ticks { whole: black_box(1), frac: black_box(1) };
    let direction = if black_box(true) { Direction::Forward } else { Direction::Reverse };
    for segment in brake.climb().copied().chain(brake.descent(interval, direction)).chain([any_segment()]) {
        black_box((segment.steps(), segment.direction().reversed(), segment.is_valid(), segment.duration()));
        black_box(segment.interval_before(black_box(1)));
        for ticks in segment.intervals(&mut carry) {
            black_box(ticks);
        }
    }
    let mut stepper = Stepper::<8>::new(brake);
    black_box((feed.peek().copied(), feed.next(), feed.steps()));
    black_box((stepper.set_end(black_box(1)).is_ok(), stepper.end()));
    black_box(stepper.push(any_segment(), stepper.tick_rate()).is_ok());
    black_box((stepper.set_position(black_box(1)), stepper.clear()));

    let timing = Timing::new().with_step_high_ns(black_box(1));
    let pins = StepDir::new(Any, Any, Any, Any, timing).with_index(Any);
    let mut actuator = Actuator::new(pins, stepper, OnFault::Disable);
    black_box((actuator.enable().is_ok(), actuator.watch_index().is_ok(), actuator.index_at()));
    black_box(actuator.start(black_box(1)).is_ok());
    while black_box(true) {
        black_box(actuator.on_timer(black_box(1)).is_ok());
        let stepper = actuator.stepper();
        black_box((stepper.room(), stepper.position(), stepper.position_at(black_box(1))));
        black_box((stepper.next_deadline(), stepper.is_moving(), stepper.retarget(black_box(1))));
        black_box(stepper.junction(black_box(1)));
        if black_box(false) {
            stepper.halt(black_box(true));
            stepper.finish();
            black_box(stepper.set_end(black_box(1)).is_ok());
        }
        if black_box(false) {
            black_box(actuator.stop(black_box(1)));
        }
    }
    let mut feed = feed.with_steps(black_box(1));
    black_box(actuator.run(&mut &mut Any, &mut feed, || black_box(false)).is_ok());
    black_box(actuator.disable().is_ok());
    let (mut pins, mut stepper) = actuator.release();
    black_box(stepper.fill(&mut feed).is_ok());
    black_box((&mut pins).step(direction).is_ok());
    black_box(pins.release());
    Ok(())
}
