//! The `frictionlab` command.

use std::process::ExitCode;

use clap::Parser;
use experiment_runner::cli::{BadInput, identify};

/// The friction laboratory.
#[derive(Parser)]
#[command(name = "frictionlab", version)]
struct Program {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    Identify(identify::IdentifyArgs),
}

fn main() -> ExitCode {
    let result = match Program::parse().command {
        Command::Identify(args) => identify::execute(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            if error.is::<BadInput>() { ExitCode::from(2) } else { ExitCode::FAILURE }
        }
    }
}
