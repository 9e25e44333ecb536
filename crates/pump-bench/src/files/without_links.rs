//! Files of a pump's record: plain files and folders, never links.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::Path;

use super::staged::{folder_of, sync_folder};

/// Refuses a link, or a file that is neither plain nor a folder, at `path`. Nothing may be there.
pub(crate) fn check_plain(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => Err(link_refusal()),
        Ok(found) if found.is_file() || found.is_dir() => Ok(()),
        Ok(_) => Err(io::Error::new(ErrorKind::InvalidInput, "it is a device or a pipe, and no file")),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// Opens a plain file. A link is refused, also one that was put there this instant.
pub(crate) fn open_plain(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    check_plain(path)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;

        let flags = rustix::fs::OFlags::NOFOLLOW | rustix::fs::OFlags::NONBLOCK;
        options.custom_flags(flags.bits() as i32);
    }
    options.open(path)
}

/// Creates a folder and those that hold it, and syncs what was created.
pub(crate) fn create_folders(path: &Path) -> io::Result<()> {
    create_folders_synced_by(path, sync_folder)
}

/// Creates a folder and those that hold it. `sync` gets each folder that has a new entry, the innermost first.
fn create_folders_synced_by(path: &Path, sync: impl FnMut(&Path) -> io::Result<()>) -> io::Result<()> {
    let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
    let created: Vec<&Path> = path.ancestors().take_while(is_missing).collect();
    fs::create_dir_all(path)?;
    // A new folder is an entry of the one that holds it.
    created.into_iter().map(folder_of).try_for_each(sync)
}

fn link_refusal() -> io::Error {
    io::Error::new(
        ErrorKind::InvalidInput,
        "it is a link, and links in the record are not followed; put the file there itself",
    )
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn a_link_a_pipe_and_a_dangling_link_are_refused_and_a_linked_folder_on_the_way_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("real")).unwrap();
        fs::write(at("real/file"), "text").unwrap();
        symlink(at("real"), at("linked")).unwrap();
        symlink(at("real/file"), at("link")).unwrap();
        symlink(at("nowhere"), at("dangling")).unwrap();
        let open = |name: &str| open_plain(&at(name), File::options().write(true).create(true));
        for name in ["link", "dangling", "linked"] {
            assert!(open(name).unwrap_err().to_string().contains("it is a link"), "{name}");
        }
        assert!(!at("nowhere").exists());
        assert!(open("linked/file").is_ok());
        assert!(open("new").is_ok() && at("new").exists());
    }

    #[test]
    fn folders_are_created_within_a_folder_by_a_short_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/c");
        create_folders(&path).unwrap();
        create_folders(&path).unwrap();
        assert!(path.is_dir());
    }

    #[test]
    fn each_folder_with_a_new_entry_is_synced_once_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let synced_for = |path: &str| {
            let mut synced = Vec::new();
            create_folders_synced_by(&folder.path().join(path), |entry| {
                synced.push(entry.strip_prefix(folder.path()).unwrap().display().to_string());
                Ok(())
            })
            .unwrap();
            synced
        };
        assert_eq!(synced_for("a/b/c"), ["a/b", "a", ""]);
        assert_eq!(synced_for("a/b/c"), [""; 0]);
        // Calibrations of a pump that has dosed before.
        assert_eq!(synced_for("a/b/c/calibrations"), ["a/b/c"]);
    }
}
