"""Puts the messages of a run in order: step by step, in table order, whatever order they came in."""

from collections.abc import Callable, Iterable

from shipcrane_twin.cosim.topics import Topic

Write = Callable[[str, int, bytes], None]


class StepCollector:
    """Holds messages back until their step is complete, then writes the step.

    So equal runs give equal bags, and a missing message is known at once.

    Parameters
    ----------
    topics : iterable of Topic
        All topics; those of rate ``irregular`` are written as they come.
    step_ns : int
        Macro step.
    telemetry_every : int
        Macro steps between two telemetry messages.
    write : callable
        Takes topic, time [ns], message.
    """

    def __init__(self, topics: Iterable[Topic], step_ns: int, telemetry_every: int, write: Write) -> None:
        topics = list(topics)
        self._step_topics = [t.name for t in topics if t.rate == "step"]
        self._all_topics = [t.name for t in topics if t.rate in ("step", "telemetry")]
        self._first_topics = [t.name for t in topics if t.rate != "irregular"]
        self._regular = set(self._first_topics)
        self._step_ns = step_ns
        self._telemetry_every = telemetry_every
        self._write = write
        self._pending: dict[int, dict[str, bytes]] = {}
        self.complete = -1

    def wanted(self, step: int) -> list[str]:
        """Return the topics of a step in the order in which they are written."""
        if step == 0:
            return self._first_topics
        return self._step_topics if step % self._telemetry_every else self._all_topics

    def add(self, topic: str, time_ns: int, message: bytes) -> None:
        """Take one message; writes every step that is complete with it."""
        step, off_grid = divmod(time_ns, self._step_ns)
        if topic not in self._regular or off_grid:
            self._write(topic, time_ns, message)
            return
        if step <= self.complete:
            return  # the step has its message of this topic: a second one is that of another run in the domain
        self._pending.setdefault(step, {})[topic] = message
        following = self.complete + 1
        while len(self._pending.get(following, ())) >= len(self.wanted(following)):
            self._flush(following)
            self.complete = following
            following += 1

    def flush(self) -> None:
        """Write what is left of incomplete steps, at the end of a run that broke off."""
        for step in sorted(self._pending):
            self._flush(step)

    def _flush(self, step: int) -> None:
        held = self._pending.pop(step)
        for name in self._first_topics:
            if name in held:
                self._write(name, step * self._step_ns, held[name])
