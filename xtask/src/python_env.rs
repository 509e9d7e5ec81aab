//! The Python side of the tests: a virtual environment with readers of bags and, where wheels
//! exist, the real rclpy with the laboratory's own message types built into it.
//!
//! The parts are independent: where one cannot be had, the others still are, and the tests that
//! need the missing one are skipped. Everything is made once; what was made of other versions or
//! other messages is made anew.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, bail, ensure};
use machine::Need;

use crate::distribution::Distribution;

/// Readers of bags that are not ours, and what our Python package and its tests are made of.
const BAG_TOOLS: &[&str] = &[
    "rosbags==0.11.9",
    "mcap-ros2-support==0.6.0",
    "numpy",
    "pandas>=2.2,<4",
    "matplotlib>=3.8,<4",
    "pytest>=8,<10",
    "PyYAML>=6,<7",
];

/// What checks the types of our Python and runs its notebook, what builds its wheel, the sampler that
/// samples are held against, and what fleets need.
const PYTHON_TOOLS: &[&str] = &[
    "mypy>=1.11,<3",
    "pandas-stubs",
    "nbclient>=0.10,<1",
    "ipykernel>=6,<8",
    "maturin>=1.9,<2",
    "emcee>=3.1,<4",
    "pyarrow>=15",
    "fsspec>=2024.2",
    "scipy>=1.11,<2",
];

/// The tool that builds ROS workspaces, as a ROS installation has it, and its extensions for cargo,
/// which some workspaces have.
const COLCON: &[&str] =
    &["colcon-common-extensions==0.3.0", "colcon-cargo==0.2.0", "colcon-ros-cargo==0.2.0"];

/// The peer of the fits.
const SCIPY: &[&str] = &["numpy", "scipy", "numba"];

/// A peer of another middleware than rclpy's.
const CYCLONE: &[&str] = &["cyclonedds==11.0.1"];

/// A viewer that reads bags.
const RERUN: &[&str] = &["rerun-sdk==0.41.0"];

/// MuJoCo, the newest that the exports know.
const MUJOCO: &[&str] = &["mujoco==4.0.0"];

/// MuJoCo from before its `dcmotor` could do without an input.
const OLDER_MUJOCO: &[&str] = &["mujoco==3.8.1"];

/// A cluster for fleets, and an object store to read them from.
const RAY: &[&str] = &[
    "ray>=2.50,<3",
    "s3fs>=2024.2",
    "moto[server]>=5,<6",
    "rosbags==0.11.9",
    "pyarrow>=15",
    "scipy>=1.11,<2",
    "pandas>=2.2,<4",
    "matplotlib>=3.8,<4",
    "pytest>=8,<10",
];

/// What [`prepare`] makes ready, in the words of a person.
pub const PARTS: [(Need, &str); 8] = [
    (Need::BagTools, "readers of bags (rosbags, mcap-ros2-support), pandas, matplotlib, pytest"),
    (Need::PythonTools, "mypy, notebooks (nbclient, ipykernel), maturin"),
    (Need::Rclpy, "rclpy with friction_msgs"),
    (Need::Cyclone, "Cyclone DDS (cyclonedds)"),
    (Need::Rerun, "a viewer of bags (rerun-sdk)"),
    (Need::Mujoco, "MuJoCo, the newest and an older one"),
    (Need::RayCluster, "Ray, and a server of an object store"),
    // It builds with what comes with rclpy.
    (Need::Colcon, "colcon"),
];

/// The environment, and what of it can be used.
#[derive(Debug)]
pub struct PythonEnv {
    /// Folder of the environment.
    pub dir: PathBuf,
    /// Each of [`PARTS`], in that order: why it is not there, if it is not.
    pub parts: Vec<anyhow::Result<()>>,
}

impl PythonEnv {
    /// The parts that are not there, in words, and why.
    pub fn missing(&self) -> impl Iterator<Item = (&'static str, &anyhow::Error)> {
        let with_words = PARTS.iter().zip(&self.parts);
        with_words.filter_map(|((_, what), part)| Some((*what, part.as_ref().err()?)))
    }

    /// The folder of the environment, once its rclpy is there.
    ///
    /// # Errors
    /// Why there is no rclpy.
    pub fn with_rclpy(self) -> anyhow::Result<PathBuf> {
        let place = PARTS.iter().position(|(need, _)| *need == Need::Rclpy);
        let rclpy = place.and_then(|place| self.parts.into_iter().nth(place));
        rclpy.context("rclpy is one of the parts")??;
        Ok(self.dir)
    }
}

/// Makes the environment of Kilted in `target/python`, and those beside it, or finds them made.
/// Needs the network the first time.
///
/// # Errors
/// No Python 3 with `venv`, or a target folder that cannot be written. A part that cannot be had is
/// told in the result.
pub fn prepare() -> anyhow::Result<PythonEnv> {
    let shared = Environment::make(&target()?.join(Distribution::Kilted.folder()))?;
    let within = |stamp: &str, wheels: &[&str]| {
        shared.half(stamp, wheels.join("\n"), || shared.install(wheels))
    };
    let apart = |folder: &str, stamp: &str, wheels: &[&str]| {
        let own = Environment::make(&target()?.join(folder))?;
        own.half(stamp, wheels.join("\n"), || own.install(wheels))
    };
    let make = |need| match need {
        Need::BagTools => within("bag_tools", BAG_TOOLS),
        Need::PythonTools => within("python_tools", PYTHON_TOOLS),
        Need::Rclpy => shared.rclpy(Distribution::Kilted),
        Need::Cyclone => apart("python-cyclone", "cyclone", CYCLONE),
        Need::Rerun => apart("python-rerun", "rerun", RERUN),
        Need::Mujoco => mujoco().map(drop),
        Need::RayCluster => apart("python-ray", "ray", RAY),
        Need::Colcon => within("colcon", COLCON),
        other => bail!("`{other}` is no part of a Python environment"),
    };
    let parts = PARTS.iter().map(|&(need, _)| make(need)).collect();
    Ok(PythonEnv { dir: shared.dir, parts })
}

/// Makes an environment with the rclpy of a distribution, or finds it made.
///
/// # Errors
/// As [`prepare`], and what keeps rclpy away.
pub fn rclpy(distribution: Distribution) -> anyhow::Result<PathBuf> {
    let environment = Environment::make(&target()?.join(distribution.folder()))?;
    environment.rclpy(distribution)?;
    Ok(environment.dir)
}

/// The target folder.
///
/// # Errors
/// None in a checkout: this package stands in the workspace.
pub fn target() -> anyhow::Result<PathBuf> {
    let root = root()?;
    Ok(env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |dir| root.join(dir)))
}

fn root() -> anyhow::Result<&'static Path> {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("xtask stands in the workspace")
}

/// A Python with SciPy and Numba, in an environment of its own: they are only needed for
/// `cargo xtask bench-fits` and `bench-monte-carlo`, and their numpy must not disturb rclpy's.
///
/// # Errors
/// No Python 3 with `venv`, no network the first time.
pub fn scipy() -> anyhow::Result<PathBuf> {
    let environment = Environment::make(&target()?.join("python-scipy"))?;
    environment.half("scipy", SCIPY.join("\n"), || environment.install(SCIPY))?;
    Ok(environment.python)
}

/// A Python with the newest MuJoCo, and one with an older.
///
/// # Errors
/// No Python 3 with `venv`, no network the first time.
pub fn mujoco() -> anyhow::Result<[PathBuf; 2]> {
    let make = |folder: &str, wheels: &[&str]| {
        let environment = Environment::make(&target()?.join(folder))?;
        environment.half("mujoco", wheels.join("\n"), || environment.install(wheels))?;
        Ok::<_, anyhow::Error>(environment.python)
    };
    Ok([make("python-mujoco", MUJOCO)?, make("python-mujoco-3", OLDER_MUJOCO)?])
}

/// Arguments of `cargo xtask python-env`.
#[derive(Debug, clap::Args)]
pub struct PythonEnvCommand {
    /// Distribution of ROS 2 whose rclpy is made ready; `kilted` with the readers of bags, `jazzy`
    /// without
    #[arg(long, value_enum, default_value = "kilted")]
    distribution: Distribution,
}

impl PythonEnvCommand {
    /// Prepares and tells.
    ///
    /// # Errors
    /// As [`prepare`], and as [`rclpy`] for a distribution that is not the usual one.
    pub fn run(&self) -> anyhow::Result<()> {
        if self.distribution != Distribution::Kilted {
            let dir = rclpy(self.distribution)?;
            println!("Python environment: {}\n  ready: rclpy with friction_msgs", dir.display());
            return told_to_the_tests(&dir);
        }
        let environment = prepare()?;
        println!("Python environment: {}", environment.dir.display());
        for ((_, what), part) in PARTS.iter().zip(&environment.parts) {
            match part {
                Ok(()) => println!("  ready: {what}"),
                Err(error) => println!(
                    "  missing: {what}; tests that need it are ignored\n    because: {error:#}"
                ),
            }
        }
        told_to_the_tests(&environment.dir)
    }
}

/// The tests beside an environment are built for what is there.
fn told_to_the_tests(environment: &Path) -> anyhow::Result<()> {
    let target = environment.parent().context("an environment lies in the target folder")?;
    Ok(machine::write_down(target, &machine::look(target))?)
}

/// A virtual environment of Python.
pub struct Environment {
    /// Its folder.
    pub dir: PathBuf,
    python: PathBuf,
}

impl Environment {
    /// Makes it, or finds it made.
    ///
    /// # Errors
    /// No Python 3 with `venv`, or a folder that cannot be written.
    pub fn make(dir: &Path) -> anyhow::Result<Self> {
        let python = dir.join("bin/python");
        if !python.exists() {
            let interpreter = env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
            fs::create_dir_all(dir).with_context(|| format!("cannot make {}", dir.display()))?;
            run_quietly(Command::new(&interpreter).args(["-m", "venv"]).arg(dir)).context(
                "a Python 3 with its `venv` module is needed; install it, or name one in PYTHON",
            )?;
        }
        // The ROS packages of the target folder are none of a workspace that this checkout is built
        // in.
        let target = dir.parent().unwrap_or(dir);
        fs::write(target.join("COLCON_IGNORE"), "")
            .with_context(|| format!("cannot write into {}", target.display()))?;
        Ok(Self { dir: dir.into(), python })
    }

    /// Makes a half unless its stamp says that it stands. The stamp is what the half was made of.
    ///
    /// # Errors
    /// What keeps the half from being made, and a stamp that cannot be written.
    pub fn half(
        &self,
        name: &str,
        key: String,
        make: impl FnOnce() -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let stamp = self.dir.join(format!("{name}.stamp"));
        if fs::read_to_string(&stamp).is_ok_and(|made_of| made_of == key) {
            return Ok(());
        }
        // No half-made half: the stamp goes first and comes last.
        if stamp.exists() {
            fs::remove_file(&stamp)?;
        }
        make()?;
        fs::write(&stamp, key).with_context(|| format!("cannot write {}", stamp.display()))
    }

    /// The half with rclpy and our message package.
    fn rclpy(&self, distribution: Distribution) -> anyhow::Result<()> {
        let package = root()?.join("msgs/friction_msgs");
        let requirements = distribution.requirements();
        let key = format!("{}\n{}", requirements.join("\n"), contents(&package)?);
        self.half("rclpy", key, || {
            self.install(&requirements)?;
            self.repair_paths()?;
            self.build(&package)
        })
    }

    /// Installs packages by pip, which gets these words behind `install`.
    ///
    /// # Errors
    /// What pip says.
    pub fn install<S: AsRef<std::ffi::OsStr>>(&self, requirements: &[S]) -> anyhow::Result<()> {
        let mut pip = Command::new(&self.python);
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        run_quietly(pip.args(requirements))
    }

    /// Asks the interpreter for one line.
    fn ask(&self, expression: &str) -> anyhow::Result<String> {
        let output =
            Command::new(&self.python).args(["-c", &format!("print({expression})")]).output()?;
        ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Ok(String::from_utf8(output.stdout)?.trim().to_owned())
    }

    /// The wheels' CMake files name folders of the machine they were built on; ours are elsewhere.
    fn repair_paths(&self) -> anyhow::Result<()> {
        let version = self.ask("'%d.%d' % __import__('sys').version_info[:2]")?;
        let tag = format!("cp{}", version.replace('.', ""));
        let built_with = format!("/opt/python/{tag}-{tag}");
        let replacements = [
            (
                format!("{built_with}/lib/python{version}/site-packages/numpy/_core/include"),
                self.ask("__import__('numpy').get_include()")?,
            ),
            (
                format!("{built_with}/include/python{version}"),
                self.ask("__import__('sysconfig').get_path('include')")?,
            ),
        ];
        for package in fs::read_dir(self.dir.join("share"))? {
            let Ok(files) = fs::read_dir(package?.path().join("cmake")) else { continue };
            for file in files {
                let file = file?.path();
                if file.extension().is_none_or(|extension| extension != "cmake") {
                    continue;
                }
                let before = fs::read_to_string(&file)?;
                let after = replacements
                    .iter()
                    .fold(before.clone(), |text, (from, to)| text.replace(from, to));
                if after != before {
                    fs::write(&file, after)?;
                }
            }
        }
        Ok(())
    }

    /// Builds the message package into the environment, as `colcon` would into a workspace.
    fn build(&self, package: &Path) -> anyhow::Result<()> {
        let build = self.dir.join("build/friction_msgs");
        if build.exists() {
            fs::remove_dir_all(&build)?;
        }
        let bin = self.dir.join("bin");
        let path = env::join_paths(
            std::iter::once(bin.clone())
                .chain(env::split_paths(&env::var_os("PATH").unwrap_or_default())),
        )?;
        let prefix = |name: &str| format!("-D{name}={}", self.dir.display());
        let command = |program: &str| {
            let mut command = Command::new(bin.join(program));
            command
                .env("AMENT_PREFIX_PATH", &self.dir)
                .env("VIRTUAL_ENV", &self.dir)
                .env("PATH", &path);
            command
        };
        run_quietly(
            command("cmake")
                .args(["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"])
                .arg("-S")
                .arg(package)
                .arg("-B")
                .arg(&build)
                .args([prefix("CMAKE_PREFIX_PATH"), prefix("CMAKE_INSTALL_PREFIX")])
                .arg(format!("-DPython3_EXECUTABLE={}", self.python.display())),
        )
        .context(
            "cannot configure friction_msgs; a C++ compiler and the headers of Python are needed",
        )?;
        run_quietly(command("cmake").arg("--build").arg(&build))
            .context("cannot build friction_msgs")?;
        run_quietly(command("cmake").arg("--install").arg(&build))
            .context("cannot install friction_msgs")?;
        run_quietly(Command::new(&self.python).args([
            "-c",
            "import rclpy, friction_msgs.msg, friction_msgs.srv, friction_msgs.action",
        ]))
        .context("rclpy with friction_msgs was built, but cannot be imported")
    }
}

/// Runs a command; its output is only told if it fails.
fn run_quietly(command: &mut Command) -> anyhow::Result<()> {
    let output = command
        .output()
        .with_context(|| format!("cannot run {}", command.get_program().display()))?;
    if output.status.success() {
        return Ok(());
    }
    let text = format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    let lines: Vec<&str> = text.lines().collect();
    let last = &lines[lines.len().saturating_sub(12)..];
    bail!("{} ended with {}:\n{}", command.get_program().display(), output.status, last.join("\n"))
}

/// Names and texts of a package's files, to see when it changes.
fn contents(package: &Path) -> anyhow::Result<String> {
    let mut files = vec![package.join("package.xml"), package.join("CMakeLists.txt")];
    for folder in ["msg", "srv", "action"] {
        let folder = package.join(folder);
        for entry in
            fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))?
        {
            files.push(entry?.path());
        }
    }
    files.sort();
    let mut text = String::new();
    for file in files {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let content =
            fs::read_to_string(&file).with_context(|| format!("cannot read {}", file.display()))?;
        text.push_str(&format!("{name}\n{content}\n"));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tests are built for what will be there. A part that was made and not listed had all of
    /// them built twice on every new machine.
    #[test]
    fn every_need_that_python_env_mends_is_one_of_its_parts() {
        let mended = machine::all().filter(|need| need.reason().contains("python-env` makes it"));
        for need in mended {
            assert!(PARTS.iter().any(|(part, _)| *part == need), "{need} is not listed");
        }
    }
}
