//! `cargo xtask book`: the documentation as a site.
//!
//! Its sources are the Markdown pages in `docs/`. Pages that are made from the code are written
//! first; tests hold those on disk to the code. Other tests check the links and the commands on all
//! pages: `cargo test -p tests --test book`.

mod mdbook;
mod models;

use std::env::consts::EXE_SUFFIX;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::python_env;

/// Arguments of `cargo xtask book`.
#[derive(Debug, clap::Args)]
pub struct Book {}

impl Book {
    /// Writes the pages and builds the book, or says why mdBook cannot be had.
    ///
    /// # Errors
    /// A page that cannot be written, and a book that mdBook complains about.
    pub fn run(&self) -> Result<()> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask stands in the workspace")?;
        models::write(root)?;
        commands(root)?;
        let mut mdbook = match mdbook::program() {
            Ok(mdbook) => mdbook,
            Err(error) => {
                println!("SKIPPED: the book, because mdBook cannot be had: {error:#}");
                return Ok(());
            }
        };
        let output = mdbook.arg("build").arg(root.join("docs")).output()?;
        let said = String::from_utf8_lossy(&output.stderr);
        print!("{said}");
        ensure!(output.status.success(), "mdBook ended with {}", output.status);
        // An include that fails, or a page that is not there, is no failure to mdBook.
        let complains = said.lines().any(|line| line.contains("WARN") || line.contains("ERROR"));
        ensure!(!complains, "mdBook complains, see above");
        println!("The book: {}", root.join("target/book/index.html").display());
        Ok(())
    }
}

/// Writes the page of the commands, by the command itself where it is built.
fn commands(root: &Path) -> Result<()> {
    let built = python_env::target()?.join("debug").join(format!("frictionlab{EXE_SUFFIX}"));
    if !built.is_file() {
        println!("The page of the commands stays as it is: `cargo build` first to make it anew.");
        return Ok(());
    }
    let mut manual = Command::new(built);
    manual.args(["manual", "--format", "markdown", "--force"]).arg(root.join("docs/reference"));
    let status = manual.status().context("frictionlab cannot be run")?;
    ensure!(status.success(), "the page of the commands cannot be made");
    Ok(())
}
