//! The modules of every crate of the workspace, parsed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

use syn::{Attribute, Item, ItemMod};

/// A module: its file and its items.
pub(crate) struct Module {
    /// File in which its items stand, relative to the workspace.
    pub file: PathBuf,
    /// Items, those of `cfg(test)` left out.
    pub items: Vec<Item>,
}

/// Every module by its path, the name of its crate first.
pub(crate) struct Sources {
    pub modules: BTreeMap<Vec<String>, Module>,
}

/// A crate that has no library is called after its folder.
const CRATES: [(&str, &str); 10] = [
    ("dose", "src/main.rs"),
    ("pump_dose", "src/lib.rs"),
    ("pump_bench", "crates/pump-bench/src/lib.rs"),
    ("pump_model", "crates/pump-model/src/lib.rs"),
    ("pump_ctl", "crates/pump-ctl/src/lib.rs"),
    ("pump_link", "crates/pump-link/src/lib.rs"),
    ("pump_node", "crates/pump-node/src/lib.rs"),
    ("pump_service", "crates/pump-service/src/lib.rs"),
    ("_pumpmodel", "crates/pump-py/src/lib.rs"),
    ("benches", "benches/src/main.rs"),
];

impl Sources {
    /// Parses every crate of the workspace in the folder `root`.
    pub(crate) fn of_workspace(root: &Path) -> Self {
        let mut sources = Self { modules: BTreeMap::new() };
        for (name, file) in CRATES.into_iter().filter(|(_, f)| root.join(f).exists()) {
            sources.read(
                root,
                vec![name.to_owned()],
                PathBuf::from(file),
                Path::new(file).parent().expect("a file has a folder"),
            );
        }
        sources
    }

    /// Reads the module `path` from `file`; its children are in `folder`.
    fn read(&mut self, root: &Path, path: Vec<String>, file: PathBuf, folder: &Path) {
        let text = fs::read_to_string(root.join(&file))
            .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let items =
            syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display())).items;
        self.add(root, path, &file, folder, items);
    }

    fn add(&mut self, root: &Path, path: Vec<String>, file: &Path, folder: &Path, items: Vec<Item>) {
        let items: Vec<Item> = items.into_iter().filter(|item| !of_tests(attributes(item))).collect();
        for item in &items {
            if let Item::Mod(ItemMod { ident, content, .. }) = item {
                let name = ident.to_string();
                let below = folder.join(&name);
                let path = [path.clone(), vec![name.clone()]].concat();
                match content {
                    Some((_, items)) => self.add(root, path, file, &below, items.clone()),
                    None => {
                        let alone = folder.join(format!("{name}.rs"));
                        let room = below.join("mod.rs");
                        let file = if root.join(&alone).exists() { alone } else { room };
                        self.read(root, path, file, &below);
                    }
                }
            }
        }
        self.modules.insert(path, Module { file: file.to_owned(), items });
    }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// True if an item is there for tests alone.
fn of_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Ident>().is_ok_and(|what| what == "test" || what == "doctest")
    })
}

/// Every file below `root` that has one of these endings, relative to it; what is built or downloaded is left out.
pub(crate) fn files(root: &Path, endings: &[&str]) -> Vec<PathBuf> {
    fn walk(folder: &Path, visit: &mut impl FnMut(PathBuf)) -> io::Result<()> {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let built = ["target", "node_modules", "__pycache__"].contains(&&*name);
            if built || (name.starts_with('.') && name != ".ci" && name != ".cargo") {
                continue;
            }
            if entry.file_type()?.is_dir() { walk(&entry.path(), visit)? } else { visit(entry.path()) }
        }
        Ok(())
    }
    let mut files = Vec::new();
    let mut visit = |path: PathBuf| {
        if path.extension().is_some_and(|end| endings.iter().any(|ending| end == *ending)) {
            files.push(path.strip_prefix(root).expect("it was found below the root").to_owned());
        }
    };
    walk(root, &mut visit).expect("the sources can be read");
    files.sort();
    files
}
