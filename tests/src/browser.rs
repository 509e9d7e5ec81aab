//! A page in a real browser: what it drew, and everything it complained about.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// Longest that one start of the browser may take.
const PATIENCE: Duration = Duration::from_secs(180);

/// Put at the very start of the page under test: collects, waits until the page is done, then
/// leaves what it found in the document, where `--dump-dom` shows it.
const COLLECTOR: &str = include_str!("../browser/collector.js");

/// A headless Chromium.
#[derive(Debug, Clone)]
pub struct Browser {
    program: PathBuf,
}

/// What the browser reported of one page.
#[derive(Debug)]
pub struct Seen {
    /// Script errors, failed resources, console errors and warnings, breaches of the page's policy,
    /// and whatever the browser itself logged about the page: empty for a sound page.
    pub complaints: Vec<String>,
    /// Addresses that the page asked for, besides itself and what it carries inside.
    pub requests: Vec<String>,
    /// Its figures, in order.
    pub figures: Vec<DrawnFigure>,
    /// Height of the whole page in CSS pixels.
    pub height: u32,
    /// What the probe returned.
    pub probe: Value,
}

/// What stands on the page for one figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DrawnFigure {
    /// Traces in the figure's data that have a point to draw.
    pub expected: u64,
    /// Traces on the page that have at least one non-empty path.
    pub drawn: u64,
    /// Text of all titles of axes, in no order.
    pub axis_titles: Vec<String>,
}

impl Browser {
    /// Chromium or Chrome: `$CHROMIUM`, or a usual name in the `PATH`.
    ///
    /// # Panics
    /// Where none is installed: the test says what it needs by [`needs`](macro@crate::needs).
    pub fn installed() -> Browser {
        Browser { program: machine::chromium().expect("a browser") }
    }

    /// Loads a copy of `html`, waits until its figures stand, then evaluates `probe`, the body of
    /// an async JavaScript function, for whatever else the test wants to know or do.
    ///
    /// # Panics
    /// When the browser does not start, end, or report.
    pub fn load(&self, html: &str, probe: &str) -> Seen {
        self.load_at(1200, html, probe)
    }

    /// The same in a window that is `width` CSS pixels wide.
    ///
    /// # Panics
    /// When the browser does not start, end, or report.
    pub fn load_at(&self, width: u32, html: &str, probe: &str) -> Seen {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let copy = folder.path().join("page.html");
        let collector = COLLECTOR.replace("/*PROBE*/", probe);
        let head = html.find("<head>").map_or(0, |at| at + "<head>".len());
        let (before, after) = html.split_at(head);
        std::fs::write(&copy, format!("{before}<script>{collector}</script>{after}"))
            .expect("writing the copy");

        let window = format!("--window-size={width},900");
        let (status, dom, log) = self.run(&copy, folder.path(), &["--dump-dom", &window]);
        let report = dom
            .rsplit_once("<script type=\"application/json\" id=\"collected\">")
            .and_then(|(_, rest)| rest.split_once("</script>"))
            .unwrap_or_else(|| {
                panic!("the page never reported; the browser ended with {status} and said:\n{log}")
            })
            .0;
        let report: Value = serde_json::from_str(report).expect("the collector writes JSON");
        let texts = |value: &Value| -> Vec<String> {
            value
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(Value::as_str)
                .map(str::to_owned)
                .collect()
        };
        let mut complaints = texts(&report["complaints"]);
        complaints.extend(log.lines().filter(|line| line.contains(":CONSOLE")).map(str::to_owned));
        Seen {
            complaints,
            requests: texts(&report["requests"]),
            figures: report["figures"]
                .as_array()
                .into_iter()
                .flatten()
                .map(|figure| DrawnFigure {
                    expected: figure["expected"].as_u64().expect("a count"),
                    drawn: figure["drawn"].as_u64().expect("a count"),
                    axis_titles: texts(&figure["axis_titles"]),
                })
                .collect(),
            height: report["height"].as_f64().unwrap_or(0.0) as u32,
            probe: report["probe"].clone(),
        }
    }

    /// Takes a picture of the page, `height` pixels high, into `png`.
    ///
    /// # Panics
    /// When there is no picture afterwards.
    pub fn screenshot(&self, html: &str, png: &Path, height: u32, dark: bool) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let copy = folder.path().join("page.html");
        std::fs::write(&copy, html).expect("writing the copy");
        let target = format!("--screenshot={}", png.display());
        let size = format!("--window-size=1200,{height}");
        let mut flags = vec!["--hide-scrollbars", &target, &size];
        if dark {
            flags.push("--blink-settings=preferredColorScheme=0");
        }
        let (status, _, log) = self.run(&copy, folder.path(), &flags);
        assert!(png.is_file(), "no screenshot; the browser ended with {status} and said:\n{log}");
    }

    /// One start of the browser: exit status, standard output, standard error.
    fn run(&self, page: &Path, folder: &Path, flags: &[&str]) -> (ExitStatus, String, String) {
        let (out, err) = (folder.join("stdout"), folder.join("stderr"));
        let create = |path: &Path| File::create(path).expect("a file in the temporary folder");
        let mut child = Command::new(&self.program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-quic",
                "--no-first-run",
            ])
            .args([
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
            ])
            .args(["--disable-dev-shm-usage", "--enable-logging=stderr", "--v=0"])
            // Nothing leaves this machine, whatever the page asks for.
            .arg("--host-resolver-rules=MAP * ~NOTFOUND")
            // Timers run ahead while nothing else happens; the page has a minute of its own time.
            .arg("--virtual-time-budget=60000")
            .arg(format!("--user-data-dir={}", folder.join("profile").display()))
            .args(flags)
            .arg(format!("file://{}", page.display()))
            .env("HOME", folder)
            .stdin(Stdio::null())
            .stdout(create(&out))
            .stderr(create(&err))
            .spawn()
            .expect("the browser starts");
        let deadline = Instant::now() + PATIENCE;
        let status = loop {
            if let Some(status) = child.try_wait().expect("waiting for the browser") {
                break status;
            }
            if Instant::now() > deadline {
                // It may have ended just now; either way it is gone afterwards.
                let _ = child.kill();
                let _ = child.wait();
                panic!("the browser did not end within {PATIENCE:?}");
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        let read = |path: &Path| {
            String::from_utf8_lossy(&std::fs::read(path).unwrap_or_default()).into_owned()
        };
        (status, read(&out), read(&err))
    }
}
