"""The cranes of the package as the kernels see them, for experiments away from a ship."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from shipcrane_twin.config.crane import CraneConfig
from shipcrane_twin.config.load import load_scenario, read_yaml
from shipcrane_twin.config.places import config_dir
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import read_settings
from shipcrane_twin.control.load_limiter import radius_and_slopes, safe_working_load
from shipcrane_twin.cosim import build
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_actuators import ActuatorParams, standing_state
from shipcrane_twin.physics.crane_chain import ChainParams
from shipcrane_twin.physics.crane_dynamics import bias_forces
from shipcrane_twin.physics.crane_reference import MotionLimits

CRANES = {"Palfinger": "cranes/palfinger.yaml", "subsea": "cranes/subsea_knuckle.yaml"}
GRAVITY = 9.80665


class Machine(NamedTuple):
    """A crane ready for the kernels."""

    scenario: Scenario
    chain: ChainParams
    actuators: ActuatorParams
    limits: MotionLimits

    @property
    def names(self) -> tuple[str, ...]:
        """The joints."""
        return self.scenario.joint_names


def machine(crane: str) -> Machine:
    """Return one of `CRANES` with its own drives."""
    path = config_dir() / CRANES[crane]
    config = read_settings(CraneConfig, read_yaml(path), lambda key: str(path))
    scenario = replace(load_scenario("case2"), crane=config)
    limits = build.crane_limits(config, build.crane_drives(config))
    return Machine(scenario, build.crane_chain(config), build.crane_actuators(config), limits)


def safe_load(crane: Machine, q: Array) -> float:
    """Return the safe working load [kg] where the tip is at joint values q (n,)."""
    return float(safe_working_load(build.load_limiter(crane.scenario), radius_and_slopes(crane.chain, q)[0]))


def loaded_state(crane: Machine, q: Array, mass: float) -> Array:
    """Return the state (7 n,) of a crane at rest at q (n,), a mass [kg] on its tip."""
    still, up = np.zeros(3), np.array([0.0, 0.0, GRAVITY])
    weight = np.array([0.0, 0.0, -mass * GRAVITY])
    effort = bias_forces(crane.chain, q, np.zeros_like(q), still, still, up, weight)
    return standing_state(crane.actuators, crane.limits.drives, q, effort)


