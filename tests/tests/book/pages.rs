//! The README, the book and the other pages: their links lead somewhere, their lengths are kept,
//! and every page of the book is in its table of contents.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use tests::book::{Page, anchor, pages, resolved};
use tests::checkout;

/// Longest line of prose [characters]. Tables, blocks, links and comments may be longer.
const COLUMNS: usize = 100;

#[test]
fn the_readme_fits_on_three_screens() {
    let readme = tests::book::read(&checkout().join("README.md"));
    let lines = readme.source.lines().count();
    assert!(lines <= 150, "README.md has {lines} lines; at most 150, the rest belongs to the book");
    let pictures = readme.source.matches("![").count();
    assert_eq!(pictures, 1, "README.md shows one picture");
}

#[test]
fn every_page_of_the_book_is_in_its_contents_once() {
    let pages = pages();
    let contents = pages.iter().find(|page| page.path == Path::new("docs/SUMMARY.md")).unwrap();
    let named: Vec<_> = contents.links.iter().map(|link| Path::new("docs").join(link)).collect();
    let all: BTreeSet<_> = named.iter().collect();
    assert_eq!(all.len(), named.len(), "docs/SUMMARY.md names a page twice");
    for page in pages.iter().filter(|page| page.path.starts_with("docs")) {
        let known = all.contains(&page.path) || page.path == contents.path;
        assert!(known, "{} is not in docs/SUMMARY.md", page.path.display());
    }
    for page in named {
        assert!(checkout().join(&page).is_file(), "docs/SUMMARY.md: no page {}", page.display());
    }
}

/// What is wrong with a link of a page.
fn fault(page: &Page, link: &str, anchors: &BTreeMap<&Path, &[String]>) -> Option<String> {
    if link.contains("://") || link.contains('@') {
        return None;
    }
    let (file, heading) = link.split_once('#').unwrap_or((link, ""));
    let target = if file.is_empty() {
        page.path.clone()
    } else {
        let beside = page.path.parent().unwrap_or(Path::new("")).join(file);
        match resolved(&beside) {
            Some(target) => target,
            None => return Some("leads out of the checkout".to_owned()),
        }
    };
    if !checkout().join(&target).exists() {
        return Some(format!("there is no {}", target.display()));
    }
    if page.path.starts_with("docs") && !target.starts_with("docs") {
        return Some("leads out of docs/, where the built book has nothing".to_owned());
    }
    let known = heading.is_empty()
        || anchors.get(target.as_path()).is_some_and(|all| all.iter().any(|one| one == heading));
    (!known).then(|| format!("{} has no heading `#{heading}`", target.display()))
}

#[test]
fn every_link_leads_somewhere() {
    let pages = pages();
    let anchors: BTreeMap<&Path, &[String]> =
        pages.iter().map(|page| (page.path.as_path(), page.anchors.as_slice())).collect();
    let mut faults = Vec::new();
    for page in &pages {
        for link in &page.links {
            if let Some(fault) = fault(page, link, &anchors) {
                faults.push(format!("{}: [{link}]: {fault}", page.path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let links: usize = pages.iter().map(|page| page.links.len()).sum();
    assert!(links > 150, "only {links} links were found");
}

#[test]
fn a_link_that_leads_nowhere_is_found() {
    let readme = tests::book::read(&checkout().join("README.md"));
    let page = tests::book::read(&checkout().join("docs/README.md"));
    let known = ["tutorials".to_owned()];
    let anchors = BTreeMap::from([(Path::new("docs/README.md"), known.as_slice())]);
    for (page, link, what) in [
        (&readme, "docs/nothing.md", "there is no"),
        (&readme, "docs/README.md#nothing", "no heading"),
        (&readme, "../nothing", "leads out of the checkout"),
        (&page, "../README.md", "leads out of docs/"),
    ] {
        let fault = fault(page, link, &anchors).expect(link);
        assert!(fault.contains(what), "{link}: {fault}");
    }
    for link in ["docs/README.md#tutorials", "LICENSE-MIT", "https://example.org/nothing"] {
        assert_eq!(fault(&readme, link, &anchors), None, "{link}");
    }
    assert_eq!(anchor("The thesis's tables, 2 of `them`"), "the-thesiss-tables-2-of-them");
}

#[test]
fn prose_keeps_to_its_columns_and_blocks_say_what_they_are() {
    let mut faults = Vec::new();
    let kept = ["docs", "python", "launch_configs"].map(Path::new);
    let of_a_crate = |page: &&Page| {
        page.path.components().count() > 1 && !kept.iter().any(|it| page.path.starts_with(it))
    };
    for page in pages().iter().filter(|page| !of_a_crate(page)) {
        let name = page.path.display().to_string();
        for block in &page.blocks {
            if block.info.is_empty() {
                faults.push(format!("{name}: a block without a language: {:.60}", block.text));
            }
            if let Err(fault) = block.treatment() {
                faults.push(format!("{name}: {fault}"));
            }
        }
        let made =
            name.starts_with("docs/reference/models") || name == "docs/reference/commands.md";
        let mut in_block = false;
        for (number, line) in page.source.lines().enumerate() {
            in_block ^= line.trim_start().starts_with("```");
            let free = in_block || made || line.trim_start().starts_with(['|', '!', '<', '[']);
            if !free && line.chars().count() > COLUMNS && line.contains(' ') {
                faults.push(format!("{name}:{}: {} columns", number + 1, line.chars().count()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_files_that_pages_name_are_there() {
    let of_the_book =
        |page: &&Page| page.path.starts_with("docs") || page.path.components().count() == 1;
    // Results and builds are made by the reader.
    let made = ["runs", "target"];
    let mut faults = Vec::new();
    let mut checked = 0;
    for page in pages().iter().filter(of_the_book) {
        for span in &page.spans {
            let is_a_path = |c: char| c.is_alphanumeric() || "/._-".contains(c);
            let Some((top, _)) = span.split_once('/') else { continue };
            let ours = !top.is_empty() && !made.contains(&top) && checkout().join(top).is_dir();
            if !ours || span.contains("NAME") || !span.chars().all(is_a_path) {
                continue;
            }
            checked += 1;
            if !checkout().join(span).exists() {
                faults.push(format!("{}: there is no {span}", page.path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(checked > 40, "only {checked} files were found");
}
