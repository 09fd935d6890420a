"""What every node process does: start rclpy, read parameters, stop on signals, leave nothing behind."""

import json
import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from shipcrane_twin.config.places import config_dir
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.ros.shared_memory import remove_own
from shipcrane_twin.ros.stop import StopFlag

EXIT_BAD_INPUT = 2
EXIT_FAILED = 3

_LEFT: list[Node] = []
"""Nodes that have left: the participant would be deleted with its last node, which `run_node` must not let happen."""


def run_node(body: Callable[[StopFlag], None], stop: StopFlag) -> NoReturn:
    """Run a node's body on a started rclpy and end the process; bad input gives one message and exit code 2.

    Parameters
    ----------
    body : callable
        Gets the stop flag, arms it when it has something to finish, and returns when it is raised or the
        work is done; its endpoints are gone then.
    stop : StopFlag

    Notes
    -----
    The process ends without taking rclpy apart: Fast DDS can wait for itself forever when a participant is
    deleted while another one leaves, as at the end of every run. Nothing is lost: endpoints have been
    removed one by one, and the files in shared memory are removed here.
    """
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ.setdefault("FASTRTPS_DEFAULT_PROFILES_FILE", str(config_dir() / "fastdds.xml"))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    code = 0
    try:
        body(stop)
    except ConfigError as err:
        sys.stderr.write(f"error: {err}\n")
        code = EXIT_BAD_INPUT
    except Exception:  # noqa: BLE001 - a process ends here, whatever went wrong
        traceback.print_exc()
        code = EXIT_FAILED
    sys.stdout.flush()
    sys.stderr.flush()
    remove_own()
    os._exit(code)


def leave_graph(node: Node) -> None:
    """Remove a node's endpoints, so that its peers stop sending to it; the node itself stays to the process's end."""
    _LEFT.append(node)
    for publisher in list(node.publishers):
        node.destroy_publisher(publisher)
    for subscription in list(node.subscriptions):
        node.destroy_subscription(subscription)
    for service in list(node.services):
        node.destroy_service(service)


def write_result(run_dir: str, name: str, result: dict[str, Any]) -> None:
    """Write a node's result as ``nodes/NAME.json`` of the run folder, whole or not at all."""
    if not run_dir:
        return
    write_json(Path(run_dir) / "nodes" / f"{name}.json", result)


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write a JSON file so that a reader finds the old or the new one, never a part."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.part")
    part.write_text(json.dumps(content), encoding="utf-8")
    part.replace(path)
