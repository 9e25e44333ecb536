//! The motion of a simulation, and the times of its samples.

use pump_bench::simulation::Simulation;
use pump_model::{Leg, ModelError, Parameter};
use pyo3::prelude::*;

use super::followed::followed;
use crate::argument::{Argument, Floats, number_of, speed};
use crate::python::errors::{self, value};
use crate::python::{append, collected};

/// Latest time, s, either way.
const MAX_TIME_S: f64 = 1e7;
/// Slowest constant speed, rad/s, as in `pump_bench::simulation::Simulation`.
const LEAST_SPEED_RAD_S: f64 = 1e-6;
/// Largest angle at the start, rad, either way.
const MAX_ANGLE_RAD: f64 = 1e9;
/// Time between samples where none is given, s.
const DT_S: f64 = 1e-3;
/// Fewest and most intervals in which a speed that is a function of time is looked at first.
const LOOKS: (u64, u64) = (64, 10_000);

/// Speed of the pump head over time.
enum Speed<'py> {
    /// One speed, rad/s.
    Constant(f64),
    /// Speeds at knots, rad/s, and a straight line from each to the next.
    Knots(Vec<f64>),
    /// A function of the time in s, the name of its argument, and the rad/s of its unit.
    Function(Bound<'py, PyAny>, &'static str, f64),
}

/// Times of the samples.
pub(super) enum Times {
    /// Times n `dt_s` from 0 on.
    Every { dt_s: f64, intervals: u64 },
    /// Times that were given, rising.
    At(Vec<f64>),
}

/// Arguments of a simulation that say how the pump head turns and when its state is asked for.
pub(super) struct Asked<'a, 'py> {
    pub(super) speed_rpm: Argument<'a, 'py>,
    pub(super) speed_rad_s: Argument<'a, 'py>,
    pub(super) duration_s: Option<f64>,
    pub(super) dt_s: Option<f64>,
    pub(super) time_s: Argument<'a, 'py>,
    pub(super) output_time_s: Argument<'a, 'py>,
    pub(super) start_angle_rad: f64,
}

/// Legs of the pump head from the start on, and the times of the samples.
pub(super) struct Motion {
    pub(super) legs: Vec<Leg>,
    pub(super) times: Times,
    /// The one speed of a motion at constant speed, rad/s.
    pub(super) constant_rad_s: Option<f64>,
}

impl Motion {
    /// Reads a motion.
    pub(super) fn of(asked: &Asked<'_, '_>) -> PyResult<Self> {
        let start_rad = asked.start_angle_rad;
        if !(-MAX_ANGLE_RAD..=MAX_ANGLE_RAD).contains(&start_rad) {
            return Err(value(format_args!(
                "start_angle_rad is {start_rad}; allowed: a finite number, up to {MAX_ANGLE_RAD:e} either way"
            )));
        }
        match speed_of(asked)? {
            Speed::Constant(rad_s) => {
                if rad_s.abs() < LEAST_SPEED_RAD_S {
                    let (name, unit_rad_s) = speed::given(asked.speed_rpm);
                    let (given, least) = (rad_s / unit_rad_s, LEAST_SPEED_RAD_S / unit_rad_s);
                    return Err(value(format_args!(
                        "{name} is {given}; allowed: {least:.1e} or more either way, or an array of speeds"
                    )));
                }
                let (times, _) = asked.times()?;
                let legs = collected([Leg::constant_speed(start_rad, rad_s)])?;
                Ok(Self { legs, times, constant_rad_s: Some(rad_s) })
            }
            Speed::Knots(rad_s) => {
                let (knots_s, times_s) = asked.knots(rad_s.len())?;
                let legs = through(&knots_s, &rad_s, start_rad)?;
                Ok(Self { legs, times: Times::At(times_s.unwrap_or(knots_s)), constant_rad_s: None })
            }
            Speed::Function(function, name, rad_s) => {
                let (times, end_s) = asked.times()?;
                let count = match &times {
                    Times::Every { intervals, .. } => *intervals,
                    Times::At(times_s) => times_s.len() as u64,
                };
                let at = |time_s: f64| -> PyResult<f64> {
                    let unit = if name == "speed_rpm" { " in r/min" } else { " in rad/s" };
                    let speed =
                        number_of(&format!("{name} at {time_s} s"), unit, &function.call1((time_s,))?)?;
                    speed::within(speed * rad_s).ok_or_else(|| {
                        let most = speed::MAX_SPEED_RAD_S / rad_s;
                        value(format_args!(
                            "{name} at {time_s} s is {speed}; allowed: a finite number, up to {most:e} either way"
                        ))
                    })
                };
                let legs = followed(name, at, end_s, count.clamp(LOOKS.0, LOOKS.1), start_rad)?;
                Ok(Self { legs, times, constant_rad_s: None })
            }
        }
    }

    /// Returns the time of the last sample, s.
    pub(super) fn last_s(&self) -> f64 {
        match &self.times {
            Times::Every { dt_s, intervals } => *dt_s * *intervals as f64,
            Times::At(times_s) => times_s.last().copied().unwrap_or_default(),
        }
    }

    /// Returns the speed at the start, rad/s.
    pub(super) fn first_rad_s(&self) -> f64 {
        self.legs.first().map_or(0.0, |leg| leg.speed_rad_s)
    }
}

impl Asked<'_, '_> {
    /// Returns the times of the samples of a motion from time 0 on, and its end, s.
    fn times(&self) -> PyResult<(Times, f64)> {
        if self.output_time_s.is_some() {
            return Err(value(
                "output_time_s is given, but the speed is no array of speeds at knots; give the times as time_s",
            ));
        }
        match (self.time_s, self.duration_s) {
            (Some(_), Some(_)) => Err(value("time_s and duration_s are both given; give exactly one")),
            (None, None) => Err(value("no time is given; give duration_s or time_s")),
            (Some(_), None) if self.dt_s.is_some() => {
                Err(value("dt_s is given, but time_s has the times already; leave one of them out"))
            }
            (Some(times), None) => {
                let times_s = rising("time_s", times, (0.0, MAX_TIME_S), "")?;
                let end_s = times_s.last().copied().unwrap_or_default();
                Ok((Times::At(times_s), end_s))
            }
            (None, Some(duration_s)) => {
                let grid = Simulation::new(1.0, duration_s, self.dt_s.unwrap_or(DT_S));
                grid.validate().map_err(named)?;
                Ok((Times::Every { dt_s: grid.dt_s, intervals: grid.intervals() }, duration_s))
            }
        }
    }

    /// Returns the times of `count` knots, and those of the samples if they are others.
    fn knots(&self, count: usize) -> PyResult<(Vec<f64>, Option<Vec<f64>>)> {
        let Some(knots) = self.time_s else {
            return Err(value(format_args!(
                "the speed is an array of {count} numbers; give the times of these speeds as time_s, or one number"
            )));
        };
        if self.duration_s.is_some() || self.dt_s.is_some() {
            return Err(value(
                "duration_s and dt_s do not go with speeds at knots; give the times of the samples as output_time_s",
            ));
        }
        let knots_s = rising("time_s", knots, (-MAX_TIME_S, MAX_TIME_S), JUMP)?;
        if knots_s.len() != count || count < 2 {
            return Err(value(format_args!(
                "time_s has {} times and the speed {count} numbers; allowed: as many, two at least",
                knots_s.len()
            )));
        }
        let ends = (knots_s[0], knots_s[count - 1]);
        let times_s = self.output_time_s.map(|times| rising("output_time_s", times, ends, "")).transpose()?;
        Ok((knots_s, times_s))
    }
}

/// Maps an error of a grid of times, in the words of the arguments.
fn named(error: ModelError) -> PyErr {
    match error {
        ModelError::OutOfRange { parameter: Parameter::Duration, value: given, allowed } => {
            value(format_args!("duration_s is {given}; allowed: {allowed}"))
        }
        ModelError::OutOfRange { parameter: Parameter::SampleInterval, value: given, .. } => {
            value(format_args!("dt_s is {given}; allowed: more than 0, duration_s at most"))
        }
        ModelError::OutOfRange { parameter: Parameter::Samples, value: given, .. } => {
            value(format_args!("dt_s makes {given:.4e} samples; allowed: 1e9 at most, by a longer dt_s"))
        }
        _ => errors::model(error),
    }
}

/// Reads the one of both speeds that is given.
fn speed_of<'py>(asked: &Asked<'_, 'py>) -> PyResult<Speed<'py>> {
    let (rpm, rad_s) = (asked.speed_rpm, asked.speed_rad_s);
    match (rpm, rad_s) {
        (Some(rpm), None) if rpm.is_callable() => {
            return Ok(Speed::Function(rpm.clone(), "speed_rpm", speed::RAD_S_PER_RPM));
        }
        (None, Some(rad_s)) if rad_s.is_callable() => {
            return Ok(Speed::Function(rad_s.clone(), "speed_rad_s", 1.0));
        }
        _ => {}
    }
    match speed::speeds_rad_s(rpm, rad_s)? {
        Floats::One(rad_s) => Ok(Speed::Constant(rad_s)),
        Floats::Many { shape, values } if shape.len() == 1 => Ok(Speed::Knots(values)),
        Floats::Many { shape, .. } => {
            Err(value(format_args!("the speed has shape {shape:?}; allowed: one number, or shape (n,)")))
        }
    }
}

/// Advice for two knots at one time.
const JUMP: &str = "; give a jump of the speed as two times with a gap of 1e-9 s";

/// Reads times of shape (n,) that rise within a range. `equal` is advice for a time that stands twice.
fn rising(
    name: &str,
    argument: &Bound<'_, PyAny>,
    (least_s, most_s): (f64, f64),
    equal: &str,
) -> PyResult<Vec<f64>> {
    let Floats::Many { shape, values } = Floats::extract(name, argument)? else {
        return Err(value(format_args!("{name} is one number; allowed: times of shape (n,)")));
    };
    if shape.len() != 1 || values.is_empty() {
        return Err(value(format_args!("{name} has shape {shape:?}; allowed: (n,), one time at least")));
    }
    if let Some(time_s) = values.iter().find(|time_s| !(least_s..=most_s).contains(*time_s)) {
        return Err(value(format_args!("{name} has {time_s} s; allowed: {least_s} to {most_s} s")));
    }
    let mut pairs = values.iter().zip(values.iter().skip(1));
    if let Some((before_s, time_s)) = pairs.find(|(before_s, time_s)| time_s <= before_s) {
        let advice = if time_s == before_s { equal } else { "" };
        return Err(value(format_args!(
            "{name} has {time_s} s after {before_s} s; allowed: times that rise{advice}"
        )));
    }
    Ok(values)
}

/// Returns the legs on straight lines from knot to knot. After the last the speed stays.
fn through(knots_s: &[f64], speeds_rad_s: &[f64], start_rad: f64) -> PyResult<Vec<Leg>> {
    let mut legs = Vec::new();
    let (mut start_s, mut angle_rad) = (knots_s[0], start_rad);
    let ends = knots_s.iter().zip(speeds_rad_s).skip(1);
    for (speed_rad_s, (end_s, end_rad_s)) in speeds_rad_s.iter().zip(ends) {
        let duration_s = end_s - start_s;
        let acceleration_rad_s2 = (end_rad_s - speed_rad_s) / duration_s;
        let leg = Leg { start_s, duration_s, angle_rad, speed_rad_s: *speed_rad_s, acceleration_rad_s2 };
        (start_s, angle_rad) = (leg.end_s(), leg.end_angle_rad());
        append(&mut legs, leg)?;
    }
    let last_rad_s = speeds_rad_s.last().copied().unwrap_or_default();
    append(&mut legs, Leg { start_s, ..Leg::constant_speed(angle_rad, last_rad_s) })?;
    Ok(legs)
}
