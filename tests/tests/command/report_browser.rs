//! The report in a real browser: does it draw what it says, without a complaint and without a
//! network?

use std::path::{Path, PathBuf};

use report::figure::Block;
use report::render_page;
use tests::browser::{Browser, Seen};

#[path = "../../../report/examples/report_demo/page.rs"]
pub(crate) mod demonstration;

/// Where a person may look at what the test saw.
fn picture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// No complaint, no request, and every figure with all its traces.
fn assert_sound(seen: &Seen) {
    assert_eq!(seen.complaints, [""; 0], "the page complains");
    assert_eq!(seen.requests, [""; 0], "the page reaches out");
    for (number, figure) in seen.figures.iter().enumerate() {
        assert!(figure.expected > 0, "figure {}: nothing to draw", number + 1);
        assert_eq!(figure.drawn, figure.expected, "figure {}: traces drawn", number + 1);
    }
}

#[tests::needs(chromium)]
#[test]
fn the_demonstration_page_draws_everything() {
    let browser = Browser::installed();
    let page = demonstration::demonstration();
    let html = render_page(&page);
    let seen = browser.load(&html, "");
    assert_sound(&seen);

    let figures: Vec<_> = page
        .blocks
        .iter()
        .filter_map(|block| if let Block::Figure(figure) = block { Some(figure) } else { None })
        .collect();
    assert_eq!(seen.figures.len(), figures.len());
    for (seen, figure) in seen.figures.iter().zip(figures) {
        assert_eq!(seen.drawn, figure.panels.iter().map(|p| p.traces.len() as u64).sum::<u64>());
        for label in figure.panels.iter().map(|p| &p.y_label).chain([&figure.x_label]) {
            assert!(
                seen.axis_titles.contains(label),
                "{label} is not among {:?}",
                seen.axis_titles
            );
        }
    }

    for (name, dark) in [("report_demo.png", false), ("report_demo_dark.png", true)] {
        let png = picture(name);
        browser.screenshot(&html, &png, seen.height, dark);
        let size = std::fs::metadata(&png).expect("the screenshot").len();
        assert!(size > 50_000, "{} has {size} bytes: an empty page", png.display());
    }
}

/// The report that a person gets: a short run of the whole job, by the built program.
#[tests::needs(chromium)]
#[test]
fn the_report_of_a_run_draws_everything() {
    let browser = Browser::installed();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("run");
    let run = tests::frictionlab()
        .args(["run", "all", "--quick", "--quiet", "--seed", "1", "--out"])
        .arg(&out)
        .current_dir(folder.path())
        .output()
        .expect("frictionlab starts");
    assert!(run.status.success(), "{}: {}", run.status, String::from_utf8_lossy(&run.stderr));
    let html =
        std::fs::read_to_string(out.join("report.html")).expect("the run leaves report.html");
    let seen = browser.load(
        &html,
        "return [...document.querySelectorAll('.caption')].map((c) => c.textContent).join();",
    );
    assert_sound(&seen);
    let titles: Vec<&str> =
        seen.figures.iter().flat_map(|f| &f.axis_titles).map(String::as_str).collect();
    for label in ["velocity [rad/s]", "time [s]", "friction torque [N m]"] {
        assert!(titles.contains(&label), "{label} is not among {titles:?}");
    }
    let tables = seen.probe.as_str().unwrap_or_default();
    assert!(
        tables.contains("Stribeck parameters") && tables.contains("compensations compared"),
        "{tables}"
    );

    let png = picture("report_run.png");
    browser.screenshot(&html, &png, seen.height, false);
    let size = std::fs::metadata(&png).expect("the screenshot").len();
    assert!(size > 50_000, "{} has {size} bytes: an empty page", png.display());
}

/// A reader's hands: dragging zooms all panels of a figure, a double click resets, a click on a
/// legend entry hides its series, pointing shows values of all panels.
#[tests::needs(chromium)]
#[test]
fn figures_answer_the_mouse() {
    let browser = Browser::installed();
    let seen = browser.load(
        &render_page(&demonstration::demonstration()),
        include_str!("../../browser/hands.js"),
    );
    assert_sound(&seen);
    let number =
        |key: &str| seen.probe[key].as_f64().unwrap_or_else(|| panic!("{key}: {}", seen.probe));
    assert!(number("span_zoomed") < 0.6 * number("span_before"), "{}", seen.probe);
    assert!((number("span_reset") - number("span_before")).abs() < 1e-9, "{}", seen.probe);
    assert_eq!(number("shared_axes"), 1.0, "panels share one horizontal axis");
    assert_eq!(number("shown_after_click"), number("shown_before") - 1.0, "{}", seen.probe);
    // Nothing that would send a figure somewhere.
    assert_eq!(seen.probe["buttons"], "Download plot, Zoom, Pan, Zoom in, Zoom out, Reset axes");
    let hover = seen.probe["hover"].as_str().unwrap_or_default();
    // Quantities with their units, and the time at which they are read.
    for said in ["velocity", "rad/s", "friction", "N m", "time", " s"] {
        assert!(hover.contains(said), "{said} is not in the readout: {hover}");
    }
    for series in ["reference", "Proposed", "estimated"] {
        assert!(hover.contains(series), "{series} is not in the readout: {hover}");
    }
}

/// A table comes whole, with one head, and a figure with its series, axes and categories.
#[tests::needs(chromium)]
#[test]
fn figures_and_tables_are_saved_as_csv() {
    let browser = Browser::installed();
    let page = demonstration::demonstration();
    let seen = browser.load(&render_page(&page), include_str!("../../browser/csv.js"));
    assert_sound(&seen);
    let files = seen.probe.as_object().expect("a file for each button");
    let counted =
        |wanted: fn(&Block) -> bool| page.blocks.iter().filter(|block| wanted(block)).count();
    let (figures, tables) = (
        counted(|block| matches!(block, Block::Figure(_))),
        counted(|block| matches!(block, Block::Table(_))),
    );
    assert_eq!(files.len(), figures + tables, "{:?}", files.keys());
    let text = |name: &str| files[name].as_str().unwrap_or_default().trim_start_matches('\u{feff}');

    // The last table is wider than the page and stands there in parts.
    let wide: Vec<&str> = text(&format!("table-{tables}.csv")).split("\r\n").collect();
    let columns = friction_model::ModelName::ALL.len() + 1;
    assert_eq!(wide.len(), 4, "{wide:?}");
    let with_comma =
        friction_model::ModelName::ALL.iter().filter(|model| model.title().contains(',')).count();
    assert_eq!(wide[0].split(',').count(), columns + with_comma, "{}", wide[0]);
    assert!(wide[0].starts_with("plant,root mean square of Coulomb [N m],"), "{}", wide[0]);
    assert!(
        wide[2].starts_with("\"a plant with a comma, and a long name\",1.0000e-3,2.0000e-3,"),
        "{}",
        wide[2]
    );
    let parameters = text("table-1.csv");
    assert!(
        parameters.contains("\r\nStribeck velocity v_s,rad/s,0.141,0.0153,10.9\r\n"),
        "{parameters}"
    );

    let bars = text(&format!("figure-{figures}.csv"));
    assert!(
        bars.starts_with("panel,series,kind of motion,value,half_error_bar,upper_edge\r\n"),
        "{bars}"
    );
    assert!(bars.contains("rms [N m],LuGre,\"slow, \"\"creeping\"\"\",0.1,,\r\n"), "{bars}");
    assert!(bars.contains("rms [N m],Proposed,reversing,,,\r\n"), "{bars}");
    assert!(bars.contains("share [%],Proposed,fast,59,,\r\n"), "{bars}");
    let stribeck = text("figure-1.csv");
    assert!(
        stribeck.lines().any(|line| line.starts_with("torque [N m],measured,0.03,")),
        "{stribeck:.300}"
    );
}

/// No two of the models look alike, in the browser's own words.
#[tests::needs(chromium)]
#[test]
fn every_model_has_its_own_look() {
    let browser = Browser::installed();
    let probe = "const plot = [...document.querySelectorAll('.plot')].at(-2); const models = plot._fullData; \
                 return { models: models.length, lines: new Set(models.map((t) => t.line.color + t.line.dash)).size, \
                 markers: new Set(models.map((t) => t.marker.color + t.marker.symbol)).size };";
    let seen = browser.load(&render_page(&demonstration::demonstration()), probe);
    assert_sound(&seen);
    let models = friction_model::ModelName::ALL.len();
    assert_eq!(
        seen.probe,
        serde_json::json!({ "models": models, "lines": models, "markers": models })
    );
}

/// Labels are text, whatever they contain.
#[tests::needs(chromium)]
#[test]
fn markup_in_labels_stays_text() {
    let browser = Browser::installed();
    let mut page = demonstration::demonstration();
    let nasty =
        "a <b>bold</b> </script><img src='https://example.invalid/x.png'> & <a href='x'>b</a>";
    for block in &mut page.blocks {
        if let Block::Figure(figure) = block {
            figure.title = nasty.into();
            figure.x_label = nasty.into();
            figure.panels[0].y_label = nasty.into();
        }
    }
    let seen = browser.load(
        &render_page(&page),
        "return document.querySelectorAll('img, figure a[href=\"x\"]').length;",
    );
    assert_sound(&seen);
    assert_eq!(seen.probe, 0);
    assert!(
        seen.figures[0].axis_titles.iter().all(|title| title == nasty || title == "residual [N m]")
    );
}

/// The checks above can fail: each of these pages has one fault, and it is seen.
#[tests::needs(chromium)]
#[test]
fn broken_pages_are_noticed() {
    let browser = Browser::installed();
    let page = |body: &str| format!("<!doctype html><html><head></head><body>{body}</body></html>");

    let seen = browser.load(&page("<p>fine</p>"), "");
    assert_sound(&seen);

    let seen = browser.load(&page("<script>throw new Error('deliberate')</script>"), "");
    assert!(seen.complaints.iter().any(|c| c.contains("deliberate")), "{:?}", seen.complaints);

    let seen = browser.load(&page("<script>console.error('spoken')</script>"), "");
    assert!(seen.complaints.iter().any(|c| c.contains("spoken")), "{:?}", seen.complaints);

    let seen = browser.load(&page("<script>Promise.reject(new Error('left alone'))</script>"), "");
    assert!(seen.complaints.iter().any(|c| c.contains("left alone")), "{:?}", seen.complaints);

    let seen = browser.load(&page("<img src=\"https://example.invalid/picture.png\">"), "");
    assert!(seen.requests.iter().any(|r| r.contains("picture.png")), "{:?}", seen.requests);
    assert!(seen.complaints.iter().any(|c| c.contains("picture.png")), "{:?}", seen.complaints);

    // Under the report's own policy the browser does not even try, and says so.
    let sound = render_page(&demonstration::demonstration());
    let reaching =
        sound.replacen("</main>", "<img src=\"https://example.invalid/picture.png\"></main>", 1);
    let seen = browser.load(&reaching, "");
    assert!(seen.complaints.iter().any(|c| c.starts_with("policy:")), "{:?}", seen.complaints);

    // A figure that cannot be drawn, and one that loses a trace.
    let broken = sound.replacen("\"traces\":[", "\"traces\":[null,", 1);
    let seen = browser.load(&broken, "");
    assert!(!seen.complaints.is_empty());
    let lost = sound.replacen(
        "drawAll();\n})();",
        "drawAll().then(() => document.querySelector('.scatterlayer .trace').remove());\n})();",
        1,
    );
    assert_ne!(lost, sound, "the end of the script has changed: adapt this test");
    let seen = browser.load(&lost, "");
    assert!(seen.figures[0].drawn < seen.figures[0].expected, "{:?}", seen.figures[0]);
}
