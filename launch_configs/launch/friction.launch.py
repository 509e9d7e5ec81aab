"""Rig driver, friction observer, controller and experiment runner, each a node in a process of its own.

    ros2 launch friction_bringup friction.launch.py
    ros2 launch friction_bringup friction.launch.py rig:=serial:/dev/ttyACM0 params_file:=runs/all-1/parameters.yaml
    ros2 launch friction_bringup friction.launch.py namespace:=axis_1 model:=lugre mode:=position record:=bags/monday

The order of parameters, what comes later wins: `config/NODE.yaml`, `params_file:=`, and the arguments rig:=, model:= and mode:=.
A real rig waits: `ros2 lifecycle set /rig_driver configure`, then `activate`.
"""

from pathlib import Path

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

CONFIG = Path(__file__).resolve().parent.parent / "config"
RIG_DRIVER, OBSERVER, CONTROLLER, RUNNER = "rig_driver", "friction_observer", "controller", "experiment_runner"
NODES = (RIG_DRIVER, OBSERVER, CONTROLLER, RUNNER)
# The ROS package that their programs are installed in.
PROGRAMS = "friction_nodes"
# Without one of these there is no loop: its end ends the others.
LOOP = (RIG_DRIVER, OBSERVER, CONTROLLER)

# `ros2 launch` keeps the other end of each process's standard input: when it is gone, by `kill -9` too, the nodes end with the motor at zero volts.
UNTIL_LAUNCH_ENDS = {"FRICTION_LAUNCHED": "until-stdin-ends"}

# Argument -> nodes whose parameter of that name it sets. An empty argument leaves the matter to the files.
SETS = {"rig": (RIG_DRIVER,), "model": (OBSERVER,), "mode": (OBSERVER, CONTROLLER)}
MODES = ("velocity", "position")
LOG_LEVELS = ("debug", "info", "warn", "error", "fatal")
TOPICS = (
    "joint_states",
    "rig_measurement",
    "reference",
    "motor_voltage",
    "friction_estimate",
    "controller_state",
    "experiment_status",
)

ARGUMENTS = {
    "rig": (
        "",
        "simulated, serial:PORT as in serial:/dev/ttyACM0, quanser or quanser:CARD; empty: as the files say (simulated). "
        "Experiments run on it too if it is a real one",
    ),
    "model": ("", "friction model that estimates: coulomb, stribeck, lugre, proposed, ...; empty: as the files say (proposed)"),
    "mode": ("", "what is regulated: velocity or position; empty: as the files say (velocity)"),
    "namespace": ("", "namespace of the axis, as in axis_1; empty for none"),
    "params_file": ("", "one more parameter file, such as parameters.yaml of an identification"),
    "record": ("", "folder of a bag that `ros2 bag record` writes; must not exist yet; empty: nothing is recorded"),
    "executables": ("packages", "packages: built by colcon; path: found on the PATH, as `cargo install` leaves them"),
    "log_level": ("info", "debug, info, warn, error or fatal"),
}


def check(given: dict[str, str]) -> None:
    """Refuses what no node could mean, before any process starts."""
    rig, port = given["rig"], given["rig"].removeprefix("serial:")
    known = rig in ("", "simulated", "quanser") or (port != rig and port) or (rig.startswith("quanser:") and rig != "quanser:")
    if not known:
        raise RuntimeError(f"rig:={rig} is not known; expected simulated, serial:PORT, quanser or quanser:CARD")
    for name, choices in (("mode", ("", *MODES)), ("executables", ("packages", "path")), ("log_level", LOG_LEVELS)):
        if given[name] not in choices:
            raise RuntimeError(f"{name}:={given[name]} is not known; expected {', '.join(filter(None, choices))}")
    if given["params_file"] and not Path(given["params_file"]).is_file():
        raise RuntimeError(f"params_file:={given['params_file']} is no file")
    if given["record"] and Path(given["record"]).exists():
        raise RuntimeError(f"record:={given['record']} exists already; name a new folder")


def node(name: str, given: dict[str, str]) -> ExecuteProcess:
    """One node with its files and what the arguments set."""
    files = [str(CONFIG / f"{name}.yaml")] + ([given["params_file"]] if given["params_file"] else [])
    sets = {argument: given[argument] for argument, nodes in SETS.items() if name in nodes and given[argument]}
    if name == RUNNER and given["rig"] not in ("", "simulated"):
        # On a real rig its experiments run too. A simulated one of their own needs no real time.
        sets["rig"] = "nodes"
    rest = {"output": "screen", "sigterm_timeout": "10", "additional_env": UNTIL_LAUNCH_ENDS}
    if name in LOOP:
        rest["on_exit"] = Shutdown(reason=f"{name} has ended")
    log_level = ["--log-level", given["log_level"]]
    if given["executables"] == "packages":
        return Node(
            package=PROGRAMS,
            executable=name,
            name=name,
            namespace=given["namespace"],
            parameters=files + ([sets] if sets else []),
            arguments=["--ros-args", *log_level],
            **rest,
        )
    command = [name, "--ros-args", *log_level]
    if given["namespace"]:
        command += ["-r", f"__ns:=/{given['namespace'].strip('/')}"]
    for file in files:
        command += ["--params-file", file]
    for argument, value in sets.items():
        command += ["-p", f"{argument}:={value}"]
    return ExecuteProcess(cmd=command, name=name, **rest)


def recorder(given: dict[str, str]) -> ExecuteProcess:
    """`ros2 bag record` of the axis's topics, and of /diagnostics, which all axes share."""
    prefix = f"/{given['namespace'].strip('/')}" if given["namespace"] else ""
    topics = [f"{prefix}/{topic}" for topic in TOPICS] + ["/diagnostics"]
    command = ["ros2", "bag", "record", "--storage", "mcap", "--output", given["record"], "--topics", *topics]
    return ExecuteProcess(cmd=command, name="recorder", output="screen", sigterm_timeout="10")


def start(context: LaunchContext) -> list[ExecuteProcess]:
    """The processes, for the arguments that were given."""
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    check(given)
    processes = [node(name, given) for name in NODES]
    # The recorder first: it is there when the rig wakes.
    return ([recorder(given)] if given["record"] else []) + processes


def generate_launch_description() -> LaunchDescription:
    """What `ros2 launch` runs."""
    arguments = [
        DeclareLaunchArgument(name, default_value=default, description=description)
        for name, (default, description) in ARGUMENTS.items()
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=start)])
