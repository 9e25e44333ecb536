//! The options of a bench: its port and pace, its leave to change things, its waits.

use std::path::PathBuf;
use std::time::Duration;

use super::super::session::Patience;
use super::Bench;
use crate::drives::StopRequest;
use crate::pump_file::{DriveTable, Pace};

impl Bench {
    /// Returns the bench with its device at `port`, if a port is given. A driver that needs a port refuses to
    /// open without one.
    #[must_use]
    pub fn at_port(mut self, port: Option<PathBuf>) -> Self {
        self.drive.port = port.or(self.drive.port);
        self
    }

    /// Returns the bench with this pace of its simulated motor, if one is given.
    #[must_use]
    pub fn paced(mut self, pace: Option<Pace>) -> Self {
        self.drive.pace = pace.or(self.drive.pace);
        self
    }

    /// Returns the bench with or without leave to write device settings that do not fit the pump. A board's one
    /// acceleration becomes the best for doses at the pump's default rate.
    #[must_use]
    pub fn configuring(mut self, configure: bool) -> Self {
        self.opening.configure = configure;
        self.opening.acceleration_rad_s2 = if configure { self.plain_acceleration_rad_s2() } else { None };
        self
    }

    /// Returns the bench that looks for the names of serial ports in `folder`, in place of /dev/serial/by-id.
    #[doc(hidden)]
    #[must_use]
    pub fn naming_ports_in(mut self, folder: PathBuf) -> Self {
        self.opening.port_names = Some(folder);
        self
    }

    /// Returns the bench with or without leave for a device, and device settings, that differ from those on record.
    #[must_use]
    pub fn accepting_settings(mut self, accept: bool) -> Self {
        self.opening.accept_settings = accept;
        self
    }

    /// Returns the bench with a request of the user to stop. It ends the waits for a device at rest; motions
    /// ask their `watch`.
    #[must_use]
    pub fn stopping_on(mut self, stop: StopRequest) -> Self {
        self.opening.stop = stop;
        self
    }

    /// Returns the bench of a pump of a rack whose board turns these others too: the id of each, and its drive table.
    #[must_use]
    pub(crate) fn in_rack(mut self, beside: Vec<(String, DriveTable)>, with_other_boards: bool) -> Self {
        (self.opening.with_other_boards, self.opening.beside) = (with_other_boards, beside);
        self
    }

    /// Returns the bench with or without leave to find the angle while a dose is unfinished. The dose stays
    /// on record, and so does its carry.
    #[must_use]
    pub fn homing_unfinished(self, unfinished: bool) -> Self {
        Self { unfinished, ..self }
    }

    /// Returns the bench with or without the user's word that the pump's values which the program filled in are those
    /// of the pump at hand. The word is recorded, and asked for again when those values change.
    #[must_use]
    pub fn confirming_pump(self, confirms_pump: bool) -> Self {
        Self { confirms_pump, ..self }
    }

    /// Returns the bench with or without a person who watches how the motor turns. Its pump file may then turn the
    /// motor in another way than when it moved last: by other steps, at another place of the board, or in the other
    /// direction.
    #[must_use]
    pub fn watching_the_turn(self, turning_is_watched: bool) -> Self {
        Self { turning_is_watched, ..self }
    }

    /// Returns the bench whose sessions wait for `limit` in all while another process holds the pump or its port.
    /// `tell` is told for whom. A request to stop ends the wait.
    #[must_use]
    pub fn waiting(self, limit: Duration, tell: impl Fn(&str) + Send + Sync + 'static) -> Self {
        Self { patience: Patience::new(limit, tell), ..self }
    }
}
