//! Keys, one at a time. A signal ends the wait for one.

use std::io::{self, ErrorKind};

use console::{Key, Term};

/// Returns the next key of the person at standard input, which must be a terminal, or none once `is_over`. Ctrl-C is a
/// key meanwhile.
pub(super) fn next_key(is_over: impl Fn() -> bool) -> io::Result<Option<Key>> {
    #[cfg(unix)]
    let _single = unix::SingleKeys::begin()?;
    while !is_over() {
        // A signal may come just before a wait begins, so no wait is long.
        #[cfg(unix)]
        if !unix::has_key()? {
            continue;
        }
        match Term::stderr().read_key_raw() {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            key => return key.map(Some),
        }
    }
    Ok(None)
}

#[cfg(unix)]
mod unix {
    use std::io;

    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use rustix::io::Errno;
    use rustix::termios::{LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcsetattr};

    /// Longest wait for a key between two looks at the signals: 0.1 s.
    const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 100_000_000 };

    /// Terminal that hands each key on at once, and does not show it.
    pub(super) struct SingleKeys {
        before: Termios,
    }

    impl SingleKeys {
        pub(super) fn begin() -> io::Result<Self> {
            let before = tcgetattr(io::stdin())?;
            let mut single = before.clone();
            single.local_modes.remove(LocalModes::ICANON | LocalModes::ECHO | LocalModes::ISIG);
            single.special_codes[SpecialCodeIndex::VMIN] = 1;
            single.special_codes[SpecialCodeIndex::VTIME] = 0;
            tcsetattr(io::stdin(), OptionalActions::Drain, &single)?;
            Ok(Self { before })
        }
    }

    impl Drop for SingleKeys {
        fn drop(&mut self) {
            // Where the terminal is gone, nothing is left to restore.
            let _ = tcsetattr(io::stdin(), OptionalActions::Drain, &self.before);
        }
    }

    /// Waits for a key for a moment. Returns true if one is there, or if the terminal is gone.
    pub(super) fn has_key() -> io::Result<bool> {
        let stdin = io::stdin();
        match poll(&mut [PollFd::new(&stdin, PollFlags::IN)], Some(&LOOK)) {
            Ok(ready) => Ok(ready > 0),
            Err(Errno::INTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }
}
