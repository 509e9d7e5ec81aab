//! What a reader sees of a report at three widths, light and dark: held against pictures, and
//! looked through for what keeps people from it.

use std::path::Path;

use report::render_page;
use serde_json::{Value, json};
use tests::pictures::{SETTLED, boxed, complaint};
use tests::tab::Tab;

use crate::report_browser::demonstration;

/// Pixels of the windows: of a phone, of half a screen, of a whole one.
const WIDTHS: [u32; 3] = [390, 900, 1400];

const FITS: &str = include_str!("../../browser/fits.js");

/// Shows a page in a window and waits until its figures stand.
pub(crate) fn show(tab: &mut Tab, file: &Path, width: u32, dark: bool) {
    tab.look(width, dark);
    tab.go("about:blank");
    tab.go(&format!("file://{}", file.display()));
    tab.until(
        "!document.querySelector('.plot') || document.documentElement.dataset.figures === 'drawn'",
    );
}

/// A browser that has shown the page once: its font is at hand when figures measure their legends.
fn warm(file: &Path) -> Tab {
    let mut tab = Tab::open();
    show(&mut tab, file, 900, false);
    assert_eq!(tab.evaluate(SETTLED), true);
    tab
}

/// What is wrong with the page in `file` at each width: parts that are cut or wider than the
/// window, curves that look alike, axes without words, complaints of the browser.
pub(crate) fn misfits(tab: &mut Tab, file: &Path) -> Vec<String> {
    let mut wrong = Vec::new();
    for width in WIDTHS {
        show(tab, file, width, width == 900);
        let found = tab.evaluate(&format!("(() => {{ {FITS} }})()"));
        let none = json!({ "wide": [], "stuck": [], "alike": [], "untitled": [], "page": 0 });
        if found != none {
            wrong.push(format!("{} at {width}: {found}", file.display()));
        }
        wrong.extend(tab.complaints());
    }
    wrong
}

/// What keeps people from the page in `file`, in light and in dark.
pub(crate) fn barriers(tab: &mut Tab, file: &Path) -> Vec<String> {
    let axe = std::fs::read_to_string(machine::axe()).expect("axe-core");
    let mut wrong = Vec::new();
    for (width, dark) in [(1400, false), (390, true)] {
        show(tab, file, width, dark);
        tab.evaluate(&format!("(() => {{ {axe}; return 1; }})()"));
        let found = tab.evaluate(
            "axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice'] })
             .then((all) => all.violations.map((one) => one.id + ': ' + one.nodes.map((node) => node.target + ' ' + node.failureSummary).join('; ')))",
        );
        if found != Value::Array(Vec::new()) {
            wrong.push(format!("{} at {width}, dark {dark}: {found}", file.display()));
        }
    }
    wrong
}

#[tests::needs(chromium)]
#[test]
fn the_demonstration_page_looks_as_it_did() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("page.html");
    boxed(&render_page(&demonstration::demonstration()), &file);
    let mut tab = warm(&file);
    let mut wrong = Vec::new();
    for width in WIDTHS {
        for dark in [false, true] {
            show(&mut tab, &file, width, dark);
            assert_eq!(tab.evaluate(SETTLED), true);
            let name = format!("report_{width}_{}", if dark { "dark" } else { "light" });
            wrong.extend(complaint(&mut tab, &name));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The comparison can fail: each of these pages has one fault, and it is seen.
#[tests::needs(chromium)]
#[test]
fn a_page_that_looks_different_is_noticed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("page.html");
    let html = render_page(&demonstration::demonstration());
    boxed(&html, &file);
    let mut tab = warm(&file);
    let mut picture = |html: &str| {
        boxed(html, &file);
        show(&mut tab, &file, 900, false);
        assert_eq!(tab.evaluate(SETTLED), true);
        tab.whole_picture(0.5)
    };
    let sound = picture(&html);
    let faults = [
        // The second colour is the first one.
        ("--c1: #d55e00;", "--c1: #0072b2;"),
        // A table is cut.
        ("overflow-x: auto;", "width: 60%; overflow: hidden;"),
        // Dark where it should be light.
        ("--paper: #ffffff;", "--paper: #15191e;"),
        // A legend is gone.
        ("showlegend: new Set(traces", "showlegend: false && new Set(traces"),
    ];
    let again = picture(&html);
    let broken: Vec<Vec<u8>> = faults
        .iter()
        .map(|(sound, broken)| {
            assert!(html.contains(sound), "{sound} has changed: adapt this test");
            picture(&html.replacen(sound, broken, 1))
        })
        .collect();
    let same = tests::pictures::compare(&mut tab, &sound, &again);
    assert!(same.is_small() && same.worst < 1.0, "{same:?}");
    for (fault, seen) in faults.iter().zip(broken) {
        let found = tests::pictures::compare(&mut tab, &seen, &sound);
        assert!(!found.is_small(), "{fault:?}: {found:?}");
        println!("{fault:?}: {found:?}");
    }
}

#[tests::needs(chromium)]
#[test]
fn the_demonstration_page_fits_every_window() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("page.html");
    std::fs::write(&file, render_page(&demonstration::demonstration())).expect("the page");
    let mut tab = Tab::open();
    assert_eq!(misfits(&mut tab, &file), [""; 0]);
    // Each fault is seen.
    let html = render_page(&demonstration::demonstration());
    let faults: [&[(&str, &str)]; 4] = [
        &[(".sideways {\n  overflow-x: auto;", ".sideways {\n  overflow-x: visible;")],
        &[("tabindex=\"0\"", "tabindex=\"-1\"")],
        &[
            ("'dash', 'dot', 'dashdot'", "'solid', 'solid', 'solid'"),
            ("SYMBOLS[trace.marker]", "SYMBOLS[0]"),
        ],
        &[("\"x_label\":\"time [s]\"", "\"x_label\":\"[s]\"")],
    ];
    for fault in faults {
        let mut broken = html.clone();
        for (sound, other) in fault {
            assert!(broken.contains(sound), "{sound} has changed: adapt this test");
            broken = broken.replace(sound, other);
        }
        std::fs::write(&file, broken).expect("the page");
        assert!(!misfits(&mut tab, &file).is_empty(), "{fault:?}");
    }
}

#[tests::needs(chromium, axe)]
#[test]
fn nothing_keeps_people_from_the_demonstration_page() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("page.html");
    std::fs::write(&file, render_page(&demonstration::demonstration())).expect("the page");
    assert_eq!(barriers(&mut Tab::open(), &file), [""; 0]);
}
