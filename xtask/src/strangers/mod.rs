//! `cargo xtask strangers`: is the identification right on machines that nobody has seen?
//!
//! Every machine is drawn at random and recorded; the built program identifies the first half of the
//! recording as a stranger would, and is scored on the second. Beside it stands what SciPy gives on
//! the same halves. With `--mujoco` another simulator moves the machines; with `--real` the machines
//! are recordings of real ones.

mod joined;
mod judge;
mod machine;
mod mujoco;
mod peer;
mod real;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::AtomicBool;

use anyhow::{Result, ensure};
use friction_ident::statistics::{quantile, sorted};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use work::part::{InParts, Part};
use work::sequencer::run_in_order;

use self::judge::{Answer, Known};
use self::machine::{Kind, Truth};
use crate::python_env;

/// Options of `cargo xtask strangers`.
#[derive(Debug, Clone, clap::Args)]
pub struct Strangers {
    /// Machines.
    #[arg(long, default_value_t = 40, value_parser = clap::value_parser!(u32).range(1..))]
    machines: u32,
    /// Number of the first one.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Options of `frictionlab identify`, as in --with=--structure=auto
    #[arg(long, value_name = "OPTION", default_values = ["--structure", "auto"], allow_hyphen_values = true)]
    with: Vec<String>,
    /// The program [default: built in release mode].
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Axes that MuJoCo simulates, in place of our own: they stick, and follow a position loop
    #[arg(long)]
    mujoco: bool,
    /// Bristles that bend far under strong dips, in place of friction of all kinds
    #[arg(long, conflicts_with = "mujoco")]
    near_rest: bool,
    /// Leave SciPy out.
    #[arg(long)]
    alone: bool,
    /// Where recordings and answers are put [default: target/strangers].
    #[arg(long, value_name = "DIR", conflicts_with = "real")]
    out: Option<PathBuf>,
    #[command(flatten)]
    parts: InParts,
    /// Machines side by side; the answers do not depend on it.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    /// Print the document in place of the table
    #[arg(long)]
    json: bool,
    /// Do not name each machine
    #[arg(long)]
    quiet: bool,
    /// Real recordings in place of machines drawn at random: both halves of each must tell the same
    #[arg(long, conflicts_with_all = ["machines", "first", "mujoco", "near_rest"])]
    real: bool,
    /// Where the real recordings are [default: $FRICTION_DATA, else ../shared/data]
    #[arg(long, value_name = "DIR", requires = "real")]
    data: Option<PathBuf>,
    /// Only recordings whose name begins so, as in "tx40 joint 2"
    #[arg(long, value_name = "NAME", requires = "real")]
    only: Option<String>,
}

/// A machine with what was said of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Case {
    number: u64,
    machine: Machine,
    answer: Answer,
    /// Error of the best of the peer's models \[%\].
    peer: Option<f64>,
}

/// What a machine is, in words.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Machine {
    friction: String,
    /// Sampling rate \[Hz\].
    rate: f64,
    has: Vec<String>,
}

impl From<&Truth> for Machine {
    fn from(truth: &Truth) -> Self {
        let has = [
            (truth.gravity.is_some(), "gravity"),
            (truth.offset != 0.0, "offset"),
            (truth.ripple.is_some(), "ripple"),
            (truth.delay > 0.0, "delay"),
            (truth.backlash > 0.0, "backlash"),
            (truth.uneven, "uneven"),
            (truth.rests, "rest"),
        ];
        let has = has.into_iter().filter(|(has, _)| *has).map(|(_, name)| name.to_owned());
        Self { friction: truth.family.to_string(), rate: truth.rate, has: has.collect() }
    }
}

impl Strangers {
    /// Draws, asks, and prints the tables; everything is in `target/strangers/cases.json`.
    ///
    /// # Errors
    /// When the program or the peer cannot be built or run.
    pub fn run(&self) -> Result<()> {
        let in_parts = self.parts.part.is_some() || self.parts.join.is_some();
        ensure!(!(self.real && in_parts), "--part and --join are of machines drawn at random");
        if let Some(parts) = &self.parts.join {
            let (cases, lacking) = joined::join(self, parts)?;
            self.told(&self.root()?, &cases)?;
            return lacking.map_or(Ok(()), |lacking| Err(anyhow::Error::msg(lacking)));
        }
        let program = match &self.program {
            Some(program) => fs::canonicalize(program)?,
            None => built(&python_env::target()?)?,
        };
        let root = self.root()?;
        if self.real {
            let Some(data) = self.data.clone().or_else(::machine::recordings) else {
                println!(
                    "skipped: there are no real recordings in $FRICTION_DATA or ../shared/data; name their folder with --data DIR"
                );
                return Ok(());
            };
            let root = root.join("real");
            let options = self.with.iter().map(String::as_str).collect();
            let asked = real::Asked { program, options, data, root, alone: self.alone };
            return asked.run(self.only.as_deref().unwrap_or_default());
        }
        let own = self.parts.part.unwrap_or(Part::WHOLE).range(self.machines);
        let numbers: Vec<u64> = own.map(|index| self.first + u64::from(index)).collect();
        let mut cases = Vec::with_capacity(numbers.len());
        let moved = if self.mujoco { mujoco::move_axes(&numbers, &root)? } else { Vec::new() };
        let ask = |&number: &u64| match moved.iter().find(|axis| axis.number == number) {
            Some(axis) => self.asked(number, (axis.into(), axis.known), &program, &root),
            None => self.drawn(number, &program, &root),
        };
        let workers = usize::from(self.jobs);
        run_in_order(&numbers, workers, &AtomicBool::new(false), ask, |_, case| {
            cases.push(case);
            Ok(())
        })?;
        if !self.alone {
            peers(&root, &mut cases)?;
        }
        match self.parts.part {
            Some(part) => {
                print!("{}", joined::document(self, part, cases)?);
                Ok(())
            }
            None => self.told(&root, &cases),
        }
    }

    /// Where recordings and answers are put.
    fn root(&self) -> Result<PathBuf> {
        match &self.out {
            Some(out) => Ok(std::path::absolute(out)?),
            None => {
                let own = match (self.mujoco, self.near_rest) {
                    (true, _) => "strangers/mujoco",
                    (false, true) => "strangers/near_rest",
                    (false, false) => "strangers",
                };
                Ok(python_env::target()?.join(own))
            }
        }
    }

    /// Draws a machine and asks the program.
    fn drawn(&self, number: u64, program: &Path, root: &Path) -> Result<Case> {
        let folder = root.join(number.to_string());
        let kind = if self.near_rest { Kind::NEAR_REST } else { Kind::USUAL };
        let truth = Truth::draw(kind, number);
        let rows = truth.record(number)?;
        fs::create_dir_all(&folder)?;
        let half = rows.time.len() / 2;
        let write = |name: &str, part| fs::write(folder.join(name), rows.csv(part, truth.velocity));
        write("estimation.csv", 0..half)?;
        write("validation.csv", half..rows.time.len())?;
        self.asked(number, ((&truth).into(), (&truth).into()), program, root)
    }

    /// Asks the program of a machine that was recorded.
    fn asked(
        &self,
        number: u64,
        (machine, known): (Machine, Known),
        program: &Path,
        root: &Path,
    ) -> Result<Case> {
        if !self.quiet {
            eprintln!("machine {number} ...");
        }
        let options: Vec<&str> = self.with.iter().map(String::as_str).collect();
        let answer = judge::ask(program, &root.join(number.to_string()), &known, &options)?;
        Ok(Case { number, machine, answer, peer: None })
    }

    /// Writes and prints what came of machines.
    fn told(&self, root: &Path, cases: &[Case]) -> Result<()> {
        let document = serde_json::to_string_pretty(cases)?;
        fs::create_dir_all(root)?;
        fs::write(root.join("cases.json"), &document)?;
        if self.json {
            println!("{document}");
        } else {
            print!("{}", table(cases));
        }
        Ok(())
    }
}

fn built(target: &Path) -> Result<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let build = ["build", "--release", "--locked", "-p", "frictionlab", "--bin", "frictionlab"];
    ensure!(Command::new(cargo).args(build).status()?.success(), "the program does not build");
    Ok(target.join("release/frictionlab"))
}

/// What the peer makes of the same halves.
fn peers(root: &Path, cases: &mut [Case]) -> Result<()> {
    let mut asked = Vec::new();
    for case in &*cases {
        if let Value::Object(settings) = &case.answer.settings {
            let mut job = settings.clone();
            job.insert("folder".to_owned(), json!(root.join(case.number.to_string())));
            job.insert("stretches".to_owned(), case.answer.stretches.clone());
            asked.push((case.number, job));
        }
    }
    let jobs: Vec<_> = asked.iter().map(|(_, job)| job.clone()).collect();
    for ((number, _), errors) in asked.iter().zip(peer::errors(&jobs)?) {
        let best = peer::best(&errors).map(|(_, error)| error).filter(|error| error.is_finite());
        if let Some(case) = cases.iter_mut().find(|case| case.number == *number) {
            case.peer = best;
        }
    }
    Ok(())
}

fn table(cases: &[Case]) -> String {
    let mut text = String::from(
        "| machine | friction | rate [Hz] | what it has | structure | held out [%] | SciPy [%] | within 95 % | wrong | warned |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for Case { number, machine, answer, peer } in cases {
        let number_of =
            |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.2}"));
        let said: Vec<_> = answer.parameters.iter().filter(|judged| judged.identified).collect();
        let within = said.iter().filter(|judged| judged.within()).count();
        let wrong: Vec<&str> = answer
            .parameters
            .iter()
            .filter(|judged| judged.wrong())
            .map(|judged| judged.name.as_str())
            .collect();
        let chosen = match &answer.refused {
            Some(refused) => format!("refused: {}", refused.lines().next().unwrap_or_default()),
            None => answer.chosen.clone(),
        };
        text += &format!(
            "| {number} | {} | {:.0} | {} | {chosen} | {} | {} | {within}/{} | {} | {} |\n",
            machine.friction,
            machine.rate,
            machine.has.join(", "),
            number_of(answer.held_out),
            number_of(*peer),
            said.len(),
            wrong.join(" "),
            answer.warnings.len(),
        );
    }
    let answers = || cases.iter().map(|case| &case.answer);
    let said: Vec<_> = answers()
        .flat_map(|answer| &answer.parameters)
        .filter(|judged| judged.identified)
        .collect();
    let percent = |part: usize, whole: usize| 100.0 * part as f64 / whole.max(1) as f64;
    let within = said.iter().filter(|judged| judged.within()).count();
    let unwarned: usize = answers().map(Answer::wrong).sum();
    let refused = answers().filter(|answer| answer.refused.is_some()).count();
    let ratios = sorted(cases.iter().filter_map(|case| Some(case.answer.held_out? / case.peer?)));
    let ratio = |share| quantile(&ratios, share).unwrap_or(f64::NAN);
    text + &format!(
        "\n{} machines, {refused} refused; of {} identified parameters {within} ({:.1} %) within their 95 % intervals; {unwarned} ({:.1} %) wrong without a \
         warning; held-out error over the best of SciPy: median {:.3}, 90 % of them at most {:.3}, largest {:.3}\n",
        cases.len(),
        said.len(),
        percent(within, said.len()),
        percent(unwarned, said.len()),
        ratio(0.5),
        ratio(0.9),
        ratio(1.0),
    )
}
