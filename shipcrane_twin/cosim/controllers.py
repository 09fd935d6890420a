"""Controllers in the lockstep: where they stand in the chain, what they hear and say, and how joints obey them.

They come behind the payload: a controller sees the whole of step k and says at t_k how fast joints shall move
in step k + 1, as a sampled controller does. Crane and winch await its word by stamp. A user's own node
(kind ``external``) joins in the same way.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from shipcrane_twin.config.controllers import ControllerConfig, ExternalConfig, joints_of, replaces
from shipcrane_twin.config.lifting import on_ship
from shipcrane_twin.config.scenario import WINCH, Scenario
from shipcrane_twin.config.settings import ConfigError
from shipcrane_twin.cosim.coupling import CHAIN, INPUTS
from shipcrane_twin.cosim.topics import BY_NAME, JOINTS, TOPICS, Topic
from shipcrane_twin.physics.arrays import Array

CONTROLLER_TOPICS = {
    "heave_compensation": Topic(
        name="/heave_compensation/joint_command",
        type=JOINTS,
        publisher="heave_compensation",
        frame="crane_tip",
        joints=("winch",),
        fields=("velocity",),
        about="Pay-out speed to add to the operator's in the step that follows [m/s].",
    ),
    "anti_sway": Topic(
        name="/anti_sway/joint_command",
        type=JOINTS,
        publisher="anti_sway",
        frame="crane_base",
        joints=("slew", "boom"),
        fields=("velocity",),
        about="Joint velocities in place of the operator's in the step that follows [rad/s].",
    ),
}
"""Of the controllers that a scenario may list: there in a run only when it does."""

CONTROLLER_INPUTS = {
    "heave_compensation": ("/vessel/odom", "/vessel/accel", "/crane/tip"),
    "anti_sway": ("/vessel/odom", "/crane/tip", "/payload/odom"),
}
"""The topics that they wait for in every step."""


def chain_of(scenario: Scenario) -> tuple[str, ...]:
    """Return the participants of a run in the order in which a step runs through them."""
    return (*CHAIN, *(controller.name for controller in scenario.controllers))


def own_chain_of(scenario: Scenario) -> tuple[str, ...]:
    """Return the participants that the run itself steps or starts: all but the user's own."""
    return (*CHAIN, *(one.name for one in scenario.controllers if not isinstance(one, ExternalConfig)))


def inputs_of(scenario: Scenario) -> dict[str, tuple[str, ...]]:
    """Return the topics that each participant of a run waits for in every step."""
    inputs = dict(INPUTS)
    if on_ship(scenario.payload):
        inputs["payload"] += ("/vessel/odom",)
    for part, joints in (("crane", scenario.joint_names), ("payload", (WINCH,))):
        inputs[part] += tuple(controller_topic(one).name for one in heard(scenario, joints))
    for one in scenario.controllers:
        inputs[one.name] = one.inputs if isinstance(one, ExternalConfig) else CONTROLLER_INPUTS[one.kind]
    return inputs


def topics_of(scenario: Scenario) -> tuple[Topic, ...]:
    """Return the topics of a run: the table, with the joints of the run's crane, and those of its controllers."""
    crane = scenario.joint_names
    cylinders = [f"{link.joint}_cylinder" for link in scenario.crane.links if link.drive.kind == "triangle"]
    joints = {
        "/crane/joint_states": (*crane, *cylinders),
        "/crane/joint_command_applied": crane,
        "/crane/joint_command": (*crane, WINCH),
    }
    table = (replace(topic, joints=joints.get(topic.name, topic.joints)) for topic in TOPICS)
    return (*table, *(controller_topic(one) for one in scenario.controllers))


def tip_holders(scenario: Scenario) -> list[str]:
    """Return the controllers that command joints of the crane in the operator's place: they take no tip commands."""
    return [one.name for one in heard(scenario, scenario.joint_names) if replaces(one)]


def controller_topic(controller: ControllerConfig) -> Topic:
    """Return the topic on which a controller says its joint velocities."""
    if not isinstance(controller, ExternalConfig):
        return CONTROLLER_TOPICS[controller.kind]
    return Topic(
        name=controller.topic,
        type=JOINTS,
        publisher=controller.name,
        joints=controller.joints,
        fields=("velocity",),
        about="Joint velocities wanted by a controller of the user's own [rad/s, m/s].",
    )


def heard(scenario: Scenario, joints: Sequence[str]) -> list[ControllerConfig]:
    """Return the controllers that command some of the joints, as listed."""
    return [one for one in scenario.controllers if set(joints_of(one)) & set(joints)]


def check_controllers(scenario: Scenario) -> None:
    """Raise ConfigError if a controller of the user's own has a name, topic or input that cannot be."""
    nodes = {"clock", "recorder", *CHAIN, *CONTROLLER_TOPICS}
    taken = {*BY_NAME, *(topic.name for topic in CONTROLLER_TOPICS.values())}
    inputs = [topic.name for topic in TOPICS if topic.rate == "step" and topic.publisher in CHAIN]
    for i, one in enumerate(scenario.controllers):
        if not isinstance(one, ExternalConfig):
            continue
        here = f"{scenario.name}: controllers[{i}]"
        if one.name in nodes:
            raise ConfigError(f"{here}.name is {one.name!r}, a node of the twin; give your node another name")
        if one.topic in taken or not one.topic.startswith("/"):
            raise ConfigError(
                f"{here}.topic is {one.topic!r}, expected an absolute name that is not taken, such as "
                f"/{one.name}/joint_command"
            )
        taken.add(one.topic)
        for name in one.inputs:
            if name not in inputs:
                raise ConfigError(f"{here}.inputs has {name!r}, expected topics of every step: {', '.join(inputs)}")


class ControllerCommands:
    """What the controllers make of the operator's velocities, joint by joint, in the order of the list.

    Parameters
    ----------
    scenario : Scenario
    joints : sequence of str
        The joints served, in the order of the command array.
    """

    def __init__(self, scenario: Scenario, joints: Sequence[str]) -> None:
        places = {joint: i for i, joint in enumerate(joints)}
        self._moves: list[tuple[str, bool, list[int], list[int]]] = []
        for one in heard(scenario, joints):
            said = [(places[joint], i) for i, joint in enumerate(joints_of(one)) if joint in places]
            own, theirs = [a for a, _ in said], [b for _, b in said]
            self._moves.append((controller_topic(one).name, replaces(one), own, theirs))

    def over(self, command: Array, inputs: Mapping[str, Array], least: float = -math.inf) -> Array:
        """Return the velocities [rad/s, m/s] to follow: the operator's, replaced or added to.

        ``least`` bounds what a controller asks for in the operator's place, not what it adds.
        """
        out = command.copy()
        for topic, instead, own, theirs in self._moves:
            said = inputs[topic][theirs]
            out[own] = np.maximum(said, least) if instead else out[own] + said
        return out
