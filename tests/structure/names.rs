//! The file that defines a name: paths are followed through imports and re-exports.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Expr, Item, ItemMod, ItemUse, Macro, Token, UseTree, Visibility};

use crate::graph::Graph;
use crate::sources::Sources;

type ModulePath = Vec<String>;

/// Meaning of a name in a module.
#[derive(Clone)]
enum Meaning {
    /// Something that the module defines.
    Item,
    /// A module below it.
    Module,
    /// An import of this path, seen from the module.
    Import(Vec<String>),
}

/// Every name of every module.
pub(crate) struct Names<'a> {
    sources: &'a Sources,
    meanings: BTreeMap<ModulePath, BTreeMap<String, Vec<Meaning>>>,
    globs: BTreeMap<ModulePath, Vec<Vec<String>>>,
}

impl<'a> Names<'a> {
    pub(crate) fn new(sources: &'a Sources) -> Self {
        let mut names = Self { sources, meanings: BTreeMap::new(), globs: BTreeMap::new() };
        for (path, module) in &sources.modules {
            let meanings = names.meanings.entry(path.clone()).or_default();
            let globs = names.globs.entry(path.clone()).or_default();
            for item in &module.items {
                if let Item::Use(item) = item {
                    for (name, target) in imports(item) {
                        if name == "*" {
                            globs.push(target);
                        } else {
                            meanings.entry(name).or_default().push(Meaning::Import(target));
                        }
                    }
                } else if let Some(name) = defined(item) {
                    let meaning = if matches!(item, Item::Mod(_)) { Meaning::Module } else { Meaning::Item };
                    meanings.entry(name).or_default().push(meaning);
                }
            }
        }
        names
    }

    /// An arrow from every file to the files that define what it names. Re-exports draw none.
    pub(crate) fn graph(&self) -> Graph {
        let mut graph = Graph::default();
        for (path, module) in &self.sources.modules {
            let mut named = Named::default();
            for item in &module.items {
                named.visit_item(item);
            }
            for used in named.paths {
                for file in self.files(path, &used) {
                    graph.add(&module.file, &file, used.last().expect("a path has a name"));
                }
            }
        }
        graph
    }

    /// Files that define what `used` means inside `module`.
    fn files(&self, module: &ModulePath, used: &[String]) -> BTreeSet<PathBuf> {
        let mut files = BTreeSet::new();
        self.follow(module, used, &mut BTreeSet::new(), &mut files);
        files
    }

    /// True if a path that begins so leads into the workspace.
    fn is_ours(&self, module: &ModulePath, first: &str) -> bool {
        ["crate", "self", "super"].contains(&first)
            || self.meanings[module].contains_key(first)
            || self.meanings.contains_key(&vec![first.to_owned()])
    }

    fn follow(
        &self,
        module: &ModulePath,
        used: &[String],
        seen: &mut BTreeSet<(ModulePath, Vec<String>)>,
        files: &mut BTreeSet<PathBuf>,
    ) {
        if !seen.insert((module.clone(), used.to_vec())) {
            return;
        }
        let Some((first, rest)) = used.split_first() else {
            return;
        };
        match first.as_str() {
            "crate" => return self.follow(&module[..1].to_vec(), rest, seen, files),
            "self" => return self.follow(module, rest, seen, files),
            "super" => return self.follow(&module[..module.len() - 1].to_vec(), rest, seen, files),
            _ => {}
        }
        let meanings = self.meanings[module].get(first);
        // A function may have a module's name; a path that goes on leads through the module.
        let through_module = !rest.is_empty()
            && meanings.is_some_and(|all| all.iter().any(|meaning| matches!(meaning, Meaning::Module)));
        for meaning in meanings.into_iter().flatten() {
            match meaning {
                Meaning::Item | Meaning::Import(_) if through_module => {}
                Meaning::Item => {
                    files.insert(self.sources.modules[module].file.clone());
                }
                Meaning::Module => {
                    let below = [module.clone(), vec![first.clone()]].concat();
                    self.follow(&below, rest, seen, files);
                }
                // `use plan::plan`: the first `plan` is the module.
                Meaning::Import(target) if target.first() == Some(first) => {
                    let mut below = module.clone();
                    if matches!(self.meanings[module][first].as_slice(), [Meaning::Import(_)]) {
                        below.clear();
                    }
                    below.push(first.clone());
                    if self.meanings.contains_key(&below) {
                        self.follow(&below, &[&target[1..], rest].concat(), seen, files);
                    }
                }
                Meaning::Import(target) => self.follow(module, &[target, rest].concat(), seen, files),
            }
        }
        if meanings.is_none() {
            let crate_root = vec![first.clone()];
            if self.meanings.contains_key(&crate_root) && !rest.is_empty() {
                return self.follow(&crate_root, rest, seen, files);
            }
            for glob in self.globs[module].iter().filter(|glob| self.is_ours(module, &glob[0])) {
                self.follow(module, &[glob, used].concat(), seen, files);
            }
        }
    }
}

/// Names that a `use` brings, each with the path that it stands for.
fn imports(item: &ItemUse) -> Vec<(String, Vec<String>)> {
    fn walk(tree: &UseTree, before: &[String], found: &mut Vec<(String, Vec<String>)>) {
        let with = |name: String| [before, &[name]].concat();
        match tree {
            UseTree::Path(path) => walk(&path.tree, &with(path.ident.to_string()), found),
            UseTree::Name(name) if name.ident == "self" => {
                found.push((before.last().cloned().unwrap_or_default(), before.to_vec()));
            }
            UseTree::Name(name) => found.push((name.ident.to_string(), with(name.ident.to_string()))),
            UseTree::Rename(rename) => {
                found.push((rename.rename.to_string(), with(rename.ident.to_string())));
            }
            UseTree::Glob(_) => found.push(("*".to_owned(), before.to_vec())),
            UseTree::Group(group) => group.items.iter().for_each(|tree| walk(tree, before, found)),
        }
    }
    let mut found = Vec::new();
    walk(&item.tree, &[], &mut found);
    found
}

/// The name that an item defines.
fn defined(item: &Item) -> Option<String> {
    let ident = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        Item::Mod(item) => &item.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(ident.to_string())
}

/// Every path that a module names.
#[derive(Default)]
struct Named {
    paths: BTreeSet<Vec<String>>,
}

impl<'ast> Visit<'ast> for Named {
    // A module below is visited by itself.
    fn visit_item_mod(&mut self, _: &'ast ItemMod) {}

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if matches!(item.vis, Visibility::Inherited) {
            self.paths
                .extend(imports(item).into_iter().filter(|(name, _)| name != "*").map(|(_, path)| path));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.paths.insert(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    // The arguments of a macro such as `format!` are expressions, most of the time.
    fn visit_macro(&mut self, mac: &'ast Macro) {
        if let Ok(arguments) = mac.parse_body_with(Punctuated::<Expr, Token![,]>::parse_terminated) {
            arguments.iter().for_each(|argument| expression(self, argument));
        }
    }
}

/// Expressions of a macro live shorter than the file that they stand in.
fn expression(named: &mut Named, argument: &Expr) {
    named.visit_expr(argument);
}
