"""The clock node: ``ros2 run shipcrane_twin clock --ros-args -p scenario:=case2``."""

from shipcrane_twin.nodes import STOP
from shipcrane_twin.ros.clock_node import ClockNode
from shipcrane_twin.ros.process import run_node
from shipcrane_twin.ros.stop import StopFlag


def body(stop: StopFlag) -> None:
    """Announce time until the scenario's end or until told to stop."""
    clock = ClockNode(stop)
    try:
        clock.run()
    finally:
        clock.close()


def main() -> None:
    """Run the node."""
    run_node(body, STOP)


if __name__ == "__main__":
    main()
