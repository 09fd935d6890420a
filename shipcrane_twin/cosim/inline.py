"""The whole twin in one process, without ROS: the same subsystems, the same scheme, the same bits."""

from collections.abc import Callable, Collection, Iterator, Mapping

from shipcrane_twin.config.controllers import ExternalConfig
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.cosim.controllers import chain_of, controller_topic, inputs_of, own_chain_of
from shipcrane_twin.cosim.participant import Participant, state_digest
from shipcrane_twin.cosim.subsystems import Subsystem
from shipcrane_twin.physics.arrays import Array

Sink = Callable[[int, str, Array], None]
"""Takes (time in ns, topic, values) of every output."""

External = Callable[[int, Mapping[str, Array]], Array]
"""Stands for a controller of the user's own: (time in ns, its inputs at that time) to joint velocities."""


class InlineRun:
    """The chain of subsystems in this process.

    Parameters
    ----------
    scenario : Scenario
    sink : callable, optional
        Gets every output, in the order in which it comes.
    externals : mapping, optional
        What stands for the controllers of kind ``external``, by name.

    Raises
    ------
    ConfigError
        If the scenario lists an external controller for which nothing stands here.
    """

    def __init__(
        self, scenario: Scenario, sink: Sink | None = None, externals: Mapping[str, External] | None = None
    ) -> None:
        self._participants = [Participant(name, scenario) for name in own_chain_of(scenario)]
        self._inputs = inputs_of(scenario)
        check_stand_ins(scenario, externals or {})
        self._externals = [
            (one.name, controller_topic(one).name, externals[one.name])
            for one in scenario.controllers
            if externals and isinstance(one, ExternalConfig)
        ]
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
                out = participant.advance(self._inputs_now(participant.name) if k else {})
                self._publish(k, out)
            for name, topic, say in self._externals:
                self._publish(k, {topic: say(k * self._step_ns, self._inputs_now(name))})
            yield k

    def _inputs_now(self, name: str) -> dict[str, Array]:
        return {topic: self._latest[topic] for topic in self._inputs[name]}

    def _publish(self, k: int, out: Mapping[str, Array]) -> None:
        self._latest.update(out)
        if self._sink is not None:
            for name, values in out.items():
                self._sink(k * self._step_ns, name, values)

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


def check_stand_ins(scenario: Scenario, present: Collection[str] = ()) -> None:
    """Raise ConfigError if the scenario lists an external controller for which nothing stands in an inline run."""
    missing = [name for name in chain_of(scenario) if name not in (*own_chain_of(scenario), *present)]
    if missing:
        raise ConfigError(
            f"{scenario.name}: the controller {missing[0]} is a node of its own; run the scenario as a graph beside it "
            "(--mode graph), or take it out of controllers"
        )
