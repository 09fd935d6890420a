"""The lockstep loop around one subsystem: wait by stamp, compute, publish."""

import dataclasses
import math
import time
from collections.abc import Callable

import numpy as np
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from shipcrane_twin.config.controllers import ExternalConfig
from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.cosim.controllers import chain_of, inputs_of, own_chain_of, topics_of
from shipcrane_twin.cosim.coupling import SCHEMES
from shipcrane_twin.cosim.participant import Participant
from shipcrane_twin.cosim.subsystems import Signals, make_subsystem
from shipcrane_twin.cosim.topics import BY_NAME, JOINTS, Topic, published_by
from shipcrane_twin.ros.cdr import CdrError, Template, joint_velocities
from shipcrane_twin.ros.command_desk import CommandDesk
from shipcrane_twin.ros.diagnostics import SelfReport
from shipcrane_twin.ros.links import (
    LATCHED_QOS,
    LOOP_QOS,
    Inbox,
    LoopOwned,
    Mailroom,
    listeners_matched,
    message_class,
    refuse_rivals,
)
from shipcrane_twin.ros.parameters import declare_run_parameters
from shipcrane_twin.ros.process import leave_graph, run_node, write_result
from shipcrane_twin.ros.stop import StopFlag

SERVICE_PERIOD_S = 0.1
"""Wall time between two looks at parameters and services."""

Desk = Callable[[Node, Participant, int], object]

KINDS = ("wait", "decode", "physics", "encode", "publish")


def done_topics(scenario: Scenario) -> dict[str, Topic]:
    """Return what each participant publishes last in a step: the clock listens to it."""
    topics = topics_of(scenario)
    return {
        name: [topic for topic in published_by(name, topics) if topic.rate == "step"][-1]
        for name in chain_of(scenario)
    }


def step_listeners(scenario: Scenario, recorded: bool) -> dict[str, set[str]]:
    """Return the nodes that must hear each topic before the first message leaves."""
    expected: dict[str, set[str]] = {topic.name: {"recorder"} if recorded else set() for topic in topics_of(scenario)}
    for consumer, topics in inputs_of(scenario).items():
        for name in topics:
            expected[name].add(consumer)
    for topic in done_topics(scenario).values():
        expected[topic.name].add("clock")
    expected["/clock"].update(own_chain_of(scenario))
    return expected


class SubsystemNode:
    """One subsystem in its own process.

    Parameters
    ----------
    name : str
        Subsystem of the chain, also the node's name.
    stop : StopFlag
    desk : callable, optional
        Makes what takes an operator's orders for this subsystem, from node and participant.
    """

    def __init__(self, name: str, stop: StopFlag, desk: Desk | None = None) -> None:
        self.name = name
        self._stop = stop
        self.node = Node(name)
        run = declare_run_parameters(self.node)
        self._run_dir = run.run_dir
        scenario = load_scenario(run.scenario)
        self._step_ns, self._last = scenario.step_ns, scenario.step_count
        if name not in own_chain_of(scenario):
            raise ConfigError(f"{name}: the scenario {scenario.name} does not list it; add it to controllers")
        warm_up(name, scenario)
        self._participant = Participant(name, scenario)

        group = LoopOwned()
        self._clock = Inbox(self.node, BY_NAME["/clock"], group)
        scheme = SCHEMES[scenario.coupling]
        table = {topic.name: topic for topic in topics_of(scenario)}
        self._inputs = [
            (Inbox(self.node, topic, group), scheme.lag(name, topic.publisher) * scenario.step_ns, Template(topic))
            for topic in map(table.__getitem__, inputs_of(scenario)[name])
        ]
        self._foreign = {one.topic for one in scenario.controllers if isinstance(one, ExternalConfig)}
        obeys = hasattr(self._participant.subsystem, "commands")
        self._commands = CommandDesk(self.node, self._participant, scenario, group) if obeys else None
        self._mail = Mailroom(self.node, [self._clock, *(inbox for inbox, _, _ in self._inputs)])
        topics = [topic for topic in published_by(name, topics_of(scenario)) if topic.rate != "irregular"]
        # compiling took longer than discovery, so a run that was here before is known by now
        refuse_rivals(self.node, [topic.name for topic in topics], ours=0, wait_s=0.0)
        self._templates = {topic.name: Template(topic) for topic in topics}
        self._publishers = {
            topic.name: self.node.create_publisher(
                message_class(topic.type), topic.name, LATCHED_QOS if topic.rate == "once" else LOOP_QOS
            )
            for topic in topics
        }
        self._expected = step_listeners(scenario, run.recorded)
        if hasattr(self._participant.subsystem, "condition"):
            SelfReport(self.node, self._participant, scenario.step_ns)
        self._desk = desk(self.node, self._participant, scenario.step_ns) if desk else None
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._service_at = 0.0
        self._allowed = -1
        self._spent = dict.fromkeys(KINDS, 0)

    def run(self) -> None:
        """Step until the end of the scenario, then stay until told to stop."""
        self._stop.arm()
        self._connect()
        cpu_from = time.process_time()
        while not self._stop and self._participant.step < self._last:
            started = time.perf_counter_ns()
            step = self._participant.step + 1
            if not self._gather(step):
                break
            waited = time.perf_counter_ns()
            inputs = self._decode(step)
            decoded = time.perf_counter_ns()
            out = self._participant.advance(inputs)
            computed = time.perf_counter_ns()
            self._publish(step, out)
            self._spent["wait"] += waited - started
            self._spent["decode"] += decoded - waited
            self._spent["physics"] += computed - decoded
        self._report(time.process_time() - cpu_from)
        while not self._stop:
            self._service(0.05)

    def close(self) -> None:
        """Leave the graph."""
        leave_graph(self.node)

    def _connect(self) -> None:
        """Wait until everyone who must hear this node is connected."""
        told = time.monotonic()
        while not self._stop:
            missing = listeners_matched(self.node, self._publishers, self._expected)
            missing += [
                f"{inbox.topic.publisher} ({inbox.topic.name})"
                for inbox, _, _ in self._inputs
                if inbox.topic.name in self._foreign and not inbox.subscription.get_publisher_count()
            ]  # a node of the user's own does not wait for those that hear it
            if not missing:
                refuse_rivals(self.node, self._publishers)
                return
            if time.monotonic() - told > 5.0:
                self.node.get_logger().warn(f"waiting for {', '.join(missing)}")
                told = time.monotonic()
            self._service(0.02)

    def _service(self, timeout_s: float) -> None:
        self._executor.spin_once(timeout_sec=timeout_s)
        self._service_at = time.monotonic() + SERVICE_PERIOD_S

    def _gather(self, step: int) -> bool:
        """Wait until the clock allows a step and all its inputs are here; False when told to stop."""
        time_ns = step * self._step_ns
        wanted = [(inbox, time_ns - lag) for inbox, lag, _ in self._inputs] if step else []
        while not self._stop:
            # backwards, because what a publisher sends last comes last
            missing = next((inbox for inbox, stamp in reversed(wanted) if not inbox.has(stamp)), None)
            if missing is None and not self._is_allowed(time_ns):
                missing = self._clock
            if missing is None:
                if self._commands is not None:
                    self._commands.obey()
                return True
            self._mail.wait(SERVICE_PERIOD_S, only=missing)
            if time.monotonic() > self._service_at:
                self._service(0.0)
        return False

    def _is_allowed(self, time_ns: int) -> bool:
        """Whether the clock has announced a time."""
        while self._allowed < time_ns and self._clock.keep():
            self._allowed = max(self._allowed, *self._clock.waiting)
            self._clock.waiting.clear()
        return self._allowed >= time_ns

    def _decode(self, step: int) -> Signals:
        if step == 0:
            return {}
        time_ns = step * self._step_ns
        inputs = {}
        for inbox, lag, template in self._inputs:
            message = inbox.pop(time_ns - lag)
            if inbox.topic.name in self._foreign:
                inputs[inbox.topic.name] = self._foreign_words(inbox.topic, message)
                continue
            values = template.decode(message)
            if not math.isfinite(values.sum()):
                raise ValueError(
                    f"{inbox.topic.name} at {time_ns / 1e9:.3f} s holds {values.tolist()}, expected finite numbers"
                )
            inputs[inbox.topic.name] = values
        return inputs

    def _foreign_words(self, topic: Topic, message: bytes) -> np.ndarray:
        """Return what a user's own controller says; a wrong message counts as zero velocities, with a warning."""
        try:
            return joint_velocities(message, topic.joints)
        except CdrError as err:
            self.node.get_logger().warn(f"{topic.name} counts as zero: {err}", throttle_duration_sec=1.0)
            return np.zeros(len(topic.joints))

    def _publish(self, step: int, out: Signals) -> None:
        time_ns = step * self._step_ns
        spent = self._spent
        for name, values in out.items():
            began = time.perf_counter_ns()
            message = self._templates[name].encode(time_ns, values)
            encoded = time.perf_counter_ns()
            self._publishers[name].publish(message)
            spent["encode"] += encoded - began
            spent["publish"] += time.perf_counter_ns() - encoded

    def _report(self, cpu_s: float) -> None:
        steps = self._participant.step
        events: dict[str, float] = getattr(self._participant.subsystem, "events", dict)()
        write_result(
            self._run_dir,
            self.name,
            {
                "steps": steps,
                "digest": self._participant.digest,
                "events": events,
                "cpu_s": cpu_s,
                "us_per_step": {kind: ns / 1000 / max(steps, 1) for kind, ns in self._spent.items()},
            },
        )


def warm_up(name: str, scenario: Scenario) -> None:
    """Compile (or load from the cache) every kernel that the subsystem uses, so that no step waits for it."""
    early = dataclasses.replace(scenario, dp=dataclasses.replace(scenario.dp, enabled_at_s=0.0))
    signals = {topic.name: np.zeros(topic.width) for topic in topics_of(scenario) if topic.type == JOINTS}
    for other in own_chain_of(scenario):
        signals.update(make_subsystem(other, early).start())
    scratch = make_subsystem(name, early)
    scratch.step(1, {topic: signals[topic] for topic in inputs_of(scenario)[name]})


def run_subsystem(name: str, stop: StopFlag, desk: Desk | None = None) -> None:
    """Run a subsystem's node until it is told to stop; see `SubsystemNode`."""

    def body(stop: StopFlag) -> None:
        runner = SubsystemNode(name, stop, desk)
        try:
            runner.run()
        finally:
            runner.close()

    run_node(body, stop)
