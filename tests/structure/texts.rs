//! The string literals of a crate, and those that speak of the command.

use syn::buffer::{Cursor, TokenBuffer};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, LitStr, Macro, Meta};

/// The texts of a module.
#[derive(Default)]
pub(crate) struct Texts {
    found: Vec<String>,
}

impl Texts {
    /// Returns the texts of these items. Documentation has none: it is not printed.
    pub(crate) fn of(items: &[Item]) -> Vec<String> {
        let mut texts = Self::default();
        items.iter().for_each(|item| texts.visit_item(item));
        texts.found
    }

    /// Adds the literals of what a macro or an attribute is given.
    fn add(&mut self, mut at: Cursor<'_>) {
        while !at.eof() {
            at = if let Some((inside, _, _, after)) = at.any_group() {
                self.add(inside);
                after
            } else if let Some((literal, after)) = at.literal() {
                if let Ok(text) = syn::parse_str::<LitStr>(&literal.to_string()) {
                    self.found.push(text.value());
                }
                after
            } else {
                // A word or a sign.
                let Some((_, after)) = at.token_tree() else { return };
                after
            };
        }
    }
}

impl<'ast> Visit<'ast> for Texts {
    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        // The text of an error, as `#[error("...")]`.
        if let Meta::List(list) = &attribute.meta {
            self.add(TokenBuffer::new2(list.tokens.clone()).begin());
        }
    }

    fn visit_macro(&mut self, mac: &'ast Macro) {
        self.add(TokenBuffer::new2(mac.tokens.clone()).begin());
        visit::visit_macro(self, mac);
    }

    fn visit_lit_str(&mut self, text: &'ast LitStr) {
        self.found.push(text.value());
    }

    // A module below is visited by itself.
    fn visit_item_mod(&mut self, _: &'ast syn::ItemMod) {}
}

/// True if a text names one of these subcommands of `dose`, or an option: words that mean nothing outside the command.
pub(crate) fn names_the_command(text: &str, subcommands: &[String]) -> bool {
    let words: Vec<&str> = text.split_whitespace().collect();
    let is_dose = |word: &str| word == "`dose" || word == "`dose`";
    let is_subcommand = |word: &str| {
        let bare = word.trim_end_matches(|c: char| !c.is_alphanumeric());
        subcommands.iter().any(|subcommand| subcommand == bare)
    };
    let calls = words.windows(2).any(|pair| pair[0] == "dose" && is_subcommand(pair[1]));
    let is_option = |word: &&str| {
        let rest = word.trim_start_matches(|c| "`('\"".contains(c)).strip_prefix("--");
        rest.is_some_and(|name| name.starts_with(|c: char| c.is_ascii_lowercase()))
    };
    calls || words.iter().any(|word| is_dose(word)) || words.iter().any(is_option)
}
