"""The heave-compensation node: ``ros2 run shipcrane_twin heave_compensation --ros-args -p scenario:=NAME``."""

from shipcrane_twin.nodes import STOP
from shipcrane_twin.ros.subsystem_node import run_subsystem


def main() -> None:
    """Run the node until it is told to stop."""
    run_subsystem("heave_compensation", STOP)


if __name__ == "__main__":
    main()
