"""Parameters that the nodes of a run share."""

from dataclasses import dataclass
from typing import TypeVar

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

from shipcrane_twin.config.settings import ConfigError


@dataclass(frozen=True, slots=True)
class RunParameters:
    """What a node is told at its start."""

    scenario: str
    run_dir: str
    recorded: bool


def declare_run_parameters(node: Node) -> RunParameters:
    """Declare and read ``scenario``, ``run_dir`` and ``recorded``.

    Raises
    ------
    ConfigError
        If no scenario was given.
    """
    scenario = declare(node, "scenario", "", "Name from config/scenarios or path to a YAML file")
    if not scenario:
        raise ConfigError(
            f"{node.get_name()}: the parameter scenario is not set; give it with --ros-args -p scenario:=case2"
        )
    return RunParameters(
        scenario=scenario,
        run_dir=declare(node, "run_dir", "", "Folder for the node's result; empty for none"),
        recorded=declare(node, "recorded", False, "Wait for the recorder before the first message"),
    )


T = TypeVar("T", str, bool, int, float)


def declare(node: Node, name: str, default: T, about: str, *, live: bool = False) -> T:
    """Declare a parameter with its description and return its value; only ``live`` ones can be set later."""
    descriptor = ParameterDescriptor(description=about, read_only=not live)
    value: T = node.declare_parameter(name, default, descriptor).value
    return value
