"""Publishers and subscriptions of the loop: serialized messages, taken by the loop itself, picked by stamp."""

import importlib
import time
from collections.abc import Iterable
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.cosim.topics import Topic
from shipcrane_twin.ros.cdr import CdrError, read_stamp

LOOP_DEPTH = 400
"""Messages kept per topic: more than the clock ever lets anyone run ahead of the slowest listener."""

NO_STAMP = -1
"""Key of a message without a readable stamp: nobody ever waits for it."""

DISCOVERY_S = 0.1
"""Wall time in which the nodes of another run in the same domain make themselves known."""

LOOP_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=LOOP_DEPTH,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)

LATCHED_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
"""Of what is published once: who comes late hears it still."""


def message_class(type_name: str) -> type[Any]:
    """Return the Python class of ``package/msg/Name``."""
    package, _, name = type_name.split("/")
    found: type[Any] = getattr(importlib.import_module(f"{package}.msg"), name)
    return found


class LoopOwned(CallbackGroup):
    """Keeps the executor away from subscriptions that the loop takes by itself."""

    def can_execute(self, entity: Any) -> bool:
        """Never."""
        return False

    def beginning_execution(self, entity: Any) -> bool:
        """Never."""
        return False

    def ending_execution(self, entity: Any) -> None:
        """Nothing was begun."""


class Inbox:
    """Serialized messages of one topic, by stamp."""

    def __init__(self, node: Node, topic: Topic, group: LoopOwned) -> None:
        self.topic = topic
        self.kind = message_class(topic.type)
        self.subscription = node.create_subscription(
            self.kind, topic.name, _unused, LOOP_QOS, callback_group=group, raw=True
        )
        self.handle = self.subscription.handle
        self.waiting: dict[int, bytes] = {}

    def take(self) -> bytes | None:
        """Take one message that has arrived; None if there is none."""
        found = self.handle.take_message(self.kind, True)
        return None if found is None else found[0]

    def keep(self) -> bool:
        """Take one message and keep it under its stamp; False if none has arrived."""
        message = self.take()
        if message is None:
            return False
        try:
            stamp = read_stamp(message)
        except CdrError:
            stamp = NO_STAMP
        self.waiting[stamp] = message
        return True

    def has(self, time_ns: int) -> bool:
        """Whether the message of a time is here, looking at what has arrived if need be."""
        while time_ns not in self.waiting:
            if not self.keep():
                return False
        return True

    def pop(self, time_ns: int) -> bytes:
        """Return the message of a time and forget it and all before it."""
        message = self.waiting.pop(time_ns)
        if self.waiting and len(self.waiting) > LOOP_DEPTH:
            for stamp in [stamp for stamp in self.waiting if stamp < time_ns]:
                del self.waiting[stamp]
        return message


def _unused(message: bytes) -> None:
    """Stand where rclpy wants a callback; the loop takes messages by itself."""


class Mailroom:
    """Waits for messages of one or several inboxes with wait sets that are built once.

    Parameters
    ----------
    node : Node
    inboxes : iterable of Inbox
    """

    def __init__(self, node: Node, inboxes: Iterable[Inbox]) -> None:
        self.inboxes = list(inboxes)
        context = node.context.handle
        assert context is not None  # rclpy has been started
        with context:
            self._wait_set = rcl.WaitSet(len(self.inboxes), 0, 0, 0, 0, 0, context)

    def wait(self, timeout_s: float, only: Inbox | None = None) -> None:
        """Wait until a message is there to be taken, from any inbox or from only one of them.

        A wake-up costs more than all else in the loop, so wait for the message that comes last and take
        the others without waiting.
        """
        wait_set = self._wait_set
        wait_set.clear_entities()
        for inbox in self.inboxes if only is None else (only,):
            wait_set.add_subscription(inbox.handle)
        wait_set.wait(int(timeout_s * 1e9))


def listeners_matched(node: Node, publishers: dict[str, Any], expected: dict[str, set[str]]) -> list[str]:
    """Return the expected listeners that are not connected yet, as ``node (topic)``.

    Parameters
    ----------
    node : Node
    publishers : dict
        Publisher by topic.
    expected : dict
        Names of the nodes that must hear a topic.
    """
    missing = []
    for topic, publisher in publishers.items():
        wanted = expected.get(topic, set())
        if not wanted:
            continue
        present = [info.node_name for info in node.get_subscriptions_info_by_topic(publisher.topic_name)]
        missing += [f"{name} ({topic})" for name in sorted(wanted - set(present))]
        if not missing and publisher.get_subscription_count() < len(present):
            missing.append(f"a listener that was seen but is not connected yet ({topic})")
    return missing


def refuse_rivals(node: Node, topics: Iterable[str], ours: int = 1, wait_s: float = DISCOVERY_S) -> None:
    """Make sure that nobody else publishes a node's topics: two runs in one domain would spoil each other.

    Parameters
    ----------
    node : Node
    topics : iterable of str
    ours : int
        How many publishers of each topic are this run's.
    wait_s : float
        Wall time to leave others to make themselves known.

    Raises
    ------
    ConfigError
        Naming topic, domain and remedy.
    """
    time.sleep(wait_s)
    for topic in topics:
        if node.count_publishers(topic) > ours:
            domain = node.context.get_domain_id()
            raise ConfigError(
                f"{node.get_name()}: {topic} has a publisher of another run in ROS domain {domain}: wait for its end, "
                "or set another ROS_DOMAIN_ID for this one"
            )
