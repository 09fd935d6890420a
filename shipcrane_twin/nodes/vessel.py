"""The vessel node: ``ros2 run shipcrane_twin vessel --ros-args -p scenario:=case2``."""

from shipcrane_twin.nodes import STOP
from shipcrane_twin.ros.subsystem_node import run_subsystem
from shipcrane_twin.ros.vessel_desk import VesselDesk


def main() -> None:
    """Run the node until it is told to stop."""
    run_subsystem("vessel", STOP, VesselDesk)


if __name__ == "__main__":
    main()
