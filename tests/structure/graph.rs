//! Files and the arrows between them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

/// For each file the files that it names something from, with the names.
#[derive(Default)]
pub(crate) struct Graph {
    arrows: BTreeMap<PathBuf, BTreeMap<PathBuf, BTreeSet<String>>>,
}

impl Graph {
    /// Draws an arrow from the naming file to the defining file.
    pub(crate) fn add(&mut self, from: &Path, to: &Path, name: &str) {
        if from != to {
            let names = self.arrows.entry(from.to_owned()).or_default().entry(to.to_owned()).or_default();
            names.insert(name.to_owned());
        }
    }

    pub(crate) fn has(&self, from: &Path, to: &Path) -> bool {
        self.arrows.get(from).is_some_and(|others| others.contains_key(to))
    }

    /// Number of arrows.
    pub(crate) fn len(&self) -> usize {
        self.arrows.values().map(BTreeMap::len).sum()
    }

    pub(crate) fn arrows(&self) -> impl Iterator<Item = (&PathBuf, Vec<&PathBuf>)> {
        self.arrows.iter().map(|(file, others)| (file, others.keys().collect()))
    }

    /// The graph of the rooms that `room` puts the files in. A file without a room is left out.
    pub(crate) fn of_rooms(&self, room: impl Fn(&Path) -> Option<PathBuf>) -> Self {
        let mut rooms = Self::default();
        for (from, others) in &self.arrows {
            for (to, names) in others {
                if let (Some(one), Some(two)) = (room(from), room(to)) {
                    names.iter().for_each(|name| rooms.add(&one, &two, name));
                }
            }
        }
        rooms
    }

    /// Groups of files that reach one another (strongly connected components with two files or more), by Tarjan's
    /// algorithm.
    pub(crate) fn circles(&self) -> Vec<Vec<PathBuf>> {
        let mut search = Search { graph: self, ..Search::default() };
        for file in self.arrows.keys() {
            if !search.order.contains_key(file) {
                search.visit(file);
            }
        }
        search.found
    }

    /// A circle in words: its files, and what ties them.
    pub(crate) fn describe(&self, circle: &[PathBuf]) -> String {
        let mut text = format!("{} files:\n", circle.len());
        for from in circle {
            for (to, names) in &self.arrows[from] {
                if circle.contains(to) {
                    let names: Vec<&str> = names.iter().map(String::as_str).collect();
                    text += &format!("  {} -> {}: {}\n", from.display(), to.display(), names.join(", "));
                }
            }
        }
        text
    }
}

/// One arrow a line.
impl Display for Graph {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (from, others) in &self.arrows {
            for (to, names) in others {
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                writeln!(f, "{} -> {}: {}", from.display(), to.display(), names.join(", "))?;
            }
        }
        Ok(())
    }
}

struct Search<'a> {
    graph: &'a Graph,
    order: BTreeMap<&'a PathBuf, usize>,
    lowest: BTreeMap<&'a PathBuf, usize>,
    stack: Vec<&'a PathBuf>,
    found: Vec<Vec<PathBuf>>,
}

impl Default for Search<'_> {
    fn default() -> Self {
        const NO_ARROWS: &Graph = &Graph { arrows: BTreeMap::new() };
        Self {
            graph: NO_ARROWS,
            order: BTreeMap::new(),
            lowest: BTreeMap::new(),
            stack: Vec::new(),
            found: Vec::new(),
        }
    }
}

impl<'a> Search<'a> {
    fn visit(&mut self, file: &'a PathBuf) {
        let number = self.order.len();
        self.order.insert(file, number);
        self.lowest.insert(file, number);
        self.stack.push(file);
        for other in self.graph.arrows.get(file).into_iter().flat_map(BTreeMap::keys) {
            let reached = if !self.order.contains_key(other) {
                self.visit(other);
                self.lowest[other]
            } else if self.stack.contains(&other) {
                self.order[other]
            } else {
                continue;
            };
            let lowest = self.lowest[file].min(reached);
            self.lowest.insert(file, lowest);
        }
        if self.lowest[file] == number {
            let start = self.stack.iter().position(|other| *other == file).expect("it was pushed above");
            let circle: Vec<PathBuf> = self.stack.split_off(start).into_iter().cloned().collect();
            if circle.len() > 1 {
                self.found.push(circle);
            }
        }
    }
}
