"""Start the six nodes of the twin; the end of any of them ends them all."""

from time import strftime

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

ARGUMENTS = {
    "scenario": ("case2", "scenario: a name in config/scenarios or the path of a file"),
    "speed": ("0.0", "simulated seconds per second of wall clock; 0 is as fast as possible"),
    "record": (strftime("runs/launch-%Y%m%d-%H%M%S"), "folder that the recorder writes"),
}


def generate_launch_description():
    """Return the arguments and the nodes; ROS_DOMAIN_ID and discovery come from the environment."""
    scenario = ParameterValue(LaunchConfiguration("scenario"), value_type=str)
    extra = {
        # The clock comes last: it starts the run once it sees the others.
        "environment": {},
        "vessel": {},
        "crane": {},
        "payload": {},
        "recorder": {"out": ParameterValue(LaunchConfiguration("record"), value_type=str)},
        "clock": {"speed": ParameterValue(LaunchConfiguration("speed"), value_type=float)},
    }
    arguments = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, (default, text) in ARGUMENTS.items()
    ]
    nodes = [
        Node(
            package="shipcrane_twin",
            executable=name,
            name=name,
            output="screen",
            parameters=[{"scenario": scenario, **parameters}],
            on_exit=Shutdown(reason=f"{name} has ended"),
        )
        for name, parameters in extra.items()
    ]
    return LaunchDescription(arguments + nodes)
