"""What every node process does: start rclpy, read parameters, stop on signals, leave nothing behind."""

import json
import os
import signal
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from shipcrane_twin.config.settings import ConfigError

EXIT_BAD_INPUT = 2
EXIT_FAILED = 3


def prepare_environment() -> None:
    """Set what rclpy reads when it is started; what the user set stays.

    Nodes of one machine talk over loopback UDP: as fast as shared memory here, and nothing stays
    behind in /dev/shm when a process is killed.
    """
    os.environ.setdefault("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")


class StopFlag:
    """Becomes true on SIGINT or SIGTERM."""

    def __init__(self) -> None:
        self.raised = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._raise)

    def _raise(self, number: int, frame: FrameType | None) -> None:
        self.raised = True

    def __bool__(self) -> bool:
        return self.raised


def run_node(body: Callable[[StopFlag], None]) -> NoReturn:
    """Run a node's body on a started rclpy and end the process; bad input gives one message and exit code 2.

    Parameters
    ----------
    body : callable
        Gets the stop flag and returns when it is raised or the work is done; its endpoints are gone then.

    Notes
    -----
    The process ends without taking rclpy apart: Fast DDS can wait for itself forever when a participant is
    deleted while another one leaves, as at the end of every run. Nothing is lost: endpoints have been
    removed one by one, and UDP leaves no files.
    """
    prepare_environment()
    stop = StopFlag()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    code = 0
    try:
        body(stop)
    except ConfigError as err:
        print(f"error: {err}", file=sys.stderr)
        code = EXIT_BAD_INPUT
    except Exception:
        traceback.print_exc()
        code = EXIT_FAILED
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def leave_graph(node: Node) -> None:
    """Remove a node's endpoints, so that its peers stop sending to it."""
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
    folder = Path(run_dir) / "nodes"
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / f".{name}.part"
    part.write_text(json.dumps(result), encoding="utf-8")
    part.replace(folder / f"{name}.json")
