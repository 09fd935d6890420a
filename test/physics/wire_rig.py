"""A wire under a fixed or moving tip, for tests."""

import numpy as np

from shipcrane_twin.config.load import load_scenario
from shipcrane_twin.cosim.build import winch_params
from shipcrane_twin.physics.payload import hanging_state, payload_step
from shipcrane_twin.physics.winch import POWERED, winch_at_rest, winch_step
from shipcrane_twin.physics.wire import STEP_MIN
from shipcrane_twin.validation.lifting_wire import FIXED, WIRE, stiffness_at

SCENARIO = load_scenario("case2")
WINCH = winch_params(SCENARIO)


def swung_state(angle, length, mass, wire=WIRE):
    """Load at rest beside the fixed tip, the wire stretched by its pull at that angle."""
    state = hanging_state(wire, FIXED[:3], np.zeros(3), length, mass)
    reach = length + mass * wire.gravity * np.cos(angle) / stiffness_at(length, wire)
    state[:3] = FIXED[:3] + reach * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    return state


def hoist(state, step_s, count, command=0.0, drive=POWERED, winch=WINCH, wire=WIRE, at_rest=None, by_length=False):
    """States of the load and of the winch after each of `count` macro steps under the fixed tip."""
    memory = winch_at_rest(winch, step_s) if at_rest is None else at_rest
    states, memories, forces = [state], [memory], []
    for _ in range(count):
        told = memory[1] if drive == POWERED else 0.0
        memory, hold = winch_step(winch, memory, states[-1][6], command, by_length, drive, step_s)
        state, force, tension = payload_step(wire, hold, states[-1], told, memory[1], FIXED, FIXED, step_s)
        states.append(state)
        memories.append(memory)
        forces.append((*force, tension))
    return np.array(states), np.array(memories), np.array(forces)


def energies(states, wire=WIRE):
    """Kinetic and total energy of each state under the fixed tip."""
    mass, length = states[:, 8], states[:, 6]
    kinetic = 0.5 * mass * np.sum(states[:, 3:6] ** 2, axis=1)
    stretch = np.maximum(0.0, np.linalg.norm(states[:, :3] - FIXED[:3], axis=1) - length)
    stiffness = np.minimum(stiffness_at(length, wire), mass * (wire.phase_max / STEP_MIN) ** 2)
    elastic = 0.5 * stiffness * stretch**2
    return kinetic, kinetic + elastic + mass * wire.gravity * (states[:, 2] - FIXED[2])
