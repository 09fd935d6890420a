"""Start the nodes of the twin; the end of any of them ends them all."""

from time import strftime

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch_ros.actions import Node

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.controllers import own_chain_of

ARGUMENTS = {
    "scenario": ("case2", "scenario: a name in config/scenarios or the path of a file"),
    "speed": ("0", "simulated seconds per second of wall clock; 0 is as fast as it goes"),
    "record": (strftime("runs/launch-%Y%m%d-%H%M%S"), "folder for bag and results; none: do not record"),
}


def start_nodes(context):
    """Return the node actions for the arguments' values."""
    values = context.launch_configurations
    run_dir = "" if values["record"] == "none" else values["record"]
    shared = {"scenario": values["scenario"], "run_dir": run_dir, "recorded": bool(run_dir)}
    own = {name: {} for name in own_chain_of(load_scenario(values["scenario"]))}
    own["clock"] = {"speed": float(values["speed"])}
    if run_dir:
        own["recorder"] = {}
    return [
        Node(
            package="shipcrane_twin",
            executable=name,
            name=name,
            output="screen",
            parameters=[{**shared, **parameters}],
            on_exit=Shutdown(reason=f"{name} has ended"),
        )
        for name, parameters in own.items()
    ]


def generate_launch_description():
    """Return the arguments and the nodes; ROS_DOMAIN_ID and discovery come from the environment."""
    arguments = [
        DeclareLaunchArgument(name, default_value=default, description=text)
        for name, (default, text) in ARGUMENTS.items()
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=start_nodes)])
