//! The terms on which a device is opened.

use std::path::{Path, PathBuf};

use super::stop_request::StopRequest;
use crate::pump_file::{DriveTable, DriverName};
use crate::record::{BOARDS, Folder};

/// Folder in which Linux keeps a name for each serial port on a USB cable.
const PORT_NAMES: &str = "/dev/serial/by-id";

/// Terms on which a device is opened.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Opening {
    /// True if device settings that do not fit the pump may be written.
    pub configure: bool,
    /// Acceleration at the pump head that a device is configured with, if it has one for every dose, rad/s².
    /// `None` takes the motor's largest.
    pub acceleration_rad_s2: Option<f64>,
    /// True if the board and its settings may differ from those on record. They are on record from then on.
    pub accept_settings: bool,
    /// Id of the pump, by which messages name it. `None` if the drive is opened for no pump of a bench.
    pub pump: Option<String>,
    /// File that holds the device settings of the last time. The record of the board is beside it. `None` keeps no
    /// record of either.
    pub settings_record: Option<PathBuf>,
    /// Folder of the records of boards, each of which all pumps of a board share. `None` keeps the record of a board
    /// beside that of its settings, so that two pumps of one board take it from each other.
    pub boards: Option<PathBuf>,
    /// Folder of the names that serial ports keep, as /dev/serial/by-id. `None` tells no ports apart.
    pub port_names: Option<PathBuf>,
    /// True if the board and its settings are on record only once `Drive::put_on_record` is called, so that a board
    /// that never moves leaves no record. Otherwise they are as soon as the board has answered.
    pub records_later: bool,
    /// Other pumps that use the board at the same time: the id of each, and its drive table. A board that takes one
    /// configuration for all of its motors is configured for them too.
    pub beside: Vec<(String, DriveTable)>,
    /// True if the pump is one of a rack with pumps at other boards too. Motions begin together with theirs, so a
    /// device whose clock is to be known well for that is asked for it at once. And theirs go on while this one's board
    /// is searched for, so that the search is short.
    pub with_other_boards: bool,
    /// Request that ends every wait at rest.
    pub stop: StopRequest,
}

/// File in the journal's folder that holds the device settings of the last time.
pub(crate) const SETTINGS_RECORD: &str = "board-settings.json";

impl Opening {
    /// Returns the terms of a pump whose device is turned by `driver`, and whose records are in `state_dir`.
    pub fn of_pump(id: &str, driver: DriverName, state_dir: &Path) -> Self {
        let folder = Folder::new(state_dir, id, driver.as_str());
        Self {
            pump: Some(id.to_owned()),
            settings_record: Some(folder.path().join(SETTINGS_RECORD)),
            boards: Some(state_dir.join(BOARDS)),
            port_names: Some(PathBuf::from(PORT_NAMES)),
            ..Self::default()
        }
    }
}
