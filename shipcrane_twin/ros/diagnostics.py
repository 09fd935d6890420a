"""What a node says about itself, for people and consoles: one status per wall-clock second on ``/diagnostics``."""

from collections.abc import Mapping

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from shipcrane_twin.cosim.participant import Participant
from shipcrane_twin.cosim.time import stamp_parts

PERIOD_S = 1.0


class SelfReport:
    """Publishes a subsystem's warnings and condition.

    Parameters
    ----------
    node : Node
    participant : Participant
        Its subsystem has ``warnings()``, a list of str, and ``condition()``, values by name with their unit.
    step_ns : int
    """

    def __init__(self, node: Node, participant: Participant, step_ns: int) -> None:
        self._participant, self._step_ns = participant, step_ns
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        node.create_timer(PERIOD_S, self._report)

    def _report(self) -> None:
        subsystem = self._participant.subsystem
        warnings: list[str] = subsystem.warnings()  # type: ignore[attr-defined]
        status = DiagnosticStatus(
            level=DiagnosticStatus.WARN if warnings else DiagnosticStatus.OK,
            name=f"{self._participant.name}: condition",
            message="; ".join(warnings) or "in order",
            values=pairs(subsystem.condition()),  # type: ignore[attr-defined]
        )
        self._publisher.publish(stamped(status, max(self._participant.step, 0) * self._step_ns))


def stamped(status: DiagnosticStatus, time_ns: int) -> DiagnosticArray:
    """Return one status with its simulated time."""
    message = DiagnosticArray(status=[status])
    message.header.stamp.sec, message.header.stamp.nanosec = stamp_parts(time_ns)
    return message


def pairs(values: Mapping[str, object]) -> list[KeyValue]:
    """Return values as a diagnostic status carries them."""
    return [KeyValue(key=key, value=str(value)) for key, value in values.items()]
