"""Anti-sway as a participant: the operator's slew and boom rates in, rates that leave no sway out."""

import numpy as np

from shipcrane_twin.config.controllers import ANTI_SWAY_JOINTS, AntiSwayConfig, steered_joints
from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.control.anti_sway import (
    AntiSwayParams,
    anti_sway_start,
    anti_sway_step,
    make_anti_sway,
    sway_offset,
)
from shipcrane_twin.cosim import build
from shipcrane_twin.cosim.commands import JointCommands
from shipcrane_twin.cosim.subsystems.base import Signals
from shipcrane_twin.cosim.time import seconds
from shipcrane_twin.physics.crane_chain import tip_state


class AntiSway:
    """Hears the operator and speaks for slew and boom in the operator's place."""

    name = "anti_sway"

    def __init__(self, scenario: Scenario) -> None:
        self._params = anti_sway_params(scenario)
        self._state = anti_sway_start(self._params)
        self._step_ns = scenario.step_ns
        self._length = scenario.winch.initial_length_m
        self.commands = JointCommands(ANTI_SWAY_JOINTS, scenario.operations, steered_joints(scenario.controllers))

    def start(self) -> Signals:
        """Return the rates for the first step; the load hangs at rest."""
        return self._say(0, self._length, np.zeros(2), np.zeros(2))

    def step(self, k: int, inputs: Signals) -> Signals:
        """Return at t_k the rates for the step that follows."""
        tip_w, load_w = inputs["/crane/tip"][:3], inputs["/payload/odom"][:3]
        offset, lever = sway_offset(self._params, inputs["/vessel/odom"], tip_w, load_w)
        return self._say(k, float(np.linalg.norm(load_w - tip_w)), offset, lever)

    def _say(self, k: int, length: float, offset: np.ndarray, lever: np.ndarray) -> Signals:
        _, wanted = self.commands.at(k * self._step_ns)
        self._state, rates = anti_sway_step(self._params, self._state, wanted, length, offset, lever)
        return {"/anti_sway/joint_command": rates}


def anti_sway_params(scenario: Scenario) -> AntiSwayParams:
    """Return the controller's constants; where the boom's pivot is follows from how the boom alone moves the tip."""
    config = next(one for one in scenario.controllers if isinstance(one, AntiSwayConfig))
    joints = np.array(scenario.crane.initial_joints)
    lift = np.array([float(name == "boom") for name in scenario.joint_names])
    tip_b, velocity_b, omega_b, _ = tip_state(build.crane_chain(scenario.crane), joints, lift)
    # a rate of 1 that lifts turns about -along, and moves the tip outward by -(height above the pivot)
    sign = -float(np.sign(tip_b[0] * omega_b[1] - tip_b[1] * omega_b[0]))
    along = -sign * omega_b
    outward = np.array([along[1], -along[0], 0.0])  # in the boom's plane, which misses the slew axis by a little
    winch = scenario.winch
    return make_anti_sway(
        damping_ratio=config.damping_ratio,
        mean_time_s=config.mean_time_s,
        tip_speed_max=config.tip_speed_max_m_s,
        rate_max=np.array([config.slew_rate_max_rad_s, config.boom_rate_max_rad_s]),
        length_min=winch.length_min_m,
        length_max=winch.length_max_m,
        gravity=scenario.constants.gravity_m_s2,
        period=seconds(scenario.step_ns),
        crane_base=np.array(scenario.crane.base_m),
        pivot_height=float(tip_b[2] + sign * velocity_b @ outward),
        boom_sign=sign,
    )
