//! The print of a pump's head: an angle on record is the angle of one head.

use crate::notice::{Notice, Remedy};
use crate::numbers::significant;
use crate::pump_file::PumpFile;
use crate::record::Story;

/// Tables of a pump file that say which head it is.
const TABLES: [&str; 3] = ["head", "rollers", "backplate"];

/// Keys that count of tables with others beside them: what a turn of a bought head delivers is measured better and
/// better, and the head stays.
const KEYS: [(&str, &[&str]); 1] = [("head", &["catalogue"])];

/// Returns the print of a pump's head: a number that changes with the rollers, the backplate and the row of the
/// catalogue. The record of a bench keeps it, so that the angle of another head is not taken for this one's.
///
/// ```
/// use pump_bench::{built_in, head_print};
///
/// let head = built_in("three-roller").unwrap();
/// let mut other = head.clone();
/// other.pump.default_rate_ml_s = 5.0;
/// assert_eq!(head_print(&head), head_print(&other));
/// other.rollers.count = 4;
/// assert_ne!(head_print(&head), head_print(&other));
/// ```
pub fn head_print(file: &PumpFile) -> u32 {
    print_of(file, &TABLES, &KEYS)
}

/// Returns a note of each change of the pump file since the last motion on record that the record does not survive as
/// it is.
pub(in crate::bench) fn changes_of_file(file: &PumpFile, story: &Story) -> impl Iterator<Item = Notice> {
    let other_head = story.other_head.then(|| other_head(file));
    let is_of_others = story.other_steps && other_head.is_none();
    let other_steps = story
        .state
        .filter(|_| is_of_others)
        .map(|state| other_steps(file, Remedy::finding_angle(state.unfinished.is_some())));
    let other_volumes = story.other_volumes.map(other_volumes);
    [other_head, other_steps, other_volumes].into_iter().flatten()
}

/// Returns the note that the record is of another head than the pump file's.
fn other_head(file: &PumpFile) -> Notice {
    let (pump, rollers) = (&file.pump.id, file.rollers.count);
    let text = format!(
        "the record of {pump} is of another head than this one with {rollers} rollers, so the angle of the rollers is \
         unknown and nothing is carried"
    );
    Notice::from(text).with_remedy(Remedy::FindAngle)
}

/// Returns the note that the motions on record were of a motor with other steps than the pump file's, or of one that
/// turned the other way.
fn other_steps(file: &PumpFile, find_angle: Remedy) -> Notice {
    let (pump, steps) = (&file.pump.id, file.motor.steps_at_pump_head());
    let text = format!(
        "the motor of {pump} has {} steps per revolution of the head by its file now, and its record counts by another \
         number or in the other direction, so the angle of the rollers is unknown and nothing is carried",
        significant(steps, 9)
    );
    Notice::from(text).with_remedy(find_angle)
}

/// Returns the note that the pump file gives another volume of a revolution than when the unfinished dose was begun, in
/// mL, then and now.
fn other_volumes((then_ml, now_ml): (f64, f64)) -> Notice {
    let [then_ml, now_ml] = [then_ml, now_ml].map(|ml| significant(ml, 6));
    format!(
        "the pump file gives {now_ml} mL per revolution, and gave {then_ml} mL when the unfinished dose was made: what \
         was delivered counts as by the file of then, and a rest is made by the file of now"
    )
    .into()
}

/// Returns a number that changes with every value in `tables` of the pump file. Of a table in `keys` only those keys
/// count.
pub(in crate::bench) fn print_of(file: &PumpFile, tables: &[&str], keys: &[(&str, &[&str])]) -> u32 {
    let mut all = toml::Table::try_from(file)
        .unwrap_or_else(|error| unreachable!("a pump file is plain tables: {error}"));
    all.retain(|table, _| tables.contains(&table));
    for (table, counting) in keys {
        if let Some(toml::Value::Table(keys)) = all.get_mut(*table) {
            keys.retain(|key, _| counting.contains(&key));
        }
    }
    // A table of which no key counts, as a tube that has only a life, counts no more than none.
    all.retain(|_, table| table.as_table().is_none_or(|keys| !keys.is_empty()));
    crc32fast::hash(all.to_string().as_bytes())
}
