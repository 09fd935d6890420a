"""What the clock decides, without ROS: which time to announce next, and who is silent."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from shipcrane_twin.cosim.coupling import CHAIN, INPUTS, Scheme
from shipcrane_twin.cosim.topics import BY_NAME, Topic

RECORDER_LEAD_STEPS = 200
"""How many steps the clock may be ahead of what the recorder has confirmed."""


@dataclass(slots=True)
class Lockstep:
    """Progress of all participants, in steps; -1 is nothing yet.

    Parameters
    ----------
    scheme : Scheme
    last : int
        The last step of the run.
    run_ahead : int
        How many steps the clock may lead the slowest participant: 1 is a strict barrier.
    recorded : bool
        A recorder confirms steps and must not fall behind.
    chain : tuple of str
        The participants, in order.
    inputs : mapping
        Topics that each participant waits for.
    topics : mapping
        The run's topics by name.
    """

    scheme: Scheme
    last: int
    run_ahead: int
    recorded: bool
    chain: tuple[str, ...] = CHAIN
    inputs: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: INPUTS)
    topics: Mapping[str, Topic] = field(default_factory=lambda: BY_NAME)
    announced: int = -1
    done: dict[str, int] = field(default_factory=dict)
    recorded_to: int = -1

    def __post_init__(self) -> None:
        """Begin with nobody having done anything."""
        self.done = dict.fromkeys(self.chain, -1) | self.done

    @property
    def slowest(self) -> int:
        """The step that every participant has finished."""
        return min(self.done.values())

    @property
    def last_behind(self) -> str:
        """The participant that the clock hears of last: the last in the chain of those that have done least."""
        return next(name for name in reversed(self.chain) if self.done[name] == self.slowest)

    def may_announce(self) -> int:
        """Return the highest step that may be announced now (the present one if no further)."""
        limit = min(self.last, self.slowest + self.run_ahead)
        if self.recorded:
            limit = min(limit, self.recorded_to + RECORDER_LEAD_STEPS)
        return max(self.announced, limit)

    @property
    def waits_for_recorder(self) -> bool:
        """Whether the recorder alone keeps the clock from going on, or from ending."""
        return self.recorded and self.announced >= min(self.last, self.recorded_to + RECORDER_LEAD_STEPS)

    @property
    def finished(self) -> bool:
        """Whether all steps are done, and recorded where they are."""
        return self.slowest >= self.last and (not self.recorded or self.recorded_to >= self.last)

    def silent(self) -> list[str]:
        """Return who holds the run up: those that have all they need for their next step."""
        names = [
            name for name in self.chain if self.done[name] < self.announced and self.can_step(name, self.done[name] + 1)
        ]
        if not names and self.recorded and self.recorded_to < self.slowest:
            return ["recorder"]
        return names

    def can_step(self, name: str, step: int) -> bool:
        """Whether every input that a participant needs for a step has been published."""
        publishers = {self.topics[topic].publisher for topic in self.inputs[name]} if step else set()
        return all(self.done[other] >= step - self.scheme.lag(name, other) for other in publishers)


@dataclass(slots=True)
class Pace:
    """Ties simulated to wall time: speed, pause and single steps.

    Parameters
    ----------
    step_s : float
        Macro step [s].
    speed : float
        Times real time; 0 is as fast as it goes.
    """

    step_s: float
    speed: float
    paused: bool = False
    single_steps: int = 0
    _from_step: int = -1
    _from_wall: float = 0.0

    def restart(self, step: int, wall_s: float) -> None:
        """Count from here: at the start, and after every change of speed or pause."""
        self._from_step, self._from_wall = step, wall_s

    def due(self, step: int, allowed: int, wall_s: float) -> int:
        """Return the step up to which the clock should announce now, between ``step`` and ``allowed``."""
        if self.paused:
            ready = min(allowed, step + self.single_steps)
            self.single_steps -= ready - step
            self.restart(ready, wall_s)
            return ready
        if self.speed <= 0.0:
            return allowed
        by_wall = self._from_step + int((wall_s - self._from_wall) * self.speed / self.step_s)
        return max(step, min(allowed, by_wall))

    def wait_s(self, step: int, wall_s: float, longest_s: float) -> float:
        """Return how long to wait for messages before the next announcement is due."""
        if self.paused or self.speed <= 0.0:
            return longest_s
        due_at = self._from_wall + (step + 1 - self._from_step) * self.step_s / self.speed
        return min(longest_s, max(0.0, due_at - wall_s))


def progress_of(stamps: Mapping[int, object], step_ns: int) -> int:
    """Return the latest step among stamps [ns]; stamps off the grid are somebody else's and do not count."""
    return max((stamp // step_ns for stamp in stamps if stamp % step_ns == 0), default=-1)
