//! The questions about the pump head: what a revolution delivers, and how many rollers there are.

use pump_bench::heads::bought_head;
use pump_bench::setup::{Answers, HeadAnswer, Topic};
use pump_bench::units;

use super::asker::{Asked, Question, Stop, Usual};
use super::course::{Course, heading, tell_person};
use super::options::contact_in_deg;
use crate::advice;
use crate::failure::Failure;

/// Answer to the question for a head.
enum Named {
    Head(HeadAnswer),
    /// The dimensions are to be asked.
    Drawing,
}

/// Asks which head the pump has, and how many rollers.
pub(super) fn ask(course: &mut Course) -> Asked<()> {
    if course.answers.head.is_none() || !knows_rollers(course) {
        heading("The pump head");
    }
    if course.answers.head.is_none() {
        ask_head(course)?;
    }
    tell_of_head(course);
    if matches!(course.answers.head, Some(HeadAnswer::Drawing { .. })) && !knows_rollers(course) {
        // A drawing whose rollers alone were never said. One that is asked anew is asked as a whole.
        let is_anew = course.earlier().any(|before| before.head == course.answers.head);
        let drawn = course.answers.head.clone().filter(|_| !is_anew);
        return ask_drawing(course, drawn);
    }
    let is_volume = matches!(course.answers.head, Some(HeadAnswer::Volume { .. }));
    if is_volume && course.answers.tube_bore_mm.is_none() {
        ask_bore(course)?;
    }
    if !knows_rollers(course) {
        ask_rollers(course)?;
    }
    Ok(())
}

fn knows_rollers(course: &Course) -> bool {
    let published = course.answers.catalogued().ok().flatten().and_then(|head| head.rollers);
    course.answers.rollers.is_some() || published.is_some() || course.answers.is_of_file()
}

fn ask_head(course: &mut Course) -> Asked<()> {
    let suggested = course.suggested(
        |other| match other.head.as_ref()? {
            HeadAnswer::Catalogue(name) => Some(name.clone()),
            HeadAnswer::Volume { ml_per_rev } => Some(format!("{ml_per_rev}mL")),
            // Another pump's drawing or file is hardly that of this one.
            _ if other.name != course.answers.name => None,
            HeadAnswer::Drawing { .. } => Some("drawing".to_owned()),
            HeadAnswer::File(path) => Some(path.display().to_string()),
        },
        None,
    );
    let question = Question {
        text: "Head: mL per revolution (as 0.5mL), a name of the catalogue, a pump file, or `drawing`",
        option: "--head masterflex-ls-16, --ml-per-rev 0.5mL, --from FILE, or the dimensions of a drawing",
        usual: suggested,
        help: "the manual says mL per revolution, or divide its flow by its speed: 50 mL/min at 100 r/min is 0.5mL; \
               `dose pumps list --catalogue` lists heads by name, as masterflex-ls-16; a pump file ends in .toml; \
               `drawing` asks for the dimensions of a head that you built",
    };
    course.at = Some(Topic::Head);
    let before = course.answers.clone();
    let named = course.asker.ask(&question, |answer| {
        let named = named(answer)?;
        if let Named::Head(head) = &named {
            with_head(&before, head).check().map_err(|error| advice::told(&error))?;
        }
        Ok(named)
    })?;
    match named {
        Named::Drawing => ask_drawing(course, None),
        Named::Head(head) => Ok(course.take_answered(Topic::Head, with_head(&before, &head))?),
    }
}

/// The answers with another head.
fn with_head(answers: &Answers, head: &HeadAnswer) -> Answers {
    let mut answers = answers.clone();
    answers.head = Some(head.clone());
    answers
}

/// Reads a head: a volume, a name, a file, or the word `drawing`.
fn named(answer: &str) -> Result<Named, String> {
    if answer == "drawing" {
        return Ok(Named::Drawing);
    }
    let is_volume = answer.ends_with("/rev") && answer.starts_with(|c: char| c.is_ascii_digit() || c == '.');
    if !is_volume && (answer.ends_with(".toml") || answer.contains('/')) {
        let path = std::path::absolute(answer).map_err(|error| error.to_string())?;
        pump_bench::PumpFile::read(&path).map_err(|error| advice::told(&error))?;
        return Ok(Named::Head(HeadAnswer::File(path)));
    }
    if bought_head(answer).is_some() {
        return Ok(Named::Head(HeadAnswer::Catalogue(answer.to_owned())));
    }
    if answer.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        let bare = answer.trim_end_matches("/rev").trim_end_matches(" per revolution");
        let volume = units::volume_ml(bare).map_err(|error| error.to_string())?;
        return Ok(Named::Head(HeadAnswer::Volume { ml_per_rev: volume }));
    }
    let nearest = pump_bench::heads::nearest_heads(answer).join(", ");
    Err(format!(
        "no head of the catalogue is `{answer}`; the nearest are {nearest}; any other head is known by its mL per \
         revolution, as 0.5mL"
    ))
}

fn ask_bore(course: &mut Course) -> Asked<()> {
    let bore = |other: &Answers| {
        other.tube_bore_mm.filter(|bore_mm| *bore_mm > 0.0).map(|bore_mm| format!("{bore_mm}mm"))
    };
    let question = Question {
        text: "Bore of the tube (inner diameter), or `unknown`",
        option: "--bore 1.6mm beside --ml-per-rev",
        usual: course.former(bore).or_else(|| course.suggested_of_head(bore, Some("unknown"))),
        help: "it is printed on the tube's bag, as 1.6mm; pumps with wide tubes differ less from one another, so it \
               tells how sure doses are before the first weighing",
    };
    course.settle(Topic::Bore, &question, length_or_unknown, |answers, mm| answers.tube_bore_mm = Some(mm))
}

/// Reads a length, mm, or 0 for one that nobody knows.
pub(super) fn length_or_unknown(answer: &str) -> Result<f64, String> {
    match answer {
        "unknown" => Ok(0.0),
        answer => units::length_mm(answer).map_err(|error| error.to_string()),
    }
}

fn ask_rollers(course: &mut Course) -> Asked<()> {
    let rollers = |other: &Answers| other.rollers.map(|rollers| rollers.to_string());
    let usual = course.former(rollers).or_else(|| course.suggested_of_head(rollers, None));
    course.settle(Topic::Rollers, &rollers_question(usual), count, |answers, rollers| {
        answers.rollers = Some(rollers);
    })
}

fn rollers_question(usual: Option<Usual>) -> Question<'static> {
    Question {
        text: "Rollers, counted",
        option: "--rollers 4",
        usual,
        help: "open the head and count the rollers that squeeze the tube, as 4",
    }
}

fn count(answer: &str) -> Result<u32, String> {
    units::count("number of rollers", units::ROLLERS)(answer).map_err(|error| error.to_string())
}

/// Asks for the rollers and the dimensions of a drawing until they contradict one another no more: any of them may be
/// the wrong one. Those of before are suggested. `drawn` is a drawing whose rollers alone are missing.
fn ask_drawing(course: &mut Course, mut drawn: Option<HeadAnswer>) -> Asked<()> {
    let mut former = course.earlier().find_map(|before| before.head.clone());
    let mut suggested = course.former(|before| before.rollers.map(|rollers| rollers.to_string()));
    let mut rollers = course.answers.rollers;
    if drawn.is_none() {
        tell_person("Dimensions as a caliper gives them; `dose pumps new -h` says more of each.");
    }
    loop {
        let counted = match rollers.take() {
            Some(counted) => counted,
            None => {
                course.at = Some(Topic::Rollers);
                let mut without_head = course.answers.clone();
                without_head.head = None;
                let counted = course.asker.ask(&rollers_question(suggested), |answer| {
                    let counted = count(answer)?;
                    without_head.rollers = Some(counted);
                    without_head.check().map_err(|error| advice::told(&error))?;
                    Ok(counted)
                });
                match counted {
                    // The word `drawing` is on record with its dimensions only.
                    Err(Stop::Back) if course.answers.head.is_none() => return ask_head(course),
                    counted => counted?,
                }
            }
        };
        let mut answers = course.answers.clone();
        answers.rollers = Some(counted);
        if answers.head.is_none() {
            // The rollers are on record before the next question.
            course.take_answered(Topic::Rollers, answers.clone())?;
        }
        suggested = Some(Usual::new(counted.to_string()));
        let head = match drawn.take() {
            Some(head) => head,
            None => match ask_dimensions(course, former.as_ref()) {
                Err(Stop::Back) => {
                    let mut answers = course.answers.clone();
                    Topic::Rollers.forget(&mut answers);
                    course.take(answers)?;
                    continue;
                }
                head => head?,
            },
        };
        answers.head = Some(head.clone());
        match answers.check() {
            Ok(()) => {
                if !course.asker.is_silent() {
                    answers.asked.insert(Topic::Rollers);
                }
                return Ok(course.take_answered(Topic::Head, answers)?);
            }
            Err(error) if course.asker.is_silent() => return Err(Failure::of(error).into()),
            Err(error) => {
                tell_person(&format!("  {}; Enter keeps a dimension that is right", advice::told(&error)));
            }
        }
        former = Some(head);
    }
}

/// Question for a dimension of a drawing, or for two.
struct Dimension {
    text: &'static str,
    option: &'static str,
    help: &'static str,
    read: fn(&str) -> Result<[f64; 2], String>,
}

const DIMENSIONS: [Dimension; 5] = [
    Dimension {
        text: "Radius of the backplate (raceway)",
        option: "--backplate 63mm",
        help: "from the shaft to the surface on which the tube lies, as 63mm: half of the bed's inner diameter",
        read: length,
    },
    Dimension {
        text: "Radius of a roller",
        option: "--roller 20mm",
        help: "half of the roller's diameter, as 20mm",
        read: length,
    },
    Dimension {
        text: "From the shaft to a roller's axis",
        option: "--offset 40mm",
        help: "measure from the shaft's middle to that of a roller's pin, as 40mm; or half of the width over two \
               opposite rollers, less the radius of a roller",
        read: length,
    },
    Dimension {
        text: "Tube, bore x outer diameter",
        option: "--tube 10x14mm",
        help: "both are printed on the tube's bag, as 1.6x4.8mm: the bore, and the bore with two walls",
        read: |answer| {
            let tube = units::tube_size(answer).map_err(|error| error.to_string())?;
            Ok([tube.bore_mm, tube.outer_mm])
        },
    },
    Dimension {
        text: "Contact angle",
        option: "--contact 30deg",
        help: "the backplate spans 180deg and twice this angle: 30deg for a bed of 240deg, -20deg for one of 140deg",
        read: |answer| {
            let contact_rad = units::angle_rad(answer).map_err(|error| error.to_string())?;
            // Degrees as they were typed, without the rounding on the way over radians.
            Ok([contact_in_deg(contact_rad), 0.0])
        },
    },
];

fn length(answer: &str) -> Result<[f64; 2], String> {
    Ok([units::length_mm(answer).map_err(|error| error.to_string())?, 0.0])
}

/// Asks for the dimensions of a drawing. Those of `former` are suggested.
fn ask_dimensions(course: &mut Course, former: Option<&HeadAnswer>) -> Asked<HeadAnswer> {
    let mut suggested = match former {
        Some(HeadAnswer::Drawing { bore_mm, outer_mm, backplate_mm, roller_mm, offset_mm, contact_deg }) => {
            let [backplate, roller, offset] =
                [backplate_mm, roller_mm, offset_mm].map(|mm| format!("{mm}mm"));
            let (tube, contact) = (format!("{bore_mm}x{outer_mm}mm"), format!("{contact_deg}deg"));
            [backplate, roller, offset, tube, contact].map(Some)
        }
        _ => [const { None }; 5],
    };
    let mut found = [[0.0; 2]; 5];
    let mut at = 0;
    while let (Some(dimension), Some(usual), Some(value)) =
        (DIMENSIONS.get(at), suggested.get_mut(at), found.get_mut(at))
    {
        let Dimension { text, option, help, read } = dimension;
        let question = Question { text, option, usual: usual.clone().map(Usual::new), help };
        let asked = course.asker.ask(&question, |answer| Ok((read(answer)?, answer.to_owned())));
        match asked {
            Ok((read, typed)) => {
                (*value, *usual) = (read, Some(typed));
                at += 1;
            }
            Err(Stop::Back) if at > 0 => at -= 1,
            Err(stop) => return Err(stop),
        }
    }
    let [[backplate_mm, _], [roller_mm, _], [offset_mm, _], [bore_mm, outer_mm], [contact_deg, _]] = found;
    Ok(HeadAnswer::Drawing { bore_mm, outer_mm, backplate_mm, roller_mm, offset_mm, contact_deg })
}

/// Says what the catalogue knows of the head.
fn tell_of_head(course: &Course) {
    if let Ok(Some(head)) = course.answers.catalogued()
        && course.answers.done.written.is_none()
    {
        let rollers = head.rollers.map_or(String::new(), |rollers| format!(", {rollers} rollers"));
        tell_person(&format!("  {} {}, {}: {}{rollers}", head.maker, head.head, head.tubing, head.published));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_volume_is_read_as_a_data_sheet_writes_it() {
        for text in ["0.5mL", "0.5mL/rev", "0.5 mL per revolution"] {
            let read = named(text);
            assert!(
                matches!(read, Ok(Named::Head(HeadAnswer::Volume { ml_per_rev })) if ml_per_rev == 0.5),
                "{text}"
            );
        }
        assert!(matches!(named("no/such/pump.toml"), Err(message) if message.contains("no/such/pump.toml")));
    }
}
