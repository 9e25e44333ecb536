//! The rows of a log, one a dose.

use serde::Serialize;

use crate::numbers::{microlitres, significant};
use crate::pump_file::FluidTable;
use crate::record::{LogEnd, LogEntry, Purpose, ShortText, Stamp};

/// Header of the table of which [`log_csv`] writes the rows.
pub const LOG_CSV_HEADER: &str = "number,time,purpose,asked,requested_ml,delivered_ml,delivered_least_ml,\
    delivered_most_ml,expanded_uncertainty_ml,carry_ml,end,cause,resumed,tube,calibration,steps,motion_s,rack,\
    clock_went_back,fluid,temperature_degc,pump,driver,order";

/// Words a dose for people, in one line without its end. `went_back` is true if its time is before that of the dose
/// before it. The fluid is said where it is not `own`, the pump file's.
pub fn log_text(own: &FluidTable, entry: &LogEntry, went_back: bool) -> String {
    let asked = match &entry.asked {
        Some(asked) => asked.as_str().to_owned(),
        None if entry.purpose == Purpose::Jog => "to the index".to_owned(),
        None if entry.until_stopped => "until stopped".to_owned(),
        None => format!("{} mL", significant(entry.requested_ml, 6)),
    };
    let unsure =
        entry.expanded_uncertainty_ml.map_or(String::new(), |ml| format!(" ± {}", significant(ml, 2)));
    let volume = match entry.delivered_range_ml {
        Some((least_ml, most_ml)) => {
            let unsure = if unsure.is_empty() { unsure } else { format!(" ({} mL)", unsure.trim_start()) };
            format!("{least_ml:.4} to {most_ml:.4} mL{unsure}")
        }
        None => format!("{:.4}{unsure} mL", entry.delivered_ml),
    };
    let end = entry.end.told(entry.cause.as_deref());
    let rack = entry.rack.map_or(String::new(), |rack| format!(", rack {}", rack.as_str()));
    let clock = if went_back { "; the clock had gone back" } else { "" };
    let rest = if entry.resumed { ", the rest of a dose" } else { "" };
    let calibration = match entry.calibration {
        Some(version) => format!(", calibration {version}"),
        // A turn to the index is to deliver nothing, so no calibration counts for it.
        None if entry.purpose == Purpose::Jog => String::new(),
        None => ", no calibration".to_owned(),
    };
    let other = entry.fluid.filter(|fluid| !fluid.is_of(own));
    let fluid = other.map_or(String::new(), |fluid| format!(", {fluid}"));
    format!(
        "{:>6}  {}  {:<9}  {asked:>10}  {volume:>20}  carry {:>9}  tube {}{calibration}{fluid}{rack}; \
         {end}{rest}{clock}",
        entry.number,
        entry.time,
        entry.purpose,
        microlitres(entry.carry_ml),
        entry.tube,
    )
}

/// Returns the volume that was asked for, in mL. `None` for a run until it is stopped and for a turn to the index,
/// which nobody asked a volume of.
fn requested_ml(entry: &LogEntry) -> Option<f64> {
    Some(entry.requested_ml).filter(|_| !entry.until_stopped && entry.purpose != Purpose::Jog)
}

/// Writes a dose of `pump` by `driver` as a row of CSV without its end. A cell is empty where nobody knows the value.
/// `went_back` is true if its time is before that of the dose before it.
pub fn log_csv(pump: &str, driver: &str, entry: &LogEntry, went_back: bool) -> String {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let (least_ml, most_ml) = entry.delivered_range_ml.unzip();
    [
        entry.number.to_string(),
        entry.time.to_string(),
        entry.purpose.to_string(),
        quoted(entry.asked.as_ref().map_or("", |asked| asked.as_str())),
        number(requested_ml(entry)),
        entry.delivered_ml.to_string(),
        number(least_ml),
        number(most_ml),
        number(entry.expanded_uncertainty_ml),
        entry.carry_ml.to_string(),
        entry.end.to_string(),
        quoted(entry.cause.as_deref().unwrap_or("")),
        entry.resumed.to_string(),
        entry.tube.to_string(),
        entry.calibration.map_or(String::new(), |version| version.to_string()),
        entry.steps.map_or(String::new(), |steps| steps.to_string()),
        number(entry.motion_s),
        quoted(entry.rack.as_ref().map_or("", |rack| rack.as_str())),
        went_back.to_string(),
        quoted(entry.fluid.as_ref().map_or("", |fluid| fluid.name.as_str())),
        number(entry.fluid.map(|fluid| fluid.temperature_degc)),
        quoted(pump),
        quoted(driver),
        quoted(entry.order.as_ref().map_or("", |order| order.as_str())),
    ]
    .join(",")
}

/// Writes a dose of `pump` by `driver` as one line of JSON (`schema` `log/1`), without its end. `went_back` is true if
/// its time is before that of the dose before it.
pub fn log_json(pump: &str, driver: &str, entry: &LogEntry, went_back: bool) -> String {
    let (least_ml, most_ml) = entry.delivered_range_ml.unzip();
    let object = Object {
        asked: &entry.asked,
        calibration: entry.calibration,
        carry_ml: entry.carry_ml,
        cause: entry.cause.as_deref(),
        clock_went_back: went_back,
        delivered_least_ml: least_ml,
        delivered_ml: entry.delivered_ml,
        delivered_most_ml: most_ml,
        driver,
        end: entry.end,
        expanded_uncertainty_ml: entry.expanded_uncertainty_ml,
        fluid: entry.fluid.map(|fluid| fluid.name),
        motion_s: entry.motion_s,
        number: entry.number,
        order: &entry.order,
        pump,
        purpose: entry.purpose,
        rack: &entry.rack,
        requested_ml: requested_ml(entry),
        resumed: entry.resumed,
        schema: "log/1",
        steps: entry.steps,
        temperature_degc: entry.fluid.map(|fluid| fluid.temperature_degc),
        time: entry.time,
        tube: entry.tube,
    };
    serde_json::to_string(&object).unwrap_or_default()
}

/// Dose as an object of JSON. It is written without a map between, for the logs of years.
#[derive(Serialize)]
struct Object<'a> {
    asked: &'a Option<ShortText>,
    calibration: Option<u32>,
    carry_ml: f64,
    cause: Option<&'a str>,
    clock_went_back: bool,
    delivered_least_ml: Option<f64>,
    delivered_ml: f64,
    delivered_most_ml: Option<f64>,
    driver: &'a str,
    end: LogEnd,
    expanded_uncertainty_ml: Option<f64>,
    fluid: Option<ShortText>,
    motion_s: Option<f64>,
    number: u64,
    order: &'a Option<ShortText>,
    pump: &'a str,
    purpose: Purpose,
    rack: &'a Option<ShortText>,
    requested_ml: Option<f64>,
    resumed: bool,
    schema: &'static str,
    steps: Option<i64>,
    temperature_degc: Option<f64>,
    time: Stamp,
    tube: u32,
}

/// Quotes a text for CSV where it needs it (RFC 4180, 2.6 and 2.7).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::DosedFluid;

    fn own() -> FluidTable {
        crate::built_in("three-roller").unwrap().fluid
    }

    /// Returns the line of a dose of a pump for `own`.
    fn line(entry: &LogEntry) -> String {
        log_text(&own(), entry, false)
    }

    fn entry() -> LogEntry {
        LogEntry {
            time: Stamp::new(1_795_400_100, 3600),
            asked: Some(ShortText::new("25 mL")),
            requested_ml: 25.0,
            delivered_ml: 25.0004,
            expanded_uncertainty_ml: Some(0.125),
            carry_ml: -0.0004,
            end: LogEnd::Fault,
            cause: Some("the board said \"no\", then nothing".to_owned()),
            tube: 2,
            calibration: Some(3),
            steps: Some(27_284),
            motion_s: None,
            fluid: Some(DosedFluid::of(&own())),
            ..LogEntry::example(7, 0)
        }
    }

    #[test]
    fn a_row_quotes_what_would_break_the_table_and_has_a_cell_for_each_column() {
        assert_eq!(
            log_csv("tank", "grbl", &entry(), false),
            "7,2026-11-23T03:15:00+01:00,dose,25 mL,25,25.0004,,,0.125,-0.0004,fault,\"the board said \"\"no\"\", then \
             nothing\",false,2,3,27284,,,false,water,25,tank,grbl,"
        );
        assert_eq!(LOG_CSV_HEADER.split(',').count(), 24);
        let endless = LogEntry { cause: None, until_stopped: true, ..entry() };
        let row = log_csv("tank", "grbl", &endless, true);
        let cells: Vec<&str> = row.split(',').collect();
        assert_eq!((cells.len(), cells[4], cells[18]), (24, "", "true"), "{row}");
        let object: serde_json::Value =
            serde_json::from_str(&log_json("tank", "grbl", &endless, true)).unwrap();
        assert!(object["requested_ml"].is_null() && object["clock_went_back"] == true, "{object}");
    }

    #[test]
    fn a_line_says_who_stopped_the_dose() {
        let fault = line(&entry());
        assert!(fault.contains("25.0004 ± 0.12 mL") && fault.contains("tube 2, calibration 3;"), "{fault}");
        assert!(fault.ends_with("ended by a fault (the board said \"no\", then nothing)"), "{fault}");
        let stopped = LogEntry {
            end: LogEnd::Stopped,
            cause: Some("SIGTERM".to_owned()),
            rack: Some(ShortText::new("mix")),
            ..entry()
        };
        assert!(line(&stopped).ends_with("calibration 3, rack mix; stopped by SIGTERM"));
        let cut =
            LogEntry { delivered_range_ml: Some((1.0, 2.0)), end: LogEnd::CutOff, cause: None, ..entry() };
        assert!(line(&cut).contains("1.0000 to 2.0000 mL (± 0.12 mL)"), "{}", line(&cut));
        let index = LogEntry { purpose: Purpose::Jog, calibration: None, asked: None, ..entry() };
        assert!(
            line(&index).contains("to the index") && line(&index).contains("tube 2; "),
            "{}",
            line(&index)
        );
        let rest = LogEntry { resumed: true, ..cut };
        assert!(line(&rest).ends_with("the process ended, the rest of a dose"));
    }

    #[test]
    fn a_line_names_the_fluid_where_it_is_not_the_pump_files() {
        let glycerol = own().changed_to(Some("glycerol 60%"), Some(22.0)).unwrap();
        let fluid = Some(DosedFluid::of(&glycerol));
        let other = line(&LogEntry { fluid, ..entry() });
        assert!(other.contains("calibration 3, glycerol 60% at 22 °C; "), "{other}");
        assert!(!line(&entry()).contains("water"));
        assert!(!line(&LogEntry { fluid: None, ..entry() }).contains("°C"));
    }
}
