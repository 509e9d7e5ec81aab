//! What a machine must have for a test to run, and whether this one has it.
//!
//! A test says what it needs by `#[needs(...)]`, which reads what was found here while the tests
//! are built. What was found stands in `machine.txt` in the target folder: `cargo xtask test` and
//! `cargo xtask python-env` look anew; `cargo test` alone looks where that file is missing.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, io};

use strum::{Display, EnumString, VariantArray};

/// Something that not every machine has.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Display, EnumString, VariantArray,
)]
#[strum(serialize_all = "snake_case")]
pub enum Need {
    /// The rclpy of ROS 2 Kilted.
    Rclpy,
    /// The rclpy of ROS 2 Jazzy.
    Jazzy,
    /// Readers of bags that are not ours.
    BagTools,
    /// What checks and builds our Python.
    PythonTools,
    /// colcon, which builds ROS workspaces.
    Colcon,
    /// A peer on Cyclone DDS.
    Cyclone,
    /// MuJoCo, the newest and an older one.
    Mujoco,
    /// Ray and an object store.
    RayCluster,
    /// A network namespace, so that nothing leaves the machine.
    Namespace,
    /// Two network namespaces with a wire between them.
    Machines,
    /// The command `ros2` of an installation.
    Ros2,
    /// A browser.
    Chromium,
    /// The checks of accessibility that `npm ci` brings.
    Axe,
    /// A client of the view that others wrote.
    ViewerClient,
    /// A viewer of bags that others wrote.
    Rerun,
    /// Headers of Fast DDS, for a peer of another vendor in C++.
    FastDds,
    /// The recordings of the EMPS benchmark.
    Emps,
    /// The recordings of the Qube servo.
    QubeServo,
    /// The logs of the XL330 servo.
    Xl330,
    /// `cargo xtask test --full`.
    LongTier,
}

/// Brings loopback up with multicast, then becomes the command.
pub const LOOPBACK_ONLY: &str = "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && exec \"$@\"";

/// Options of `unshare` that a system may grant: as root, and as another user.
pub const NAMESPACE_FLAGS: [&[&str]; 2] = [&["-n"], &["-r", "-n"]];

impl Need {
    /// Why a test is ignored here, and how to mend it.
    #[must_use]
    pub const fn reason(self) -> &'static str {
        match self {
            Self::Rclpy => "no Python with rclpy: `cargo xtask python-env` makes it",
            Self::Jazzy => {
                "no Python with Jazzy's rclpy: `cargo xtask python-env --distribution jazzy` makes it"
            }
            Self::BagTools => "no Python with readers of bags: `cargo xtask python-env` makes it",
            Self::PythonTools => {
                "no Python with mypy, nbclient and maturin: `cargo xtask python-env` makes it"
            }
            Self::Colcon => "no colcon: `cargo xtask python-env` makes it",
            Self::Cyclone => "no Python with Cyclone DDS: `cargo xtask python-env` makes it",
            Self::Mujoco => "no Python with MuJoCo: `cargo xtask python-env` makes it",
            Self::RayCluster => "no Python with Ray: `cargo xtask python-env` makes it",
            Self::Namespace => {
                "no network namespace (`unshare -n` with `ip`): run as root or allow user namespaces"
            }
            Self::Machines => {
                "no two network namespaces (`unshare -n`, `ip link add type veth`, `nsenter`, `tc`): run as root"
            }
            Self::Ros2 => {
                "no `ros2` command on the path; the other tests make the same calls with rclpy"
            }
            Self::Chromium => "no Chromium: install `chromium`, or name one in CHROMIUM",
            Self::Axe => "no axe-core: run `npm ci` in `web`",
            Self::ViewerClient => {
                "no client of the view: run `npm ci --ignore-scripts` in `tests/viewers`"
            }
            Self::Rerun => "no Python with rerun: `cargo xtask python-env` makes it",
            Self::FastDds => {
                "no Fast DDS: `apt-get install libssl-dev libfastrtps-dev libfastcdr-dev`"
            }
            Self::Emps => "the EMPS recordings are neither in $FRICTION_DATA nor in ../shared/data",
            Self::QubeServo => {
                "the Qube servo's recordings are neither in $FRICTION_DATA nor in ../shared/data"
            }
            Self::Xl330 => "the servo logs are neither in $FRICTION_DATA nor in ../shared/data",
            Self::LongTier => "it takes minutes: `cargo xtask test --full` runs it",
        }
    }

    /// Whether this machine has it. Python environments stand in the target folder.
    #[must_use]
    pub fn is_met(self, target: &Path) -> bool {
        let part = |variable: &str, beside: &str, part: &str| {
            let folder = environment(target, variable, beside);
            folder.join("bin/python").is_file() && folder.join(format!("{part}.stamp")).is_file()
        };
        match self {
            Self::Rclpy => part("FRICTION_PYTHON_ENV", "python", "rclpy"),
            Self::BagTools => part("FRICTION_PYTHON_ENV", "python", "bag_tools"),
            Self::PythonTools => part("FRICTION_PYTHON_ENV", "python", "python_tools"),
            Self::Colcon => part("FRICTION_PYTHON_ENV", "python", "colcon"),
            Self::Jazzy => part("FRICTION_PYTHON_ENV_JAZZY", "python-jazzy", "rclpy"),
            Self::Cyclone => part("FRICTION_PYTHON_ENV_CYCLONE", "python-cyclone", "cyclone"),
            Self::Mujoco => {
                part("FRICTION_PYTHON_ENV_MUJOCO", "python-mujoco", "mujoco")
                    && part("FRICTION_PYTHON_ENV_MUJOCO_3", "python-mujoco-3", "mujoco")
            }
            Self::RayCluster => part("FRICTION_PYTHON_ENV_RAY", "python-ray", "ray"),
            Self::Namespace => namespace_flags().is_some(),
            Self::Machines => namespace_flags().is_some() && two_namespaces(),
            Self::Ros2 => succeeds("ros2", &[&["--help"]]),
            Self::Chromium => chromium().is_some(),
            Self::Axe => axe().is_file(),
            Self::ViewerClient => {
                viewer_client().join("node_modules/@foxglove/ws-protocol").is_dir()
                    && succeeds("node", &[&["--version"]])
            }
            Self::Rerun => part("FRICTION_PYTHON_ENV_RERUN", "python-rerun", "rerun"),
            Self::FastDds => ["fastdds", "openssl/ssl.h"]
                .iter()
                .all(|header| Path::new("/usr/include").join(header).exists()),
            Self::Emps => recording("emps"),
            Self::QubeServo => recording("qube_servo"),
            Self::Xl330 => recording("xl330"),
            Self::LongTier => env::var_os("FRICTION_FULL").is_some(),
        }
    }

    /// Whether it is looked for anew whenever the tests are built: the environment alone decides.
    #[must_use]
    pub const fn is_of_the_environment(self) -> bool {
        matches!(self, Self::Emps | Self::QubeServo | Self::Xl330 | Self::LongTier)
    }
}

/// The Python environment of that name in the target folder, unless a variable names another.
#[must_use]
pub fn environment(target: &Path, variable: &str, beside: &str) -> PathBuf {
    env::var_os(variable).map_or_else(|| target.join(beside), PathBuf::from)
}

/// The folder of recordings that are not part of the project: `$FRICTION_DATA`, or `shared/data`
/// beside the checkout; `None` where there is none.
#[must_use]
pub fn recordings() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = env::var_os("FRICTION_DATA").map_or_else(beside, PathBuf::from);
    folder.is_dir().then_some(folder)
}

fn recording(name: &str) -> bool {
    recordings().is_some_and(|folder| folder.join(name).is_dir())
}

/// The options with which this system grants a network namespace.
#[must_use]
pub fn namespace_flags() -> Option<&'static [&'static str]> {
    NAMESPACE_FLAGS
        .into_iter()
        .find(|flags| succeeds("unshare", &[flags, &["bash", "-c", LOOPBACK_ONLY, "--", "true"]]))
}

fn two_namespaces() -> bool {
    const WIRE: &str = "unshare -n sleep 5 & other=$!
        until [ \"$(readlink /proc/$other/ns/net)\" != \"$(readlink /proc/self/ns/net)\" ]; do sleep 0.01; done
        ip link add card type veth peer name wire && ip link set wire netns $other && nsenter -t $other -n ip link set wire up && tc -V
        granted=$?; kill $other; exit $granted";
    NAMESPACE_FLAGS.into_iter().any(|flags| succeeds("unshare", &[flags, &["bash", "-c", WIRE]]))
}

/// The browser: `$CHROMIUM`, or the first that is installed under a usual name.
#[must_use]
pub fn chromium() -> Option<PathBuf> {
    let named = env::var_os("CHROMIUM").map(PathBuf::from);
    let usual = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    let path = env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = env::split_paths(&path).collect();
    let installed = folders.iter().flat_map(|folder| usual.map(|name| folder.join(name)));
    named.into_iter().chain(installed).find(|program| program.is_file())
}

/// The script of axe-core, which looks for what keeps people from using a page; it is there after
/// `npm ci` in `web`.
#[must_use]
pub fn axe() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web/node_modules/axe-core/axe.min.js")
}

/// The folder of the client of the view that others wrote.
#[must_use]
pub fn viewer_client() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../viewers")
}

fn succeeds(program: &str, arguments: &[&[&str]]) -> bool {
    let mut command = Command::new(program);
    command.args(arguments.concat()).stdin(Stdio::null());
    command.output().is_ok_and(|output| output.status.success())
}

/// Where it is written down what this machine has.
#[must_use]
pub fn file(target: &Path) -> PathBuf {
    target.join("machine.txt")
}

/// All that can be needed.
pub fn all() -> impl Iterator<Item = Need> {
    Need::VARIANTS.iter().copied()
}

/// Looks for everything.
#[must_use]
pub fn look(target: &Path) -> BTreeSet<Need> {
    all().filter(|need| need.is_met(target)).collect()
}

/// Writes down what was found, but for what the environment decides. The file is touched only where
/// something has changed: the tests are built anew then.
///
/// # Errors
/// The file cannot be written.
pub fn write_down(target: &Path, found: &BTreeSet<Need>) -> io::Result<()> {
    let lasting = found.iter().filter(|need| !need.is_of_the_environment());
    let text: String = lasting.map(|need| format!("{need}\n")).collect();
    let file = file(target);
    if fs::read_to_string(&file).is_ok_and(|before| before == text) {
        return Ok(());
    }
    fs::write(file, text)
}

/// What was written down; everything is looked for where nothing was.
///
/// # Errors
/// The file cannot be written.
pub fn written_down(target: &Path) -> io::Result<BTreeSet<Need>> {
    let Ok(text) = fs::read_to_string(file(target)) else {
        let found = look(target);
        write_down(target, &found)?;
        return Ok(found);
    };
    let lasting = text.lines().filter_map(|name| name.parse::<Need>().ok());
    let of_environment = all().filter(|need| need.is_of_the_environment());
    Ok(lasting.chain(of_environment.filter(|need| need.is_met(target))).collect())
}
