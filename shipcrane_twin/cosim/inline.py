"""The whole twin in one process, without ROS: the same subsystems, the same scheme, the same bits."""

from collections.abc import Callable, Iterator

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim.coupling import CHAIN, INPUTS
from shipcrane_twin.cosim.participant import Participant, state_digest
from shipcrane_twin.cosim.subsystems import Subsystem
from shipcrane_twin.physics.arrays import Array

Sink = Callable[[int, str, Array], None]
"""Takes (time in ns, topic, values) of every output."""


class InlineRun:
    """The chain of subsystems in this process.

    Parameters
    ----------
    scenario : Scenario
    sink : callable, optional
        Gets every output, in the order in which it comes.
    """

    def __init__(self, scenario: Scenario, sink: Sink | None = None) -> None:
        self._participants = [Participant(name, scenario) for name in CHAIN]
        self._step_ns = scenario.step_ns
        self._last = scenario.step_count
        self._sink = sink
        self._latest: dict[str, Array] = {}

    def steps(self) -> Iterator[int]:
        """Run from t = 0 to the end, yielding the number of each finished step.

        Going through the chain in order, the latest value of a neighbour before is that of this step
        and of one behind that of the step before: just what the schemes ask for.
        """
        for k in range(self._last + 1):
            for participant in self._participants:
                inputs = {name: self._latest[name] for name in INPUTS[participant.name]} if k else {}
                out = participant.advance(inputs)
                self._latest.update(out)
                if self._sink is not None:
                    for name, values in out.items():
                        self._sink(k * self._step_ns, name, values)
            yield k

    @property
    def latest(self) -> dict[str, Array]:
        """The latest value of every topic."""
        return self._latest

    def subsystem(self, name: str) -> Subsystem:
        """Return a subsystem of the chain, to look into."""
        return next(p.subsystem for p in self._participants if p.name == name)

    @property
    def digest(self) -> str:
        """The run's state digest so far."""
        return state_digest({p.name: p.digest for p in self._participants})
