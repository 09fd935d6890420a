"""Whether a scenario that reads well can also be built: names of schemes, geometry, equilibrium."""

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import ConfigError, nearest
from shipcrane_twin.cosim.build import crane_chain, crane_drives
from shipcrane_twin.cosim.coupling import SCHEMES
from shipcrane_twin.cosim.initial import at_rest
from shipcrane_twin.physics.crane_cylinders import joints_from_lengths


def check_buildable(scenario: Scenario) -> None:
    """Raise ConfigError if the physics refuses the scenario's numbers.

    Parameters
    ----------
    scenario : Scenario
        Already right in types, ranges and across its parts.
    """
    if scenario.coupling not in SCHEMES:
        raise ConfigError(
            f"{scenario.name}: coupling is {scenario.coupling!r}; {nearest(scenario.coupling, list(SCHEMES))}"
        )
    try:
        crane_chain(scenario.crane)
        drives = crane_drives(scenario.crane)
        at_rest(scenario)
    except ValueError as err:
        raise ConfigError(f"{scenario.name}: {err}") from None
    lows = joints_from_lengths(drives, drives.length_min)
    highs = joints_from_lengths(drives, drives.length_max)
    for link, value, low, high in zip(
        scenario.crane.links, scenario.crane.initial_joints, lows, highs, strict=True
    ):
        if not min(low, high) <= value <= max(low, high):
            raise ConfigError(
                f"{scenario.name}: crane.initial_joints has {value:g} for {link.joint}, "
                f"expected {min(low, high):.4f} to {max(low, high):.4f}, where its cylinder ends"
            )
