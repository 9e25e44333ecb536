//! A watcher of the service's events, which notes the time at which each comes.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::thread::{self, JoinHandle};
use std::time::Instant;

use serde_json::Value;

/// Part of a motion, of its steps, in which it goes on at one speed.
const STEADY: std::ops::Range<f64> = 0.01..0.99;

/// A watcher that hears.
pub(crate) struct Watcher {
    stream: TcpStream,
    hearing: JoinHandle<Heard>,
}

/// Events that were heard, with their times.
#[derive(Default)]
pub(crate) struct Heard(Vec<(Instant, String, String)>);

impl Watcher {
    /// Begins to hear.
    pub(crate) fn begin(address: &str) -> std::io::Result<Self> {
        let mut stream = TcpStream::connect(address)?;
        stream.write_all(format!("GET /events HTTP/1.1\r\nhost: {address}\r\n\r\n").as_bytes())?;
        let lines = BufReader::new(stream.try_clone()?).lines();
        let hearing = thread::spawn(move || {
            let (mut heard, mut event) = (Heard::default(), String::new());
            for line in lines.map_while(Result::ok) {
                if let Some(name) = line.strip_prefix("event: ") {
                    event = name.to_owned();
                } else if let Some(data) =
                    line.strip_prefix("data: ").filter(|_| event == "input" || event == "progress")
                {
                    heard.0.push((Instant::now(), event.clone(), data.to_owned()));
                }
            }
            heard
        });
        Ok(Self { stream, hearing })
    }

    /// Ends the connection, and returns what was heard.
    pub(crate) fn end(self) -> Heard {
        // A service that has ended has closed it.
        let _ = self.stream.shutdown(std::net::Shutdown::Both);
        self.hearing.join().unwrap_or_default()
    }
}

impl Heard {
    fn of(&self, event: &str) -> impl Iterator<Item = (Instant, Value)> {
        let of = self.0.iter().filter(move |(_, name, _)| name == event);
        of.filter_map(|(time, _, data)| Some((*time, serde_json::from_str(data).ok()?)))
    }

    /// Returns the times from each word of the input `spare` to its event, in ms. A word without an event is late for
    /// ever.
    pub(crate) fn delays_of_words_ms(&self, told: &[Instant]) -> Vec<f64> {
        let mut heard = BTreeMap::new();
        for (time, input) in self.of("input") {
            let number = input["reason"].as_str().and_then(|reason| reason.rsplit(' ').next()?.parse().ok());
            number.map(|number: usize| heard.entry(number).or_insert(time));
        }
        let delay = |(number, told): (usize, &Instant)| {
            heard.get(&number).map_or(f64::INFINITY, |heard| 1e3 * heard.duration_since(*told).as_secs_f64())
        };
        told.iter().enumerate().map(delay).collect()
    }

    /// Returns by how much each line of progress is later than the soonest one of its pump, in ms: at one speed the
    /// steps that it tells say when it was written.
    pub(crate) fn delays_of_progress_ms(&self) -> Vec<f64> {
        let mut pumps: BTreeMap<String, Vec<(Instant, f64)>> = BTreeMap::new();
        for (time, told) in self.of("progress") {
            if let (Some(name), Some(steps), Some(of_steps)) =
                (told["name"].as_str(), told["steps"].as_f64(), told["of_steps"].as_f64())
                && STEADY.contains(&(steps / of_steps))
            {
                pumps.entry(name.to_owned()).or_default().push((time, steps));
            }
        }
        pumps.into_values().flat_map(later_than_the_soonest_ms).collect()
    }
}

/// Returns by how much each time is later than the soonest one, where the steps go on evenly.
fn later_than_the_soonest_ms(lines: Vec<(Instant, f64)>) -> Vec<f64> {
    let (Some(&(first, from)), Some(&(last, to))) = (lines.first(), lines.last()) else { return Vec::new() };
    let step_s = last.duration_since(first).as_secs_f64() / (to - from).max(1.0);
    let late_s =
        lines.iter().map(|(time, steps)| time.duration_since(first).as_secs_f64() - step_s * (steps - from));
    let late_s: Vec<f64> = late_s.collect();
    let soonest_s = late_s.iter().copied().fold(f64::INFINITY, f64::min);
    late_s.iter().map(|late_s| 1e3 * (late_s - soonest_s)).collect()
}
