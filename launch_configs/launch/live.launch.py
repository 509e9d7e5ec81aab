"""Rig, observer and controller live in one process, recorded and published: `frictionlab live`.

    ros2 launch friction_bringup live.launch.py model:=lugre mode:=position
    ros2 launch friction_bringup live.launch.py rig:=serial:/dev/ttyACM0 serve:=true

`frictionlab` must be on the PATH, where `source install/setup.bash` puts it, and
`cargo install --locked --path frictionlab`. Arguments that are not given come from
`config/live.yaml`, or from the file named by `config:=`.
"""

from pathlib import Path

import yaml
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

CONFIG = Path(__file__).resolve().parent.parent / "config" / "live.yaml"

# `ros2 launch` keeps the other end of the process's standard input: when it is gone, by `kill -9` too, the run ends with the motor at zero volts.
UNTIL_LAUNCH_ENDS = {"FRICTION_LAUNCHED": "until-stdin-ends"}

# Launch argument -> option of `frictionlab live`. An empty argument leaves the matter to the file.
OPTIONS = {
    "rig": "--rig",
    "model": "--model",
    "mode": "--mode",
    "parameters": "--parameters",
    "duration": "--duration",
    "seed": "--seed",
    "out": "--out",
}
# Launch argument -> switch, given when it is true.
SWITCHES = {"serve": "--serve", "no_compensation": "--no-compensation"}


def start(context: LaunchContext) -> list[ExecuteProcess]:
    """The process, with what was given on the command line before what the file says."""
    file = Path(LaunchConfiguration("config").perform(context))
    settings = yaml.safe_load(file.read_text(encoding="utf-8")) or {}
    expected = [*OPTIONS, *SWITCHES]
    unknown = set(settings) - set(expected)
    if unknown:
        raise RuntimeError(f"{file} has {', '.join(sorted(unknown))}; expected only {', '.join(expected)}")
    value = {name: str(LaunchConfiguration(name).perform(context) or settings.get(name, "")) for name in expected}
    command = ["frictionlab", "live"]
    for name, option in OPTIONS.items():
        if value[name]:
            command += [option, value[name]]
    for name, switch in SWITCHES.items():
        if value[name].lower() not in ("", "true", "false"):
            raise RuntimeError(f"{name}:={value[name]} is not known; expected true or false")
        if value[name].lower() == "true":
            command.append(switch)
    return [ExecuteProcess(cmd=command, output="screen", sigterm_timeout="10", additional_env=UNTIL_LAUNCH_ENDS)]


def generate_launch_description() -> LaunchDescription:
    """What `ros2 launch` runs."""
    arguments = [
        DeclareLaunchArgument(name, default_value="", description=f"frictionlab live {option}")
        for name, option in {**OPTIONS, **SWITCHES}.items()
    ]
    config = DeclareLaunchArgument("config", default_value=str(CONFIG), description="YAML file with the defaults")
    return LaunchDescription([*arguments, config, OpaqueFunction(function=start)])
