//! `frictionlab completions`: words that a shell completes.

use clap_complete::Shell;
use work::saying::print;

/// Print the completions of this command for a shell
///
/// Put them where your shell looks for them, and start it again:
///
///   frictionlab completions bash > ~/.local/share/bash-completion/completions/frictionlab
///   frictionlab completions zsh > ~/.zfunc/_frictionlab
///   frictionlab completions fish > ~/.config/fish/completions/frictionlab.fish
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Prints them; `command` is the whole command.
///
/// # Errors
/// A standard output that cannot be written.
pub fn execute(args: &CompletionsArgs, command: &mut clap::Command) -> anyhow::Result<()> {
    let mut script = Vec::new();
    let name = command.get_name().to_owned();
    clap_complete::generate(args.shell, command, name, &mut script);
    print(&String::from_utf8_lossy(&script))
}
