//! The project's own commands: `cargo xtask COMMAND`.

mod bench;

use clap::Parser;

/// The project's own commands.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask")]
enum Task {
    /// Nanoseconds a control step of the friction models, in Rust and in plain C.
    Bench(bench::Bench),
}

fn main() -> anyhow::Result<()> {
    match Task::parse() {
        Task::Bench(bench) => bench.run(),
    }
}
