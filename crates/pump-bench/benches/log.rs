//! The cost of a log of 100,000 doses, beside serde_json alone on the same lines in the same run, and its peak memory.
//!
//! Run it with `cargo bench -p pump-bench --bench log`. Each round lists the log to a sink and parses it by turns, so a
//! slow spell of the machine slows both. The peak memory is `VmHWM` of /proc/self/status after the kernel was told to
//! forget the last one. A bound that is missed fails the run.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a benchmark may panic, and prints its result")]

use std::fs;
use std::hint::black_box;
use std::io::{self, BufRead, BufReader, BufWriter, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use pump_bench::record::LogLine;
use pump_bench::report::{LogTotals, log_text};
use pump_bench::{Bench, DoseRequest, built_in};

/// Numbers of doses, the second as the goal names it.
const DOSES: [u64; 2] = [10_000, 100_000];

/// Longest time for the larger log, in s.
const MOST_S: f64 = 1.0;

/// Largest ratio to serde_json alone.
const MOST_RATIO: f64 = 3.0;

/// Largest difference of the peak memories of both logs, in kB.
const MOST_KB: i64 = 1024;

const ROUNDS: usize = 5;

fn main() {
    let logs = DOSES.map(Log::of);
    let mut times = Vec::new();
    for _ in 0..ROUNDS {
        let log = &logs[1];
        times.push([
            seconds(|| assert_eq!(log.read(), DOSES[1])),
            seconds(|| assert_eq!(log.parse(), DOSES[1])),
        ]);
    }
    let ours_s = median(times.iter().map(|[ours, _]| *ours).collect());
    let ratio = median(times.iter().map(|[ours, peer]| ours / peer).collect());
    println!("log of {} doses: {ours_s:.3} s, {ratio:.2} times serde_json alone", DOSES[1]);
    let mut is_met = verdict("time", ours_s <= MOST_S, &format!("at most {MOST_S} s"));
    is_met &= verdict("ratio", ratio <= MOST_RATIO, &format!("at most {MOST_RATIO}"));
    let [small, large] = [&logs[0], &logs[1]].map(|log| peak_kb(|| assert!(log.read() > 0)));
    if let Some((small, large)) = small.zip(large) {
        println!("peak memory: {small} kB more for {} doses, {large} kB more for {}", DOSES[0], DOSES[1]);
        is_met &= verdict("memory", large - small <= MOST_KB, &format!("at most {MOST_KB} kB apart"));
    }
    assert!(is_met, "a bound was missed");
}

fn verdict(what: &str, is_met: bool, bound: &str) -> bool {
    println!("{what}: {bound}; {}", if is_met { "met" } else { "missed" });
    is_met
}

fn seconds(act: impl FnOnce()) -> f64 {
    let began = Instant::now();
    act();
    began.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Returns the memory by which the peak exceeds that before, in kB. `None` where the system does not tell.
fn peak_kb(act: impl FnOnce()) -> Option<i64> {
    let status = |key: &str| {
        let text = fs::read_to_string("/proc/self/status").ok()?;
        let line = text.lines().find_map(|line| line.strip_prefix(key))?.to_owned();
        line.trim().trim_end_matches(" kB").parse::<i64>().ok()
    };
    // 5 resets the peak (Linux, Documentation/filesystems/proc.rst).
    fs::write("/proc/self/clear_refs", "5").ok()?;
    let before = status("VmRSS:")?;
    act();
    Some(status("VmHWM:")? - before)
}

/// Log with so many doses.
struct Log {
    bench: Bench,
    folder: tempfile::TempDir,
}

impl Log {
    /// Makes a dose, and writes its line so many times, each with its own number.
    fn of(doses: u64) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let bench = Bench::new(built_in("three-roller").unwrap(), None, folder.path()).unwrap();
        {
            let mut session = bench.session().unwrap();
            let prepared = session.prepare(DoseRequest::dose(0.1).with_asked("0.1 mL")).unwrap();
            session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
        }
        let log = Self { bench, folder };
        let line = fs::read_to_string(log.path()).unwrap();
        let (_, entry) = line.trim_end().split_once(r#""entry":{"number":1,"#).unwrap();
        let mut file = BufWriter::new(fs::File::create(log.path()).unwrap());
        for number in 1..=doses {
            let entry = format!(r#"{{"number":{number},{}"#, entry.strip_suffix('}').unwrap());
            writeln!(file, r#"{{"crc32":"{:08x}","entry":{entry}}}"#, crc32(entry.as_bytes())).unwrap();
        }
        file.flush().unwrap();
        log
    }

    fn path(&self) -> std::path::PathBuf {
        Path::new(self.folder.path()).join("three-roller/sim/log.jsonl")
    }

    /// Lists the log as `dose log` does, rows and totals, to a sink. Returns the number of doses.
    fn read(&self) -> u64 {
        let (mut to, mut totals, mut doses) = (BufWriter::new(io::sink()), LogTotals::default(), 0);
        for line in self.bench.log().unwrap().map(Result::unwrap) {
            let LogLine::Dose(entry) = line else { continue };
            totals.add(&entry, false);
            writeln!(to, "{}", log_text(&self.bench.file().fluid, &entry, false)).unwrap();
            doses += 1;
        }
        black_box(totals.text());
        doses
    }

    /// Reads the lines by serde_json alone. Returns their number.
    fn parse(&self) -> u64 {
        let lines = BufReader::new(fs::File::open(self.path()).unwrap()).lines();
        lines.fold(0, |count, line| {
            black_box(serde_json::from_str::<serde_json::Value>(&line.unwrap()).unwrap());
            count + 1
        })
    }
}

/// Returns the checksum of a line (CRC-32 of IEEE 802.3, reflected).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}
