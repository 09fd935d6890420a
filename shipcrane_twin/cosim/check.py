"""Whether a scenario that reads well can also be built: names of schemes, geometry, equilibrium, stability."""

import itertools
import math

import numpy as np

from shipcrane_twin.config.scenario import Scenario
from shipcrane_twin.config.settings import ConfigError, nearest
from shipcrane_twin.cosim.build import crane_actuators, crane_chain, crane_drives
from shipcrane_twin.cosim.controllers import check_controllers, own_chain_of
from shipcrane_twin.cosim.coupling import CHAIN, SCHEMES
from shipcrane_twin.cosim.initial import Rest, at_rest
from shipcrane_twin.cosim.subsystems import make_subsystem
from shipcrane_twin.cosim.topics import THRUSTERS
from shipcrane_twin.physics.arrays import Array
from shipcrane_twin.physics.crane_actuators import joint_stiffness
from shipcrane_twin.physics.crane_chain import ChainParams, tip_jacobian
from shipcrane_twin.physics.crane_cylinders import joint_rates_per_length, joints_from_lengths
from shipcrane_twin.physics.crane_dynamics import bias_forces, mass_matrix
from shipcrane_twin.physics.frames import matrix_from_quat, rotate_to_body

RK4_REACH = 2.5
"""Largest rate times step that classical Runge-Kutta integrates stably (2.79 for real rates), with a margin."""

SLING_REACH = 1.0
"""Of a sling's stiffness times step squared over the tip's inertia; loads of 5 t start to chatter from 1.5 on."""


def check_buildable(scenario: Scenario) -> None:
    """Raise ConfigError if the physics refuses the scenario's numbers.

    Parameters
    ----------
    scenario : Scenario
        Already right in types, ranges and across its parts.
    """
    name = scenario.name
    if scenario.coupling not in SCHEMES:
        raise ConfigError(f"{name}: coupling is {scenario.coupling!r}; {nearest(scenario.coupling, list(SCHEMES))}")
    names = tuple(thruster.name for thruster in scenario.vessel.thrusters)
    if names != THRUSTERS:
        raise ConfigError(
            f"{name}: vessel.thrusters are {', '.join(names)}, expected {', '.join(THRUSTERS)} in this order; "
            "their names are those that /thrusters/joint_states publishes"
        )
    try:
        chain = crane_chain(scenario.crane)
        drives = crane_drives(scenario.crane)
        rest = at_rest(scenario)
        for part in ("vessel", "crane", *own_chain_of(scenario)[len(CHAIN) :]):
            make_subsystem(part, scenario)
    except ValueError as err:
        raise ConfigError(f"{name}: {err}") from None
    ends = np.sort([joints_from_lengths(drives, drives.length_min), joints_from_lengths(drives, drives.length_max)], 0)
    start = scenario.crane.initial_joints
    for link, value, low, high in zip(scenario.crane.links, start, *ends, strict=True):
        if not low <= value <= high:
            raise ConfigError(
                f"{name}: crane.initial_joints has {value:g} for {link.joint}, "
                f"expected {low:.4f} to {high:.4f}, where its cylinder ends"
            )
    check_controllers(scenario)
    check_strength(scenario, chain, rest)
    check_servo_step(scenario, chain, ends)
    check_sling(scenario, chain)


def check_sling(scenario: Scenario, chain: ChainParams) -> None:
    """Raise ConfigError if the sling of a box is too stiff for the macro step.

    Its force reaches the tip a step late, so stiffness times step squared is bounded by the tip's own inertia.
    """
    box = scenario.payload.box
    if box is None:
        return
    q = np.array(scenario.crane.initial_joints)
    lift = tip_jacobian(chain, q)[2]
    tip_mass = 1.0 / float(lift @ np.linalg.solve(mass_matrix(chain, q), lift))
    upright = 1.0 - (0.5 * box.sling.lug_distance_m / box.sling.leg_length_m) ** 2
    allowed = SLING_REACH * tip_mass / (2.0 * upright * (1e-3 * scenario.macro_step_ms) ** 2)
    if box.sling.leg_stiffness_n_m > allowed:
        raise ConfigError(
            f"{scenario.name}: payload.box.sling.leg_stiffness_n_m is {box.sling.leg_stiffness_n_m:g}, too stiff for "
            f"macro_step_ms = {scenario.macro_step_ms:g} on this crane; "
            f"expected at most {allowed:.3g}, or a shorter step"
        )


def check_strength(scenario: Scenario, chain: ChainParams, rest: Rest) -> None:
    """Raise ConfigError if a joint's drive cannot hold crane and load at the start."""
    rot = matrix_from_quat(rest.vessel[3:7])
    still = np.zeros(3)
    proper_b = scenario.constants.gravity_m_s2 * rot[2]
    force_b = rotate_to_body(rot, rest.wire_force_w)
    efforts = bias_forces(chain, rest.joints, np.zeros_like(rest.joints), still, still, proper_b, force_b)
    actuators = crane_actuators(scenario.crane)
    forces = efforts * joint_rates_per_length(crane_drives(scenario.crane), rest.joints)
    limits = np.where(forces > 0.0, actuators.push, actuators.pull)
    for link, force, limit in zip(scenario.crane.links, forces, limits, strict=True):
        if abs(force) > limit:
            raise ConfigError(
                f"{scenario.name}: the {link.joint} needs {abs(force):.3g} to hold crane and load at the start, but "
                f"its drive has {limit:.3g}; lighten the load "
                f"(payload.mass_kg = {scenario.payload.mass_kg:g}), shorten the radius (crane.initial_joints) or "
                "strengthen the drive"
            )


def check_servo_step(scenario: Scenario, chain: ChainParams, ends: Array) -> None:
    """Raise ConfigError if the crane's micro steps are too long for its fastest servo mode in any posture.

    Parameters
    ----------
    scenario : Scenario
    chain : ChainParams
    ends : float64, shape (2, n)
        Lowest and highest joint values; infinite for joints without ends.
    """
    crane = scenario.crane
    start = np.array(crane.initial_joints)
    actuators, drives = crane_actuators(crane), crane_drives(crane)
    postures = [
        np.linspace(low, high, 5) if math.isfinite(high - low) else [value]
        for low, high, value in zip(*ends, start, strict=True)
    ]
    fastest = 0.0
    for posture in itertools.product(*postures):
        stiffness, damping = joint_stiffness(actuators, drives, np.array(posture))
        fastest = max(fastest, servo_rate(chain, np.array(posture), stiffness, damping))
    step_ms = scenario.macro_step_ms / math.ceil(scenario.macro_step_ms / crane.servo.micro_step_max_ms)
    allowed_ms = 1e3 * RK4_REACH / fastest
    if step_ms > allowed_ms:
        raise ConfigError(
            f"{scenario.name}: crane.servo.micro_step_max_ms is {crane.servo.micro_step_max_ms:g}, too long for the "
            f"fastest servo mode ({fastest:.0f} 1/s); expected at most {allowed_ms:.2f}"
        )


def servo_rate(chain: ChainParams, q: Array, stiffness: Array, damping: Array) -> float:
    """Return the largest rate |lambda| [1/s] of ``M q'' + damping q' + stiffness q = 0`` at a posture."""
    n = len(q)
    inverse = np.linalg.inv(mass_matrix(chain, q))
    system = np.zeros((2 * n, 2 * n))
    system[:n, n:] = np.eye(n)
    system[n:, :n] = -inverse * stiffness
    system[n:, n:] = -inverse * damping
    return float(np.abs(np.linalg.eigvals(system)).max())
