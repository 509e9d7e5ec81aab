//! Programs with a view, and their page in a real browser.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use serde_json::Value;

use crate::network::{namespaced, run_ignored, turn};
use crate::tab::Tab;

/// Runs a test of the calling program that is ignored elsewhere, on a machine with loopback only.
///
/// # Panics
/// If it fails.
pub fn inside(test: &str) {
    let _turn = turn();
    let program = crate::frictionlab().get_program().to_owned();
    let emulator = crate::rig_emulator().get_program().to_owned();
    let programs = [("FRICTIONLAB_BIN", program.as_os_str()), ("RIG_EMULATOR_BIN", &emulator)];
    run_ignored(namespaced(), test, &programs);
}

/// A program with a view, and where its page is. Dropped, it is killed.
pub struct Viewed {
    program: Child,
    url: String,
    said: Arc<Mutex<String>>,
}

impl Viewed {
    /// `frictionlab live --view`.
    ///
    /// # Panics
    /// If it does not start.
    #[must_use]
    pub fn live(folder: &Path, port: &str, more: &[&str]) -> Self {
        let loop_of_its_own = ["live", "--view", "--view-port", port, "--force", "--out", "out"];
        Self::start(folder, &[&loop_of_its_own, more].concat())
    }

    /// A command that says where its view is.
    ///
    /// # Panics
    /// If it does not start.
    #[must_use]
    pub fn start(folder: &Path, words: &[&str]) -> Self {
        let mut program: Child = crate::frictionlab()
            .args(words)
            .current_dir(folder)
            .env("ROS_DOMAIN_ID", "77")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        let said = Arc::new(Mutex::new(String::new()));
        let (place, places) = channel();
        let out = program.stdout.take().expect("its output is ours");
        let err = program.stderr.take().expect("its output is ours");
        listen(out, &said, place.clone());
        listen(err, &said, place);
        let Ok(url) = places.recv() else {
            panic!(
                "it ended without a view: {}",
                said.lock().unwrap_or_else(PoisonError::into_inner)
            )
        };
        Self { program, url, said }
    }

    /// Where its page is.
    #[must_use]
    pub fn url(&self) -> &str {
        &self.url
    }

    /// The port of its page.
    ///
    /// # Panics
    /// If its address has none.
    #[must_use]
    pub fn port(&self) -> String {
        let address = self.url.trim_end_matches('/');
        address.rsplit(':').next().expect("a port").to_owned()
    }

    /// What it said until now.
    #[must_use]
    pub fn said(&self) -> String {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Whether it still runs.
    ///
    /// # Panics
    /// If the system does not tell.
    pub fn runs(&mut self) -> bool {
        self.program.try_wait().expect("its end").is_none()
    }

    /// Waits for its end.
    ///
    /// # Panics
    /// If the system does not tell.
    pub fn wait(&mut self) -> ExitStatus {
        self.program.wait().expect("it ends")
    }

    /// Ends it as ctrl-C does.
    ///
    /// # Panics
    /// If it ends as one that failed.
    pub fn end(mut self) {
        let id = self.program.id().to_string();
        let told = Command::new("kill").args(["-INT", &id]).status().expect("kill runs");
        assert!(told.success());
        assert!(self.wait().success());
    }
}

impl Drop for Viewed {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// Reads what it says, so that it never waits for us, and tells where its view is.
fn listen(from: impl Read + Send + 'static, said: &Arc<Mutex<String>>, place: Sender<String>) {
    let said = Arc::clone(said);
    thread::spawn(move || {
        for line in BufReader::new(from).lines().map_while(Result::ok) {
            if let Some((_, url)) = line.split_once("view: ") {
                // Nobody waits for a second one.
                let _ = place.send(url.trim().to_owned());
            }
            let mut said = said.lock().unwrap_or_else(PoisonError::into_inner);
            said.push_str(&line);
            said.push('\n');
        }
    });
}

/// The page of a program, connected.
///
/// # Panics
/// When it does not come.
#[must_use]
pub fn page(of: &Viewed) -> Tab {
    let mut tab = Tab::open();
    tab.look(1200, false);
    tab.go(of.url());
    tab.until("document.getElementById('connection').textContent === 'connected'");
    tab
}

/// Sets a parameter as a person does who types.
///
/// # Panics
/// When the page has none of that name.
pub fn set(tab: &mut Tab, name: &str, value: &str) {
    let row = format!("document.querySelector('[data-name=\"{name}\"]')");
    tab.until(&row);
    tab.evaluate(&format!(
        "(() => {{ const input = {row}.querySelector('input:not([type=range]), select');
         input.value = '{value}'; input.dispatchEvent(new Event('change')); }})()"
    ));
}

/// What is said beside a parameter.
#[must_use]
pub fn said(name: &str) -> String {
    format!("document.querySelector('[data-name=\"{name}\"] output').textContent")
}

/// Waits for a state of the rig.
///
/// # Panics
/// When it does not come.
pub fn rig_is(tab: &mut Tab, state: &str) {
    tab.until(&format!("document.getElementById('rig').textContent === 'rig: {state}'"));
}

/// What keeps people from using the page, by axe: a list, empty where nothing does.
///
/// # Panics
/// Where axe is not there.
pub fn barriers(tab: &mut Tab) -> Value {
    let axe = std::fs::read_to_string(machine::axe()).expect("axe");
    tab.evaluate("document.querySelectorAll('details').forEach((one) => one.open = true)");
    tab.evaluate(&format!("(() => {{ if (!window.axe) {{ {axe}; }} return 1; }})()"));
    tab.evaluate(
        "axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice'] })
         .then((all) => all.violations.map((one) => one.id + ': ' + one.nodes.map((node) => node.target + ' ' + node.failureSummary).join('; ')))",
    )
}
