//! The cost of `dose serve` with 50 simulated pumps: processor time, memory, and the delay of events to a watcher.
//!
//! `cargo bench --features serve --bench serve` moves all of them at real pace for half a minute, then has each dose
//! once an hour of a day in fast time. `quick` makes a tenth of it, as a check that the measurement runs. It reads
//! /proc, so it is for Linux.

#![allow(clippy::print_stdout, reason = "a table is printed")]

mod processes;
mod service;
mod watcher;

use std::error::Error;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::json;

use processes::Family;
use service::Service;
use watcher::Watcher;

/// Pumps that move at a time.
const PUMPS: usize = 50;

/// Time from one word of an input to its next.
const APART: Duration = Duration::from_millis(50);

/// Goals: share of one core, memory in MB, delay in ms.
const MOST_SHARE: f64 = 0.20;
const MOST_MB: f64 = 100.0;
const MOST_MS: f64 = 100.0;

/// Doses of a pump in a day, one an hour.
const DOSES: usize = 24;

fn main() -> Result<(), Box<dyn Error>> {
    let quick = std::env::args().any(|argument| argument == "quick");
    let (window, doses) = if quick { (Duration::from_secs(3), 2) } else { (Duration::from_secs(30), DOSES) };
    println!("{PUMPS} simulated pumps at real pace, {} s:\n", window.as_secs());
    at_real_pace(window)?;
    println!("\n{PUMPS} simulated pumps in fast time, {doses} doses each:\n");
    a_day(doses)
}

/// Moves every pump at real pace.
fn at_real_pace(window: Duration) -> Result<(), Box<dyn Error>> {
    let service = Service::begin(PUMPS, "real")?;
    for pump in 0..PUMPS {
        service.post(
            &format!("/api/v1/pumps/p{pump}/dose"),
            &json!({"volume": "400mL", "options": {"rate": "1mL/s"}}),
        )?;
    }
    let watcher = Watcher::begin(service.address())?;
    let [family, alone] = [Family::of(service.process()), Family::alone(service.process())];
    let (begun, before_s, alone_before_s) = (Instant::now(), family.processor_s()?, alone.processor_s()?);
    let mut told = Vec::new();
    while begun.elapsed() < window {
        let reason = format!("word {}", told.len());
        told.push(Instant::now());
        service.post("/api/v1/inputs/spare", &json!({"ok": false, "reason": reason}))?;
        sleep(APART);
    }
    let took_s = begun.elapsed().as_secs_f64();
    let share = (family.processor_s()? - before_s) / took_s;
    let of_service = (alone.processor_s()? - alone_before_s) / took_s;
    let (memory_mb, of_service_mb) = (family.memory_mb()?, alone.memory_mb()?);
    println!("{} processes: the service and one for each motion", family.count());
    let heard = watcher.end();
    let [words, progress] = [heard.delays_of_words_ms(&told), heard.delays_of_progress_ms()];
    verdict("share of one core", 100.0 * share, 100.0 * MOST_SHARE, "%");
    println!("  of which the service has {:.1} %", 100.0 * of_service);
    verdict("memory of all processes (PSS)", memory_mb, MOST_MB, "MB");
    println!("  of which the service has {of_service_mb:.1} MB");
    for (what, delays_ms) in [
        ("from an input's word over HTTP to the watcher", words),
        ("progress, later than the soonest line of its pump", progress),
    ] {
        println!("  {what}: {} events", delays_ms.len());
        verdict("    half of them within", part(&delays_ms, 0.50), MOST_MS, "ms");
        verdict("    99 % of them within", part(&delays_ms, 0.99), MOST_MS, "ms");
    }
    service.post("/api/v1/stop", &json!({}))?;
    service.end()
}

/// Has every pump dose again and again in fast time, with a watcher, and tells the growth of the service.
fn a_day(doses: usize) -> Result<(), Box<dyn Error>> {
    let service = Service::begin(PUMPS, "fast")?;
    let watcher = Watcher::begin(service.address())?;
    let memory_mb = || Family::alone(service.process()).memory_mb();
    let round = || -> Result<(), Box<dyn Error>> {
        for pump in 0..PUMPS {
            service.dose_to_its_end(&format!("p{pump}"))?;
        }
        Ok(())
    };
    round()?;
    let first_mb = memory_mb()?;
    for _ in 1..doses {
        round()?;
    }
    let last_mb = memory_mb()?;
    watcher.end();
    println!("memory of the service after the first {PUMPS} doses: {first_mb:.1} MB");
    verdict(&format!("memory of the service after {} doses", PUMPS * doses), last_mb, MOST_MB, "MB");
    service.end()
}

/// Returns the value below which this part of the values is. Infinite without values, so that nothing seems met.
fn part(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (part * sorted.len() as f64).ceil() as usize;
    sorted.get(place.saturating_sub(1)).copied().unwrap_or(f64::INFINITY)
}

fn verdict(what: &str, value: f64, most: f64, unit: &str) {
    let word = if value <= most { "met" } else { "missed" };
    println!("{what}: {value:.1} {unit}, at most {most:.0} {unit}: {word}");
}
