"""The payload node: ``ros2 run shipcrane_twin payload --ros-args -p scenario:=case2``."""

from shipcrane_twin.nodes import STOP
from shipcrane_twin.ros.subsystem_node import run_subsystem


def main() -> None:
    """Run the node until it is told to stop."""
    run_subsystem("payload", STOP)


if __name__ == "__main__":
    main()
