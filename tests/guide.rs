//! The guide says what is so: its commands are those of `dose`, and its messages those of the sources.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Files below a folder that end so.
fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
            let path = entry.expect("an entry of a folder").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == ending) {
                found.push(path);
            }
        }
    }
    found
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A command without its words in quotes, which may be other commands.
fn unquoted(command: &str) -> String {
    let quote = |c: char| if command.contains('\'') { c == '\'' } else { c == '"' };
    command.split(quote).step_by(2).collect::<Vec<_>>().join("QUOTED")
}

/// The `dose` commands of a page: lines of its blocks of the shell, and code in its prose.
fn commands(page: &str) -> Vec<String> {
    let joined = page.replace("\\\n", " ");
    let mut found = Vec::new();
    for (at, part) in joined.split("```").enumerate() {
        let is_prose = at % 2 == 0;
        let code: Vec<&str> =
            if is_prose { part.split('`').skip(1).step_by(2).collect() } else { part.lines().collect() };
        let typed = code.into_iter().map(|code| code.trim().trim_start_matches("$ "));
        let named = typed.filter(|code| code.starts_with("dose "));
        found.extend(named.map(|code| code.split_whitespace().collect::<Vec<_>>().join(" ")));
    }
    found
}

/// Text of `dose PATH --help`.
#[derive(Default)]
struct Help(BTreeMap<String, String>);

impl Help {
    fn of(&mut self, path: &str) -> &str {
        self.0.entry(path.to_owned()).or_insert_with(|| {
            let words = path.split_whitespace().chain(["--help"]);
            let output =
                Command::new(env!("CARGO_BIN_EXE_dose")).args(words).output().expect("the command runs");
            assert!(output.status.success(), "dose {path} --help");
            String::from_utf8(output.stdout).expect("help is text")
        })
    }

    /// True if the command of this path has a subcommand of this name.
    fn has(&mut self, path: &str, name: &str) -> bool {
        let help = self.of(path).split_once("\nCommands:\n").map_or("", |(_, rest)| rest);
        let listed = help.lines().take_while(|line| !line.is_empty());
        listed.filter_map(|line| line.split_whitespace().next()).any(|word| word == name)
    }

    /// Options of a command that it does not take.
    fn foreign(&mut self, command: &str) -> Vec<String> {
        let mut path = String::new();
        let command = unquoted(command);
        let mut words = command.split_whitespace().skip(1).peekable();
        while let Some(name) = words.next_if(|word| self.has(&path, word)) {
            path = format!("{path} {name}").trim_start().to_owned();
        }
        let options = words.filter(|word| word.starts_with("--") && word.len() > 2);
        let names = options.map(|word| word.split(['=', ',', ';']).next().unwrap_or(word).to_owned());
        let known: BTreeSet<String> =
            self.of(&path).split_whitespace().map(|word| word.trim_end_matches(',').to_owned()).collect();
        names.filter(|name| name != "--help" && !known.contains(name)).collect()
    }
}

#[test]
fn every_command_of_the_guide_has_the_options_that_it_is_given() {
    let mut help = Help::default();
    let mut seen = 0;
    let mut wrong = Vec::new();
    for page in files("docs", "md").into_iter().chain(["README.md".into()]) {
        for command in commands(&read(&page)) {
            if command.starts_with("dose serve") && !cfg!(feature = "serve") {
                continue;
            }
            seen += 1;
            let foreign = help.foreign(&command);
            if !foreign.is_empty() {
                wrong.push(format!("{}: `{command}`: {}", page.display(), foreign.join(" ")));
            }
        }
    }
    assert!(seen > 300, "{seen} commands were found");
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!(help.foreign("dose tube --new --spped 3rpm"), ["--spped"]);
}

#[test]
fn every_message_of_troubleshooting_is_one_of_the_sources() {
    let sources = files("src", "rs").into_iter().chain(files("crates", "rs"));
    let folded = sources.map(|file| {
        let mut lines = read(&file);
        while let Some((before, after)) = lines.split_once("\\\n") {
            lines = format!("{before}{}", after.trim_start());
        }
        lines
    });
    let text: String = folded.collect();
    let mut unknown = Vec::new();
    let mut seen = 0;
    for page in ["docs/troubleshooting.md", "docs/limits.md"] {
        let page = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(page));
        let mut is_of_messages = false;
        for line in page.lines() {
            match line.strip_prefix("| ") {
                None => is_of_messages = false,
                Some(row) if row.starts_with("message") => is_of_messages = true,
                Some(row) if is_of_messages && row.starts_with('`') => {
                    let message = row.split('`').nth(1).expect("a message in code");
                    seen += 1;
                    let pieces = message.split('…').map(str::trim).filter(|piece| piece.len() > 3);
                    unknown.extend(pieces.filter(|piece| !text.contains(piece)).map(str::to_owned));
                }
                Some(_) => {}
            }
        }
    }
    assert!(seen > 50, "{seen} messages were found");
    assert!(unknown.is_empty(), "no source says {unknown:#?}");
}

#[test]
fn the_glossary_is_in_the_order_of_its_words() {
    let page = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/glossary.md"));
    let words = page.lines().filter_map(|line| line.strip_prefix("**")?.split("**").next());
    // A hyphen counts as a space, and what stands in parentheses does not count.
    let folded = |word: &str| {
        let bare = word.split('(').next().unwrap_or(word).trim_end_matches('.').trim();
        bare.to_lowercase().replace('-', " ")
    };
    let words: Vec<String> = words.map(folded).collect();
    assert!(words.len() > 60, "{} words were found", words.len());
    let disorder: Vec<_> = words.windows(2).filter(|pair| pair[0] > pair[1]).collect();
    assert!(disorder.is_empty(), "{disorder:?}");
}

#[test]
fn pages_write_microlitres_with_their_own_sign() {
    for page in files("docs", "md").into_iter().chain(["README.md".into()]) {
        let text = read(&page);
        // In code it is what a person types.
        let prose = text.split('`').step_by(2);
        let typed = prose.flat_map(str::lines).find(|line| line.split_whitespace().any(|word| word == "uL"));
        assert!(typed.is_none(), "{}: {typed:?}", page.display());
    }
}

#[test]
fn every_picture_that_the_command_draws_adapts_to_a_dark_screen() {
    let folder = tempfile::tempdir().expect("a folder for the pictures");
    let head =
        "pumps new --tube 10x14mm --backplate 63mm --roller 20mm --offset 40mm --contact 30deg --rollers 3";
    let hoses = "size --flow 2L/h --inlet-hose 6x10mm,1m --outlet-hose 6x10mm,3m";
    for (command, file) in [(head, Some("pump.toml")), (hoses, None), ("25mL --dry-run", None)] {
        let picture = folder.path().join("picture.svg");
        let output = Command::new(env!("CARGO_BIN_EXE_dose"))
            .args(command.split_whitespace())
            .arg("--plot")
            .arg(&picture)
            .args(file.map(|file| folder.path().join(file)))
            .env("DOSE_STATE_DIR", folder.path())
            .env("XDG_CONFIG_HOME", folder.path())
            .output()
            .expect("the command runs");
        assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(read(&picture).contains("prefers-color-scheme:dark"), "{command}");
    }
}
