//! The questions about the place: the air's pressure, the heights of supply and vessel, and the usual rate.

use pump_bench::pump_file::OutletEnd;
use pump_bench::setup::Topic;
use pump_bench::units::{self, Pressure};

use super::asker::{Asked, Question, Usual};
use super::course::{Course, heading, tell_person};
use super::head::length_or_unknown;
use crate::options::limits::ambient_kpa;

/// Asks where the pump stands, unless a file knows it, and for the rate of its doses. A file whose lines end at
/// absolute pressures knows no place: in other air they are those of other heights.
pub(super) fn ask(course: &mut Course) -> Asked<()> {
    let is_of_file = course.answers.is_of_file();
    let answers = &course.answers;
    let of_file_mm = answers.heights_of_pressures_mm()?;
    let lifts_mm = [answers.suction_lift_mm, answers.discharge_lift_mm];
    let asks_height =
        [0, 1].map(|line| lifts_mm[line].is_none() && (!is_of_file || of_file_mm[line].is_some()));
    let knows_air = answers.has_ambient() || is_of_file && of_file_mm == [None; 2];
    if !knows_air || asks_height.contains(&true) {
        heading("The place");
        if is_of_file {
            tell_person("  The file states absolute pressures, which are those of its own place.");
        }
        if !knows_air {
            ask_ambient(course)?;
        }
        ask_lifts(course, asks_height, of_file_mm)?;
    }
    if !is_of_file {
        ask_outlet(course)?;
    }
    if course.answers.rate_ml_s.is_none() {
        ask_rate(course)?;
    }
    Ok(())
}

fn ask_ambient(course: &mut Course) -> Asked<()> {
    let last = |last: &pump_bench::setup::Answers| {
        let altitude = last.altitude_m.map(|m| format!("{m}m"));
        altitude.or_else(|| last.ambient_kpa.map(|kpa| format!("{kpa}kPaa")))
    };
    let question = Question {
        text: "Altitude of the place, as 500m, or the air's pressure, as 98.2kPaa",
        option: "--altitude 500m or --ambient 98.2kPaa",
        usual: course.suggested(last, None),
        help: "100 m more or less do not matter; a map tells the altitude, a barometer in the room the pressure (not \
               the one of a weather report, which is reduced to sea level)",
    };
    let read = |answer: &str| {
        if let Ok(altitude_mm) = units::height_mm(answer) {
            return Ok((Some(1e-3 * altitude_mm), None));
        }
        let pressure: Pressure = units::pressure(answer).map_err(|_| {
            format!("`{answer}` is neither a height, as 500m, nor an absolute pressure, as 98.2kPaa")
        })?;
        let kpa = ambient_kpa(pressure).map_err(|failure| failure.message().to_owned())?;
        Ok((None, Some(kpa)))
    };
    course.settle(Topic::Ambient, &question, read, |answers, (altitude_m, kpa)| {
        (answers.altitude_m, answers.ambient_kpa) = (altitude_m, kpa);
    })
}

/// Asks for the heights of the supply and of the vessel, each if nobody knows it. `of_file_mm` are those to which a
/// file's pressures amount.
fn ask_lifts(course: &mut Course, asks: [bool; 2], of_file_mm: [Option<f64>; 2]) -> Asked<()> {
    let height = |answer: &str| units::height_mm(answer).map_err(|error| error.to_string());
    let shown = |mm: f64| if mm == 0.0 { "0".to_owned() } else { format!("{}m", mm / 1e3) };
    let [of_supply, of_vessel] = of_file_mm.map(|mm| mm.map(|mm| Usual::new(shown(mm.round()))));
    if asks[0] {
        let question = Question {
            text: "Height of the pump above the supply's surface, as 0.3m",
            option: "--suction-lift 0.3m",
            usual: of_supply.or_else(|| course.suggested(|last| last.suction_lift_mm.map(shown), Some("0"))),
            help: "negative if the supply stands above the pump, as -0.3m; 0 if both stand on one bench",
        };
        course.settle(Topic::SuctionLift, &question, height, |answers, mm| {
            answers.suction_lift_mm = Some(mm);
        })?;
    }
    if asks[1] {
        let question = Question {
            text: "Height of the vessel above the pump, as 0.3m",
            option: "--discharge-lift 0.3m",
            usual: of_vessel
                .or_else(|| course.suggested(|last| last.discharge_lift_mm.map(shown), Some("0"))),
            help: "negative if the vessel stands below the pump, as -0.3m",
        };
        course.settle(Topic::DischargeLift, &question, height, |answers, mm| {
            answers.discharge_lift_mm = Some(mm);
        })?;
    }
    Ok(())
}

/// Asks how the outlet ends: a drop that hangs there is part of each dose's uncertainty.
fn ask_outlet(course: &mut Course) -> Asked<()> {
    if course.answers.outlet_end.is_none() {
        let question = Question {
            text: "End of the outlet: in air, or immersed in the vessel's liquid (air, immersed)",
            option: "--outlet-end air",
            usual: course.suggested(|last| last.outlet_end.map(|end| end.as_str().to_owned()), Some("air")),
            help: "a drop hangs from an end in air, and stays there or falls; it matters to doses below a millilitre",
        };
        let read = |answer: &str| answer.parse::<OutletEnd>().map_err(|error| error.to_string());
        course.settle(Topic::OutletEnd, &question, read, |answers, end| answers.outlet_end = Some(end))?;
    }
    if course.answers.outlet_end == Some(OutletEnd::Air) && course.answers.nozzle_bore_mm.is_none() {
        let millimetres = |bore_mm: Option<f64>| bore_mm.filter(|mm| *mm > 0.0).map(|mm| format!("{mm}mm"));
        let bore_mm = course.answers.bore_mm();
        let own = millimetres(bore_mm);
        let question = Question {
            text: "Inner diameter of the outlet's end, or `unknown`",
            option: "--nozzle-bore 1.6mm",
            // The end of another tube is hardly that of this one: a wider end holds a larger drop.
            usual: course.suggested(
                |last| millimetres(last.nozzle_bore_mm).filter(|_| last.bore_mm() == bore_mm),
                Some(own.as_deref().unwrap_or("unknown")),
            ),
            help: "that of the tube if it ends without a nozzle, as 1.6mm; larger drops hang from a wider end",
        };
        course.settle(Topic::Nozzle, &question, length_or_unknown, |answers, mm| {
            answers.nozzle_bore_mm = Some(mm);
        })?;
    }
    Ok(())
}

fn ask_rate(course: &mut Course) -> Asked<()> {
    let own = format!("{}mL/s", significant(course.answers.usual_rate_ml_s()?));
    let question = Question {
        text: "Rate of a dose that names none",
        option: "--rate 0.2mL/s",
        // The rate of another pump fits a head of another size badly.
        usual: course.suggested_of_head(|last| Some(format!("{}mL/s", last.rate_ml_s?)), Some(&own)),
        help: "mean flow, as 0.2mL/s or 12mL/min; a slow dose is gentler to the liquid and to the scale",
    };
    let read = |answer: &str| units::flow_ml_s(answer).map_err(|error| error.to_string());
    course.settle(Topic::Rate, &question, read, |answers, rate_ml_s| answers.rate_ml_s = Some(rate_ml_s))
}

/// Two digits of a rate.
fn significant(rate_ml_s: f64) -> f64 {
    format!("{rate_ml_s:.1e}").parse().unwrap_or(rate_ml_s)
}
