//! `dose backup` and `dose restore`: all records in one file, and back.

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use pump_bench::record::{BackedUp, BackupError, Clock, SystemClock, backup, is_backup, restore};
use pump_bench::report::ErrorKind;

use crate::failure::Failure;
use crate::options::files::Files;
use crate::options::pump::{ConfigOption, RecordOption};
use crate::outputs::Outputs;
use crate::terminal::tell;

#[derive(Debug, Args)]
pub(crate) struct BackupArgs {
    /// File to write
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: RecordOption,
}

#[derive(Debug, Args)]
pub(crate) struct RestoreArgs {
    /// File that `dose backup` wrote
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: RecordOption,
}

impl BackupArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let state_dir = self.record.folder(&self.config.config()?)?;
        let outputs: [(&'static str, Option<&Path>); 1] = [("the backup", Some(&self.file))];
        let config = self.config.path();
        Files { outputs: &outputs, inputs: &[], config, state_dir: Some(state_dir.clone()) }.check()?;
        self.check_place(&state_dir)?;
        let mut made: Option<Result<BackedUp, BackupError>> = None;
        let mut written = Outputs::default();
        let staged = written.write(&self.file, |to| {
            let ended = backup(&state_dir, SystemClock::default().now(), to);
            let is_made = ended.is_ok();
            made = Some(ended);
            if is_made { Ok(()) } else { Err(io::ErrorKind::Other.into()) }
        });
        let BackedUp { files, bytes, .. } = match made {
            Some(Err(error)) => return Err(Failure::of(error)),
            Some(Ok(made)) => made,
            None => return staged,
        };
        staged.and_then(|()| written.put())?;
        tell(&format!(
            "{files} files of {} are in {} ({bytes} bytes)\n",
            state_dir.display(),
            self.file.display()
        ))
    }
}

impl BackupArgs {
    /// Refuses a place among the records, where the next backup would hold this one, and a file that is no backup.
    fn check_place(&self, state_dir: &Path) -> Result<(), Failure> {
        let refused = |why: &str| {
            let message = format!("the backup {}: {why}", self.file.display());
            Err(Failure::refused(message).kind(ErrorKind::Output).value(self.file.display()))
        };
        let folder = self.file.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new(".")).canonicalize();
        let is_among =
            folder.ok().zip(state_dir.canonicalize().ok()).is_some_and(|(at, of)| at.starts_with(of));
        if is_among {
            return refused("it would lie in the folder of the records; name a file elsewhere");
        }
        if self.file.exists()
            && !is_backup(&self.file).map_err(|error| Failure::unread(&self.file, &error))?
        {
            return refused("there is a file that is no backup, and it would be lost; name another file");
        }
        Ok(())
    }
}

impl RestoreArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let state_dir = self.record.folder(&self.config.config()?)?;
        let restored = restore(&state_dir, &self.file).map_err(Failure::of)?;
        let before = restored
            .before
            .map_or(String::new(), |path| format!("; those of before are in {}", path.display()));
        tell(&format!(
            "{} files of {} are in {} again{before}\nif a rotor was turned since the backup, say where it stands with \
             `dose home`\n",
            restored.files,
            self.file.display(),
            state_dir.display(),
        ))
    }
}
