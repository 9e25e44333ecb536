//! Choices that an entry makes for the runs that do not go by the clock.

use serde::{Serialize, Serializer};

/// A choice of a few words, in the file as in the program.
macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $word:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
        pub enum $name { $($(#[$variant_doc])* $variant),* }

        impl $name {
            /// Each choice with its word in the file.
            pub(super) const CHOICES: &[(&str, Self)] = &[$(($word, Self::$variant)),*];

            /// Returns the word in the file.
            pub fn as_str(self) -> &'static str {
                match self { $(Self::$variant => $word),* }
            }
        }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.as_str())
            }
        }
    };
}

choice! {
    /// Choice for the runs whose time passed while nobody was there to begin them.
    IfMissed {
        /// Missed runs are left out and reported.
        #[default]
        Skip = "skip",
        /// One run makes up for all that were missed.
        Once = "once",
        /// Each missed run is made up for, one after the other.
        All = "all",
    }
}

choice! {
    /// Choice for a pump whose last dose was interrupted.
    IfUnfinished {
        /// The run is refused, so that a person decides.
        #[default]
        Ask = "ask",
        /// The rest of the interrupted dose is made first.
        Resume = "resume",
        /// The interrupted dose is accepted as it is.
        Accept = "accept",
    }
}

choice! {
    /// Choice for a run whose pump still moves at its time.
    IfBusy {
        /// The run is left out and reported.
        #[default]
        Skip = "skip",
        /// The run waits for the pump, until the entry's next time at most.
        Wait = "wait",
    }
}
