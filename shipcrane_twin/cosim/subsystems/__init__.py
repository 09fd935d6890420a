"""The parts of the twin, each with its own state, stepped by the inline runner or by a node."""

from collections.abc import Callable

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.cosim.subsystems.anti_sway import AntiSway
from shipcrane_twin.cosim.subsystems.base import Signals, Subsystem
from shipcrane_twin.cosim.subsystems.crane import Crane
from shipcrane_twin.cosim.subsystems.environment import Environment
from shipcrane_twin.cosim.subsystems.heave_compensation import HeaveCompensation
from shipcrane_twin.cosim.subsystems.payload import Payload
from shipcrane_twin.cosim.subsystems.vessel import Vessel

__all__ = ["Signals", "Subsystem", "make_subsystem"]


def make_subsystem(name: str, scenario: Scenario) -> Subsystem:
    """Return a subsystem of the chain by name, at its initial state."""
    makers: dict[str, Callable[[Scenario], Subsystem]] = {
        "environment": Environment,
        "vessel": Vessel,
        "crane": Crane,
        "payload": Payload,
        "heave_compensation": HeaveCompensation,
        "anti_sway": AntiSway,
    }
    return makers[name](scenario)
