"""Two axes on one domain, told apart by namespace: everything of friction.launch.py twice, as /axis_1 and /axis_2.

    ros2 launch friction_bringup two_axes.launch.py
    ros2 launch friction_bringup two_axes.launch.py rig_1:=serial:/dev/ttyACM0 rig_2:=serial:/dev/ttyACM1

Simulated, the second axis has LuGre's friction and noise of its own (`config/axis_2.yaml`).
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration

HERE = Path(__file__).resolve().parent
PARAMETERS = {"axis_1": "", "axis_2": str(HERE.parent / "config" / "axis_2.yaml")}


def generate_launch_description() -> LaunchDescription:
    """What `ros2 launch` runs."""
    actions = []
    for number, (namespace, file) in enumerate(PARAMETERS.items(), start=1):
        rig, model, params_file = f"rig_{number}", f"model_{number}", f"params_file_{number}"
        actions += [
            DeclareLaunchArgument(rig, default_value="simulated", description=f"rig:= of /{namespace}"),
            DeclareLaunchArgument(model, default_value="", description=f"model:= of /{namespace}"),
            DeclareLaunchArgument(params_file, default_value=file, description=f"params_file:= of /{namespace}"),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(str(HERE / "friction.launch.py")),
                launch_arguments={
                    "namespace": namespace,
                    "rig": LaunchConfiguration(rig),
                    "model": LaunchConfiguration(model),
                    "params_file": LaunchConfiguration(params_file),
                }.items(),
            ),
        ]
    return LaunchDescription(actions)
