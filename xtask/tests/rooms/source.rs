//! The modules of a crate, as its sources have them, without its tests.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::{Attribute, Item, UseTree};

/// The way to a module or an item from the crate's root.
pub type Way = Vec<String>;

/// One module: what it names, and what is written in it.
#[derive(Default)]
pub struct Module {
    /// Names of the items that it defines itself.
    pub items: BTreeSet<String>,
    /// What its `use` lines bring in: a name, and the way as it is written.
    pub uses: Vec<(String, Way)>,
    /// Ways of its `use` lines that end with a star.
    pub stars: Vec<Way>,
    /// The items themselves.
    pub written: Vec<Item>,
    /// The file that it stands in.
    pub file: PathBuf,
}

/// The modules of a crate by their ways from its root, which is the empty one.
#[derive(Default)]
pub struct Crate {
    /// The modules.
    pub modules: BTreeMap<Way, Module>,
}

impl Crate {
    /// Reads `src/lib.rs` or `src/main.rs` and every module beneath.
    pub fn read(root: &Path) -> Self {
        let mut found = Self::default();
        found.enter(Way::new(), root, root.parent().unwrap());
        found
    }

    /// Takes in a file; modules beneath it lie in `inside`.
    fn enter(&mut self, way: Way, file: &Path, inside: &Path) {
        let text = fs::read_to_string(file).unwrap();
        let parsed = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        self.take(way, parsed.items, file, inside);
    }

    fn take(&mut self, way: Way, items: Vec<Item>, file: &Path, inside: &Path) {
        let mut module = Module { file: file.to_owned(), ..Module::default() };
        for item in items.into_iter().filter(|item| !of_tests(attributes(item))) {
            match item {
                Item::Mod(room) => {
                    let name = room.ident.to_string();
                    let (beneath, within) =
                        ([&way[..], std::slice::from_ref(&name)].concat(), inside.join(&name));
                    match room.content {
                        Some((_, items)) => self.take(beneath, items, file, &within),
                        None => {
                            let mut files =
                                [within.join("mod.rs"), inside.join(name + ".rs")].into_iter();
                            let file =
                                files.find(|file| file.is_file()).expect("a module has its file");
                            self.enter(beneath, &file, &within);
                        }
                    }
                }
                // Another crate's, whatever this one has of that name.
                Item::Use(line) if line.leading_colon.is_some() => {}
                Item::Use(line) => module.bring(&line.tree, &Way::new()),
                other => {
                    module.items.extend(name(&other));
                    module.written.push(other);
                }
            }
        }
        self.modules.insert(way, module);
    }
}

impl Module {
    /// Takes in a `use` line whose beginning is `before`.
    fn bring(&mut self, tree: &UseTree, before: &Way) {
        let longer = |last: &syn::Ident| [&before[..], &[last.to_string()]].concat();
        match tree {
            UseTree::Path(path) => self.bring(&path.tree, &longer(&path.ident)),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.bring(tree, before)),
            UseTree::Glob(_) => self.stars.push(before.clone()),
            UseTree::Rename(renamed) => {
                self.uses.push((renamed.rename.to_string(), longer(&renamed.ident)));
            }
            UseTree::Name(name) if name.ident == "self" => {
                self.uses.extend(before.last().map(|last| (last.clone(), before.clone())));
            }
            UseTree::Name(name) => self.uses.push((name.ident.to_string(), longer(&name.ident))),
        }
    }
}

fn name(item: &Item) -> Option<String> {
    Some(match item {
        Item::Const(item) => item.ident.to_string(),
        Item::Enum(item) => item.ident.to_string(),
        Item::Fn(item) => item.sig.ident.to_string(),
        Item::Static(item) => item.ident.to_string(),
        Item::Struct(item) => item.ident.to_string(),
        Item::Trait(item) => item.ident.to_string(),
        Item::Type(item) => item.ident.to_string(),
        Item::Union(item) => item.ident.to_string(),
        Item::Macro(item) => item.ident.as_ref()?.to_string(),
        _ => return None,
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// Whether an item is built for tests only.
fn of_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    })
}

/// Every Rust file beneath a folder.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .flat_map(|path| if path.is_dir() { rust_files(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect()
}

/// Lines of a crate's `src` that are neither empty, nor comments, nor tests.
pub fn lines_of_code(folder: &Path) -> usize {
    let of_tests = |file: &Path| {
        file.components().any(|part| part.as_os_str() == "tests") || file.ends_with("tests.rs")
    };
    let source = folder.join("src");
    let files = rust_files(&source);
    let files = files.iter().filter(|file| !of_tests(file.strip_prefix(&source).unwrap()));
    let code = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
    files
        .map(|file| fs::read_to_string(file).unwrap())
        .map(|text| text.split("\n#[cfg(test)]\nmod ").next().unwrap().lines().filter(code).count())
        .sum()
}
