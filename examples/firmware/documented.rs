//! The figures that docs/embedding.md states, held against those that the firmware measures.

const DOCS: &str = include_str!("../../docs/embedding.md");

/// Part by which a cost may differ from the stated one. Another compiler counts other instructions.
const TOLERANCE: f64 = 0.1;

/// Rows of the table of costs: the words of the row, words of the firmware's line, and which of its numbers.
const COSTS: [(&str, &str, usize); 15] = [
    ("a plan: angle and profile", "for a plan: ", 1),
    ("its 18 segments", "for a plan: ", 2),
    ("a plan with line-aware ramps", "to plan with line-aware ramps", 0),
    ("a plan with a smooth flow: angle and profile", "with a smooth flow: ", 1),
    ("its 519 segments", "with a smooth flow: ", 2),
    ("pressures and settling time of the dose, exactly (`Plan::predict`)", "for a prediction", 0),
    ("another volume and rate in mid-dose (`Doser::retarget`)", "to plan a change", 0),
    ("its 15 segments", "to plan a change", 1),
    ("the motor's brake, once", "the motor's brake", 0),
    ("a step in `Stepper::on_deadline`, on average", "a step in on_deadline, its call", 0),
    ("a step in `Stepper::on_deadline`, at most", "at most for a step", 0),
    ("the whole interrupt, two pins and the timer included", "for the whole interrupt", 0),
    ("the wait in it for the pulse, 1.9 µs high and low", "a step more of waiting", 0),
    ("`Stepper::stop`", "for a stop", 0),
    ("`Stepper::retarget`", "for a retarget", 0),
];

/// Holds the figures of the documentation against the firmware's lines of cost and memory.
pub(crate) fn check(figures: &[&str]) -> Result<(), String> {
    for (row, words, place) in COSTS {
        let start = format!("| {row} | ");
        let stated = DOCS.lines().find_map(|line| line.strip_prefix(&start)).ok_or(missing(&start))?;
        let stated = numbers(&stated.replace(',', ""));
        let [stated] = stated[..] else { return Err(missing(&start)) };
        let found = number(figures, words, place)?;
        if (found / stated - 1.0).abs() > TOLERANCE {
            return Err(format!("docs/embedding.md states {stated} for {row}, and it costs {found}"));
        }
    }
    let whole = |words, place| number(figures, words, place).map(|bytes| thousands(bytes as u64));
    let kilobytes = |words| number(figures, words, 0).map(|bytes| (bytes / 1000.0).round());
    states(&format!(
        "`Stepper<Q>` takes {} + {} `Q` bytes on a Cortex-M, {} of them for the brake: {} with 64 places.",
        whole("of an executor", 0)?,
        whole("of an executor", 1)?,
        whole("of an executor", 2)?,
        whole("of an executor", 3)?,
    ))?;
    states(&format!(
        "A `Plan` takes {} bytes, its `Segments` {}, a `Pump` {}, a `FlowCurve` {}.",
        whole("of a plan", 0)?,
        whole("of a plan", 1)?,
        whole("of a plan", 2)?,
        whole("of a plan", 3)?,
    ))?;
    states(&format!("The program takes {} kB of flash,", kilobytes("of flash")?))?;
    states(&format!("Its stack is {} kB at its deepest", kilobytes("of stack")?))
}

fn states(sentence: &str) -> Result<(), String> {
    let text: Vec<&str> = DOCS.split_whitespace().collect();
    if text.join(" ").contains(sentence) { Ok(()) } else { Err(missing(sentence)) }
}

fn missing(what: &str) -> String {
    format!("docs/embedding.md must say: {what}")
}

/// Returns a number of the line that has these words.
fn number(figures: &[&str], words: &str, place: usize) -> Result<f64, String> {
    let line = figures.iter().find(|line| line.contains(words)).ok_or(format!("no line says '{words}'"))?;
    numbers(line).get(place).copied().ok_or(format!("too few numbers in\n  {line}"))
}

fn numbers(line: &str) -> Vec<f64> {
    line.split(' ').filter_map(|word| word.trim_end_matches([',', ';', ':']).parse().ok()).collect()
}

/// Writes a number with a comma before each three digits.
fn thousands(number: u64) -> String {
    match number.checked_div(1000).filter(|above| *above > 0) {
        Some(above) => format!("{},{:03}", thousands(above), number % 1000),
        None => number.to_string(),
    }
}
