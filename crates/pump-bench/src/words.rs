//! Choices among words: each word exists once, and text is read, printed and listed from there.

use thiserror::Error;

/// A text that is none of the words of a choice.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("`{text}` is none of: {allowed}")]
#[non_exhaustive]
pub struct WordError {
    /// The text that was read.
    pub text: String,
    /// The words that are accepted, separated by commas.
    pub allowed: String,
}

/// Gives an enum `ALL`, `as_str`, `Display` and `FromStr` from one list of its words.
macro_rules! words {
    ($choice:ident { $($variant:ident = $word:literal),+ $(,)? }) => {
        impl $choice {
            /// Every choice, in the order in which the choices are listed.
            pub const ALL: &[Self] = &[$(Self::$variant),+];

            /// The word of the choice, as it is typed and printed.
            pub const fn as_str(self) -> &'static str {
                match self {
                    $(Self::$variant => $word),+
                }
            }
        }

        impl ::std::fmt::Display for $choice {
            fn fmt(&self, to: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                to.pad(self.as_str())
            }
        }

        impl ::std::str::FromStr for $choice {
            type Err = $crate::words::WordError;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                Self::ALL.iter().find(|choice| choice.as_str() == text).copied().ok_or_else(|| {
                    let allowed: Vec<&str> = Self::ALL.iter().map(|choice| choice.as_str()).collect();
                    $crate::words::WordError { text: text.to_owned(), allowed: allowed.join(", ") }
                })
            }
        }
    };
}

/// Gives an enum what `words` gives, and serialises it as its word.
macro_rules! words_of_reports {
    ($choice:ident $words:tt) => {
        $crate::words::words!($choice $words);

        impl ::serde::Serialize for $choice {
            fn serialize<S: ::serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                to.serialize_str(self.as_str())
            }
        }
    };
}

pub(crate) use {words, words_of_reports};

#[cfg(test)]
mod tests {
    use crate::dosing::Missed;
    use crate::pump_file::DriverName;

    #[test]
    fn every_word_is_read_as_the_choice_that_prints_it() {
        for driver in DriverName::ALL {
            assert_eq!(driver.to_string().parse(), Ok(*driver));
        }
        let error = "later".parse::<Missed>().unwrap_err().to_string();
        assert_eq!(error, "`later` is none of: skip, now");
    }
}
