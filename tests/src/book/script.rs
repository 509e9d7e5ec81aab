//! The commands of a page as a script that runs in a folder of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs};

use super::{Page, Treatment};
use crate::{checkout, frictionlab, leave_out, python, rig_emulator};

/// Recordings that are not part of the project, by the names that the pages have for them.
const RECORDINGS: [(&str, &str); 4] = [
    ("estimation.csv", "emps/estimation.csv"),
    ("validation.csv", "emps/validation.csv"),
    ("episode_1.csv", "qube_servo/episode_1.csv"),
    ("episode_2.csv", "qube_servo/episode_2.csv"),
];

/// What stands before the commands of a page. What a command prints is kept in `$OUTPUTS`, by its
/// words, which are the first line. A device of the emulator is there before anything talks to it.
const HEAD: &str = r#"set -Eeuo pipefail
trap 'echo "failed: $BASH_COMMAND" >&2' ERR
trap 'kill $(jobs -p) 2> /dev/null || true' EXIT
frictionlab() {
  local output
  output=$(mktemp "$OUTPUTS/XXXXXXXX")
  echo "$*" > "$output"
  "$FRICTIONLAB" "$@" | tee -a "$output"
}
cargo() {
  if [ "$1 $2 $3" != "run --release --" ]; then echo "cargo $* is not run here" >&2; return 9; fi
  shift 3
  frictionlab "$@"
}
rig_emulator() { exec "$RIG_EMULATOR" "$@"; }
ready() { until [ -e "$1" ]; do sleep 0.05; done; }
friction-plot() { "$PYTHON" -m friction_analysis.figures "$@"; }
friction-table() { "$PYTHON" -m friction_analysis.table "$@"; }
"#;

/// A page's folder, with what its commands printed.
#[derive(Debug)]
pub struct Ran {
    folder: tempfile::TempDir,
    recorded: bool,
    printed: BTreeMap<String, String>,
}

impl Ran {
    /// Runs the blocks of a page that are to be run in this tier. `known` is what commands printed
    /// on pages before ([`Ran::independent`]).
    ///
    /// # Panics
    /// When a command ends otherwise than the page says; the message has what it said.
    #[must_use]
    pub fn new(page: &Page, known: &BTreeMap<String, String>) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let recorded = recordings(folder.path());
        let linked =
            std::os::unix::fs::symlink(checkout().join("docs"), folder.path().join("docs"));
        linked.expect("a link");
        let mut ran = Self { folder, recorded, printed: known.clone() };
        if let Some(script) = ran.script(page) {
            ran.run(&page.path, &script);
        }
        ran
    }

    /// What commands printed that name no file: they print the same in every folder.
    #[must_use]
    pub fn independent(&self) -> BTreeMap<String, String> {
        let named = |words: &String| words.contains(['/', '.']);
        let printed = self.printed.iter().filter(|(words, _)| !named(words));
        printed.map(|(words, text)| (words.clone(), text.clone())).collect()
    }

    fn script(&self, page: &Page) -> Option<String> {
        let full = env::var_os("FRICTION_FULL").is_some();
        let mut script = String::new();
        for block in &page.blocks {
            let runs = match block.treatment().expect("the words behind a fence") {
                Some(Treatment::Run { .. }) => true,
                Some(Treatment::Full) => full,
                Some(Treatment::Python) => self.has_python(page, &block.text),
                Some(Treatment::Parse) | None => false,
            };
            if !runs || !self.has_what_it_reads(page, &block.text) {
                continue;
            }
            let exit = match block.treatment() {
                Ok(Some(Treatment::Run { exit })) => exit,
                _ => 0,
            };
            let text = block.text.replace("/tmp/rig", "$PWD/rig");
            let text: String = text.lines().map(with_wait).collect();
            script += &match exit {
                0 => text,
                code => {
                    format!("code=0; (\n{text}) || code=$?\n[ $code = {code} ]\n")
                }
            };
        }
        (!script.is_empty()).then_some(script)
    }

    /// Whether there is a Python that can run what a block says; says so where there is none.
    fn has_python(&self, page: &Page, text: &str) -> bool {
        let here = machine::Need::BagTools.is_met(&crate::target_folder());
        if !here {
            leave_out(&format!(
                "{}: {}: {text}",
                page.path.display(),
                machine::Need::BagTools.reason()
            ));
        }
        here
    }

    /// Whether the recordings that a command names are here; says so where they are not.
    fn has_what_it_reads(&self, page: &Page, text: &str) -> bool {
        let here = self.recorded || !RECORDINGS.iter().any(|(name, _)| text.contains(name));
        if !here {
            leave_out(&format!("{}: the recordings are not at hand: {text}", page.path.display()));
        }
        here
    }

    fn run(&mut self, page: &Path, script: &str) {
        let outputs = tempfile::tempdir().expect("a folder");
        let mut bash = Command::new("bash");
        bash.args(["-c", &format!("{HEAD}{script}")])
            .current_dir(self.folder.path())
            .env("FRICTIONLAB", frictionlab().get_program())
            .env("OUTPUTS", outputs.path())
            .env("PYTHONPATH", checkout().join("python"))
            .env("MPLCONFIGDIR", outputs.path().join("matplotlib"))
            .stdin(Stdio::null());
        if script.contains("rig_emulator") {
            bash.env("RIG_EMULATOR", rig_emulator().get_program());
        }
        if machine::Need::BagTools.is_met(&crate::target_folder()) {
            bash.env("PYTHON", python::interpreter("bag_tools"));
        }
        let output = bash.output().expect("bash starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}:\n{script}\n{said}", page.display());
        for file in fs::read_dir(outputs.path()).expect("the outputs") {
            let file = file.expect("an output").path();
            let Ok(text) = fs::read_to_string(&file) else { continue };
            if let Some((words, text)) = text.split_once('\n') {
                self.printed.insert(words.to_owned(), text.to_owned());
            }
        }
    }

    /// What `frictionlab` prints with these words: what it printed when the page's commands ran, or
    /// else now, in the same folder. `None` where the recordings that it reads are not at hand.
    ///
    /// # Panics
    /// When it fails.
    #[must_use]
    pub fn printed(&self, page: &Page, words: &[&str]) -> Option<String> {
        let command = words.join(" ");
        if let Some(text) = self.printed.get(&command) {
            return Some(text.clone());
        }
        if !self.has_what_it_reads(page, &command) {
            return None;
        }
        let mut asked = frictionlab();
        let output = asked.args(words).current_dir(self.folder.path()).output().expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "frictionlab {command}: {said}");
        Some(String::from_utf8_lossy(&output.stdout).into_owned())
    }
}

/// A line of the script; what starts a device is waited for until its port is there.
fn with_wait(line: &str) -> String {
    let link = line.split_whitespace().skip_while(|word| *word != "--link").nth(1);
    match link {
        Some(link) if line.trim_end().ends_with('&') => format!("{line}\nready {link}\n"),
        _ => format!("{line}\n"),
    }
}

/// Whether the recordings were to be had and are in the folder now.
fn recordings(folder: &Path) -> bool {
    let Some(data) = machine::recordings() else { return false };
    let copied =
        |(name, file): &(&str, &str)| fs::copy(data.join(PathBuf::from(file)), folder.join(name));
    RECORDINGS.iter().all(|recording| copied(recording).is_ok())
}
