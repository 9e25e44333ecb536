//! Claims about a month of doses by cron, in fast time: with clocks that are set, power cuts and full disks, no day
//! goes beyond its limit, and the record loses and doubles nothing.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fs::{self, File};
use std::io;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use pump_bench::record::{Clock, LogEntry, LogLine, Purpose, Stamp, Storage};
use pump_bench::{Bench, Delivered, DoseError, DoseRequest, Session, built_in};
use pump_ctl::plan::Phase;

const HOUR: u64 = 3600;
const DAY: u64 = 24 * HOUR;
const START: u64 = 1_795_400_100;

/// Limit of a day, mL.
const LIMIT_ML: f64 = 50.0;

/// Volume by which a limit may be exceeded by rounding to motor steps, mL: two mean steps of 21.32 mL / 12,800.
const STEPS_ML: f64 = 2.0 * 21.32 / 12_800.0;

/// Clock on the wall, which is set now and then.
#[derive(Debug, Clone)]
struct WallClock(Arc<AtomicU64>);

impl Clock for WallClock {
    fn now(&self) -> Stamp {
        Stamp::new(self.0.load(Ordering::Relaxed), 3600)
    }
}

/// Disk that is full after some entries.
#[derive(Debug)]
struct Disk {
    left: u64,
}

impl Storage for Disk {
    fn sync(&mut self, file: &File) -> io::Result<()> {
        if self.left == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.left -= 1;
        file.sync_data()
    }
}

/// The account that this test keeps by itself, with the true time and what left the pump.
#[derive(Debug, Default)]
struct Account {
    /// True time and volume of each motion, mL.
    pumped: Vec<(u64, f64)>,
    /// True time at which a person cleared the pump last.
    cleared_s: u64,
    /// True time and volume between the bounds of each motion that was cut off, mL.
    unsure: Vec<(u64, f64)>,
    refused: u32,
    cut_off: u32,
    full: u32,
    clears: u32,
}

impl Account {
    /// Adds a motion, and holds the 24 true hours until then against the limit. An angle that is not known exactly
    /// after a power cut makes the volumes of the next two days less sure.
    fn add(&mut self, at_s: u64, volume_ml: f64) {
        self.pumped.push((at_s, volume_ml));
        let counts = |time_s: u64| at_s - time_s < DAY && time_s >= self.cleared_s;
        let day_ml: f64 =
            self.pumped.iter().filter(|(time_s, _)| counts(*time_s)).map(|(_, ml)| ml.abs()).sum();
        let unsure_ml = self.unsure_ml(at_s.saturating_sub(2 * DAY));
        assert!(
            day_ml <= LIMIT_ML + STEPS_ML + unsure_ml + 1e-6,
            "{day_ml} mL in 24 h at hour {}",
            (at_s - START) / HOUR
        );
    }
}

impl Account {
    /// Volume between the bounds of the motions that were cut off since `from_s`, mL.
    fn unsure_ml(&self, from_s: u64) -> f64 {
        self.unsure.iter().filter(|(time_s, _)| *time_s >= from_s).map(|(_, volume_ml)| volume_ml).sum()
    }
}

/// Difference of the clock on the wall from the true time, s.
fn skew_s(hour: u64) -> i64 {
    let ahead = 36 * HOUR as i64;
    match hour {
        // The clock is set back by three hours for a day, and then right again.
        120..144 => ahead - 3 * HOUR as i64,
        // A start without the network: two hours in 1970.
        220..222 => -((START + hour * HOUR) as i64) + (hour as i64 - 219) * HOUR as i64,
        // Somebody plays with it.
        300..330 => ahead - (hour as i64 % 5) * 2 * HOUR as i64,
        // It was ahead by a day and a half from the beginning, and is set right for good.
        500.. => 0,
        _ => ahead,
    }
}

fn doses(bench: &Bench) -> Vec<LogEntry> {
    let read = |line| match line {
        LogLine::Dose(entry) => entry,
        other => panic!("{other:?}"),
    };
    bench.log().unwrap().map(|line| read(line.unwrap())).collect()
}

/// The month of a pump that doses `volume_ml` every hour.
struct Month {
    bench: Bench,
    clock: WallClock,
    journal: PathBuf,
    log: PathBuf,
    account: Account,
    volume_ml: f64,
}

impl Month {
    fn session(&self) -> Session<'_> {
        let mut session = self.bench.session().unwrap();
        session.keep_time_by(Box::new(self.clock.clone()));
        session
    }

    /// One hour: the dose of cron, after the interrupted one if there is one.
    fn hour(&mut self, hour: u64) {
        let true_s = START + hour * HOUR;
        self.clock.0.store(true_s.checked_add_signed(skew_s(hour)).unwrap(), Ordering::Relaxed);
        if hour % 24 == 9 {
            self.person(true_s);
        }
        let bench = self.bench.clone();
        let mut session = bench.session().unwrap();
        session.keep_time_by(Box::new(self.clock.clone()));
        // The disk has no room for the intent, or none for the second stretch of the motion.
        let room = match hour {
            _ if hour % 149 == 88 => Some(0),
            _ if hour % 131 == 57 => Some(3),
            _ => None,
        };
        if let Some(left) = room {
            session.store_by(Box::new(Disk { left }));
        }
        if session.state().is_some_and(|state| state.unfinished.is_some())
            && !self.finishes_what_is_unfinished(&mut session, hour)
        {
            return;
        }
        let purpose = if hour % 50 == 7 { Purpose::Prime } else { Purpose::Dose };
        let before = session.state().map_or(0.0, |state| state.wear.volume_ml);
        let prepared = match session.prepare(DoseRequest::new(purpose, self.volume_ml)) {
            Ok(prepared) => prepared,
            Err(DoseError::Stands { .. }) => {
                assert_eq!(session.state().unwrap().wear.volume_ml, before, "nothing moved");
                self.account.refused += 1;
                return;
            }
            Err(error) => panic!("{error}"),
        };
        let cut_at = (hour % 97 == 13).then_some(prepared.plan.steps().unsigned_abs() / 3);
        let mut left: Option<(u64, Vec<u8>, Option<Vec<u8>>)> = None;
        let ended = session.run(&prepared, |made| match cut_at {
            Some(at) if made >= at => {
                // The power fails here: nothing that is written later was ever written.
                left.get_or_insert_with(|| {
                    (made, fs::read(&self.journal).unwrap(), fs::read(&self.log).ok())
                });
                ControlFlow::Break(())
            }
            _ => ControlFlow::Continue(()),
        });
        drop(session);
        let truth_ml = |made| prepared.plan.delivered_ml(&prepared.model, made);
        match left {
            Some((made, journal, log)) => {
                fs::write(&self.journal, journal).unwrap();
                log.into_iter().for_each(|log| fs::write(&self.log, log).unwrap());
                self.account.cut_off += 1;
                self.ended_early(true_s, truth_ml(made));
            }
            None => self.ended(true_s, ended),
        }
    }

    /// Makes or accepts an interrupted dose. Returns false if it stands in the way still.
    fn finishes_what_is_unfinished(&mut self, session: &mut Session<'_>, hour: u64) -> bool {
        if !hour.is_multiple_of(2) {
            session.accept().unwrap();
            return true;
        }
        match session.prepare_rest(DoseRequest::dose(0.0)) {
            Ok(rest) => {
                if let Ok(made) = session.run(&rest, |_| ControlFlow::Continue(())) {
                    self.account.add(START + hour * HOUR, made.volume_ml);
                }
            }
            Err(DoseError::Stands { .. }) => self.account.refused += 1,
            Err(error) => panic!("{error}"),
        }
        session.state().is_none_or(|state| state.unfinished.is_none())
    }

    /// Adds a motion whose power did not fail. The disk may have been full.
    fn ended(&mut self, true_s: u64, ended: Result<Delivered, DoseError>) {
        match ended {
            Ok(delivered) => self.account.add(true_s, delivered.volume_ml),
            Err(
                DoseError::NotJournalled { delivered_ml, .. } | DoseError::NotRecorded { delivered_ml, .. },
            ) => {
                self.account.full += 1;
                self.ended_early(true_s, delivered_ml);
            }
            // Nothing moved: the intent had no room.
            Err(DoseError::Journal(_)) => self.account.full += 1,
            Err(error) => panic!("{error}"),
        }
    }

    /// Adds an interrupted motion, and holds its volume against the bounds on record.
    fn ended_early(&mut self, true_s: u64, truth_ml: f64) {
        self.account.add(true_s, truth_ml);
        let part = self.session().state().unwrap().unfinished.unwrap();
        let (least_ml, most_ml) = part.delivered_ml(self.bench.model());
        assert!((least_ml - 1e-6..=most_ml + 1e-6).contains(&truth_ml), "{least_ml} {truth_ml} {most_ml}");
        self.account.unsure.push((true_s, most_ml - least_ml));
    }

    /// A person looks at nine, clears a pump that stands, and says the angle if it is not known exactly.
    fn person(&mut self, true_s: u64) {
        let mut session = self.session();
        let cleared = session.clear_safety("looked at it at nine").is_ok();
        let state = session.state().copied();
        if let Some(state) = state.filter(|state| state.unfinished.is_none() && state.half_width_rad > 0.0) {
            session.set_angle(Some(Phase::known(state.angle_rad))).unwrap();
        }
        drop(session);
        if cleared {
            self.account.cleared_s = true_s;
            self.account.clears += 1;
        }
    }
}

fn month(volume_ml: f64) -> Account {
    let folder = tempfile::tempdir().unwrap();
    let mut file = built_in("three-roller").unwrap();
    file.safety.max_ml_per_day = Some(LIMIT_ML);
    let bench = Bench::new(file, None, folder.path()).unwrap();
    let [journal, log] = ["journal.jsonl", "log.jsonl"].map(|name| bench.folder().path().join(name));
    let clock = WallClock(Arc::new(AtomicU64::new(START)));
    let mut month = Month { bench, clock, journal, log, account: Account::default(), volume_ml };
    for hour in 0..30 * 24 {
        month.hour(hour);
    }
    let logged = doses(&month.bench);
    let numbers: Vec<u64> = logged.iter().map(|dose| dose.number).collect();
    assert_eq!(numbers, (1..=logged.len() as u64).collect::<Vec<_>>(), "each once");
    let account = month.account;
    assert_eq!(logged.len(), account.pumped.len(), "each motion has a line");
    let sum = |volumes: &mut dyn Iterator<Item = f64>| volumes.sum::<f64>();
    let (booked_ml, truth_ml) = (
        sum(&mut logged.iter().map(|dose| dose.delivered_ml)),
        sum(&mut account.pumped.iter().map(|(_, volume_ml)| *volume_ml)),
    );
    let rounding_ml = 1e-4 * logged.len() as f64;
    assert!(
        (booked_ml - truth_ml).abs() <= account.unsure_ml(0) + rounding_ml,
        "{booked_ml} {truth_ml} {account:?}"
    );
    assert!(account.cut_off >= 5 && account.full >= 6, "{account:?}");
    account
}

#[test]
fn a_month_within_its_limit_is_refused_only_where_a_clock_was_set() {
    let account = month(2.0);
    let made = account.pumped.len();
    assert!(made > 600 && account.refused < 100, "{made} made, {} refused", account.refused);
}

#[test]
fn a_month_beyond_its_limit_stands_every_day_until_a_person_comes() {
    let account = month(3.0);
    assert!(account.clears >= 25 && account.refused > 150, "{} {}", account.clears, account.refused);
}
