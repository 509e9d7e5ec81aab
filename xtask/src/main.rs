//! The project's own commands: `cargo xtask COMMAND`.

mod audit;
mod bench;
mod bench_fits;
mod bench_live;
mod bench_monte_carlo;
mod bench_ros;
mod bench_simulate;
mod bench_step;
mod bench_sweep;
mod book;
mod distribution;
mod lanes;
mod python_env;
mod room;
mod simulators;
mod soak;
mod strangers;
mod tally;
mod test;

use clap::Parser;

/// The project's own commands.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask")]
enum Task {
    /// Licences, bans and sources of every dependency, judged by deny.toml.
    Audit(audit::Audit),
    /// Nanoseconds a control step of the friction models, in Rust and in plain C.
    Bench(bench::Bench),
    /// Milliseconds of the identification's fits, beside SciPy's least squares over models compiled
    /// by Numba.
    BenchFits(bench_fits::BenchFits),
    /// Period errors of the loop of `frictionlab live`, beside a bare `clock_nanosleep` loop of the
    /// same scheduling class.
    BenchLive(bench_live::BenchLive),
    /// Draws a second of the Monte Carlo of position tracking, beside the same loop compiled by
    /// Numba.
    BenchMonteCarlo(bench_monte_carlo::BenchMonteCarlo),
    /// `/friction_estimate` at 1 kHz from `live` and `launch` beside a publisher of rclpy: rate,
    /// loss, latency, processor time, memory, calls.
    BenchRos(bench_ros::BenchRos),
    /// Points a second of `simulate`, beside a loop compiled by Numba.
    BenchSimulate(bench_simulate::BenchSimulate),
    /// Nanoseconds of a whole control step, estimator and controller, for every model and
    /// technique.
    BenchStep(bench_step::BenchStep),
    /// Nanoseconds a step of many parameter sets along one motion: in lanes beside the scalar step, on
    /// all cores beside Numba's `prange`.
    BenchSweep(bench_sweep::BenchSweep),
    /// The book, from docs/ into target/book, with the pages that are made from the code made anew
    /// first.
    Book(book::Book),
    /// A Python environment with `rosbags` and the real rclpy, for the tests that use them.
    PythonEnv(python_env::PythonEnvCommand),
    /// Exported friction in versions of MuJoCo, beside our own models along the same torque.
    Simulators(simulators::Simulators),
    /// The loop at 1 kHz for minutes, with the real rclpy listening: memory, losses, drift.
    Soak(soak::Soak),
    /// Whether the identification is right on machines drawn at random, beside SciPy.
    Strangers(strangers::Strangers),
    /// Every test of the project, with what they need made ready first.
    Test(test::Test),
}

fn main() -> anyhow::Result<()> {
    match Task::parse() {
        Task::Audit(audit) => audit.run(),
        Task::Bench(bench) => bench.run(),
        Task::BenchFits(bench) => bench.run(),
        Task::BenchLive(bench) => bench.run(),
        Task::BenchMonteCarlo(bench) => bench.run(),
        Task::BenchRos(bench) => bench.run(),
        Task::BenchSimulate(bench) => bench.run(),
        Task::BenchStep(bench) => bench.run(),
        Task::BenchSweep(bench) => bench.run(),
        Task::Book(book) => book.run(),
        Task::PythonEnv(python_env) => python_env.run(),
        Task::Simulators(simulators) => simulators.run(),
        Task::Soak(soak) => soak.run(),
        Task::Strangers(strangers) => strangers.run(),
        Task::Test(test) => test.run(),
    }
}

#[cfg(test)]
mod held_to_the_pages {
    use clap::CommandFactory;
    use tests::book::{check, pages};

    use super::Task;

    /// What is wrong with the words behind `cargo xtask`, by its own definition.
    fn fault(words: &[String]) -> Option<String> {
        let [cargo, xtask, rest @ ..] = words else { return None };
        if (cargo.as_str(), xtask.as_str()) != ("cargo", "xtask") {
            return None;
        }
        let asked = std::iter::once("cargo xtask").chain(rest.iter().map(String::as_str));
        Task::command().try_get_matches_from(asked).err().map(|error| error.to_string())
    }

    #[test]
    fn the_pages_name_only_tasks_and_options_that_there_are() {
        let mut checked = 0;
        for page in pages() {
            let blocks = page.blocks.iter().filter(|block| block.info.starts_with("sh"));
            let spans = page.spans.iter().filter(|span| span.starts_with("cargo xtask "));
            for text in blocks.map(|block| &block.text).chain(spans) {
                for words in check::commands(text) {
                    checked += usize::from(words.get(1).is_some_and(|word| word == "xtask"));
                    let fault = fault(&words);
                    assert!(fault.is_none(), "{}: {words:?}: {fault:?}", page.path.display());
                }
            }
        }
        assert!(checked > 10, "only {checked} tasks were found");
        for wrong in ["cargo xtask tset", "cargo xtask test --ful"] {
            assert!(fault(&check::commands(wrong)[0]).is_some(), "{wrong}");
        }
    }
}
