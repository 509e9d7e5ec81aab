//! `frictionlab launch`: the nodes as processes, as `ros2 launch` would start them.

use std::{path::Path, time::Duration};

use anyhow::Context;
use ros_node::{Arguments, Discovery, Participant, Stop};
use view::ViewOptions;

use crate::launch::arguments::AxisArguments;
use crate::launch::{LaunchArguments, LaunchFile, files::ConfigFolder, plan, supervise::supervise};
use crate::viewing::{Heard, NodesView, Shelf, Shown, ViewArgs, refused};
use work::destination::RUNS;
use work::saying::print;

/// Start the nodes, each a process of its own
///
/// For those without ROS: the same as `ros2 launch friction_bringup friction.launch.py`, with the
/// same arguments.
///
///   frictionlab launch                                            simulated rig, four nodes
///   frictionlab launch model:=lugre mode:=position
///   frictionlab launch rig:=serial:/dev/ttyACM0 params_file:=runs/all-1/parameters.yaml
///   frictionlab launch namespace:=axis_1                          a whole axis in a namespace
///   frictionlab launch --file two-axes rig_2:=serial:/dev/ttyACM1   /axis_1 and /axis_2 on one
///   domain frictionlab launch --show                                     what would be started
///
/// Arguments (an empty value is none; what is not given is as the parameter files say):
///
///   rig:=RIG           simulated, serial:PORT, quanser or quanser:CARD; experiments run on it too
///   if it is a real one model:=NAME        friction model that estimates; `frictionlab models`
///   lists them mode:=MODE         what is regulated: velocity or position
///   namespace:=NAME    namespace of the axis
///   params_file:=FILE  one more parameter file for all nodes
///   record:=DIR        bag written by `ros2 bag record`, or by frictionlab where there is no ros2;
///   true: runs/launch-N log_level:=LEVEL   debug, info, warn, error or fatal
///   files:=DIR         folder for the nodes' own parameter files, to be edited; made if it is not
///   there
///
/// `--file two-axes` has rig_1, model_1, params_file_1 and the same with _2, and mode, record,
/// log_level and files for both.
///
/// The nodes are in frictionlab itself, as `frictionlab node NAME`. A real rig waits for
/// `configure` and `activate` of /rig_driver. Ctrl-C ends all; if one of the loop's three nodes
/// ends, the others are ended, and the exit code is 1.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct LaunchArgs {
    /// Arguments of the launch file
    #[arg(value_name = "NAME:=VALUE")]
    pub arguments: Vec<String>,
    /// What to start
    #[arg(long, value_enum, default_value_t)]
    pub file: LaunchFile,
    /// The same as rig:=RIG
    #[arg(long, value_name = "RIG")]
    pub rig: Option<String>,
    /// The same as model:=NAME
    #[arg(long, value_name = "NAME")]
    pub model: Option<String>,
    /// The same as mode:=MODE
    #[arg(long, value_name = "MODE")]
    pub mode: Option<String>,
    /// The same as namespace:=NAME
    #[arg(long, value_name = "NAME")]
    pub namespace: Option<String>,
    /// The same as params_file:=FILE
    #[arg(long, value_name = "FILE")]
    pub params_file: Option<String>,
    /// The same as record:=DIR
    #[arg(long, value_name = "DIR")]
    pub record: Option<String>,
    /// The view.
    #[command(flatten)]
    pub view: ViewArgs,
    /// Print the commands and start nothing
    #[arg(long)]
    pub show: bool,
}

/// Time from the first signal in which it ends, its processes with it.
const ENDS_WITHIN: Duration = Duration::from_secs(15);

/// Runs it until ctrl-C.
///
/// # Errors
/// [`LaunchError`](crate::launch::LaunchError) for an argument that cannot be, and if a program is
/// missing, does not start or ends by itself.
pub fn execute(args: &LaunchArgs) -> anyhow::Result<()> {
    let LaunchArgs { rig, model, mode, namespace, params_file, record, .. } = args;
    let options = [
        ("rig", rig),
        ("model", model),
        ("mode", mode),
        ("namespace", namespace),
        ("params_file", params_file),
        ("record", record),
    ];
    let given: Vec<String> = args
        .arguments
        .iter()
        .cloned()
        .chain(
            options
                .iter()
                .filter_map(|(name, value)| value.as_ref().map(|value| format!("{name}:={value}"))),
        )
        .collect();
    let arguments = LaunchArguments::read(args.file, &given)?;
    if args.show {
        return show(&arguments);
    }
    // It waits for those who write bags.
    ros_node::ends_within(ENDS_WITHIN);
    let stop = Stop::on_signals().context("cannot watch for ctrl-C")?;
    let config = ConfigFolder::make(arguments.files.as_deref())?;
    let processes = processes(&arguments, config.path());
    let views = views(&args.view, &arguments)?;
    for view in &views {
        ros_node::terminal::say(format!("[launch] {}", view.words()));
    }
    // A terminal that went away must not stop the nodes.
    let ended =
        supervise(&processes, &stop, |text| ros_node::terminal::say(format!("[launch] {text}")));
    ros_node::terminal::flush();
    drop(views);
    Ok(ended?)
}

/// A view of each axis, as one more participant.
fn views(args: &ViewArgs, arguments: &LaunchArguments) -> anyhow::Result<Vec<NodesView>> {
    let Some(options) = args.options("launch") else { return Ok(Vec::new()) };
    let discovery = Discovery::from_environment()?;
    let view = |(at, axis): (usize, &AxisArguments)| {
        let given = axis.namespace.iter().flat_map(|namespace| {
            let namespace = format!("__ns:=/{}", namespace.trim_matches('/'));
            ["--ros-args".to_owned(), "-r".to_owned(), namespace]
        });
        let ours = Arguments::parse(given)?.or_enclave("/view");
        let join = move || Participant::join_with(&discovery, ours.clone());
        let participant = join()?;
        let shown = Shown { heard: Heard::Network, experiments: true, reference: false };
        // The axis behind the first has the port behind it.
        let port = options.port.map(|port| port.saturating_add(at as u16));
        let options = ViewOptions { port, ..options.clone() };
        let shelf = Shelf::new(args.runs(RUNS));
        NodesView::open(&options, &participant, (shown, shelf), Box::new(join)).map_err(refused)
    };
    arguments.axes.iter().enumerate().map(view).collect()
}

/// The processes; where there is no `ros2`, frictionlab itself records.
fn processes(arguments: &LaunchArguments, config: &Path) -> Vec<plan::Process> {
    let processes = plan::processes(arguments, config);
    if plan::Program::Named("ros2").find().is_ok() {
        processes
    } else {
        plan::without_ros(processes, arguments)
    }
}

/// What would be started, ready to be typed.
fn show(arguments: &LaunchArguments) -> anyhow::Result<()> {
    let (folder, note) = match &arguments.files {
        Some(folder) => {
            let config = ConfigFolder::make(Some(folder))?;
            (config.path().to_owned(), String::new())
        }
        None => {
            let note =
                "# `files:=DIR` writes the parameter files named below to a folder that stays\n";
            (ConfigFolder::temporary_path(), note.to_owned())
        }
    };
    let lines = processes(arguments, &folder)
        .iter()
        .fold(note, |text, process| text + &process.command_line() + "\n");
    print(&lines)
}
