//! The pages that people read, taken apart: the README, the book in `docs/`, and the other pages at
//! the top of the checkout and beside the crates.
//!
//! A block of shell commands says behind its language what a test does with it:
//!
//! | fence | what is done |
//! |---|---|
//! | `sh` | run, in a folder of its own for each page, one block after the other |
//! | `sh exit=1` | the same; its last command ends with that code |
//! | `sh full` | run by `cargo xtask test --full`; otherwise checked |
//! | `sh python` | run where the Python environment is; otherwise checked |
//! | `sh parse` | checked: it needs hardware, ROS, a network or a person |
//!
//! What is checked, and not run, must be a command that there is, with options that there are
//! ([`check`]).

pub mod check;
pub mod script;

use std::path::{Component, Path, PathBuf};
use std::{fs, io};

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

use crate::checkout;

/// A page with its includes in place.
#[derive(Debug)]
pub struct Page {
    /// Where it lies, from the checkout.
    pub path: PathBuf,
    /// Its text as it is on the disk.
    pub source: String,
    /// Fenced blocks.
    pub blocks: Vec<Block>,
    /// Code within lines.
    pub spans: Vec<String>,
    /// Where its links and pictures lead to, as written.
    pub links: Vec<String>,
    /// Its headings, as links name them.
    pub anchors: Vec<String>,
}

/// A fenced block.
#[derive(Debug)]
pub struct Block {
    /// What stands behind the fence: the language, then words.
    pub info: String,
    /// What is in it.
    pub text: String,
}

/// What a test does with a block of shell commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Treatment {
    /// Run; the code that its last command ends with.
    Run {
        /// The exit code.
        exit: u8,
    },
    /// Run in the long tier.
    Full,
    /// Run where the Python environment is.
    Python,
    /// Only checked.
    Parse,
}

impl Block {
    /// What is done with it; `None` for what is no shell block.
    ///
    /// # Errors
    /// Words behind the fence that mean nothing.
    pub fn treatment(&self) -> Result<Option<Treatment>, String> {
        let mut words = self.info.split_whitespace();
        if words.next() != Some("sh") {
            return Ok(None);
        }
        let word = words.next();
        let treatment = match word {
            None => Treatment::Run { exit: 0 },
            Some("full") => Treatment::Full,
            Some("python") => Treatment::Python,
            Some("parse") => Treatment::Parse,
            Some(word) => {
                let exit = word.strip_prefix("exit=").and_then(|code| code.parse().ok());
                let exit =
                    exit.ok_or(format!("`sh {word}`: expected full, python, parse or exit=N"))?;
                Treatment::Run { exit }
            }
        };
        match words.next() {
            None => Ok(Some(treatment)),
            Some(more) => Err(format!("`{}`: one word behind `sh`, not `{more}` too", self.info)),
        }
    }
}

/// Folders that hold no pages of this project.
const LEFT_OUT: [&str; 5] = ["target", "third_party", "runs", "node_modules", "ros"];

/// All pages.
///
/// # Panics
/// When a page cannot be read; the message names it.
#[must_use]
pub fn pages() -> Vec<Page> {
    let mut files = Vec::new();
    markdown_files(checkout(), &mut files).expect("the checkout can be read");
    files.sort();
    files.iter().map(|file| read(file)).collect()
}

fn markdown_files(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if path.is_dir() && !name.starts_with('.') && !LEFT_OUT.contains(&name) {
            markdown_files(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "md") {
            files.push(path);
        }
    }
    Ok(())
}

/// One page.
///
/// # Panics
/// When it, or what it includes, cannot be read.
#[must_use]
pub fn read(file: &Path) -> Page {
    let source = fs::read_to_string(file)
        .unwrap_or_else(|error| panic!("{} cannot be read: {error}", file.display()));
    let text = with_includes(&source, file);
    let mut page = Page {
        path: file.strip_prefix(checkout()).expect("it lies in the checkout").to_owned(),
        source,
        blocks: Vec::new(),
        spans: Vec::new(),
        links: Vec::new(),
        anchors: Vec::new(),
    };
    let mut heading: Option<String> = None;
    let mut block: Option<Block> = None;
    for event in Parser::new_ext(&text, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
            Event::End(TagEnd::Heading(_)) => {
                page.anchors.push(anchor(&heading.take().unwrap_or_default()));
            }
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(info))) => {
                block = Some(Block { info: info.to_string(), text: String::new() });
            }
            Event::End(TagEnd::CodeBlock) => page.blocks.extend(block.take()),
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                page.links.push(dest_url.to_string());
            }
            Event::Text(words) => {
                if let Some(block) = &mut block {
                    block.text += &words;
                } else if let Some(heading) = &mut heading {
                    *heading += &words;
                }
            }
            Event::Code(words) => {
                if let Some(heading) = &mut heading {
                    *heading += &words;
                }
                page.spans.push(words.to_string());
            }
            _ => {}
        }
    }
    page
}

/// A heading as the book's links name it.
#[must_use]
pub fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter_map(|c| match c {
        c if c.is_alphanumeric() || c == '_' || c == '-' => Some(c.to_ascii_lowercase()),
        c if c.is_whitespace() => Some('-'),
        _ => None,
    });
    kept.collect()
}

/// The text with what `{{#include FILE}}` and `{{#include FILE:ANCHOR}}` put in.
fn with_includes(text: &str, file: &Path) -> String {
    let mut whole = String::new();
    for line in text.lines() {
        let include = line.strip_prefix("{{#include ").and_then(|rest| rest.strip_suffix("}}"));
        let Some(named) = include else {
            whole.push_str(line);
            whole.push('\n');
            continue;
        };
        let (path, part) = named.split_once(':').unwrap_or((named, ""));
        let path = file.parent().unwrap_or(Path::new("")).join(path);
        let included = fs::read_to_string(&path).unwrap_or_else(|error| {
            panic!("{}: {} cannot be included: {error}", file.display(), path.display())
        });
        let inside = part.is_empty().then_some(included.as_str()).or_else(|| {
            let (_, rest) = included.split_once(&format!("<!-- ANCHOR: {part} -->"))?;
            Some(rest.split_once(&format!("<!-- ANCHOR_END: {part} -->"))?.0)
        });
        let inside = inside
            .unwrap_or_else(|| panic!("{}: {named} has no such part", file.display()))
            .to_owned();
        whole.push_str(&inside);
    }
    whole
}

/// A path without `.` and `..`; `None` if it leads out of the checkout.
#[must_use]
pub fn resolved(path: &Path) -> Option<PathBuf> {
    let mut whole = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                if !whole.pop() {
                    return None;
                }
            }
            Component::CurDir => {}
            part => whole.push(part),
        }
    }
    Some(whole)
}
