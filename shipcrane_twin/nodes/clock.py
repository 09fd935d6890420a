"""The clock node: ``ros2 run shipcrane_twin clock --ros-args -p scenario:=case2``."""

from shipcrane_twin.ros.clock_node import ClockNode
from shipcrane_twin.ros.process import StopFlag, run_node


def body(stop: StopFlag) -> None:
    """Announce time until the scenario's end or until told to stop."""
    clock = ClockNode(stop)
    try:
        clock.run()
    finally:
        clock.close()


def main() -> None:
    """Run the node."""
    run_node(body)


if __name__ == "__main__":
    main()
