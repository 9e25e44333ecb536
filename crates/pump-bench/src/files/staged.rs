//! Files that appear whole or not at all.

use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::plain::{FileError, kind_of};

/// A file whose contents are written but not yet in place.
///
/// The contents wait in a synced temporary file beside the target, which [`Staged::put`] renames. So nobody
/// ever sees half of the file, and the old file stays until then. A staged file that is dropped leaves
/// nothing. `/dev/null` and the pipes and terminals of this process, as `/dev/stderr`, are written directly.
#[derive(Debug)]
pub struct Staged {
    temporary: Option<tempfile::NamedTempFile>,
    target: PathBuf,
}

impl Staged {
    /// Writes the contents that will replace `path`.
    ///
    /// # Errors
    /// Returns the [`io::Error`] of `write` or of the file system. A folder, a device, a pipe and a file without write
    /// permission are refused.
    pub fn new(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<Self> {
        match fs::metadata(path) {
            Ok(found) if !found.is_file() => return Self::stream(path, &found, write),
            Ok(_) if is_stream(path) => return Err(FileError::Occupied.into()),
            // A file without write permission must not be replaced either.
            Ok(_) => drop(File::options().write(true).open(path)?),
            Err(_) => {}
        }
        // Following a link replaces its target and not the link.
        let target = match fs::canonicalize(path) {
            Ok(target) => target,
            Err(error) if error.kind() == io::ErrorKind::NotFound => path.to_owned(),
            Err(error) => return Err(error),
        };
        // The error names the temporary file, which users do not know. Its kind says enough.
        let mut temporary =
            temporary_beside(folder_of(&target)).map_err(|error| io::Error::from(error.kind()))?;
        // Errors of the file itself do not name it.
        let mut buffered = BufWriter::new(temporary.as_file_mut());
        write(&mut buffered)?;
        buffered.flush()?;
        drop(buffered);
        temporary.as_file().sync_all()?;
        Ok(Self { temporary: Some(temporary), target })
    }

    /// Writes to a stream of this process or to `/dev/null`. Anything else that is not plain is refused: a pipe would
    /// block, and a device may be a disk or a motor.
    fn stream(
        path: &Path,
        found: &Metadata,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<Self> {
        let kind = found.file_type();
        if found.is_dir() || !(is_stream(path) || path == Path::new("/dev/null")) {
            return Err(FileError::NotWritable { found: kind_of(kind) }.into());
        }
        let mut stream = BufWriter::new(File::options().write(true).open(path)?);
        write(&mut stream)?;
        stream.flush()?;
        Ok(Self { temporary: None, target: path.to_owned() })
    }

    /// Puts the file in place.
    ///
    /// # Errors
    /// Returns the [`io::Error`] of the rename or of the sync of the folder.
    pub fn put(self) -> io::Result<()> {
        if let Some(temporary) = self.temporary {
            temporary.persist(&self.target)?;
            sync_folder(folder_of(&self.target))?;
        }
        Ok(())
    }

    /// Puts the file in place unless the target exists.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if the target exists. Otherwise the error of the file system.
    pub(crate) fn put_new(self) -> io::Result<()> {
        let Some(temporary) = self.temporary else { return Err(io::ErrorKind::AlreadyExists.into()) };
        temporary.persist_noclobber(&self.target)?;
        sync_folder(folder_of(&self.target))
    }
}

/// Returns true if a path names an open stream of this process.
fn is_stream(path: &Path) -> bool {
    let named = ["/dev/stdout", "/dev/stderr"].map(Path::new);
    named.contains(&path) || ["/dev/fd", "/proc/self/fd"].map(Path::new).contains(&folder_of(path))
}

/// Returns the folder of a file, `.` for a bare name.
pub(crate) fn folder_of(target: &Path) -> &Path {
    match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Creates a temporary file with the permissions that any new file gets.
fn temporary_beside(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".dose-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// Makes a rename in the folder survive a power loss. A folder that may be passed but not read cannot be
/// synced: its file system does so in its own time.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    #[cfg(unix)]
    match File::open(folder) {
        Ok(folder) => folder.sync_all()?,
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => {}
        Err(error) => return Err(error),
    }
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn replace_file(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        Staged::new(path, write)?.put()
    }

    #[test]
    fn a_failed_write_leaves_the_old_contents_and_no_litter() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("trace.csv");
        replace_file(&path, |file| file.write_all(b"old")).unwrap();
        let failed = replace_file(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::other("disk full"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(replace_file(folder.path(), |_| Ok(())).is_err(), "a folder is no file");
        assert!(replace_file(&folder.path().join("no/such/folder"), |_| Ok(())).is_err());
    }

    #[test]
    fn a_new_file_overwrites_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("1.json");
        let new = |text: &str| Staged::new(&path, |file| file.write_all(text.as_bytes()))?.put_new();
        new("first").unwrap();
        assert_eq!(new("second").unwrap_err().kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_keeps_pointing_and_a_device_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        replace_file(&link, |file| file.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&target).unwrap(), b"new");
        replace_file(Path::new("/dev/null"), |file| file.write_all(b"gone")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
