//! The wheel `frictionlab` as others get it: a source distribution that holds all that it is built
//! from, and wheels built by pip from it and from the checkout, each tried in an empty environment.

use std::path::{Path, PathBuf};
use std::process::Command;

use tests::python;

/// What is tried where nothing of the checkout is near: the examples in the documentation of every
/// module, and a fit.
const TRIED: &str = r#"
import doctest, importlib, pkgutil
import numpy as np
import frictionlab, friction_analysis

assert "site-packages" in frictionlab.__file__, frictionlab.__file__
tried = 0
for module in pkgutil.iter_modules(frictionlab.__path__):
    result = doctest.testmod(importlib.import_module(f"frictionlab.{module.name}"))
    assert result.failed == 0, module.name
    tried += result.attempted
assert tried > 10, tried
v = np.linspace(0.05, 3.0, 40)
points = {"velocity_rad_s": np.r_[-v, v], "torque_Nm": np.r_[-0.1 - 0.04 * v, 0.1 + 0.04 * v]}
found = frictionlab.identify(points, model="coulomb_viscous")
assert abs(found["coulomb_viscous"]["f_v"].value - 0.04) < 1e-9
assert found.to_pandas().shape[0] >= 2 and "f_c" in found.to_yaml()
print("works", frictionlab.__version__)
"#;

fn run(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {said}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The source distribution, made into a folder.
fn source_distribution(into: &Path) -> PathBuf {
    let maturin = python::interpreter("python_tools").with_file_name("maturin");
    let manifest = tests::checkout().join("python/binding/Cargo.toml");
    run(Command::new(maturin).arg("sdist").arg("-m").arg(manifest).arg("-o").arg(into));
    let made = into.read_dir().expect("a folder").next().expect("a file").expect("an entry");
    made.path()
}

#[tests::needs(python_tools)]
#[test]
fn the_source_distribution_holds_what_it_is_built_from() {
    let folder = tempfile::tempdir().expect("a folder");
    let packed = source_distribution(&folder.path().join("made"));
    run(Command::new("tar").arg("-xf").arg(&packed).arg("-C").arg(folder.path()));
    let name = packed.file_name().and_then(|name| name.to_str()).expect("a name");
    let root = folder.path().join(name.trim_end_matches(".tar.gz"));
    // Every package that the extension module is built from, with its sources.
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let manifest = root.join("python/binding/Cargo.toml");
    let told = run(Command::new(cargo)
        .args(["tree", "--offline", "--prefix=none", "--format={lib} {p}"])
        .args(["--edges=normal,build", "--manifest-path"])
        .arg(manifest));
    let root_name = root.to_str().expect("a text");
    let ours = |line: &&str| line.contains(root_name);
    assert!(told.lines().filter(ours).any(|line| line.starts_with("friction_lanes ")), "{told}");
    for file in ["frictionlab/__init__.py", "frictionlab/py.typed", "friction_analysis/bag.py"] {
        let found = [root.join(file), root.join("python").join(file)];
        assert!(found.iter().any(|path| path.is_file()), "{file} is missing");
    }
}

/// A new environment with nothing in it, into which pip installs what it builds in `target`; what
/// works there.
fn tried(folder: &Path, what: &Path, profile: &str, target: &Path) -> String {
    let environment = folder.join(profile);
    let python = python::interpreter("python_tools");
    run(Command::new(python).args(["-m", "venv"]).arg(&environment));
    let python = environment.join("bin/python");
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).arg(what);
    pip.env("CARGO_TARGET_DIR", target);
    pip.env("MATURIN_PEP517_ARGS", format!("--profile {profile}"));
    run(&mut pip);
    let mut command = Command::new(python);
    run(command.args(["-c", TRIED]).current_dir(folder).env_remove("PYTHONPATH"))
}

/// A build takes minutes: from the source distribution it is that of the development profile, from
/// the checkout the one that people get.
#[tests::needs(python_tools, long_tier)]
#[test]
fn wheels_work_in_an_empty_environment() {
    let folder = tempfile::tempdir().expect("a folder");
    let packed = source_distribution(&folder.path().join("made"));
    // Files of a source distribution are all of one old time: in a folder with an earlier build Cargo
    // would take that for their own.
    let new = folder.path().join("target");
    assert!(tried(folder.path(), &packed, "dev", &new).starts_with("works"));
    let checkout = tests::checkout().join("python");
    // What other tests need is not built over.
    let own = Path::new(env!("CARGO_TARGET_TMPDIR")).join("wheel");
    assert!(tried(folder.path(), &checkout, "release", &own).starts_with("works"));
}
