//! The logins of people at the page, which hold over a restart of the service.

use jiff::Timestamp;
use rusqlite::params;

use super::error::HistoryError;
use super::history::History;

/// Most logins at a time: a further one ends the oldest.
const MOST: u32 = 200;

impl History {
    /// Records a login by its mark, from which nobody learns its cookie.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if it cannot be recorded. Nobody is logged in then.
    pub(crate) fn begin_login(&self, mark: &str, now: Timestamp) -> Result<(), HistoryError> {
        self.execute("INSERT INTO logins (mark, begun) VALUES (?,?)", params![mark, now.to_string()])?;
        let older =
            "DELETE FROM logins WHERE rowid NOT IN (SELECT rowid FROM logins ORDER BY rowid DESC LIMIT ?)";
        self.execute(older, params![MOST])
    }

    /// Returns true if a login of this mark began at `since` or later.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if the file cannot be read.
    pub(crate) fn has_login(&self, mark: &str, since: Timestamp) -> Result<bool, HistoryError> {
        self.read(|file| {
            let sql = "SELECT EXISTS (SELECT 1 FROM logins WHERE mark = ? AND begun >= ?)";
            file.query_row(sql, params![mark, since.to_string()], |row| row.get(0))
        })
    }

    /// Ends every login.
    ///
    /// # Errors
    ///
    /// [`HistoryError::File`] if that cannot be recorded. They hold on then.
    pub(crate) fn end_logins(&self) -> Result<(), HistoryError> {
        self.execute("DELETE FROM logins", [])
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn the_oldest_login_ends_where_a_further_one_would_be_too_many() {
        let history = History::open(Path::new(":memory:")).unwrap();
        let now = Timestamp::UNIX_EPOCH;
        for number in 0..=MOST {
            history.begin_login(&number.to_string(), now).unwrap();
        }
        let has = |number: u32| history.has_login(&number.to_string(), now).unwrap();
        assert_eq!((has(0), has(1), has(MOST)), (false, true, true));
    }
}
