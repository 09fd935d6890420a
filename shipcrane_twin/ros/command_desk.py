"""Where crane, winch and anti-sway take an operator's commands: of joints, and of the crane's tip."""

from rclpy.node import Node

from shipcrane_twin.config.scenario import WINCH, Scenario
from shipcrane_twin.cosim.participant import Participant
from shipcrane_twin.cosim.topics import BY_NAME, TWIST
from shipcrane_twin.ros.cdr import CdrError, read_joint_command, read_stamped
from shipcrane_twin.ros.links import Inbox, LoopOwned

JOINT_COMMAND, TIP_COMMAND = "/crane/joint_command", "/crane/tip_command"


class CommandDesk:
    """Takes commands between steps and hands them on; a wrong one is refused with a warning.

    Parameters
    ----------
    node : Node
    participant : Participant
        Its subsystem has ``commands``; one that moves the tip has ``say_tip`` besides.
    scenario : Scenario
    group : LoopOwned
        Of the loop's subscriptions.
    """

    def __init__(self, node: Node, participant: Participant, scenario: Scenario, group: LoopOwned) -> None:
        self._node, self._subsystem = node, participant.subsystem
        self._known = (*scenario.joint_names, WINCH)
        self._joints = Inbox(node, BY_NAME[JOINT_COMMAND], group)
        moves_tip = hasattr(self._subsystem, "say_tip")
        self._tip = Inbox(node, BY_NAME[TIP_COMMAND], group) if moves_tip else None

    def obey(self) -> None:
        """Take all that has arrived."""
        while (message := self._joints.take()) is not None:
            self._tell(JOINT_COMMAND, self._say(message))
        while self._tip is not None and (message := self._tip.take()) is not None:
            self._tell(TIP_COMMAND, self._say_tip(message))

    def _say(self, message: bytes) -> str | None:
        """Take a command of joints; return why it was refused, or None."""
        try:
            names, velocities, positions = read_joint_command(message)
        except CdrError as err:
            return str(err)
        unknown = sorted(set(names) - set(self._known))
        if unknown:
            return f"joint {unknown[0]!r} is unknown, expected some of {', '.join(self._known)}"
        refusal: str | None = self._subsystem.commands.say(names, velocities, positions)  # type: ignore[attr-defined]
        return refusal

    def _say_tip(self, message: bytes) -> str | None:
        """Take a command of the tip; return why it was refused, or None."""
        try:
            frame, numbers = read_stamped(message, TWIST)
        except CdrError as err:
            return str(err)
        refusal: str | None = self._subsystem.say_tip(frame, numbers[:3])  # type: ignore[attr-defined]
        return refusal

    def _tell(self, topic: str, refusal: str | None) -> None:
        if refusal:
            self._node.get_logger().warn(f"{topic} refused: {refusal}", throttle_duration_sec=1.0)
