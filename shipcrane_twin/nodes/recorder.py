"""The recorder node: ``ros2 run shipcrane_twin recorder --ros-args -p scenario:=case2 -p run_dir:=FOLDER``."""

from shipcrane_twin.nodes import STOP
from shipcrane_twin.ros.process import run_node
from shipcrane_twin.ros.recorder_node import RecorderNode
from shipcrane_twin.ros.stop import StopFlag


def body(stop: StopFlag) -> None:
    """Record until told to stop; the bag is complete whatever ends it."""
    recorder = RecorderNode(stop)
    try:
        recorder.run()
    finally:
        recorder.close()


def main() -> None:
    """Run the node."""
    run_node(body, STOP)


if __name__ == "__main__":
    main()
