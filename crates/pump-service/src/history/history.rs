//! The file of the history.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use rusqlite::{Connection, OptionalExtension, Row, params};
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::error::HistoryError;
use super::record::{EventRecord, Key, OrderRecord, OrderState};
use crate::order::{Order, OrderId, Task};

/// Version of the tables.
const VERSION: i64 = 1;

/// Time for which a key stands for its order.
const KEY_HOLDS: SignedDuration = SignedDuration::from_hours(24);

/// Longest wait for another program that reads the file.
const PATIENCE: Duration = Duration::from_secs(5);

const TABLES: &str = "
CREATE TABLE IF NOT EXISTS orders (
    id TEXT PRIMARY KEY, key TEXT, body TEXT, pump TEXT NOT NULL, asked TEXT NOT NULL, origin TEXT NOT NULL,
    state TEXT NOT NULL, begun TEXT NOT NULL, ended TEXT, code INTEGER,
    reports TEXT NOT NULL DEFAULT '[]', messages TEXT NOT NULL DEFAULT '[]', error TEXT
) STRICT;
CREATE INDEX IF NOT EXISTS orders_by_key ON orders (key) WHERE key IS NOT NULL;
CREATE INDEX IF NOT EXISTS orders_by_time ON orders (begun);
CREATE TABLE IF NOT EXISTS events (
    time TEXT NOT NULL, kind TEXT NOT NULL, pump TEXT, text TEXT NOT NULL
) STRICT;
CREATE INDEX IF NOT EXISTS events_by_time ON events (time);
CREATE TABLE IF NOT EXISTS planned (
    entry TEXT PRIMARY KEY, last TEXT NOT NULL
) STRICT;
CREATE TABLE IF NOT EXISTS words (
    name TEXT PRIMARY KEY, value TEXT NOT NULL
) STRICT;
CREATE TABLE IF NOT EXISTS marks (
    pump TEXT NOT NULL, number INTEGER NOT NULL, weighed INTEGER NOT NULL, accepted TEXT, PRIMARY KEY (pump, number)
) STRICT;
CREATE TABLE IF NOT EXISTS logins (
    mark TEXT NOT NULL UNIQUE, begun TEXT NOT NULL
) STRICT;
";

/// Columns of an order, as [`order`] reads them.
const COLUMNS: &str = "id, pump, asked, origin, state, begun, ended, code, reports, messages, error";

/// The history of a service.
#[derive(Debug)]
pub struct History {
    path: PathBuf,
    file: Mutex<Connection>,
    is_new: bool,
}

impl History {
    /// Opens the history at `path`, or begins one.
    ///
    /// # Errors
    ///
    /// [`HistoryError`] if the file cannot be used, or is of a later version.
    pub fn open(path: &Path) -> Result<Self, HistoryError> {
        let failed = |source| HistoryError::File { path: path.to_owned(), source };
        let file = Connection::open(path).map_err(failed)?;
        file.busy_timeout(PATIENCE).map_err(failed)?;
        file.pragma_update(None, "journal_mode", "WAL").map_err(failed)?;
        // An order is on the disk before its command starts.
        file.pragma_update(None, "synchronous", "FULL").map_err(failed)?;
        let found: i64 = file.query_row("PRAGMA user_version", [], |row| row.get(0)).map_err(failed)?;
        if found > VERSION {
            return Err(HistoryError::Version { path: path.to_owned(), found, known: VERSION });
        }
        file.execute_batch(TABLES).map_err(failed)?;
        file.pragma_update(None, "user_version", VERSION).map_err(failed)?;
        Ok(Self { path: path.to_owned(), file: Mutex::new(file), is_new: found == 0 })
    }

    /// Returns true if there was no history before: the service is new, or its history was lost.
    pub fn is_new(&self) -> bool {
        self.is_new
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Records an order that is about to begin.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if it cannot be recorded. Nothing may move then.
    pub fn begin(
        &self,
        id: &OrderId,
        order: &Order,
        origin: &str,
        key: Option<&Key>,
        now: Timestamp,
    ) -> Result<(), HistoryError> {
        let (text, body) = key.map_or((None, None), |key| (Some(&key.text), Some(&key.body)));
        self.execute(
            "INSERT INTO orders (id, key, body, pump, asked, origin, state, begun) VALUES (?,?,?,?,?,?,?,?)",
            params![
                id.as_str(),
                text,
                body,
                order.pump,
                json(order),
                origin,
                OrderState::Running.word(),
                now.to_string()
            ],
        )
    }

    /// Records how an order ended.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if it cannot be recorded.
    pub fn end(&self, record: &OrderRecord) -> Result<(), HistoryError> {
        self.execute(
            "UPDATE orders SET state = ?, ended = ?, code = ?, reports = ?, messages = ?, error = ? WHERE id = ?",
            params![
                record.state.word(),
                record.ended.map(|time| time.to_string()),
                record.code,
                json(&record.reports),
                json(&record.messages),
                record.error.as_ref().map(json),
                record.id.as_str()
            ],
        )
    }

    /// Records orders that ended before this history began, all of them or none.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if they cannot be recorded.
    pub fn take_over(&self, records: &[OrderRecord]) -> Result<(), HistoryError> {
        self.read(|file| {
            let all = file.unchecked_transaction()?;
            let mut insert = all.prepare(
                "INSERT INTO orders (id, pump, asked, origin, state, begun, ended, messages) VALUES (?,?,?,?,?,?,?,?)",
            )?;
            for record in records {
                insert.execute(params![
                    record.id.as_str(),
                    record.order.pump,
                    json(&record.order),
                    record.origin,
                    record.state.word(),
                    record.begun.to_string(),
                    record.ended.map(|time| time.to_string()),
                    json(&record.messages)
                ])?;
            }
            drop(insert);
            all.commit()
        })
    }

    /// Finds the order of a key that was given in the last 24 hours, with the body of its first use.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read.
    pub fn of_key(&self, key: &str, now: Timestamp) -> Result<Option<(OrderId, String)>, HistoryError> {
        let since = now.checked_sub(KEY_HOLDS).unwrap_or(Timestamp::MIN).to_string();
        self.read(|file| {
            file.query_row(
                "SELECT id, body FROM orders WHERE key = ? AND begun >= ? ORDER BY begun DESC LIMIT 1",
                params![key, since],
                |row| Ok((OrderId::of(&row.get::<_, String>(0)?), row.get(1)?)),
            )
            .optional()
        })
    }

    /// Finds an order by its name.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read.
    pub fn order(&self, id: &OrderId) -> Result<Option<OrderRecord>, HistoryError> {
        let sql = format!("SELECT {COLUMNS} FROM orders WHERE id = ?");
        self.read(|file| file.query_row(&sql, params![id.as_str()], order).optional())
    }

    /// Finds who gave an order.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read.
    pub fn origin(&self, id: &str) -> Result<Option<String>, HistoryError> {
        let sql = "SELECT origin FROM orders WHERE id = ?";
        self.read(|file| file.query_row(sql, params![id], |row| row.get(0)).optional())
    }

    /// Lists the last orders, the latest first, `most` at most; those of one pump if one is named.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read.
    pub fn last_orders(&self, pump: Option<&str>, most: u32) -> Result<Vec<OrderRecord>, HistoryError> {
        let sql = format!(
            "SELECT {COLUMNS} FROM orders WHERE ?1 IS NULL OR pump = ?1 ORDER BY begun DESC, rowid DESC LIMIT ?2"
        );
        self.read(|file| file.prepare(&sql)?.query_map(params![pump, most], order)?.collect())
    }

    /// Marks the orders of a service that ended before them. Returns these orders.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read or written.
    pub fn cut_off(&self, now: Timestamp) -> Result<Vec<OrderRecord>, HistoryError> {
        let sql = format!("SELECT {COLUMNS} FROM orders WHERE state = 'running'");
        let mut cut: Vec<OrderRecord> =
            self.read(|file| file.prepare(&sql)?.query_map([], order)?.collect())?;
        for record in &mut cut {
            (record.state, record.ended) = (OrderState::CutOff, Some(now));
            self.end(record)?;
        }
        Ok(cut)
    }

    /// Records an event.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if it cannot be recorded.
    pub fn note(&self, event: &EventRecord) -> Result<(), HistoryError> {
        self.execute(
            "INSERT INTO events (time, kind, pump, text) VALUES (?,?,?,?)",
            params![event.time.to_string(), event.kind, event.pump, event.text],
        )
    }

    /// Lists the last events, the latest first, `most` at most.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read.
    pub fn last_events(&self, most: u32) -> Result<Vec<EventRecord>, HistoryError> {
        self.read(|file| {
            file.prepare("SELECT time, kind, pump, text FROM events ORDER BY time DESC, rowid DESC LIMIT ?")?
                .query_map(params![most], |row| {
                    Ok(EventRecord {
                        time: instant(row, 0)?,
                        kind: row.get(1)?,
                        pump: row.get(2)?,
                        text: row.get(3)?,
                    })
                })?
                .collect()
        })
    }

    /// Returns the last planned time on record of an entry of the schedule.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read.
    pub fn planned(&self, entry: &str) -> Result<Option<Timestamp>, HistoryError> {
        self.read(|file| {
            file.query_row("SELECT last FROM planned WHERE entry = ?", params![entry], |row| instant(row, 0))
                .optional()
        })
    }

    /// Records that the run of an entry at this planned time is made or missed, before anything moves.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if it cannot be recorded. The run is not made then.
    pub fn plan(&self, entry: &str, planned: Timestamp) -> Result<(), HistoryError> {
        self.execute(
            "INSERT INTO planned (entry, last) VALUES (?,?) ON CONFLICT (entry) DO UPDATE SET last = excluded.last",
            params![entry, planned.to_string()],
        )
    }

    /// Returns a word of the service's own, by its name.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read.
    pub fn word(&self, name: &str) -> Result<Option<String>, HistoryError> {
        self.read(|file| {
            file.query_row("SELECT value FROM words WHERE name = ?", params![name], |row| row.get(0))
                .optional()
        })
    }

    /// Keeps a word of the service's own.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if it cannot be recorded.
    pub fn keep_word(&self, name: &str, value: &str) -> Result<(), HistoryError> {
        self.execute(
            "INSERT INTO words (name, value) VALUES (?,?) ON CONFLICT (name) DO UPDATE SET value = excluded.value",
            params![name, value],
        )
    }

    fn locked(&self) -> MutexGuard<'_, Connection> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn read<T>(
        &self,
        read: impl FnOnce(&Connection) -> rusqlite::Result<T>,
    ) -> Result<T, HistoryError> {
        read(&self.locked()).map_err(|source| HistoryError::File { path: self.path.clone(), source })
    }

    pub(super) fn execute(&self, sql: &str, values: impl rusqlite::Params) -> Result<(), HistoryError> {
        self.read(|file| file.execute(sql, values).map(drop))
    }
}

fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).unwrap_or_else(|error| unreachable!("plain data: {error}"))
}

/// Reads an order of the columns of [`COLUMNS`].
fn order(row: &Row<'_>) -> rusqlite::Result<OrderRecord> {
    let pump: String = row.get(1)?;
    Ok(OrderRecord {
        schema: "order/1",
        id: OrderId::of(&row.get::<_, String>(0)?),
        order: parsed(row, 2)?.unwrap_or_else(|| Order::new(&pump, Task::Run)),
        origin: row.get(3)?,
        state: OrderState::of_word(&row.get::<_, String>(4)?),
        begun: instant(row, 5)?,
        ended: row.get::<_, Option<String>>(6)?.and_then(|time| time.parse().ok()),
        code: row.get(7)?,
        reports: parsed(row, 8)?.unwrap_or_default(),
        messages: parsed(row, 9)?.unwrap_or_default(),
        error: parsed::<Value>(row, 10)?,
    })
}

/// Reads JSON of a column; `None` for a column without.
fn parsed<T: DeserializeOwned>(row: &Row<'_>, column: usize) -> rusqlite::Result<Option<T>> {
    let Some(text) = row.get::<_, Option<String>>(column)? else { return Ok(None) };
    serde_json::from_str(&text).map(Some).map_err(|error| {
        rusqlite::Error::FromSqlConversionFailure(column, rusqlite::types::Type::Text, Box::new(error))
    })
}

fn instant(row: &Row<'_>, column: usize) -> rusqlite::Result<Timestamp> {
    let text: String = row.get(column)?;
    text.parse().map_err(|error| {
        rusqlite::Error::FromSqlConversionFailure(column, rusqlite::types::Type::Text, Box::new(error))
    })
}
