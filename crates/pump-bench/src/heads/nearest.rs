//! The names that are nearest to a name that is not in the catalogue.

use super::rows::bought_heads;

/// Number of names that an answer holds.
const NEAREST: usize = 3;

/// Length of a name, in letters, beyond which a name is cut before it is compared.
const LONGEST: usize = 64;

/// Returns the names of the catalogue that are nearest to `name`, the nearest first.
///
/// A name that has more of the words comes first. Among equals the fewer letters are to change, the nearer it is.
///
/// ```
/// assert_eq!(pump_bench::heads::nearest_heads("masterflex-ls-61")[0], "masterflex-ls-16");
/// assert_eq!(pump_bench::heads::nearest_heads("ls16")[0], "masterflex-ls-16");
/// ```
pub fn nearest_heads(name: &str) -> Vec<&'static str> {
    let name: Vec<char> = name.to_lowercase().chars().take(LONGEST).collect();
    let typed = words(&name);
    let mut names: Vec<(usize, usize, &'static str)> = bought_heads()
        .iter()
        .map(|head| {
            let known: Vec<char> = head.name.chars().collect();
            let of_known = words(&known);
            let missing = typed.iter().filter(|word| !of_known.contains(word)).count();
            (missing, letters_to_change(&name, &known), head.name.as_str())
        })
        .collect();
    names.sort_unstable();
    names.into_iter().take(NEAREST).map(|(.., name)| name).collect()
}

/// Returns the words of a name: its runs of letters and its runs of digits.
fn words(name: &[char]) -> Vec<&[char]> {
    let class = |c: &char| (c.is_alphabetic(), c.is_numeric());
    name.chunk_by(|a, b| class(a) == class(b)).filter(|word| word[0].is_alphanumeric()).collect()
}

/// Returns the number of letters to insert, leave out, replace or exchange with their neighbour to turn one name into
/// the other: the optimal string alignment distance (Damerau, Communications of the ACM 7, 171 (1964)).
fn letters_to_change(from: &[char], to: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=to.len()).collect();
    for (i, letter) in from.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, other) in to.iter().enumerate() {
            let replaced = last[j] + usize::from(letter != other);
            let mut least = replaced.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && *letter == to[j - 1] && from[i - 1] == *other {
                least = least.min(before[j - 1] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_counted_as_damerau_counts_them() {
        let count = |a: &str, b: &str| {
            letters_to_change(&a.chars().collect::<Vec<_>>(), &b.chars().collect::<Vec<_>>())
        };
        for (a, b, letters) in [
            ("", "", 0),
            ("", "abc", 3),
            ("kitten", "sitting", 3),
            ("ls-61", "ls-16", 1),
            ("ca", "abc", 3),
            ("omega", "omeg", 1),
        ] {
            assert_eq!((count(a, b), count(b, a)), (letters, letters), "{a} {b}");
        }
    }

    #[test]
    fn a_typo_is_answered_with_the_name_that_was_meant() {
        for (typo, meant) in [
            ("masterflex-ls-61", "masterflex-ls-16"),
            ("mastreflex-ls-16", "masterflex-ls-16"),
            ("masterflex16", "masterflex-ls-16"),
            ("Masterflex L/S 16", "masterflex-ls-16"),
            ("kamoer-kphm400", "kamoer-kphm400-25"),
            ("omega 1/16", "omega-fpu5mt-1-16in"),
            ("yz1515x-3-16", "runze-yz1515x-3-16"),
        ] {
            assert_eq!(nearest_heads(typo)[0], meant, "{typo}");
        }
        assert_eq!(nearest_heads("").len(), 3);
        assert_eq!(nearest_heads(&"ä".repeat(100_000)).len(), 3);
    }
}
