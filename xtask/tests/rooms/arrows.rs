//! Which module speaks of which: `use` lines, paths in the code, paths within macros.

use std::collections::{BTreeMap, BTreeSet};

use syn::visit::{self, Visit};

use crate::source::{Crate, Module, Way};

/// Arrows between modules beneath one parent, with a file that draws each.
pub type Graph = BTreeMap<String, BTreeMap<String, String>>;

/// The graph of every module that has some beneath it.
pub fn between_siblings(from: &Crate) -> BTreeMap<String, Graph> {
    let mut graphs: BTreeMap<String, Graph> = BTreeMap::new();
    for (way, module) in &from.modules {
        for target in spoken_of(from, way, module) {
            let same = way.iter().zip(&target).take_while(|(a, b)| a == b).count();
            if let (Some(a), Some(b)) = (way.get(same), target.get(same)) {
                let parent: String = way[..same].iter().map(|name| format!("::{name}")).collect();
                let drawn = graphs.entry(parent).or_default().entry(a.clone()).or_default();
                let file = module.file.file_name().unwrap().to_string_lossy();
                let what = format!("{file} speaks of {}", target.join("::"));
                drawn.entry(b.clone()).or_insert(what);
            }
        }
    }
    graphs
}

/// The modules whose items a module names.
fn spoken_of(from: &Crate, way: &Way, module: &Module) -> BTreeSet<Way> {
    let mut paths = Paths::default();
    module.written.iter().for_each(|item| paths.visit_item(item));
    let used = module.uses.iter().map(|(_, written)| written);
    let written = used.chain(&module.stars).chain(&paths.0);
    written.filter_map(|written| owner(from, way, written, 0)).collect()
}

/// The module in which an item stands, for a way as it is written in module `at`; `None` for what
/// other crates hold.
fn owner(from: &Crate, at: &Way, written: &[String], depth: usize) -> Option<Way> {
    let (first, rest) = written.split_first()?;
    match first.as_str() {
        "crate" => lookup(from, &Way::new(), rest, depth),
        "self" => lookup(from, at, rest, depth),
        "super" => owner(from, &at[..at.len().checked_sub(1)?].to_vec(), &with_self(rest), depth),
        _ => {
            let known = named(from, at, first).is_some();
            if known { lookup(from, at, written, depth) } else { None }
        }
    }
}

/// `super::super::x` is read one step at a time.
fn with_self(rest: &[String]) -> Way {
    match rest.first().map(String::as_str) {
        Some("super") => rest.to_vec(),
        _ => [&["self".to_owned()], rest].concat(),
    }
}

/// Where a name of a module leads.
enum Leads<'a> {
    Beneath(Way),
    Here,
    Elsewhere(&'a Way),
}

fn named<'a>(from: &'a Crate, at: &Way, name: &str) -> Option<Leads<'a>> {
    let beneath = [&at[..], &[name.to_owned()]].concat();
    if from.modules.contains_key(&beneath) {
        return Some(Leads::Beneath(beneath));
    }
    let module = from.modules.get(at)?;
    if module.items.contains(name) {
        return Some(Leads::Here);
    }
    let brought = module.uses.iter().find(|(known, _)| known == name);
    brought.map(|(_, written)| Leads::Elsewhere(written))
}

/// Follows a way down from module `at`, through what is used again.
fn lookup(from: &Crate, at: &Way, rest: &[String], depth: usize) -> Option<Way> {
    // A name that is brought in by the name of a crate may lead to itself.
    const DEEPEST: usize = 16;
    let Some((first, beyond)) = rest.split_first().filter(|_| depth < DEEPEST) else {
        return Some(at.clone());
    };
    match named(from, at, first) {
        Some(Leads::Beneath(module)) => lookup(from, &module, beyond, depth + 1),
        Some(Leads::Here) => Some(at.clone()),
        Some(Leads::Elsewhere(written)) if written.first() != Some(first) || written.len() > 1 => {
            owner(from, at, &[written, beyond].concat(), depth + 1)
        }
        Some(Leads::Elsewhere(_)) => None,
        None => {
            let stars = &from.modules.get(at)?.stars;
            let through = stars.iter().find_map(|star| {
                let room = owner(from, at, star, depth + 1)?;
                named(from, &room, first).map(|_| lookup(from, &room, rest, depth + 1))
            });
            through.unwrap_or_else(|| Some(at.clone()))
        }
    }
}

/// Paths of more than one name in code and in the words of macros.
#[derive(Default)]
struct Paths(Vec<Way>);

impl<'ast> Visit<'ast> for Paths {
    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() && path.segments.len() > 1 {
            self.0.push(path.segments.iter().map(|part| part.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.words(&call.tokens.to_string());
        visit::visit_macro(self, call);
    }
}

impl Paths {
    fn words(&mut self, tokens: &str) {
        let tokens = tokens.replace(" :: ", "::");
        let words = tokens.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        let rooted = |word: &&str| {
            ["crate::", "super::", "self::"].iter().any(|root| word.starts_with(root))
        };
        let ways = words.filter(rooted).map(|word| word.split("::").map(str::to_owned).collect());
        self.0.extend(ways);
    }
}
