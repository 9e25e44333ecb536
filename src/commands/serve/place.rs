//! The place of a running service: who it is and how commands on this machine reach it, in `serve.json` beside the
//! records.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use serde_json::json;

use crate::failure::Failure;

/// A service's hold of a folder of records. The file goes with it.
#[derive(Debug)]
pub(super) struct Place {
    path: PathBuf,
    /// The lock, which the system ends with the process.
    _lock: File,
}

impl Place {
    /// Takes the folder of records for one service.
    pub(super) fn take(state_dir: &Path) -> Result<Self, Failure> {
        fs::create_dir_all(state_dir).map_err(|error| Failure::unwritten(state_dir, &error))?;
        let lock_path = state_dir.join("serve.lock");
        let options = OpenOptions::new().create(true).truncate(false).write(true).open(&lock_path);
        let lock = options.map_err(|error| Failure::unwritten(&lock_path, &error))?;
        match lock.try_lock() {
            Ok(()) => Ok(Self { path: state_dir.join("serve.json"), _lock: lock }),
            Err(TryLockError::WouldBlock) => Err(Failure::refused(format!(
                "another service has the pumps of {}; stop it first, or name other records with --state-dir",
                state_dir.display()
            ))),
            Err(TryLockError::Error(error)) => Err(Failure::unwritten(&lock_path, &error)),
        }
    }

    /// Tells commands on this machine where the service is. Only this user can read it.
    pub(super) fn tell(&self, address: SocketAddr, token: &str) -> Result<(), Failure> {
        let text = json!({
            "schema": "serve/1",
            "url": format!("http://{address}"),
            "token": token,
            "process": std::process::id(),
            "version": env!("CARGO_PKG_VERSION"),
        });
        self.write(&format!("{text}\n")).map_err(|error| Failure::unwritten(&self.path, &error))
    }

    fn write(&self, text: &str) -> io::Result<()> {
        let new = self.path.with_extension("json.new");
        let _ = fs::remove_file(&new);
        let mut options = OpenOptions::new();
        options.create_new(true).write(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let mut file = options.open(&new)?;
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
        fs::rename(&new, &self.path)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        // A file that stays behind names a service that does not answer, which commands take for none.
        let _ = fs::remove_file(&self.path);
    }
}
