//! The words that set the simulated board.

use std::error::Error;
use std::str::FromStr;
use std::time::Duration;

use crate::simulated::options::{Options, Sensor};

/// Sets the option of the board that `word` names, to the value after it. Returns false for a word that names none.
pub(crate) fn set(
    options: &mut Options,
    word: &str,
    value: &mut dyn FnMut() -> Result<String, String>,
) -> Result<bool, Box<dyn Error>> {
    match word {
        "--axes" => {
            options.axes = value()?.parse()?;
            if !(1..=3).contains(&options.axes) {
                return Err(format!("--axes is {}; allowed: 1 to 3", options.axes).into());
            }
        }
        "--fast" => options.time_scale = value()?.parse()?,
        "--resets" => options.resets_on_open = true,
        "--set" => {
            let text = value()?;
            let (number, value) = text.split_once('=').ok_or("--set needs <number>=<value>")?;
            options.settings.push((number.parse()?, value.parse()?));
        }
        // The board keeps it for as long as the program runs.
        "--info" => options.text = value()?.leak(),
        "--sensor" => options.sensor = Some(Sensor { at: value()?.parse()?, width: 128, every: 12_800 }),
        "--auto-report" => options.auto_report = Some(Duration::from_secs_f64(value()?.parse()?)),
        "--chatter" => options.chatters = true,
        "--press" => options.defects.pressed = Some(pair(&value()?)?),
        "--jog" => options.defects.foreign = Some(pair(&value()?)?),
        "--garble" => options.defects.garbles = Some(pair(&value()?)?),
        "--stretch" => options.defects.stretches = Some(value()?.parse()?),
        "--miss" => {
            let (place, steps) = pair(&value()?)?;
            options.defects.misses = Some((place, steps, place + 500));
        }
        "--misread" => {
            let (number, value) = pair(&value()?.replace('=', ":"))?;
            options.defects.misreads = Some((1, number, value));
        }
        "--firmware" => options.firmware = value()?.parse()?,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Reads two values with a colon between them.
pub(crate) fn pair<A, B>(text: &str) -> Result<(A, B), Box<dyn Error>>
where
    A: FromStr<Err: Error + 'static>,
    B: FromStr<Err: Error + 'static>,
{
    let (one, two) = text.split_once(':').ok_or(format!("{text} needs a colon between two values"))?;
    Ok((one.parse()?, two.parse()?))
}
